//! Scenes that are made to be hard: what the program takes for them, and whether what it claims is true.
//!
//! `cargo bench --bench hard_scenes`, a part of `make bench-error`. Scenes are made on the spot, as OBJ files in `target/hard_scenes`. Every run is
//! the program `patchlight`, from reading the scene to writing values at the points of the reference. All runs go to
//! `target/hard_scenes/runs.csv`; the section of BENCHMARKS.md is written anew when all scenes are run as by default, and docs/hard_scenes.md with it.
//!
//! `-- comb gap --seeds 3 --errors 0.05,0.02 --norm energy` runs a part, and prints what came of it.
//!
//! `-- --file SCENE.obj` takes a scene of your own instead, or several; a reference that is not there yet is made in `target/hard_scenes`. `--sides both` for
//! scenes of sheets.
//!
//! `-- --random 1..25` takes 24 rooms made at random, each the same whenever it is asked for, with references that are made likewise.
//!
//! `-- --references` makes references by path tracing, `-- --references comb --rays 1e9` those of some scenes, less noisy. They
//! belong to a scene's very surfaces, so a generator that changes needs them made anew.
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "a benchmark tells how far it is, and prints its tables")]

mod making;
mod norms;
mod obj;
mod options;
#[path = "../support/path_tracer.rs"]
mod path_tracer;
#[path = "../support/points.rs"]
mod points;
#[path = "../support/process.rs"]
mod process;
mod reference;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod run;
mod scenes;
#[path = "../support/section.rs"]
mod section;
mod subject;
mod tables;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::{Path, PathBuf};

use norms::Norm;
use options::Options;
use reference::Reference;
use run::{Asked, Problem, Run};
use subject::Subject;
use tables::Scored;

fn main() {
    let options = Options::read(std::env::args().skip(1)).unwrap_or_else(|error| panic!("{error}"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = root.join("target/hard_scenes");
    std::fs::create_dir_all(&folder).expect("a folder for what is made");
    let (mut scored, mut known) = (Vec::new(), Vec::new());
    let mut run_on = |subject: &Subject| {
        let reference = subject.reference(&options);
        tell(&subject.name, &reference);
        if !options.references {
            scored.push(runs(subject, &reference, &options, &folder));
            tables::write_csv(&folder.join("runs.csv"), &scored).expect("runs are written");
        }
        reference
    };
    for file in &options.files {
        run_on(&Subject::of_file(file, options.sides, &folder));
    }
    for number in options.random.clone() {
        run_on(&Subject::of_random(number, &folder));
    }
    for hard in scenes::all().into_iter().filter(|hard| options.wants(hard.name)) {
        let reference = run_on(&Subject::of_suite(&hard, root, &folder));
        known.push((hard, reference));
    }

    if known.len() == scenes::all().len() {
        std::fs::write(root.join("docs/hard_scenes.md"), tables::document(&known)).expect("the scenes are told");
    }
    if !options.references {
        let text = tables::text(&scored);
        println!("{text}");
        if options.is_whole() {
            let said = format!("Norm: {}; {} seeds.\n\n{text}", options.norm.name(), options.seeds);
            section::write(&root.join("BENCHMARKS.md"), "hard_scenes", &said).expect("BENCHMARKS.md has the marks");
        }
    }
}

fn tell(name: &str, reference: &Reference) {
    let [local, energy] = Norm::ALL.map(|norm| section::percent(norm.noise(reference)));
    eprintln!("{name}: noise of the reference {local} (local), {energy} (energy)");
}

/// All runs on a scene.
fn runs(subject: &Subject, reference: &Reference, options: &Options, folder: &Path) -> Scored {
    let points: PathBuf = folder.join(format!("{}_points.csv", subject.name));
    points::write_points(&points, reference.points.iter());
    let problem = Problem { scene: &subject.file, sides: subject.sides, points: &points, reference };
    let mut runs: Vec<Run> = Vec::new();
    for &error in &options.errors {
        for seed in 0..options.seeds {
            let run = run::patchlight(&problem, Asked { norm: options.norm, error, seed }, folder);
            eprintln!("  {}", run.line());
            runs.push(run);
        }
    }
    Scored { name: subject.name.clone(), runs }
}
