//! A solution as one page for browsers: the lit scene in 3D, and what is known of it. It loads nothing from anywhere.
//!
//! # The format
//! HTML with its style, its program (`assets/page`, and three.js beside them) and these elements, whose texts are data; arrays are deflated (zlib, RFC 1950)
//! and written in base64, all numbers little-endian:
//!
//! | id | what its text is |
//! |---|---|
//! | `facts-data` | JSON: title, materials, camera, options, counts, errors, and the run's report where there is one |
//! | `positions` | `f32`, three for each node, in metres |
//! | `radiosity` | `f32`, one or three for each node, in W/m^2 |
//! | `standard-errors` | `f32`, for each node the standard error of its radiosity, channels together; empty where it is not known |
//! | `elements` | `u32`: six nodes of each element of the lit mesh |
//! | `triangles` | `u32`: three nodes of each triangle of surfaces without elements, or of the solver's elements |
//! | `element-runs`, `triangle-runs` | `u32`: the surface that so many of these in a row are on, and how many |
//! | `surfaces` | `u32`: of each surface the number of its face, and of its material, object and group among the names of these, 2^32 - 1 where it has none |
//! | `group-radiosity` | as `radiosity`, of each light group alone; without groups empty |
//! | `plane-values` | `f32`: what the sensors of measuring planes show, row after row and plane after plane, in the unit of the plane |
//! | `curve-ends` | `f32`: the ends of lines where light is not smooth, six coordinates each, in metres; those of each degree in a row |
//! | `lost-ray-ends` | `f32`: the ends of some rays from surfaces that leave the scene, then of some that meet backs, as those |

mod curves;
mod geometry;
mod groups;
mod lost;
mod planes;
mod warned;

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};

use self::geometry::Geometry;
use self::groups::Groups;
use super::{LUMENS_PER_WATT, MeasuredPlane, Provenance, Quantity, RunReport, origin};
use crate::discontinuities::CurveSegment;
use crate::inspect::SurfaceRays;
use crate::picture::Camera;
use crate::solve::{Norm, Solution, SolveOptions};

const HTML: &str = include_str!("../../../assets/page/page.html");
const PARTS: [(&str, &str); 13] = [
    ("{{style}}", include_str!("../../../assets/page/page.css")),
    ("{{three}}", include_str!("../../../assets/page/three.min.js")),
    ("{{input}}", include_str!("../../../assets/page/input.js")),
    ("{{scale}}", include_str!("../../../assets/page/scale.js")),
    ("{{history}}", include_str!("../../../assets/page/history.js")),
    ("{{facts}}", include_str!("../../../assets/page/facts.js")),
    ("{{groups}}", include_str!("../../../assets/page/groups.js")),
    ("{{shaders}}", include_str!("../../../assets/page/shaders.js")),
    ("{{planes}}", include_str!("../../../assets/page/planes.js")),
    ("{{segments}}", include_str!("../../../assets/page/segments.js")),
    ("{{edges}}", include_str!("../../../assets/page/edges.js")),
    ("{{places}}", include_str!("../../../assets/page/places.js")),
    ("{{page}}", include_str!("../../../assets/page/page.js")),
];
const DATA: &str = "{{data}}";

/// What a page shows.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// What stands above it, such as the name of the scene's file.
    pub title: &'a str,
    /// The solution.
    pub solution: &'a Solution,
    /// The first view.
    pub camera: &'a Camera,
    /// What the run tells about itself, if it is known.
    pub report: Option<&'a RunReport>,
    /// Measuring planes.
    pub planes: &'a [MeasuredPlane],
    /// Where light is not smooth.
    pub curves: &'a [CurveSegment],
    /// What rays from the surfaces met: those that light would be lost on are shown.
    pub met: &'a SurfaceRays,
}

/// Writes a page.
///
/// # Errors
/// What the writer says.
pub fn write_page(writer: &mut impl Write, page: &Page<'_>, provenance: &Provenance) -> io::Result<()> {
    // Between the parts of the frame stand style, data and programs, in the order of the frame.
    let mut rest = HTML;
    while let Some(at) = rest.find("{{") {
        writer.write_all(&rest.as_bytes()[..at])?;
        rest = &rest[at..];
        if let Some(behind) = rest.strip_prefix(DATA) {
            write_data(writer, page, provenance)?;
            rest = behind;
            continue;
        }
        let part = PARTS.iter().find_map(|(mark, text)| Some((text, rest.strip_prefix(mark)?)));
        let Some((text, behind)) = part else { break };
        writer.write_all(text.as_bytes())?;
        rest = behind;
    }
    writer.write_all(rest.as_bytes())
}

/// Writes the elements with data.
fn write_data(writer: &mut impl Write, page: &Page<'_>, provenance: &Provenance) -> io::Result<()> {
    let geometry = Geometry::of(page.solution);
    let groups = Groups::of(page.solution)?;
    let (of_groups, groups) = groups.map_or((Vec::new(), Value::Null), |groups| (groups.radiosity, groups.facts));
    let mut facts = facts(page, &geometry, provenance);
    facts["light_groups"] = groups;
    let (planes, plane_values) = planes::told(page.planes, page.solution.scene());
    facts["planes"] = planes;
    let (degrees, curve_ends) = curves::told(page.curves);
    facts["curves"] = json!(degrees);
    let (lost, lost_ray_ends) = lost::told(page.met);
    facts["lost"] = lost;
    // Within a script no text of the data may look like its end.
    let facts = facts.to_string().replace('<', "\\u003c");
    writeln!(writer, "<script type=\"application/json\" id=\"facts-data\">{facts}</script>")?;

    let scene = page.solution.scene();
    let surfaces = (0..scene.surfaces().len() as u32)
        .flat_map(|surface| origin::of_surface(scene, surface))
        .map(|number| number as u32)
        .collect();
    let of_floats = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let of_numbers = |numbers: &Vec<u32>| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    for (id, bytes) in [
        ("positions", of_floats(&geometry.positions)),
        ("radiosity", of_floats(&geometry.radiosity)),
        ("standard-errors", of_floats(&geometry.errors)),
        ("elements", of_numbers(&geometry.elements)),
        ("triangles", of_numbers(&geometry.triangles)),
        ("element-runs", of_numbers(&geometry.element_runs)),
        ("triangle-runs", of_numbers(&geometry.triangle_runs)),
        ("surfaces", of_numbers(&surfaces)),
        ("group-radiosity", of_floats(&of_groups)),
        ("plane-values", of_floats(&plane_values)),
        ("curve-ends", of_floats(&curve_ends)),
        ("lost-ray-ends", of_floats(&lost_ray_ends)),
    ] {
        write!(writer, "<script type=\"text/plain\" id=\"{id}\">")?;
        let mut array = ZlibEncoder::new(EncoderWriter::new(&mut *writer, &STANDARD), Compression::default());
        array.write_all(&bytes)?;
        array.finish()?.finish()?;
        writeln!(writer, "</script>")?;
    }
    Ok(())
}

/// All that the page tells in words and numbers.
fn facts(page: &Page<'_>, geometry: &Geometry, provenance: &Provenance) -> Value {
    let Page { solution, camera, .. } = *page;
    let (scene, options) = (solution.scene(), solution.options());
    let quantity = if matches!(scene.channels(), 1 | 3) { Quantity::Illuminance } else { Quantity::Irradiance };
    let per_irradiance = if quantity == Quantity::Illuminance { LUMENS_PER_WATT } else { 1.0 };
    let changed = changed_options(options);
    let materials = scene.materials().iter().map(|material| {
        let [reflectance, exitance] = [&material.reflectance, &material.exitance].map(|of| geometry::shown(of));
        json!({ "name": material.name, "reflectance": reflectance, "exitance": exitance })
    });
    let kind = if solution.mesh().is_some() { "elements of the lit mesh" } else { "elements of the solver" };
    let elements = if solution.mesh().is_some() { geometry.elements.len() / 6 } else { leaves(solution) };
    json!({
        "title": page.title,
        "claim": claim(page),
        "errors": errors(page),
        "about_errors": about_errors(options),
        "counts": [
            ("surfaces", scene.surfaces().len()),
            ("materials", scene.materials().len()),
            ("channels", scene.channels()),
            (kind, elements),
            ("nodes shown", geometry.positions.len() / 3),
        ],
        "materials": materials.collect::<Vec<Value>>(),
        "objects": scene.objects().names(),
        "groups": scene.groups().names(),
        "shown_channels": geometry.channels,
        "quantity": quantity.name(),
        "unit": quantity.unit(),
        "per_irradiance": per_irradiance,
        "camera": {
            "eye": camera.eye, "target": camera.target, "up": camera.up, "fov": camera.field_of_view_degrees,
            "aspect": f64::from(camera.width) / f64::from(camera.height),
        },
        "command": command(page, &changed),
        "options": changed,
        "software": provenance.software(),
        "report": page.report,
        "places": warned::places(scene, page.report.map_or(&[], |report| &report.warned_faces)),
    })
}

/// How many elements the solver has.
fn leaves(solution: &Solution) -> usize {
    let mut count = 0;
    solution.for_each_leaf(|_, _, _| count += 1);
    count
}

/// The claim of what is shown, in words.
fn claim(page: &Page<'_>) -> String {
    let options = page.solution.options();
    let claimed = match page.report {
        Some(RunReport { lit_mesh: Some(mesh), .. }) => Some(mesh.whole.estimate),
        Some(report) => Some(report.error.estimate),
        None => None,
    };
    let asked = format!("{:.2}% asked for in the {} norm", 100.0 * options.error, options.norm);
    match claimed {
        Some(claimed) if claimed.is_finite() => format!("error {:.2}% claimed, {asked}", 100.0 * claimed),
        _ => asked,
    }
}

/// The errors that are known, as parts; `null` becomes "not known".
fn errors(page: &Page<'_>) -> Vec<(&'static str, Option<f64>)> {
    let mut errors = vec![("asked for", Some(page.solution.options().error))];
    if let Some(RunReport { error, lit_mesh, .. }) = page.report {
        errors.extend([("values at points, claimed", Some(error.estimate)), ("values at points, measured", Some(error.measured))]);
        if let Some(mesh) = lit_mesh {
            errors.extend([
                ("lit mesh off these, claimed", Some(mesh.off_values.estimate)),
                ("both together, claimed", Some(mesh.whole.estimate)),
            ]);
        }
    } else if let Some(mesh) = page.solution.mesh() {
        errors.push(("lit mesh off values at points, claimed", Some(mesh.claimed)));
    }
    errors
}

fn about_errors(options: &SolveOptions) -> &'static str {
    match options.norm {
        Norm::Local => {
            "Root mean square over the lit area, relative to the reflected light at each place, or to typical light where it is darker."
        }
        Norm::Energy => "Root mean square over all surfaces, relative to that of all reflected light.",
    }
}

/// Key and value of all options that are not the default.
fn changed_options(options: &SolveOptions) -> Vec<(&'static str, String)> {
    let default = SolveOptions::default();
    let changed = |entry: &crate::solve::OptionEntry| {
        let value = entry.value(options)?;
        (entry.value(&default).as_ref() != Some(&value)).then_some((entry.key, value))
    };
    SolveOptions::entries().filter_map(changed).collect()
}

/// The command that does it again.
fn command(page: &Page<'_>, changed: &[(&'static str, String)]) -> String {
    let scene = page.report.map_or("SCENE.obj".into(), |report| report.scene.file.to_string_lossy());
    let quoted = |text: &str| {
        let is_plain = text.chars().all(|c| c.is_ascii_alphanumeric() || "._-/+:=,".contains(c));
        if is_plain { text.to_owned() } else { format!("'{}'", text.replace('\'', "'\\''")) }
    };
    let sides = match page.solution.scene().sides() {
        crate::scene::Sides::Front => "",
        crate::scene::Sides::Both => " --sides both",
    };
    let set: String = changed.iter().map(|(key, value)| format!(" --set {}", quoted(&format!("{key}={value}")))).collect();
    let planes: String = page.planes.iter().map(|plane| format!(" --plane {}", quoted(&plane.name))).collect();
    let curves = if page.curves.is_empty() { "" } else { " --curves" };
    format!("patchlight solve {}{sides}{set} --html page.html{planes}{curves}", quoted(&scene))
}
