//! The same input gives the same bytes, for any number of threads.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::path::Path;

use patchlight::pipeline::solve;
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{
    ChangShih98Options, LinkOptions, RunOptions, SolveOptions, SolveReport, Solver, Strategy, Subdivision, Sweep, UniformOptions,
};
use rooms::{crowded, points_of};
use triangles::Random;

fn cornell() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
    read_scene(&file, &ImportOptions::default()).unwrap().scene
}

/// The solution as bytes, the bits of values at points, and the report without what a clock has a part in.
fn run(scene: Scene, options: &SolveOptions, threads: usize, points: &[SurfacePoint]) -> (Vec<u8>, Vec<u32>, String) {
    let run = RunOptions { threads, ..RunOptions::default() };
    let (evaluator, report) = solve(scene, options, &run, &Silent).unwrap();
    let bytes = postcard::to_stdvec(evaluator.solution()).unwrap();
    let values = evaluator.values_at(points, &Silent).unwrap().radiosity.into_iter().map(f32::to_bits).collect();
    let mut report = SolveReport { time_s: Default::default(), ..report };
    report.skipped.iter_mut().for_each(|skipped| skipped.estimate_saved_s = 0.0);
    report.history.iter_mut().for_each(|judgement| judgement.time_s = 0.0);
    (bytes, values, serde_json::to_string(&report).unwrap())
}

/// Every number of threads gives what one gives.
fn check(scene: &Scene, options: &SolveOptions, threads: &[usize]) {
    let points: Vec<SurfacePoint> = points_of(scene, 700, &mut Random(1)).into_iter().map(|(point, _)| point).collect();
    let (bytes, values, report) = run(scene.clone(), options, 1, &points);
    for &threads in threads {
        let (other_bytes, other_values, other_report) = run(scene.clone(), options, threads, &points);
        let differing = bytes.iter().zip(&other_bytes).filter(|(a, b)| a != b).count();
        assert!(bytes == other_bytes, "{threads} threads: {differing} bytes of {} differ, {options:?}", bytes.len());
        assert!(values == other_values, "{threads} threads: values at points differ, {options:?}");
        assert_eq!(report, other_report, "{threads} threads: {options:?}");
    }
}

#[test]
fn one_two_three_and_seven_threads_give_the_same_bytes() {
    let options = [
        SolveOptions { error: 0.05, ..SolveOptions::default() },
        SolveOptions {
            error: 0.1,
            links: LinkOptions { sweep: Sweep::InPlace, ..LinkOptions::default() },
            ..SolveOptions::default()
        },
        SolveOptions { error: 0.1, strategy: Strategy::Hanrahan91, ..SolveOptions::default() },
        SolveOptions {
            strategy: Strategy::Uniform,
            uniform: UniformOptions { element_area: Some(0.02) },
            ..SolveOptions::default()
        },
        SolveOptions {
            error: 0.1,
            strategy: Strategy::ErrorDriven,
            links: LinkOptions { tolerance: Some(2.0), ..LinkOptions::default() },
            ..SolveOptions::default()
        },
        SolveOptions { max_links: Some(3000), ..SolveOptions::default() },
        SolveOptions { error: 0.05, solver: Solver::Cells, ..SolveOptions::default() },
        SolveOptions {
            error: 0.1,
            solver: Solver::Links,
            links: LinkOptions { subdivision: Subdivision::Discontinuities, ..LinkOptions::default() },
            ..SolveOptions::default()
        },
        SolveOptions {
            error: 0.2,
            strategy: Strategy::Lazy94Reduction,
            links: LinkOptions { subdivision: Subdivision::Discontinuities, ..LinkOptions::default() },
            ..SolveOptions::default()
        },
    ];
    for options in options {
        check(&cornell(), &options, &[2, 3, 7]);
    }
}

#[test]
fn threads_change_nothing_where_links_are_made_once() {
    for strategy in [Strategy::BottomUp98, Strategy::TopDown98] {
        let options = SolveOptions {
            error: 0.2,
            strategy,
            chang_shih98: ChangShih98Options { bottom_area: 1.0 / 64.0, ..ChangShih98Options::default() },
            ..SolveOptions::default()
        };
        check(&cornell(), &options, &[2, 5]);
    }
}

#[test]
fn threads_change_nothing_with_clusters() {
    for sweep in [Sweep::Jacobi, Sweep::InPlace] {
        check(
            &crowded(200, 3),
            &SolveOptions { error: 0.1, links: LinkOptions { sweep, ..LinkOptions::default() }, ..SolveOptions::default() },
            &[2, 3, 7],
        );
    }
}

#[test]
fn another_seed_gives_another_answer_that_is_as_good() {
    let places = points_of(&cornell(), 700, &mut Random(2));
    let points: Vec<SurfacePoint> = places.iter().map(|(point, _)| *point).collect();
    let with_seed = |seed| SolveOptions { error: 0.05, seed, ..SolveOptions::default() };
    let (bytes, values, _) = run(cornell(), &with_seed(1), 0, &points);
    let (other_bytes, other_values, _) = run(cornell(), &with_seed(2), 0, &points);
    assert_ne!(bytes, other_bytes);

    // Each claims an error of 5% in the norm of what is reflected, so they differ by 10% in it at most.
    let scene = cornell();
    let exitances = places.iter().flat_map(|(_, surface)| scene.material_of(SurfaceId(*surface as u32)).exitance.clone());
    let (mut difference_sq, mut norm_sq) = (0.0, 0.0);
    for ((a, b), exitance) in values.iter().zip(&other_values).zip(exitances) {
        let (a, b) = (f64::from(f32::from_bits(*a)), f64::from(f32::from_bits(*b)));
        difference_sq += (a - b).powi(2);
        norm_sq += (a - exitance).powi(2);
    }
    let difference = (difference_sq / norm_sq).sqrt();
    println!("two seeds differ by {difference:.4}");
    assert!(difference > 0.0 && difference <= 0.1, "{difference}");
}

#[test]
fn strategies_agree_on_the_power_that_is_absorbed() {
    // Cornell's light goes around several times: a strategy that misses a bounce misses a tenth or more.
    let absorbed = |options: SolveOptions| solve(cornell(), &options, &RunOptions::default(), &Silent).unwrap().1.energy.absorbed;
    let default = absorbed(SolveOptions { error: 0.02, ..SolveOptions::default() });
    for strategy in [Strategy::Uniform, Strategy::Hanrahan91] {
        // Neither looks at what is partly visible: with few rays a link, the power alone scatters by some percent.
        let found = absorbed(SolveOptions {
            error: 0.05,
            strategy,
            uniform: UniformOptions { element_area: Some(0.02) },
            links: LinkOptions { rays_per_link: 32, ..LinkOptions::default() },
            ..SolveOptions::default()
        });
        println!("{strategy:?}: {found} W absorbed; default: {default} W");
        assert!((found / default - 1.0).abs() < 0.03, "{strategy:?}: {found} W absorbed, the default strategy finds {default} W");
    }
}
