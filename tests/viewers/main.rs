//! Other programs: the Khronos glTF validator, Blender, PyVista and trimesh open what is written, and what they and three.js write is read.
//!
//! They are asked where they are installed, and skipped aloud where they are not: `npm install gltf-validator three` where `NODE_PATH` says; `pip install bpy
//! pyvista trimesh` for the Python that `PATCHLIGHT_VIEWERS_PYTHON` names, or else `python3`.
#![allow(clippy::print_stdout, reason = "a test tells what it skips")]

#[path = "../support/same_light.rs"]
mod same_light;
#[path = "../support/mod.rs"]
mod support;
mod three;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use patchlight::bake::{Atlas, BakeOptions, Lightmap};
use patchlight::output::{ExportFormat, Provenance, export_elements, export_mesh, export_vertex_light, write_lightmap_glb};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use serde_json::Value;

use same_light::{assert_same_areas, assert_same_light};

fn python() -> Command {
    Command::new(std::env::var_os("PATCHLIGHT_VIEWERS_PYTHON").unwrap_or_else(|| "python3".into()))
}

/// Whether a program can be asked; else it says that it is skipped.
fn is_there(mut check: Command, what: &str) -> bool {
    let is_there = check.output().is_ok_and(|ran| ran.status.success());
    if !is_there {
        println!("SKIPPED: {what} is not installed");
    }
    is_there
}

fn has_module(module: &str) -> bool {
    let mut check = python();
    check.args(["-c", &format!("import {module}")]);
    is_there(check, &format!("{module}, a package of Python,"))
}

/// Runs a script of this folder; what it writes.
fn run(mut program: Command, script: &str, files: &[&Path]) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/viewers").join(script);
    let ran = program.arg(&script).args(files).output().unwrap();
    assert!(ran.status.success(), "{}: {}", script.display(), String::from_utf8_lossy(&ran.stderr));
    String::from_utf8(ran.stdout).unwrap()
}

/// The JSON behind the word that marks it: libraries may say something before.
fn json_of(written: &str) -> Value {
    let line = written.lines().find_map(|line| line.strip_prefix("JSON ")).unwrap();
    serde_json::from_str(line).unwrap()
}

fn solved() -> Evaluator {
    let options = SolveOptions { error: 0.2, lit_mesh: true, ..SolveOptions::default() };
    pipeline::solve(support::small_room(3), &options, &RunOptions::default(), &Silent).unwrap().0
}

fn lightmap(evaluator: &Evaluator, size: u32) -> Lightmap {
    let options = BakeOptions { texel: 0.1, size, ..BakeOptions::default() };
    let atlas = Atlas::new(evaluator.solution().scene(), &options).unwrap();
    evaluator.bake(&atlas, None, &Silent).unwrap().unwrap()
}

/// All kinds of GLB, in a folder.
fn glbs(evaluator: &Evaluator, folder: &Path) -> Vec<PathBuf> {
    let (solution, provenance) = (evaluator.solution(), Provenance::new(evaluator.solution().options()));
    let (mut files, mut written) = (Vec::new(), Vec::new());
    let mut keep = |name: &str, written: &mut Vec<u8>| {
        let file = folder.join(name);
        fs::write(&file, std::mem::take(written)).unwrap();
        files.push(file);
    };
    let mesh = evaluator.mesh().unwrap();
    export_mesh(&mut written, ExportFormat::Glb, solution, mesh, &provenance).unwrap();
    keep("mesh.glb", &mut written);
    export_elements(&mut written, ExportFormat::Glb, solution, &provenance).unwrap();
    keep("elements.glb", &mut written);
    let light = evaluator.bake_vertices(&BakeOptions::default(), f64::INFINITY, &Silent).unwrap().unwrap();
    export_vertex_light(&mut written, ExportFormat::Glb, solution, &light, &provenance).unwrap();
    keep("vertices.glb", &mut written);
    for (name, size) in [("lightmap.glb", 4096), ("pages.glb", 32)] {
        write_lightmap_glb(&mut written, solution.scene(), &lightmap(evaluator, size), 0.0, &provenance).unwrap();
        keep(name, &mut written);
    }
    files
}

fn area(scene: &Scene) -> f64 {
    scene.surfaces().iter().map(|surface| surface.polygon.area()).sum()
}

#[test]
fn the_khronos_validator_finds_nothing_wrong() {
    let mut check = Command::new("node");
    check.args(["-e", "require('gltf-validator')"]);
    if !is_there(check, "gltf-validator, a package of Node.js,") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let files = glbs(&solved(), folder.path());
    let said = run(Command::new("node"), "validate.js", &files.iter().map(PathBuf::as_path).collect::<Vec<_>>());
    assert_eq!(said.lines().count(), files.len());
    for (line, file) in said.lines().zip(&files) {
        println!("{}: {line}", file.display());
        let found: Value = serde_json::from_str(line).unwrap();
        assert_eq!((&found["errors"], &found["warnings"]), (&0.into(), &0.into()), "{}: {line}", file.display());
    }

    // It would find something.
    let broken = folder.path().join("broken.glb");
    fs::write(&broken, &fs::read(&files[0]).unwrap()[..200]).unwrap();
    let said: Value = serde_json::from_str(&run(Command::new("node"), "validate.js", &[&broken])).unwrap();
    assert!(said["errors"].as_u64().unwrap() > 0, "{said}");
}

#[test]
fn blender_opens_meshes_and_lightmaps_as_they_were_written() {
    if !has_module("bpy") {
        return;
    }
    let (folder, evaluator) = (tempfile::tempdir().unwrap(), solved());
    let files = glbs(&evaluator, folder.path());
    let whole = area(evaluator.solution().scene());
    for file in &files {
        let found = json_of(&run(python(), "open.py", &[file]));
        assert!((found["area"].as_f64().unwrap() / whole - 1.0).abs() < 1e-5, "{}: {found}", file.display());
        let name = file.file_stem().unwrap().to_string_lossy();
        let size = match &*name {
            "lightmap" => 4096,
            "pages" => 32,
            _ => {
                assert!(found["colours"].as_array().unwrap().iter().all(|names| !names.as_array().unwrap().is_empty()), "{name}");
                continue;
            }
        };

        // Both sets of coordinates, and every page to the byte.
        assert!(found["uv_layers"].as_array().unwrap().iter().all(|count| *count == 2) && found["uv_in_page"] == true, "{name}");
        let lightmap = lightmap(&evaluator, size);
        let sizes: Vec<[u32; 2]> = serde_json::from_value(found["images"].clone()).unwrap();
        assert_eq!(sizes, lightmap.atlas.pages());
        let pixels: Vec<i64> = serde_json::from_value(found["pixels"].clone()).unwrap();
        let srgb = |x: f64| if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        let mut at = 0;
        for page in &lightmap.pages {
            let (width, height) = (page.width as usize, page.height as usize);
            for row in (0..height).rev() {
                for radiance in page.radiance[row * width * 3..][..width * 3].chunks(3) {
                    for (channel, &radiance) in radiance.iter().enumerate() {
                        let expected = 255.0 * srgb(f64::from(radiance).min(1.0));
                        assert!(
                            (pixels[at + channel] as f64 - expected).abs() <= 0.51,
                            "{name}: {} {expected}",
                            pixels[at + channel]
                        );
                    }
                    at += 4;
                }
            }
        }
        assert_eq!(at, pixels.len());
    }
}

/// Scenes that Blender reads from OBJ and writes as GLB, and trimesh once more.
const SCENES: [&str; 10] = [
    "cornell",
    "dining_room",
    "east_room",
    "exhibit_room",
    "four_polygons",
    "full_office",
    "gallery",
    "pyramid",
    "room",
    "two_rooms",
];

#[test]
fn scenes_by_other_hands_are_read_and_lit_as_ours() {
    if !has_module("bpy") {
        return;
    }
    let (folder, with_trimesh) = (tempfile::tempdir().unwrap(), has_module("trimesh"));
    let read = |file: &Path| read_scene(file, &ImportOptions::default()).unwrap().scene;
    for name in SCENES {
        let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
        let by_blender = folder.path().join(format!("{name}.glb"));
        run(python(), "convert.py", &[&ours, &by_blender]);
        let expected = read(&ours);
        assert_same_areas(name, &read(&by_blender), &expected);
        if with_trimesh {
            let by_trimesh = folder.path().join(format!("{name}.trimesh.glb"));
            run(python(), "pass_on.py", &[&by_blender, &by_trimesh]);
            assert!((area(&read(&by_trimesh)) / area(&expected) - 1.0).abs() < 1e-5, "{name} by trimesh");
        }
        if name == "room" {
            assert_same_light(&read(&by_blender), &expected);
        }
    }
}

#[test]
fn pyvista_reads_meshes_and_elements_as_they_were_written() {
    if !has_module("pyvista") {
        return;
    }
    let (folder, evaluator) = (tempfile::tempdir().unwrap(), solved());
    let (solution, provenance) = (evaluator.solution(), Provenance::new(evaluator.solution().options()));
    let whole = area(solution.scene());
    let read = |written: &[u8]| {
        let file = folder.path().join("a.vtp");
        fs::write(&file, written).unwrap();
        let found = json_of(&run(python(), "read_vtp.py", &[&file]));
        assert!((found["area"].as_f64().unwrap() / whole - 1.0).abs() < 1e-5, "{}", found["area"]);
        found
    };
    let numbers = |found: &Value| serde_json::from_value::<Vec<[f32; 3]>>(found["radiosity"].clone()).unwrap();

    // Elements, each with its radiosity.
    let mut written = Vec::new();
    export_elements(&mut written, ExportFormat::Vtp, solution, &provenance).unwrap();
    let found = read(&written);
    let mut leaves = Vec::new();
    solution.for_each_leaf(|_, _, radiosity| leaves.push([radiosity[0], radiosity[1], radiosity[2]]));
    assert_eq!(numbers(&found["cell_data"]), leaves);

    // The lit mesh: all nodes with theirs, in four triangles an element.
    let (mut written, mesh) = (Vec::new(), evaluator.mesh().unwrap());
    export_mesh(&mut written, ExportFormat::Vtp, solution, mesh, &provenance).unwrap();
    let found = read(&written);
    assert_eq!(found["cells"], 4 * mesh.elements() as u64);
    assert_eq!(numbers(&found["point_data"]).len() as u64, found["points"].as_u64().unwrap());
}
