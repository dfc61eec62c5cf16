//! Where surfaces come from in the input: the number of their face, counted from 0, and the names that it has there.

use std::io::{self, Write};

use crate::scene::{FaceNames, Scene};

/// What the columns or arrays are called that hold the numbers of [`of_surface`].
pub(super) const NUMBERS: [&str; 4] = ["face", "material", "object", "group"];

/// The number of a surface's face in the input, from 0, and of its material, object and group among the names of these, -1 where it has none.
pub(super) fn of_surface(scene: &Scene, surface: u32) -> [i64; 4] {
    let of = &scene.surfaces()[surface as usize];
    let named = |names: &FaceNames| names.of(of.face).map_or(-1, |name| name as i64);
    [of.face.into(), of.material.into(), named(scene.objects()), named(scene.groups())]
}

/// The names of all materials, objects and groups, with what each list is called.
pub(super) fn names(scene: &Scene) -> [(&'static str, Vec<&str>); 3] {
    let materials = scene.materials().iter().map(|material| material.name.as_str()).collect();
    let [objects, groups] = [scene.objects(), scene.groups()].map(|of| of.names().iter().map(String::as_str).collect());
    [("materials", materials), ("objects", objects), ("groups", groups)]
}

/// Writes the names as comments of a PLY file, `comment object 2 desk lamp`, numbered from 0.
pub(super) fn write_ply_comments(writer: &mut impl Write, scene: &Scene) -> io::Result<()> {
    for ((_, names), kind) in names(scene).into_iter().zip(&NUMBERS[1..]) {
        for (number, name) in names.into_iter().enumerate() {
            // A comment ends with its line.
            writeln!(writer, "comment {kind} {number} {}", name.replace(['\n', '\r'], " "))?;
        }
    }
    Ok(())
}

/// What the header of a PLY file says of the numbers that [`write_ply_numbers`] writes for each face.
pub(super) const PLY_PROPERTIES: &str = "property uint face\nproperty uint material\nproperty int object\nproperty int group";

/// Appends the numbers of a surface to a face of a PLY file.
pub(super) fn write_ply_numbers(writer: &mut impl Write, scene: &Scene, surface: u32) -> io::Result<()> {
    of_surface(scene, surface).iter().try_for_each(|&number| writer.write_all(&(number as u32).to_le_bytes()))
}
