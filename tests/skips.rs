//! What a solve leaves out changes what it takes, not what it says.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::path::Path;

use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Material, Scene};
use patchlight::solve::{LinkOptions, Skips, SolveOptions, SolveReport, Solver};
use rooms::{points_of, solve, values};
use triangles::Random;

fn cornell() -> Scene {
    read_scene(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj"), &ImportOptions::default()).unwrap().scene
}

/// A scene whose channels are those of another; one of `None` is dark.
fn recoloured(scene: &Scene, channels: &[Option<usize>]) -> Scene {
    let materials = scene.materials().iter().map(|material| Material {
        name: material.name.clone(),
        reflectance: channels.iter().map(|channel| channel.map_or(0.5, |channel| material.reflectance[channel])).collect(),
        exitance: channels.iter().map(|channel| channel.map_or(0.0, |channel| material.exitance[channel])).collect(),
    });
    let faces = scene.surfaces().iter().map(|surface| (surface.polygon.clone(), surface.material, surface.face));
    Scene::new(channels.len(), materials.collect(), faces.collect(), scene.sides()).unwrap()
}

fn points(scene: &Scene) -> Vec<SurfacePoint> {
    points_of(scene, 300, &mut Random(3)).into_iter().map(|(point, _)| point).collect()
}

fn count(report: &SolveReport, what: &str) -> u64 {
    report.skipped.iter().filter(|skipped| skipped.what.starts_with(what)).map(|skipped| skipped.count).sum()
}

/// The root mean square of the difference of two lists, relative to the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let wrong: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (wrong / b.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

#[test]
fn channels_that_repeat_others_are_read_off() {
    for solver in [Solver::Links, Solver::Cells] {
        let scene = recoloured(&cornell(), &[Some(1), Some(1), Some(1)]);
        let of = |skips| {
            let options = SolveOptions {
                error: 0.05,
                solver,
                links: LinkOptions { skips, ..LinkOptions::default() },
                ..SolveOptions::default()
            };
            let (evaluator, report) = solve(scene.clone(), &options);
            (values(&evaluator, &points(&scene)), report)
        };
        let (merged, merged_report) = of(Skips::ALL);
        let (all, all_report) = of(Skips::ALL.without("channels").unwrap());
        assert_eq!((count(&merged_report, "channels"), count(&all_report, "channels")), (2, 0));
        assert!(merged.chunks(3).all(|value| value[0] == value[1] && value[0] == value[2]));

        // The same rays, so the same but for the order in which roundings add up.
        assert_eq!(merged_report.counts.rays, all_report.counts.rays);
        assert!(difference(&merged, &all) < 1e-6, "{}", difference(&merged, &all));
        let (merged, all) = (merged_report.energy, all_report.energy);
        for (merged, all) in [(merged.emitted, all.emitted), (merged.absorbed, all.absorbed), (merged.sent, all.sent)] {
            assert!((merged / all - 1.0).abs() < 1e-6, "{merged} and {all}");
        }
    }
}

#[test]
fn channels_in_which_no_light_is_on_are_dark() {
    let bands = [Some(0), None, Some(1), Some(2), None];
    let scene = recoloured(&cornell(), &bands);
    let (evaluator, report) = solve(scene.clone(), &SolveOptions { error: 0.03, ..SolveOptions::default() });
    assert_eq!((count(&report, "channels"), evaluator.solution().scene().channels()), (2, 5));
    let five = values(&evaluator, &points(&scene));

    // The others are those of the scene without such channels, bit for bit.
    let three = values(&solve(cornell(), &SolveOptions { error: 0.03, ..SolveOptions::default() }).0, &points(&cornell()));
    assert_eq!(five.len() / 5, three.len() / 3);
    for (five, three) in five.chunks(5).zip(three.chunks(3)) {
        assert_eq!(five, [three[0], 0.0, three[1], three[2], 0.0]);
    }
}

#[test]
fn segments_between_planes_with_nothing_in_between_are_not_asked() {
    let scene = cornell();
    let of = |skips| {
        let (evaluator, report) = solve(
            scene.clone(),
            &SolveOptions { error: 0.03, links: LinkOptions { skips, ..LinkOptions::default() }, ..SolveOptions::default() },
        );
        (values(&evaluator, &points(&scene)), report)
    };
    let (spared, spared_report) = of(Skips::ALL);
    let (asked, asked_report) = of(Skips::ALL.without("clear").unwrap());
    let segments = count(&spared_report, "segments between planes");
    assert!(segments > 5000 && count(&asked_report, "segments between planes") == 0, "{segments}");
    let (difference, claimed) = (difference(&spared, &asked), spared_report.error.estimate + asked_report.error.estimate);
    println!("{segments} segments were not asked; values differ by {difference:.4}, {claimed:.4} is claimed");
    assert!(difference <= claimed, "{difference} {claimed}");
}
