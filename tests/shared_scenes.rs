//! Scenes by others, which lie beside the repository, in ../shared: `cargo test --test shared_scenes -- --ignored`.
#![allow(clippy::print_stderr, reason = "a test tells what it did")]

use std::path::{Path, PathBuf};

use patchlight::inspect::{DEFAULT_POINTS, inspect};
use patchlight::pipeline::solve;
use patchlight::progress::Silent;
use patchlight::scene::SceneSummary;
use patchlight::scene::import::{DiagnosticKind, ImportOptions, Severity, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use patchlight::visibility::{Backend, OccluderMesh, build};

fn shared() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared")
}

/// Every `scene.obj` of shared/scenes and every OBJ of shared/peers/scenes.
fn scene_files(shared: &Path) -> Vec<PathBuf> {
    let entries = |folder: &str| std::fs::read_dir(shared.join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries("scenes").map(|folder| folder.join("scene.obj")).filter(|file| file.is_file()).collect();
    files.extend(entries("peers/scenes").filter(|file| file.extension().is_some_and(|e| e == "obj")));
    files.sort();
    files
}

#[test]
#[ignore = "needs ../shared: scenes by others"]
fn every_scene_is_read_and_no_face_is_lost() {
    let shared = shared();
    for file in scene_files(&shared) {
        let imported = read_scene(&file, &ImportOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let summary = SceneSummary::new(&imported.scene, &imported.diagnostics);

        let text = std::fs::read_to_string(&file).unwrap();
        let written = text.lines().filter(|line| line.starts_with("f ")).count();
        let dropped =
            imported.diagnostics.count(DiagnosticKind::DegenerateFace) + imported.diagnostics.count(DiagnosticKind::DuplicateFace);
        eprintln!("== {}: {written} faces, {dropped} dropped\n{summary}", file.display());
        assert_eq!(imported.lines.len(), written);
        assert_eq!(summary.faces, written - dropped);
    }
}

/// The five scenes that must be read without a complaint that is not deserved: these are all complaints, each looked at by hand.
#[test]
#[ignore = "needs ../shared: scenes by others"]
fn complaints_are_deserved() {
    use DiagnosticKind::{DuplicateFace, IgnoredProperty, NoLight, NonPlanarFace};
    let shared = shared();
    for (name, deserved) in [
        // The right wall is not planar in the measured data (x = 552.8, 549.6, 556, 556); the face of the light is commented out.
        ("cornell_embree", vec![(NonPlanarFace, 72), (NoLight, 0)]),
        ("cornell_tinyobj", vec![(NonPlanarFace, 77)]),
        // The left wall likewise; the bottoms of both boxes name the vertices of a side again.
        ("cornell_mcguire", vec![(NonPlanarFace, 62), (DuplicateFace, 107), (DuplicateFace, 155)]),
        // Quads of furniture that are bent by 0.1 to 0.7 mm.
        ("office2", [648, 653, 691, 696, 755, 760, 798, 803].map(|line| (NonPlanarFace, line)).to_vec()),
        // Eight materials with highlights, which a diffuse solver leaves out.
        ("corridor", vec![(IgnoredProperty, 7)]),
    ] {
        let file = shared.join("scenes").join(name).join("scene.obj");
        let imported = read_scene(&file, &ImportOptions::default()).unwrap();
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&imported.scene)).unwrap();
        let inspection = inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS);
        let mut diagnostics = imported.diagnostics.clone();
        diagnostics.items.extend(inspection.suspicions(&imported.file, &imported.lines));

        let complaints: Vec<_> = (diagnostics.items.iter())
            .filter(|item| item.severity() != Severity::Note)
            .map(|item| (item.kind, item.line.unwrap_or(0)))
            .collect();
        let summary = SceneSummary::new(&imported.scene, &diagnostics);
        assert_eq!(complaints, deserved, "{name}\n{summary}");
    }
}

/// The five scenes are solved: the answer is well formed, light goes no other way than into surfaces and out, and the error that was asked for
/// is reached.
#[test]
#[ignore = "needs ../shared: scenes by others"]
fn five_scenes_are_solved() {
    let shared = shared();
    for (name, has_light) in
        [("cornell_embree", false), ("cornell_tinyobj", true), ("cornell_mcguire", true), ("office2", true), ("corridor", true)]
    {
        let file = shared.join("scenes").join(name).join("scene.obj");
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let start = std::time::Instant::now();
        let options = SolveOptions { error: 0.1, ..SolveOptions::default() };
        let (evaluator, report) = solve(scene, &options, &RunOptions::default(), &Silent).unwrap();
        eprintln!(
            "{name}: {:.2} s, claimed {:.4}, {:?}, {:?}, {:?}, {:?}",
            start.elapsed().as_secs_f64(),
            report.error.estimate,
            report.stopped_by,
            report.counts,
            report.time_s,
            report.energy
        );
        evaluator.solution().validate().unwrap_or_else(|fault| panic!("{name}: {fault}"));
        assert!(report.converged, "{name}: {:?}, claimed {}", report.stopped_by, report.error.estimate);

        // What is emitted is absorbed, or escapes through openings; the links conserve it to within the error that was asked for. In a closed
        // scene what escapes is noise.
        let energy = report.energy;
        let lost = energy.emitted - energy.absorbed - energy.escaped;
        assert!((energy.emitted > 0.0) == has_light && lost.abs() <= 0.1 * energy.emitted, "{name}: {energy:?}");
        assert!(energy.escaped >= -0.02 * energy.emitted, "{name}: more light arrives than leaves, {energy:?}");
    }
}
