//! Error against time, for whole runs of the program and of its peers, and whether the claimed errors are true.
//!
//! `make bench-error`, or `cargo bench --bench error_vs_time`: some ten minutes. Every run is the program `patchlight`, from reading the scene to writing
//! the values, and its CPU seconds are those that the system counts for the process, all threads, from start to end. Values are scored against
//! references that no run of the table made: exact ones, converged path tracing, or (labelled) light paths of our own.
//!
//! `cargo bench --bench error_vs_time -- office` runs the scenes with this in their names, and prints what it would write. References are kept in
//! `target/error_vs_time`; remove it to have them made anew.
//!
//! With `PATCHLIGHT_PEERS=<virtual environment>` Mitsuba 3 and Radiance run beside, on the same points (`peers/README.md` says how to install
//! them). The section in BENCHMARKS.md between the marks of this benchmark, and the plots in docs/, are written anew.
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "a benchmark tells how far it is, and prints its tables")]

mod figures;
mod peers;
#[path = "../support/plot.rs"]
mod plot;
mod problem;
mod run;
mod section;
#[path = "../../tests/support/two_squares.rs"]
mod two_squares;

use std::path::Path;

use problem::Problem;
use run::{Job, Measured};

/// Requested errors, from coarse to fine.
const LADDER: [f64; 4] = [0.1, 0.05, 0.02, 0.01];

/// Points of a whole bake: an office of 344 m^2 in texels of 5 cm.
const BAKE_POINTS: usize = 138_000;

/// What the program is asked for, scene by scene.
fn jobs(problem: &Problem) -> Vec<Job> {
    let mut jobs = Vec::new();
    for error in LADDER {
        jobs.extend((0..3).map(|seed| Job { seed, ..Job::new("auto", "auto", error) }));
        if error >= 0.02 {
            let ways = ["links", "hemisphere"].into_iter().filter(|_| problem.both_ways);
            jobs.extend(ways.map(|gather| Job::new(gather, "auto", error)));
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
    let mut measured: Vec<(Problem, Vec<Measured>)> = Vec::new();
    for problem in problem::all(root, &folder, &wanted, peers.as_ref()) {
        eprintln!("{}: {} points, reference: {}", problem.name, problem.points.len(), problem.reference_is);
        let mut runs = Vec::new();
        for job in jobs(&problem) {
            let run = run::patchlight(&problem, &job, &folder);
            eprintln!("  {}", run.line());
            runs.push(run);
        }
        if let Some(peers) = &peers {
            for run in peers.run(&problem, &folder) {
                eprintln!("  {}", run.line());
                runs.push(run);
            }
        }
        measured.push((problem, runs));
    }

    let text = section::text(&measured);
    if !wanted.is_empty() {
        println!("{text}");
        return;
    }
    let docs = root.join("docs");
    for (problem, runs) in &measured {
        for (kind, title) in [(figures::Time::Cpu, "CPU"), (figures::Time::Wall, "wall")] {
            let file = docs.join(format!("error_vs_time_{}_{}.svg", problem.file_name(), title.to_lowercase()));
            let figure = figures::log_log(&format!("{}: error against {title} time", problem.name), runs, kind);
            std::fs::write(file, figure).expect("a figure is written");
        }
    }
    section::write(&root.join("BENCHMARKS.md"), &text).expect("BENCHMARKS.md has the marks of this benchmark");
}
