//! Power by face, object, group and material, as CSV.
//!
//! | column | what it holds |
//! |---|---|
//! | `of` | `scene`, `material`, `object`, `group` or `face`: what the row adds up |
//! | `face` | the number of the face in the input, from 1 |
//! | `material`, `object`, `group` | its names in the input; empty where it has none |
//! | `area_m2` | the area, of both sides where both emit and reflect |
//! | `emitted_r,...` | W by channel |
//! | `incident_r,...` | W that arrive |
//! | `absorbed_r,...` | W of these that are not reflected |
//! | `net_r,...` | absorbed less emitted |

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use super::values::channel_columns;
use crate::scene::{FaceNames, Scene, Surface};
use crate::solve::{Flux, Solution};

/// Writes the powers of [`Solution::fluxes`], of the whole scene first and of single faces last.
///
/// # Errors
/// What the writer says.
pub fn write_fluxes(writer: &mut impl Write, solution: &Solution) -> io::Result<()> {
    let scene = solution.scene();
    let fluxes = solution.fluxes();
    let quantities = ["emitted", "incident", "absorbed", "net"].map(|name| channel_columns(name, scene.channels()).join(","));
    writeln!(writer, "of,face,material,object,group,area_m2,{}", quantities.join(","))?;

    let mut whole = Flux::none(scene.channels());
    fluxes.iter().for_each(|flux| whole.add(flux));
    write_row(writer, ["scene", "", "", "", ""], &whole)?;

    let material = |surface: &Surface| Some(surface.material as usize);
    for (number, flux) in &added_by(scene, &fluxes, material) {
        write_row(writer, ["material", "", &quoted(&scene.materials()[*number].name), "", ""], flux)?;
    }
    for (number, flux) in &added_by(scene, &fluxes, |surface| scene.objects().of(surface.face)) {
        write_row(writer, ["object", "", "", &quoted(&scene.objects().names()[*number]), ""], flux)?;
    }
    for (number, flux) in &added_by(scene, &fluxes, |surface| scene.groups().of(surface.face)) {
        write_row(writer, ["group", "", "", "", &quoted(&scene.groups().names()[*number])], flux)?;
    }

    // All pieces and sides of a face together; its pieces have one material.
    let material_of: BTreeMap<u32, u32> = scene.surfaces().iter().map(|surface| (surface.face, surface.material)).collect();
    for (&face, flux) in &added_by(scene, &fluxes, |surface| Some(surface.face as usize)) {
        let face = face as u32;
        let name = |names: &FaceNames| names.of(face).map_or(String::new(), |number| quoted(&names.names()[number]).into_owned());
        let material = &scene.materials()[material_of[&face] as usize].name;
        let (number, object, group) = ((u64::from(face) + 1).to_string(), name(scene.objects()), name(scene.groups()));
        write_row(writer, ["face", &number, &quoted(material), &object, &group], flux)?;
    }
    Ok(())
}

/// The powers of surfaces that `key` puts together, by ascending key.
fn added_by(scene: &Scene, fluxes: &[Flux], key: impl Fn(&Surface) -> Option<usize>) -> BTreeMap<usize, Flux> {
    let mut sums = BTreeMap::new();
    for (surface, flux) in scene.surfaces().iter().zip(fluxes) {
        if let Some(key) = key(surface) {
            sums.entry(key).or_insert_with(|| Flux::none(scene.channels())).add(flux);
        }
    }
    sums
}

fn write_row(writer: &mut impl Write, names: [&str; 5], flux: &Flux) -> io::Result<()> {
    write!(writer, "{},{}", names.join(","), flux.area)?;
    for numbers in [&flux.emitted, &flux.incident, &flux.absorbed, &flux.net().collect()] {
        numbers.iter().try_for_each(|power| write!(writer, ",{power}"))?;
    }
    writeln!(writer)
}

/// A field as CSV takes it (RFC 4180): in quotes, if it has a comma, a quote or the end of a line in it.
fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", field.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(field)
    }
}
