//! Error against time, for whole runs of the program and of its peers, and whether the claimed errors are true.
//!
//! `make bench-error`, or `cargo bench --bench error_vs_time`: some ten minutes. Every run is the program `patchlight`, from reading the scene to writing
//! the values, and its CPU seconds are those that the system counts for the process, all threads, from start to end. Values are scored against
//! references that no run of the table made: exact ones, converged path tracing, or (labelled) light paths of our own.
//!
//! `cargo bench --bench error_vs_time -- office` runs the scenes with this in their names, and prints what it would write. References are made anew
//! each time.
//!
//! With `PATCHLIGHT_PEERS=<virtual environment>` Mitsuba 3 and Radiance run beside, on the same points (`peers/README.md` says how to install
//! them); else their runs are those that docs/error_vs_time.md tells of the last time. The section in BENCHMARKS.md between the marks of this
//! benchmark, docs/error_vs_time.md and the plots beside it are written anew.
//!
//! All runs go to `target/error_vs_time/runs.csv` as well, whichever scenes are run: keep that of one build to compare it with another's.
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "a benchmark tells how far it is, and prints its tables")]

mod by_run;
mod figures;
mod peers;
#[path = "../support/plot.rs"]
mod plot;
#[path = "../support/points.rs"]
mod points;
mod problem;
#[path = "../support/process.rs"]
mod process;
mod run;
mod scenes;
mod scored;
#[path = "../support/section.rs"]
mod section;
mod tables;
mod told;
#[path = "../../tests/support/triangles.rs"]
mod triangles;
#[path = "../../tests/support/two_squares.rs"]
mod two_squares;

use std::path::Path;

use problem::Problem;
use run::Job;
use scored::Scored;

/// Requested errors, from coarse to fine.
const LADDER: [f64; 4] = [0.1, 0.05, 0.02, 0.01];

/// What the program is asked for, scene by scene.
fn jobs(problem: &Problem) -> Vec<Job> {
    let mut jobs = Vec::new();
    for error in LADDER {
        jobs.extend((0..3).map(|seed| Job { seed, ..Job::new("auto", "auto", error) }));
        if error >= 0.02 {
            let solvers = ["links", "cells"].into_iter().filter(|_| problem.both_solvers);
            jobs.extend(solvers.map(|solver| Job::new(solver, "auto", error)));
            jobs.extend((0..2).map(|seed| Job { seed, ..Job::new("auto", "obvhs", error) }));
        }
    }
    if problem.bakes {
        jobs.extend(LADDER[1..].iter().map(|&error| Job { bake: true, ..Job::new("auto", "auto", error) }));
    }
    jobs
}

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = root.join("target/error_vs_time");
    std::fs::create_dir_all(&folder).expect("a folder for what is measured");
    let peers = peers::installed();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let mut scored: Vec<Scored> = Vec::new();
    for problem in scenes::all(root, &folder, &wanted, peers.as_ref()) {
        eprintln!("{}: {} points, reference: {}", problem.name, problem.points.len(), problem.reference_is);
        let jobs = jobs(&problem);
        let mut runs = Vec::new();
        for job in &jobs {
            let run = run::patchlight(&problem, job, &folder);
            eprintln!("  {}", run.line());
            runs.push(run);
        }
        let of_peers = peers.as_ref().map_or_else(|| told::runs(root, &problem.name), |peers| peers.run(&problem, &folder));
        for run in of_peers {
            eprintln!("  {}", run.line());
            runs.push(run);
        }
        scored.push(Scored { problem, jobs, runs });
        by_run::write_csv(&folder.join("runs.csv"), &scored).expect("runs are written");
    }

    let text = tables::text(&scored);
    if wanted.is_empty() {
        write_docs(root, &scored);
        section::write(&root.join("BENCHMARKS.md"), "error_vs_time", &text).expect("BENCHMARKS.md has the marks of this benchmark");
    } else {
        println!("{text}");
    }
}

/// The long tables and the figures.
fn write_docs(root: &Path, scenes: &[Scored]) {
    let docs = root.join("docs");
    std::fs::write(docs.join("error_vs_time.md"), by_run::text(scenes)).expect("the runs are written");
    for Scored { problem, runs, .. } in scenes {
        for (kind, title) in [(figures::Time::Cpu, "CPU"), (figures::Time::Wall, "wall")] {
            let file = docs.join(format!("error_vs_time_{}_{}.svg", problem.file_name(), title.to_lowercase()));
            let figure = figures::log_log(&format!("{}: error against {title} time", problem.name), runs, kind);
            std::fs::write(file, figure).expect("a figure is written");
        }
    }
}
