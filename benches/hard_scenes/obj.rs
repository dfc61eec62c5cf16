//! Scenes as OBJ files.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};

/// Writes a scene of three channels with its materials, and reads it as the program does: the file and what is in it.
pub fn through_obj(scene: &Scene, folder: &Path, name: &str) -> (PathBuf, Scene) {
    let mut materials = String::new();
    let mut names = HashSet::new();
    for material in scene.materials() {
        assert!(names.insert(&material.name), "{name}: two materials named {}", material.name);
        let triple = |values: &[f64]| format!("{} {} {}", values[0], values[1], values[2]);
        let radiance: Vec<f64> = material.exitance.iter().map(|exitance| exitance / PI).collect();
        let (reflectance, radiance) = (triple(&material.reflectance), triple(&radiance));
        let _ = writeln!(materials, "newmtl {}\nKd {reflectance}\nKe {radiance}", material.name);
    }
    let mut text = format!("mtllib {name}.mtl\n");
    let mut vertices = 0;
    for surface in scene.surfaces() {
        let corners = surface.polygon.vertices();
        let numbers: Vec<String> = (1..=corners.len()).map(|k| (vertices + k).to_string()).collect();
        vertices += corners.len();
        corners.for_each(|[x, y, z]| writeln!(text, "v {x} {y} {z}").unwrap_or_default());
        let material = &scene.materials()[surface.material as usize].name;
        let _ = writeln!(text, "usemtl {material}\nf {}", numbers.join(" "));
    }
    let file = folder.join(format!("{name}.obj"));
    std::fs::write(folder.join(format!("{name}.mtl")), materials).expect("materials are written");
    std::fs::write(&file, text).expect("a scene is written");
    let read = read_scene(&file, &ImportOptions::default()).expect("a scene that was just written").scene;
    assert_eq!(read.surfaces().len(), scene.surfaces().len(), "{name}: the reader drops or cuts faces");
    (file, read)
}
