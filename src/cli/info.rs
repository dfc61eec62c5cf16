//! `patchlight info`: what is in a scene or a solution, what was repaired, what is suspicious.

use std::fmt::Write;
use std::path::Path;

use patchlight::output::is_solution_file;
use patchlight::pipeline::PipelineError;
use patchlight::reconstruct::{BackFaces, sampled_back_faces};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, Sides, SurfaceId};
use patchlight::solve::Solution;
use patchlight::visibility::{self, Backend, OccluderMesh};

use super::arguments::InfoArguments;
use super::exit::{Exit, Failure};
use super::files;
use super::request::parse_sides;

/// Rays that look for back faces.
const BACK_FACE_RAYS: u32 = 20_000;

/// Below this share back faces are what rounding lets through at edges.
const BACK_FACE_SHARE: f64 = 1e-3;

/// Tells what is in a file.
pub fn info(arguments: &InfoArguments) -> Result<Exit, Failure> {
    let sides = parse_sides(&arguments.sides)?;
    let path = &arguments.file;
    let text = if is_solution_file(path) {
        describe_solution(path, &files::read_solution(path)?)
    } else {
        let imported = read_scene(path, &ImportOptions { sides }).map_err(Failure::bad_input)?;
        describe_scene_file(path, &imported.scene, imported.diagnostics.warnings)?
    };
    files::to_stdout(|writer| writer.write_all(text.as_bytes()))?;
    Ok(Exit::Done)
}

fn describe_scene_file(path: &Path, scene: &Scene, mut warnings: Vec<String>) -> Result<String, Failure> {
    let mesh = OccluderMesh::of_scene(scene);
    let visibility = visibility::build(Backend::Auto, &mesh).map_err(PipelineError::from)?;
    warnings.extend(warn_of_back_faces(path, &sampled_back_faces(scene, visibility.as_ref(), BACK_FACE_RAYS)));

    let mut text = format!("{}: scene\n", path.display());
    describe_scene(&mut text, scene);
    figure(&mut text, "triangles", &mesh.triangles.len().to_string());
    figure(&mut text, "warnings", &warnings.len().to_string());
    for warning in warnings {
        let _ = writeln!(text, "    {warning}");
    }
    Ok(text)
}

/// A wall that is seen from behind is nearly always wound the wrong way.
fn warn_of_back_faces(path: &Path, seen: &BackFaces) -> Option<String> {
    if seen.share() < BACK_FACE_SHARE {
        return None;
    }
    let faces: Vec<String> = seen.faces.iter().take(5).map(|(face, _)| (face + 1).to_string()).collect();
    let more = if seen.faces.len() > faces.len() { ", ..." } else { "" };
    Some(format!(
        "{}: {:.1}% of what the front faces see are back faces, which reflect nothing (face {}{more}); \
         turn them around or use --sides both",
        path.display(),
        100.0 * seen.share(),
        faces.join(", ")
    ))
}

fn describe_solution(path: &Path, solution: &Solution) -> String {
    let mut text = format!("{}: solution\n", path.display());
    describe_scene(&mut text, solution.scene());
    let mut leaves = 0_u64;
    solution.for_each_leaf(|_, _, _| leaves += 1);
    figure(&mut text, "leaves", &leaves.to_string());
    figure(&mut text, "options", &serde_json::to_string(solution.options()).unwrap_or_default());
    text
}

fn describe_scene(text: &mut String, scene: &Scene) {
    let surfaces = scene.surfaces();
    let area: f64 = surfaces.iter().map(|surface| surface.polygon.area()).sum();
    let sides = match scene.sides() {
        Sides::Front => "front sides",
        Sides::Both => "both sides",
    };
    figure(text, "surfaces", &format!("{} ({sides}), {area:.6} m^2", surfaces.len()));
    figure(text, "channels", &scene.channels().to_string());
    let bounds = scene.bounds();
    figure(text, "bounds", &format!("{:?} to {:?} m", bounds.min(), bounds.max()));
    figure(text, "materials", &scene.materials().len().to_string());

    // Power by channel, over the surfaces that emit.
    let mut power = vec![0.0; scene.channels()];
    let mut lights = 0;
    for (surface, id) in surfaces.iter().zip((0..).map(SurfaceId)) {
        let material = scene.material_of(id);
        lights += usize::from(material.emits());
        power.iter_mut().zip(&material.exitance).for_each(|(power, exitance)| *power += exitance * surface.polygon.area());
    }
    if lights == 0 {
        figure(text, "light", "none: every radiosity will be 0");
    } else {
        let power: Vec<String> = power.iter().map(|watts| format!("{watts:.4}")).collect();
        figure(text, "light", &format!("{} W emitted by {lights} surfaces", power.join(", ")));
    }
}

fn figure(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<10} {value}");
}
