//! Stored solutions: what is written can be read, gives the same values, and whatever else is read does no harm.

#[path = "../../fuzz/harness/solution.rs"]
mod harness;
mod mutations;
mod round_trips;
#[path = "../support/spoilt.rs"]
mod spoilt;
#[path = "../support/triangles.rs"]
mod triangles;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use patchlight::output::{Provenance, SolutionFileError, read_solution_from, write_solution};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, Sides, SurfacePoint};
use patchlight::solve::{RunOptions, Solution, SolveOptions};

/// The scenes of the repository, by name.
fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes"));
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files.filter(|file| file.extension().is_some_and(|extension| extension == "obj")).collect();
    files.sort();
    assert!(files.len() >= 10, "{files:?}");
    files
}

fn scene(name: &str, sides: Sides) -> Scene {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes")).join(name);
    read_scene(&file, &ImportOptions { sides, ..ImportOptions::default() }).unwrap().scene
}

fn solved(scene: Scene, options: &SolveOptions) -> Evaluator {
    // A spoilt scene may take any number of cells.
    let run = RunOptions { memory_bytes: Some(1 << 28), ..RunOptions::default() };
    pipeline::solve(scene, options, &run, &Silent).unwrap().0
}

fn stored(solution: &Solution) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write_solution(&mut file, solution, &Provenance::new(solution.options())).unwrap();
    file.into_inner()
}

fn read(bytes: &[u8]) -> Result<Solution, SolutionFileError> {
    read_solution_from(bytes, Path::new("in memory"))
}

/// A point on each of some surfaces.
fn points(scene: &Scene, most: usize) -> Vec<SurfacePoint> {
    let step = (scene.surfaces().len() / most).max(1);
    let point = |surface: &patchlight::scene::Surface| SurfacePoint {
        position: surface.polygon.centroid(),
        normal: surface.polygon.normal(),
    };
    scene.surfaces().iter().step_by(step).map(point).collect()
}
