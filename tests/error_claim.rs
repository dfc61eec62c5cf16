//! The error that a run claims covers the true one, where the truth is known; and a run that cannot reach what was asked says so.
//!
//! The norm is the one that is asked for, over all surfaces, of the values at points.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/claims.rs"]
mod claims;
#[path = "support/least_memory.rs"]
mod least_memory;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use claims::most_failures;
use patchlight::pipeline::{self, PipelineError};
use patchlight::progress::{Observer, Silent};
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Norm, RunOptions, SolveOptions, SolveReport, Solver, StoppedBy, Strategy};
use rooms::{Room, cube, points_of, solve, straight, two_squares, values};
use triangles::Random;
use two_squares::TwoSquares;

/// B at a point of a surface, one channel.
type Truth = dyn Fn(&SurfacePoint, usize) -> f64;

/// A scene with points, uniform by area, and what is known there.
struct Known {
    name: &'static str,
    scene: Scene,
    points: Vec<SurfacePoint>,
    /// B and E at each point.
    truth: Vec<[f64; 2]>,
}

impl Known {
    fn new(name: &'static str, (scene, truth): (Scene, Box<Truth>)) -> Self {
        let places = points_of(&scene, 4000, &mut Random(21));
        let exitance = |surface: usize| scene.material_of(SurfaceId(surface as u32)).exitance[0];
        let truth = places.iter().map(|(point, surface)| [truth(point, *surface), exitance(*surface)]).collect();
        Self { name, points: places.into_iter().map(|(point, _)| point).collect(), truth, scene }
    }

    /// The true error of a run in its norm, and its report.
    fn true_error(&self, options: &SolveOptions) -> (f64, SolveReport) {
        let (evaluator, report) = solve(self.scene.clone(), options);
        let found = values(&evaluator, &self.points);
        let off = || found.iter().zip(&self.truth).map(|(value, [expected, exitance])| (value - expected, expected - exitance));
        let error_sq = match options.norm {
            Norm::Energy => {
                let (error_sq, norm_sq) = off().fold((0.0, 0.0), |sum, (off, light)| (sum.0 + off * off, sum.1 + light * light));
                error_sq / norm_sq
            }
            Norm::Local => {
                let mut lit: Vec<f64> = off().map(|(_, light)| light.abs()).filter(|&light| light > 0.0).collect();
                lit.sort_by(f64::total_cmp);
                let typical = lit[lit.len() / 2];
                off().map(|(off, light)| (off / light.abs().max(typical)).powi(2)).sum::<f64>() / lit.len() as f64
            }
        };
        (error_sq.sqrt(), report)
    }
}

/// A closed room with a box on a pillar in it, every surface with a reflectance of its own, in which B = 1 everywhere (Kirchhoff).
fn kirchhoff() -> Scene {
    let mut random = Random(77);
    let mut room = Room::default();
    let mut material = |room: &mut Room, _| {
        let rho = random.between(0.2, 0.9);
        room.material(&[rho], &[1.0 - rho])
    };
    room.cuboid([0.0; 3], straight(3.0, 2.0, 2.0), true, &mut material);
    room.cuboid([1.0, 0.5, 0.4], straight(0.6, 0.6, 0.8), false, &mut material);
    room.cuboid([2.1, 1.1, 0.7], straight(0.5, 0.4, 0.1), false, &mut material);
    room.scene()
}

/// Two facing squares: the exact solution; nothing is reflected by the blocker.
fn squares(blocker: bool) -> (Scene, Box<Truth>) {
    let exact = TwoSquares::new(blocker);
    let truth = move |point: &SurfacePoint, surface: usize| {
        if surface < 2 { exact.at(surface, [point.position[0], point.position[1]]) } else { 0.0 }
    };
    (two_squares(blocker), Box::new(truth))
}

fn scenes() -> Vec<Known> {
    let uniform = |rho: f64| -> (Scene, Box<Truth>) { (cube(&[rho], &[1.0]), Box::new(move |_, _| 1.0 / (1.0 - rho))) };
    vec![
        Known::new("furnace 0.5", uniform(0.5)),
        Known::new("furnace 0.9", uniform(0.9)),
        Known::new("kirchhoff", (kirchhoff(), Box::new(|_, _| 1.0))),
        Known::new("two squares", squares(false)),
        Known::new("two squares with a blocker", squares(true)),
    ]
}

/// Runs all, counts claims that do not hold, and prints every one.
fn check(runs: &[(&Known, SolveOptions)]) {
    let mut failed = Vec::new();
    for (known, options) in runs {
        let name = known.name;
        let (error, report) = known.true_error(options);
        let claimed = report.error.estimate;
        println!(
            "{name}, {:?}, {}, requested {}, seed {}, max_links {:?}: error {error:.6}, claimed {claimed:.6}, measured {:.6}, {:?}",
            options.solver, options.norm, options.error, options.seed, options.max_links, report.error.measured, report.stopped_by
        );
        assert!(!report.converged || claimed <= options.error, "{name}: {report:?}");
        assert_eq!(report.converged, report.stopped_by == StoppedBy::Error);
        if error > claimed {
            let (way, norm) = (options.solver, options.norm);
            failed.push(format!(
                "{name}, {way:?}, {norm}, requested {}, seed {}: {error:.6} > {claimed:.6}",
                options.error, options.seed
            ));
        }
    }
    assert!(failed.len() <= most_failures(runs.len()), "{} of {} claims do not hold: {failed:#?}", failed.len(), runs.len());
}

#[test]
fn claims_cover_the_truth() {
    let scenes = scenes();
    let mut runs = Vec::new();
    for known in &scenes {
        for (error, seeds) in [(0.2, 0..3), (0.1, 0..3), (0.05, 0..3), (0.02, 0..1)] {
            for seed in seeds {
                for solver in [Solver::Links, Solver::Cells] {
                    for norm in [Norm::Local, Norm::Energy] {
                        runs.push((known, SolveOptions { error, seed, solver, norm, ..SolveOptions::default() }));
                    }
                }
            }
        }
    }
    check(&runs);
}

#[test]
fn claims_of_runs_that_a_limit_ends_cover_the_truth() {
    // With few links the error is large, and the claim must say so.
    let scenes = scenes();
    let mut runs = Vec::new();
    for known in &scenes[2..] {
        for max_links in [1, 100] {
            for seed in [0, 1, 2] {
                let options =
                    SolveOptions { error: 0.01, max_links: Some(max_links), point_rays: Some(16), seed, ..SolveOptions::default() };
                runs.push((known, options));
            }
        }
    }
    check(&runs);
}

/// Cancels at once.
struct Cancel;

impl Observer for Cancel {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn a_run_that_cannot_reach_the_error_says_why() {
    let scene = || two_squares(true);
    let hard = SolveOptions { error: 0.002, ..SolveOptions::default() };
    let stopped_by = |options: &SolveOptions, run: &RunOptions, observer: &dyn Observer| {
        let (_, report) = pipeline::solve(scene(), options, run, observer).unwrap();
        assert!(!report.converged, "{report:?}");
        assert_eq!(report.error.requested, options.error);
        report.stopped_by
    };
    let run = RunOptions::default();
    let few_links = SolveOptions { max_links: Some(10), solver: Solver::Links, ..hard.clone() };
    assert_eq!(stopped_by(&few_links, &run, &Silent), StoppedBy::MaxLinks);
    assert_eq!(
        stopped_by(&hard, &RunOptions { memory_bytes: Some(least_memory::least_bytes(scene())), ..run.clone() }, &Silent),
        StoppedBy::Memory
    );
    assert_eq!(stopped_by(&hard, &RunOptions { time_s: Some(1e-6), ..run.clone() }, &Silent), StoppedBy::Time);
    assert_eq!(stopped_by(&hard, &run, &Cancel), StoppedBy::Cancelled);
    let coarse = SolveOptions { strategy: Strategy::Uniform, point_rays: Some(4), ..hard };
    assert_eq!(stopped_by(&coarse, &run, &Silent), StoppedBy::Exhausted);
}

#[test]
fn a_time_limit_out_of_range_is_rejected() {
    for seconds in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        let run = RunOptions { time_s: Some(seconds), ..RunOptions::default() };
        let result = pipeline::solve(kirchhoff(), &SolveOptions::default(), &run, &Silent);
        assert!(matches!(result, Err(PipelineError::Options(_))), "{seconds}");
    }
}
