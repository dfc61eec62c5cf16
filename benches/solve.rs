//! How long does a whole solve take for a requested error, and how long a sweep over the links?
//!
//! `cargo bench --bench solve`. Scenes are the Cornell box and the furnished room of scenes/; the error that each run claims is printed beside it.
//! Before anything is timed, the run must have reached what was asked, and its solution must be well formed.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]
#![allow(clippy::print_stderr, reason = "the error is printed beside the time")]

use std::{hint::black_box, path::Path, time::Duration};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{LinkOptions, RunOptions, SolveOptions, SolveReport, Strategy, Sweep, UniformOptions};

fn scene(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene
}

fn solve(scene: &Scene, options: &SolveOptions) -> SolveReport {
    let (evaluator, report) =
        pipeline::solve(scene.clone(), options, &RunOptions::default(), &Silent).expect("options that are legal");
    black_box(evaluator);
    report
}

/// Whole solves, from the scene to the error estimate.
fn time_to_error(criterion: &mut Criterion) {
    for name in ["cornell", "room"] {
        let scene = scene(&format!("{name}.obj"));
        let mut group = criterion.benchmark_group(format!("solve/{name}"));
        group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
        for error in [0.1, 0.05] {
            let options = SolveOptions { error, ..SolveOptions::default() };
            let (evaluator, report) =
                pipeline::solve(scene.clone(), &options, &RunOptions::default(), &Silent).expect("options that are legal");
            evaluator.solution().validate().expect("a solution that is well formed");
            assert!(report.converged && report.error.estimate <= error, "{name}: {report:?}");
            eprintln!(
                "{name}, requested {error}: claimed {:.4}, measured {:.4}, {} links, {} elements, {} rays",
                report.error.estimate, report.error.measured, report.counts.links, report.counts.elements, report.counts.rays
            );
            group.bench_function(format!("{error}"), |bencher| bencher.iter(|| solve(&scene, black_box(&options))));
        }
        group.finish();
    }
}

/// Many sweeps over the same links: refinement, leaves and error estimate are cut to next to nothing. Throughput is in links gathered over.
fn gather_push_pull(criterion: &mut Criterion) {
    let scene = scene("cornell.obj");
    let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    let mut group = criterion.benchmark_group("gather");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    for (name, sweep) in [("jacobi", Sweep::Jacobi), ("in-place", Sweep::InPlace)] {
        let options = SolveOptions {
            strategy: Strategy::Uniform,
            point_rays: Some(1),
            error: 0.9,
            uniform: UniformOptions { element_area: Some(area / 300.0) },
            links: LinkOptions {
                rays_per_link: 1,
                rays_per_light_link: 1,
                leaf_rays: Some(0),
                sweep,
                sweep_tolerance: 1e-15,
                ..LinkOptions::default()
            },
            ..SolveOptions::default()
        };
        let report = solve(&scene, &options);
        assert!(report.energy.residual <= 1e-12, "{name}: {:?}", report.energy);
        eprintln!("{name}: {} sweeps over {} links", report.counts.iterations, report.counts.links);
        group.throughput(Throughput::Elements(report.counts.iterations * report.counts.links));
        group.bench_function(name, |bencher| {
            // Only the time of the sweeps counts.
            bencher.iter_custom(|count| {
                (0..count).map(|_| Duration::from_secs_f64(solve(&scene, black_box(&options)).time_s.gather)).sum()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, time_to_error, gather_push_pull);
criterion_main!(benches);
