//! Bottom-up linking and the top-down linking that it is compared with (Chang, Shih 1998) against exact form factors and furnaces.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use fixtures::{form_factor_cases, value, vectors};
use patchlight::bounds::Certainty;
use patchlight::form_factor::exact_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Bounds, ChangShih98Options, Solution, SolveOptions, Strategy};
use rooms::{Room, cube, solve, two_squares as facing_squares, values};
use triangles::Random;
use two_squares::TwoSquares;

const BOTH: [Strategy; 2] = [Strategy::BottomUp98, Strategy::TopDown98];

/// Linking alone, with little effort on everything else.
fn options(strategy: Strategy, form_factor_tolerance: f64) -> SolveOptions {
    SolveOptions {
        strategy,
        point_rays: Some(1),
        error: 0.9,
        chang_shih98: ChangShih98Options { form_factor_tolerance, ..ChangShih98Options::default() },
        ..SolveOptions::default()
    }
}

/// Mean and its standard error.
fn statistics(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// Runs whose mean is compared: 4.5 standard errors, taken from 16 runs themselves, are exceeded with probability 4e-4.
const SEEDS: u64 = 16;
const STANDARD_ERRORS: f64 = 4.5;

#[test]
fn form_factors_between_surfaces_are_unbiased_with_and_without_occlusion() {
    for case in form_factor_cases().iter().filter(|case| case["group"] == "A4" && case["quantity"] == "F_visible(P1->P2)") {
        let (name, geometry, exact) = (case["name"].as_str().unwrap(), &case["geometry"], value(case));
        let mut spread = [0.0; 2];
        for (index, strategy) in BOTH.into_iter().enumerate() {
            let found: Vec<f64> = (0..SEEDS).map(|seed| form_factor(&scene_of(geometry), strategy, seed)).collect();
            let (mean, error) = statistics(&found);
            println!("{name}, {strategy:?}: {mean:.6} +- {error:.1e}, exact {exact:.6}");
            assert!((mean - exact).abs() <= STANDARD_ERRORS * error + 1e-7, "{name}, {strategy:?}: {mean} for {exact}, {error}");
            spread[index] = error;
        }
        // The sums over 64 x 64 elements are better known than one pair of surfaces by 4 x 4 points, and well known: 0.29 times at
        // worst, by 64 seeds; the ratio of two errors from 16 scatters by a quarter.
        assert!(exact == 0.0 || spread[0] < 0.375 * spread[1] && spread[0] < 0.01 * exact, "{name}: {spread:?}");
    }
}

fn scene_of(geometry: &serde_json::Value) -> Scene {
    let mut room = Room::default();
    let (grey, black) = (room.material(&[0.5], &[1.0]), room.material(&[0.0], &[0.0]));
    room.face(&vectors(&geometry["polygons"]["P1"]), grey);
    room.face(&vectors(&geometry["polygons"]["P2"]), grey);
    for blocker in geometry["blockers"].as_array().unwrap() {
        room.sheet(&vectors(blocker), black);
    }
    room.scene()
}

/// From surface 0 to surface 1, with so large a tolerance that surfaces are linked as they are.
fn form_factor(scene: &Scene, strategy: Strategy, seed: u64) -> f64 {
    let mut options = SolveOptions { seed, ..options(strategy, 1.0) };
    options.chang_shih98.bottom_area = 1.0 / 64.0;
    let (evaluator, _) = solve(scene.clone(), &options);
    let solution = evaluator.solution();
    let [receiver, source] = [0, 1].map(|surface| solution.hierarchy().node_of(SurfaceId(surface)));
    let links: Vec<f64> = (solution.links().of(receiver).iter())
        .filter(|link| link.source == source)
        .map(|link| link.occluded_form_factor())
        .collect();
    assert_eq!(links.len(), 1, "the surfaces are not linked as they are");
    links[0]
}

/// Of how many leaves each node is made, as a row of the leaves' numbers.
fn leaves_below(solution: &Solution) -> (Vec<NodeId>, Vec<Vec<usize>>) {
    let hierarchy = solution.hierarchy();
    let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let mut below = vec![Vec::new(); hierarchy.len()];
    for (index, &leaf) in leaves.iter().enumerate() {
        std::iter::successors(Some(leaf), |&node| hierarchy.parent(node)).for_each(|node| below[node.index()].push(index));
    }
    (leaves, below)
}

#[test]
fn a_finer_tolerance_comes_nearer_to_the_exact_form_factors_of_elements() {
    // Two squares that face each other: how far all pairs of leaves are from what is exact.
    let mut room = Room::default();
    let grey = room.material(&[0.5], &[1.0]);
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
    room.quad([0.0, 0.0, 0.5], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], grey);
    let scene = room.scene();
    for strategy in BOTH {
        let mut before = (0, f64::INFINITY);
        for tolerance in [1.0, 0.1, 0.02] {
            let mut options = options(strategy, tolerance);
            options.chang_shih98.bottom_area = 1.0 / 64.0;
            let (evaluator, report) = solve(scene.clone(), &options);
            let solution = evaluator.solution();
            let hierarchy = solution.hierarchy();
            let (leaves, below) = leaves_below(solution);
            let polygons: Vec<Polygon> = leaves.iter().map(|&leaf| Polygon::new(&hierarchy.polygon(leaf)).unwrap()).collect();
            let (mut error_sq, mut norm_sq) = (0.0, 0.0);
            for (receiver, link) in solution.links().iter() {
                for &r in &below[receiver.index()] {
                    for &s in &below[link.source.index()] {
                        let exact = exact_area_form_factor(&polygons[r], &polygons[s]);
                        let share = polygons[s].area() / hierarchy.area(link.source);
                        let found = polygons[r].area() * link.occluded_form_factor() * share;
                        error_sq += (found - exact).powi(2);
                        norm_sq += exact.powi(2);
                    }
                }
            }
            let error = (error_sq / norm_sq).sqrt();
            println!("{strategy:?}, {tolerance}: {} links, {error:.4}", report.counts.links);
            assert!(
                report.counts.links > before.0 && error < 0.6 * before.1,
                "{strategy:?}, {tolerance}: {error} after {before:?}"
            );
            before = (report.counts.links, error);
        }
        assert!(before.1 < 0.1, "{strategy:?}: {}", before.1);
    }
}

#[test]
fn a_furnace_is_off_by_no_more_than_its_form_factors() {
    // In a closed cube form factors add up to 1; sampled along edges they may be far off. If those of every leaf do within delta,
    // the radiosity, B0 everywhere, is off by at most rho delta / (1 - rho (1 + delta)) of it.
    const RHO: f64 = 0.3;
    for strategy in BOTH {
        for seed in 0..8 {
            let mut options = SolveOptions { seed, ..options(strategy, 0.1) };
            options.chang_shih98.bottom_area = 1.0 / 64.0;
            options.links.sweep_tolerance = 1e-9;
            let (evaluator, report) = solve(cube(&[RHO], &[1.0]), &options);
            let solution = evaluator.solution();
            let (leaves, below) = leaves_below(solution);
            let mut of_leaves = vec![0.0; leaves.len()];
            for (receiver, link) in solution.links().iter() {
                let form_factor = link.occluded_form_factor();
                below[receiver.index()].iter().for_each(|&leaf| of_leaves[leaf] += form_factor);
            }
            let delta = of_leaves.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
            let exact = 1.0 / (1.0 - RHO);
            let off = leaves.iter().map(|&leaf| (solution.radiosity().of(leaf)[0] / exact - 1.0).abs()).fold(0.0, f64::max);
            let allowed = RHO * delta / (1.0 - RHO * (1.0 + delta));
            if seed == 0 {
                println!("{strategy:?}: {} links, sums off by {delta:.3}, B by {off:.3} of {allowed:.3}", report.counts.links);
            }
            assert!(
                RHO * (1.0 + delta) < 1.0 && off <= allowed + 1e-6,
                "{strategy:?}, seed {seed}: {off} of {allowed}, sums off by {delta}"
            );
        }
    }
}

#[test]
fn values_at_points_are_within_the_claim() {
    for strategy in BOTH {
        for blocker in [false, true] {
            let options = SolveOptions {
                strategy,
                error: 0.05,
                chang_shih98: ChangShih98Options { bottom_area: 1.0 / 64.0, ..ChangShih98Options::default() },
                ..SolveOptions::default()
            };
            let (evaluator, report) = solve(facing_squares(blocker), &options);
            let exact = TwoSquares::new(blocker);
            let mut random = Random(98);
            let places: Vec<(usize, [f64; 2])> = (0..800).map(|k| (k % 2, [random.unit(), random.unit()])).collect();
            let points: Vec<_> = (places.iter())
                .map(|&(square, [x, y])| SurfacePoint {
                    position: [x, y, square as f64],
                    normal: [0.0, 0.0, 1.0 - 2.0 * square as f64],
                })
                .collect();
            let found = values(&evaluator, &points);
            let error_sq: f64 = found.iter().zip(&places).map(|(b, &(square, x))| (b - exact.at(square, x)).powi(2)).sum();
            let error = (2.0 * error_sq / places.len() as f64 / exact.reflected_norm_sq()).sqrt();
            println!("{strategy:?}, blocker {blocker}: {error:.4}, claimed {:.4}", report.error.estimate);
            assert!(report.converged && error <= report.error.estimate, "{strategy:?}, blocker {blocker}: {error}, {report:?}");
        }
    }
}

#[test]
fn bounds_can_be_proved_over_these_links() {
    for strategy in BOTH {
        let options = SolveOptions {
            strategy,
            bounds: Bounds::Guaranteed,
            error: 0.5,
            chang_shih98: ChangShih98Options { bottom_area: 1.0 / 16.0, ..ChangShih98Options::default() },
            ..SolveOptions::default()
        };
        let (evaluator, report) = solve(facing_squares(false), &options);
        let exact = TwoSquares::new(false);
        let power = exact.mean(0) + exact.mean(1);
        let bounds = report.bounds.expect("bounds were asked for");
        let [channel] = &bounds.channels[..] else { panic!("one channel: {bounds:?}") };
        println!("{strategy:?}: {power} W within {} to {}", channel.lower_power, channel.upper_power);
        assert_eq!(bounds.certainty, Certainty::Guaranteed);
        assert!(channel.lower_power <= power && power <= channel.upper_power, "{strategy:?}: {power}, {bounds:?}");
        assert!(evaluator.solution().validate().is_ok());
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |key: &str, value: &str| SolveOptions::default().set(key, value).unwrap_err().to_string();
    for (key, values, range) in [
        ("form_factor_tolerance", &["0", "-1", "1.5", "NaN"][..], "above 0, at most 1"),
        ("bottom_area", &["0", "0.0001", "2", "NaN", "-1"], "0.0009765625 to 1"),
        ("bottom_samples", &["0", "9"], "1 to 8"),
    ] {
        for value in values {
            let message = refused(key, value);
            assert!(message.contains(key) && message.contains(range), "{message}");
        }
    }
}
