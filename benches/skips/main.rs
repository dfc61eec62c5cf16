//! What is each of the things worth that a solve leaves out because they would be in vain?
//!
//! `cargo bench --bench skips` prints a table for each scene, as Markdown: everything left out, each thing done after all, everything done.
//! Values at points are held against a reference. Asserted is that leaving something out changes values by no more than both runs claim;
//! claims that do not hold against the reference are counted. On one thread; medians of CPU seconds.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod scenes;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use cpu::cpu_seconds;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{RunOptions, Skips, SolveOptions, SolveReport, Solver};
use triangles::Random;

/// Where values are compared.
const POINTS: usize = 2000;

/// Runs of which the median counts.
const RUNS: usize = 3;

/// A run with what it took.
struct Run {
    skips: String,
    cpu_s: f64,
    report: SolveReport,
    /// Against the reference.
    error: f64,
    /// Against the run that leaves out nothing.
    changed_by: f64,
    values: Vec<f64>,
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    for (name, scene, options) in scenes::all().into_iter().filter(|(name, ..)| names.is_empty() || names.iter().any(|n| n == name))
    {
        let runs = measure(&scene, &options);
        print(name, &scene, &options, &runs);

        // The last run leaves out nothing.
        let whole = &runs[runs.len() - 1];
        for run in &runs {
            let (changed, most) = (run.changed_by, run.report.error.estimate + whole.report.error.estimate);
            assert!(changed <= most, "{name}, {}: values change by {changed}, more than the {most} that is claimed", run.skips);
        }
        let failed = runs.iter().filter(|run| run.error > run.report.error.estimate).count();
        println!("\nClaims that do not hold: {failed} of {}.", runs.len());
    }
}

/// All that can be left out, each thing done after all, and everything done.
fn settings() -> Vec<(String, Skips)> {
    let each = Skips::NAMES.iter().filter_map(|name| Some((format!("all but {name}"), Skips::ALL.without(name)?)));
    let mut settings = vec![("all".to_owned(), Skips::ALL)];
    settings.extend(each);
    settings.push(("none".to_owned(), Skips::NONE));
    settings
}

fn measure(scene: &Scene, options: &SolveOptions) -> Vec<Run> {
    let points = rooms::points_of(scene, POINTS, &mut Random(5));
    let places: Vec<SurfacePoint> = points.iter().map(|(point, _)| *point).collect();

    // A reference by light paths, which need no links.
    let fine = SolveOptions { error: 0.005, solver: Solver::Cells, seed: 77, ..SolveOptions::default() };
    let reference = rooms::values(&solve(scene, &fine).0, &places);
    let exitance: Vec<f64> =
        points.iter().flat_map(|(_, surface)| scene.material_of(SurfaceId(*surface as u32)).exitance.clone()).collect();
    let difference = |a: &[f64], b: &[f64]| {
        let wrong: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
        let reflected: f64 = b.iter().zip(&exitance).map(|(b, e)| (b - e).powi(2)).sum();
        (wrong / reflected).sqrt()
    };
    let mut runs: Vec<Run> = settings()
        .into_iter()
        .map(|(name, skips)| {
            let mut options = options.clone();
            options.links.skips = skips;
            let mut seconds = Vec::new();
            let mut last = None;
            for _ in 0..RUNS {
                let start = cpu_seconds();
                last = Some(solve(scene, &options));
                seconds.push(cpu_seconds() - start);
            }
            let (evaluator, report) = last.expect("at least one run");
            evaluator.solution().validate().expect("a solution that is well formed");
            seconds.sort_by(f64::total_cmp);
            let values = rooms::values(&evaluator, &places);
            let error = difference(&values, &reference);
            Run { skips: name, cpu_s: seconds[RUNS / 2], report, error, changed_by: 0.0, values }
        })
        .collect();
    let whole = runs[runs.len() - 1].values.clone();
    runs.iter_mut().for_each(|run| run.changed_by = difference(&run.values, &whole));
    runs
}

fn solve(scene: &Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    pipeline::solve(scene.clone(), options, &run, &Silent).expect("options that are legal")
}

fn print(name: &str, scene: &Scene, options: &SolveOptions, runs: &[Run]) {
    println!("\n**{name}**: {} surfaces, asked for {}.\n", scene.surfaces().len(), percent(options.error));
    println!(
        "| left out | CPU-s | refining, s | k segments | k links | k dormant | measured | claimed | from none |\n|---|---|---|---|---|---|---|---|---|"
    );
    for Run { skips, cpu_s, report, error, changed_by, .. } in runs {
        let counts = report.counts;
        println!(
            "| {skips} | {cpu_s:.2} | {:.3} | {:.0} | {:.1} | {:.1} | {} | {} | {} |",
            report.time_s.refine,
            (counts.rays - counts.first_hit_rays) as f64 * 1e-3,
            counts.links as f64 * 1e-3,
            counts.dormant as f64 * 1e-3,
            percent(*error),
            percent(report.error.estimate),
            percent(*changed_by)
        );
    }
    let told = |what: &patchlight::solve::SkippedWork| {
        format!(
            "{} {} ({:.0} k rays, {:.3} s)",
            what.count,
            what.what,
            what.estimate_saved_rays as f64 * 1e-3,
            what.estimate_saved_s
        )
    };
    println!("\nTold by the run that leaves out all: {}.", runs[0].report.skipped.iter().map(told).collect::<Vec<_>>().join("; "));
}

fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}
