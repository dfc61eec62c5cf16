//! Closed rooms with boxes in which all light is known (Kirchhoff).

use patchlight::bounds::{Certainty, FormFactorRule, RadiosityBounds};
use patchlight::geometry::Polygon;
use patchlight::pipeline::Evaluator;
use patchlight::solve::SolveOptions;

use super::kirchhoff::{Kirchhoff, kirchhoff};
use super::rooms::{self, solve};
use super::triangles::Random;
use super::{bounded, bounds_of, uniform};

/// B0 everywhere but where something stands: there only the exitance is left.
fn check_kirchhoff(name: &str, furnace: &Kirchhoff, evaluator: &Evaluator, bounds: &RadiosityBounds, random: &mut Random) -> f64 {
    let (hierarchy, scene) = (evaluator.solution().hierarchy(), &furnace.scene);
    let mut gap = 0.0_f64;
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let material = scene.material_of(hierarchy.surface_of(leaf).unwrap());
        let polygon = Polygon::new(&hierarchy.polygon(leaf)).unwrap();
        for _ in 0..4 {
            let covered = furnace.is_covered(rooms::point_of(&polygon, random).position);
            for (channel, b0) in furnace.b0.iter().enumerate() {
                let truth = if covered { material.exitance[channel] } else { *b0 };
                let (lower, upper) = (bounds.lower(leaf)[channel], bounds.upper(leaf)[channel]);
                assert!(
                    lower <= truth * (1.0 + 1e-12) && truth <= upper * (1.0 + 1e-12),
                    "{name}: {truth} not in [{lower}, {upper}]"
                );
                gap = gap.max((upper - lower) / b0);
            }
        }
    }
    gap
}

#[test]
fn kirchhoff_furnaces_with_boxes_lie_within_the_bounds() {
    check_kirchhoff_furnaces(0..3, 1.0);
}

/// More of them, with finer elements: `cargo test --release --test bounds -- --ignored --nocapture`, some minutes.
#[test]
#[ignore = "minutes"]
fn many_kirchhoff_furnaces_lie_within_the_bounds() {
    check_kirchhoff_furnaces(3..43, 0.6);
}

fn check_kirchhoff_furnaces(seeds: std::ops::Range<u64>, h: f64) {
    for seed in seeds {
        let furnace = kirchhoff(seed, 3);
        let (evaluator, report) = bounded(furnace.scene.clone(), &uniform(h));
        let gap = check_kirchhoff("uniform", &furnace, &evaluator, evaluator.bounds().unwrap(), &mut Random(seed));
        let found = bounds_of(&report);
        println!(
            "seed {seed}: widest {gap:.3} B0, enclosed {:.3}, {:.1} s, {:?}",
            found.enclosed_share, report.time_s.bounds, found.evidence
        );
        assert!(found.enclosed_share > 0.5 && found.enclosed_share <= 1.0);

        // Light comes from surfaces alone that emit at least (1 - rho) B0: in a furnace that is not trivial.
        assert!(found.channels.iter().all(|channel| channel.lower_power > 0.0 && channel.upper_power >= channel.lower_power));
    }
}

#[test]
fn what_a_default_run_links_is_bounded_too() {
    let furnace = kirchhoff(3, 3);
    let (evaluator, _) = solve(furnace.scene.clone(), &SolveOptions { error: 0.1, ..SolveOptions::default() });
    assert!(evaluator.bounds().is_none());
    let (bounds, report) = evaluator.bound(FormFactorRule::QuasiConcave);
    check_kirchhoff("default", &furnace, &evaluator, &bounds, &mut Random(3));
    assert_eq!(report.certainty, Certainty::Guaranteed);
}
