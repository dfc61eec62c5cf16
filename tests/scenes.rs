//! The scenes in `scenes/` are what their generator writes, and they are read without any complaint.

use std::path::Path;

use patchlight::inspect::{DEFAULT_POINTS, inspect};
use patchlight::scene::SceneSummary;
use patchlight::scene::import::{ImportOptions, Imported, read_scene};
use patchlight::visibility::{Backend, OccluderMesh, build};

#[path = "../examples/generate_scenes/cornell.rs"]
mod cornell;
#[path = "../examples/generate_scenes/furnace.rs"]
mod furnace;
#[path = "../examples/generate_scenes/model.rs"]
mod model;
#[path = "../examples/generate_scenes/room.rs"]
mod room;
#[path = "../examples/generate_scenes/scenes.rs"]
mod scenes;

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes"))
}

fn read(name: &str) -> (Imported, SceneSummary, patchlight::inspect::Inspection) {
    let imported = read_scene(&folder().join(name), &ImportOptions::default()).unwrap();
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&imported.scene)).unwrap();
    let inspection = inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS);
    let mut diagnostics = imported.diagnostics.clone();
    diagnostics.items.extend(inspection.suspicions(&imported.file, &imported.lines));
    let summary = SceneSummary::new(&imported.scene, &diagnostics);
    assert_eq!((&summary.repairs, &summary.suspicions), (&vec![], &vec![]), "{name}:\n{summary}\n{inspection:?}");
    (imported, summary, inspection)
}

#[test]
fn the_committed_scenes_are_those_of_the_generator() {
    for (name, content) in scenes::all() {
        let committed = std::fs::read_to_string(folder().join(&name)).unwrap();
        assert!(committed == content, "scenes/{name} differs; run: cargo run --example generate_scenes");
    }
}

#[test]
fn the_furnace_is_closed_and_shines_pi_watts_a_square_metre() {
    let (_, summary, inspection) = read("furnace.obj");
    assert_eq!((summary.surfaces, summary.area, inspection.escaped, inspection.met_back), (6, 6.0, 0, 0));
    assert!(summary.emitted_power.iter().all(|power| (power / (6.0 * std::f64::consts::PI) - 1.0).abs() < 1e-15));
}

#[test]
fn the_cornell_box_has_its_published_measures() {
    let (imported, summary, inspection) = read("cornell.obj");
    assert_eq!((summary.faces, summary.emitters, inspection.met_back), (20, 1, 0));
    assert_eq!(summary.bounds, [[0.0, 0.0, 0.0], [0.556, 0.5488, 0.5592]]);
    let light = imported.scene.surfaces().iter().find(|s| imported.scene.materials()[s.material as usize].emits()).unwrap();
    assert!((light.polygon.area() - 0.130 * 0.105).abs() < 1e-15);
    assert_eq!(light.polygon.normal(), [0.0, -1.0, 0.0]);
}

#[test]
fn the_room_is_closed_and_nothing_in_it_is_inside_out() {
    let (_, summary, inspection) = read("room.obj");
    assert_eq!((inspection.escaped, inspection.met_back), (0, 0), "{inspection:?}");
    assert!((400..=800).contains(&summary.faces), "{}", summary.faces);
    assert!(summary.emitters >= 2);
    assert!((summary.bounds[1][0] - summary.bounds[0][0] - 5.16).abs() < 1e-12);
}
