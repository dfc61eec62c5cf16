//! Scenes that other programs were measured on, against references of long path tracing. They lie beside the repository, in
//! ../shared/peers: `cargo test --test peers -- --ignored`.
#![allow(clippy::print_stderr, reason = "a test tells what it did")]

#[path = "support/claims.rs"]
mod claims;

use std::path::{Path, PathBuf};

use claims::most_failures;
use patchlight::pipeline::solve;
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, SolveReport};

fn peers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers")
}

/// Rows of numbers; lines that are none, such as a header, are left out.
fn numbers(file: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines().filter_map(|line| line.split([' ', ',']).map(|number| number.parse().ok()).collect()).collect()
}

/// Solves and evaluates at the points of the scene: values by channel, and the report.
fn values(folder: &Path, name: &str, options: &SolveOptions) -> (Vec<f64>, SolveReport) {
    let scene = read_scene(&folder.join(format!("scenes/{name}.obj")), &ImportOptions::default()).unwrap().scene;
    let points: Vec<SurfacePoint> = numbers(&folder.join(format!("scenes/{name}.pts")))
        .iter()
        .map(|row| SurfacePoint { position: [row[0], row[1], row[2]], normal: [row[3], row[4], row[5]] })
        .collect();
    let (evaluator, report) = solve(scene, options, &RunOptions::default(), &Silent).unwrap();
    let values = evaluator.values_at(&points, &Silent).unwrap();
    assert_eq!(values.missed, 0);
    (values.radiosity.into_iter().map(f64::from).collect(), report)
}

/// `sqrt(mean (B - R)^2 / mean R^2)` over points and channels, and the same of the reference's own noise.
fn relative_errors(values: &[f64], reference: &[Vec<f64>]) -> (f64, f64) {
    assert_eq!(values.len(), 3 * reference.len());
    let (mut error_sq, mut noise_sq, mut norm_sq) = (0.0, 0.0, 0.0);
    for (value, row) in values.chunks(3).zip(reference) {
        for channel in 0..3 {
            error_sq += (value[channel] - row[channel]).powi(2);
            noise_sq += row[channel + 3].powi(2);
            norm_sq += row[channel].powi(2);
        }
    }
    ((error_sq / norm_sq).sqrt(), (noise_sq / norm_sq).sqrt())
}

/// Runs with other random numbers: one claim alone may fail by chance.
const SEEDS: u64 = 6;

/// What is claimed must cover what is measured as often as it says, and a run that says it converged must have reached what was asked.
fn check(name: &str, requested: f64) {
    let folder = peers();
    let reference = numbers(&folder.join(format!("refs/{name}_ref.csv")));
    assert_eq!(reference.len(), 2000);
    let mut failures = 0;
    for seed in 0..SEEDS {
        let (values, report) = values(&folder, name, &SolveOptions { error: requested, seed, ..SolveOptions::default() });
        let (error, noise) = relative_errors(&values, &reference);
        let (claimed, measured) = (report.error.estimate, report.error.measured);
        eprintln!(
            "{name}, requested {requested}, seed {seed}: rRMSE {error:.5} (noise of the reference {noise:.5}), claimed {claimed:.5}, \
             measured {measured:.5}, {:?}, {} links, {} rounds, {:?}",
            report.stopped_by, report.counts.links, report.counts.rounds, report.time_s
        );
        assert!(report.converged, "{name}: {:?}", report.stopped_by);
        assert!(error <= requested.hypot(noise), "{name}: {error} is more than the requested {requested}");
        failures += usize::from(error > claimed.hypot(noise));
    }
    assert!(failures <= most_failures(SEEDS as usize), "{name}: {failures} of {SEEDS} claims do not hold");
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn cornell_to_two_percent() {
    check("cornell", 0.02);
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn cornell_to_one_percent() {
    check("cornell", 0.01);
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn office_to_five_percent() {
    check("office", 0.05);
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn office_to_two_percent() {
    check("office", 0.02);
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn office_to_one_percent() {
    check("office", 0.01);
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn the_furnace_is_uniform() {
    let folder = peers();
    let (values, report) = values(&folder, "furnace", &SolveOptions::default());
    // E = pi and rho = 1/2, so B = 2 pi everywhere and B - E = pi.
    let expected = 2.0 * std::f64::consts::PI;
    let mean_sq = values.iter().map(|value| (value - expected).powi(2)).sum::<f64>() / values.len() as f64;
    let error = mean_sq.sqrt() / (0.5 * expected);
    eprintln!("furnace: error {error:.6}, claimed {:.5}", report.error.estimate);
    assert!(error <= report.error.estimate);
}
