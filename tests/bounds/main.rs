//! Radiosities that are proved: no value that is known exactly may lie outside, and where all is visible they must be near it.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "../support/fixtures.rs"]
mod fixtures;
mod furnaces;
#[path = "../support/kirchhoff.rs"]
mod kirchhoff;
mod pairs;
#[path = "../support/rooms.rs"]
mod rooms;
mod small_scenes;
#[path = "../support/triangles.rs"]
mod triangles;
#[path = "../support/two_squares.rs"]
mod two_squares;

use fixtures::{solution_cases, solution_value, value};
use kirchhoff::kirchhoff;
use patchlight::bounds::{BoundsReport, Certainty, Evidence, FormFactorRule, RadiosityBounds};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::{Observer, Silent};
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Bounds, LinkOptions, RunOptions, SolveOptions, SolveReport, Strategy, UniformOptions};
use rooms::{Room, cube, icosphere, points_of, room_of_boxes, solve, straight, values};
use triangles::Random;
use two_squares::TwoSquares;

/// Elements of side `h` where surfaces are squares, bounded; the values themselves cost little.
fn uniform(h: f64) -> SolveOptions {
    SolveOptions {
        bounds: Bounds::Guaranteed,
        strategy: Strategy::Uniform,
        point_rays: Some(1),
        error: 0.5,
        uniform: UniformOptions { element_area: Some(h * h) },
        links: LinkOptions { rays_per_link: 1, rays_per_light_link: 1, leaf_rays: Some(0), ..LinkOptions::default() },
        ..SolveOptions::default()
    }
}

fn bounded(scene: Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    let (evaluator, report) = solve(scene, options);
    let found = report.bounds.as_ref().unwrap();
    assert_eq!(found.certainty, Certainty::Guaranteed);
    // Shares add up to 1 but for rounding.
    let shares = |of: fn(&patchlight::bounds::EvidenceShare) -> f64| found.evidence.iter().map(of).sum::<f64>();
    assert!((shares(|share| share.upper_share) - 1.0).abs() < 1e-9, "{found:?}");
    (evaluator, report)
}

/// The mean over a surface of both bounds.
fn mean_bounds(evaluator: &Evaluator, bounds: &RadiosityBounds, surface: u32) -> [f64; 2] {
    let hierarchy = evaluator.solution().hierarchy();
    let of_surface =
        |&node: &patchlight::hierarchy::NodeId| hierarchy.is_leaf(node) && hierarchy.surface_of(node) == Some(SurfaceId(surface));
    let (mut sums, mut area) = ([0.0; 2], 0.0);
    for leaf in hierarchy.ids().filter(of_surface) {
        area += hierarchy.area(leaf);
        sums[0] += hierarchy.area(leaf) * bounds.lower(leaf)[0];
        sums[1] += hierarchy.area(leaf) * bounds.upper(leaf)[0];
    }
    sums.map(|sum| sum / area)
}

/// Asserts that exact values at points, known to within `tolerance`, are within the bounds there, as rounded outwards to f32.
fn assert_at_points(name: &str, evaluator: &Evaluator, points: &[(SurfacePoint, f64)], tolerance: f64) {
    let places: Vec<SurfacePoint> = points.iter().map(|(point, _)| *point).collect();
    let bounds = evaluator.bounds_at(&places).unwrap();
    for (index, (place, exact)) in points.iter().enumerate() {
        let (lower, upper) = (f64::from(bounds.lower[index]), f64::from(bounds.upper[index]));
        let holds = lower - tolerance <= *exact && *exact <= upper + tolerance;
        assert!(holds, "{name}, {:?}: {exact} is not in [{lower}, {upper}]", place.position);
    }
}

fn bounds_of(report: &SolveReport) -> &BoundsReport {
    report.bounds.as_ref().unwrap()
}

#[test]
fn uniform_furnaces_and_isothermal_rooms_lie_within_the_bounds() {
    for (rho, exact) in [
        (0.5, solution_value("furnace_cube_rho0.5", "B(x) everywhere")),
        (0.9, solution_value("furnace_cube_rho0.9", "B(x) everywhere")),
    ] {
        for h in [1.0, 0.25] {
            // All that is seen is equally bright, and form factors add up to 1: the bounds close in entirely, but for the last sweeps.
            let (evaluator, report) = bounded(cube(&[rho], &[1.0]), &uniform(h));
            let bounds = evaluator.bounds().unwrap();
            for node in evaluator.solution().hierarchy().ids() {
                let (lower, upper) = (bounds.lower(node)[0], bounds.upper(node)[0]);
                assert!(lower <= exact && exact <= upper, "rho {rho}, h {h}: [{lower}, {upper}]");
            }
            let found = bounds_of(&report);
            println!("rho {rho}, h {h}: width {:.2e} after {} sweeps", found.channels[0].l_infinity, found.sweeps);
            assert_eq!(found.enclosed_share, 1.0);
            assert!(found.channels[0].l_infinity < 0.01 * exact, "{found:?}");
        }
    }
    assert_eq!(solution_value("isothermal_enclosure_any_rho", "B(x) everywhere"), 1.0);
    let mut room = Room::default();
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |room, face| {
        let rho = 0.15 * face as f64 + 0.1;
        room.material(&[rho], &[1.0 - rho])
    });
    let (evaluator, _) = bounded(room.scene(), &uniform(0.25));
    let bounds = evaluator.bounds().unwrap();
    for node in evaluator.solution().hierarchy().ids() {
        assert!(bounds.lower(node)[0] <= 1.0 && 1.0 <= bounds.upper(node)[0]);
    }
}

fn square_probes(blocker: bool) -> Vec<(SurfacePoint, f64)> {
    let name = if blocker { "two_squares_h1_blocker_rho0" } else { "two_squares_h1" };
    let of_point = |case: &serde_json::Value| {
        let (square, place) = case["quantity"].as_str().unwrap().strip_suffix(')')?.split_once('(')?;
        let (x, y) = place.split_once(", ")?;
        let upper = f64::from(u8::from(square == "B2"));
        let position = [x.parse().unwrap(), y.parse().unwrap(), upper];
        Some((SurfacePoint { position, normal: [0.0, 0.0, 1.0 - 2.0 * upper] }, value(case)))
    };
    let probes: Vec<_> = solution_cases().iter().filter(|case| case["name"] == name).filter_map(of_point).collect();
    assert_eq!(probes.len(), 10);
    probes
}

#[test]
fn two_squares_lie_within_the_bounds_and_near_them() {
    check_two_squares(&[1.0, 0.5, 0.25, 0.125]);
}

/// Down to finer elements: `cargo test --release --test bounds -- --ignored --nocapture`.
#[test]
#[ignore = "a minute"]
fn two_squares_of_small_elements_lie_within_the_bounds_and_near_them() {
    check_two_squares(&[0.125, 0.0625, 0.03125]);
}

fn check_two_squares(sizes: &[f64]) {
    for blocker in [false, true] {
        let exact = TwoSquares::new(blocker);
        let mut widths = Vec::new();
        for &h in sizes {
            let (evaluator, report) = bounded(rooms::two_squares(blocker), &uniform(h));
            let (solution, bounds) = (evaluator.solution(), evaluator.bounds().unwrap());
            assert_at_points("two squares", &evaluator, &square_probes(blocker), 1e-12);
            let mut random = Random(17);
            let random_points: Vec<_> = points_of(solution.scene(), 400, &mut random)
                .into_iter()
                .filter(|(_, surface)| *surface < 2)
                .map(|(point, surface)| (point, exact.at(surface, [point.position[0], point.position[1]])))
                .collect();
            // What the independent solution is known to; see tests/convergence.rs.
            assert_at_points("two squares", &evaluator, &random_points, 2e-10);
            for square in 0..2 {
                let [lower, upper] = mean_bounds(&evaluator, bounds, square);
                assert!(lower <= exact.mean(square as usize) && exact.mean(square as usize) <= upper);
            }

            // The largest error of an element's value, at its corners, against the widest bounds over the elements of the solve, whose size
            // is known.
            let (over_links, of_links) = evaluator.bound(FormFactorRule::QuasiConcave);
            let hierarchy = solution.hierarchy();
            let (mut largest, mut widest) = (0.0f64, 0.0f64);
            for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
                let surface = hierarchy.surface_of(leaf).unwrap().index();
                if surface > 1 {
                    continue;
                }
                for corner in hierarchy.polygon(leaf) {
                    largest = largest.max((solution.radiosity().of(leaf)[0] - exact.at(surface, [corner[0], corner[1]])).abs());
                }
                widest = widest.max(over_links.upper(leaf)[0] - over_links.lower(leaf)[0]);
            }
            println!("blocker {blocker}, h {h}: widest {widest:.5}, largest error {largest:.5}, {:.2} times", widest / largest);
            println!("    {:?}", bounds_of(&report).evidence);
            // Proved bounds leave a few times the error itself (two to three; empirical).
            assert!(blocker || widest <= 5.0 * largest, "h {h}: {widest} for errors up to {largest}");
            widths.push(of_links.channels[0].l1);
        }
        println!("blocker {blocker}: L1 widths {widths:.5?}");
        // Halving the elements should halve the widths; coarse ones have not come so far.
        assert!(widths[usize::from(sizes[0] == 1.0)..].windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{widths:?}");
    }
}

#[test]
fn the_cube_with_an_emitting_floor_lies_within_the_bounds() {
    let case = "unit_cube_floor_emits_rho0.5";
    let scene = || {
        let mut room = Room::default();
        let (wall, floor) = (room.material(&[0.5], &[0.0]), room.material(&[0.5], &[1.0]));
        room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, face| if face == 0 { floor } else { wall });
        room.scene()
    };
    let point =
        |quantity: &str, position: [f64; 3], normal: [f64; 3]| (SurfacePoint { position, normal }, solution_value(case, quantity));
    let probes = [
        point("B_floor(.5,.5)", [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]),
        point("B_floor(.1,.5)", [0.1, 0.5, 0.0], [0.0, 0.0, 1.0]),
        point("B_floor(.1,.1)", [0.1, 0.1, 0.0], [0.0, 0.0, 1.0]),
        point("B_ceiling(.5,.5)", [0.5, 0.5, 1.0], [0.0, 0.0, -1.0]),
        point("B_ceiling(.1,.1)", [0.1, 0.1, 1.0], [0.0, 0.0, -1.0]),
        point("B_wall(mid,.5)", [0.0, 0.5, 0.5], [1.0, 0.0, 0.0]),
        point("B_wall(mid,z=.1)", [0.0, 0.5, 0.1], [1.0, 0.0, 0.0]),
        point("B_wall(mid,z=.9)", [0.0, 0.5, 0.9], [1.0, 0.0, 0.0]),
        point("B_wall(.1 along,z=.1)", [0.0, 0.1, 0.1], [1.0, 0.0, 0.0]),
    ];
    for h in [0.5, 0.25, 0.125] {
        let (evaluator, report) = bounded(scene(), &uniform(h));
        // The reference values are numerical, to 2e-5; means to 1e-5.
        assert_at_points(case, &evaluator, &probes, 2e-5);
        for (surface, quantity) in [(0, "mean floor"), (1, "mean ceiling"), (2, "mean wall")] {
            let (exact, [lower, upper]) =
                (solution_value(case, quantity), mean_bounds(&evaluator, evaluator.bounds().unwrap(), surface));
            println!("h {h}: {quantity} {exact} in [{lower:.5}, {upper:.5}]");
            assert!(lower - 1e-5 <= exact && exact <= upper + 1e-5);
        }
        assert_eq!(bounds_of(&report).enclosed_share, 1.0);
    }
}

#[test]
fn clusters_are_bounded_by_their_boxes() {
    // A furnace, in which little but the sum of form factors is known. Whoever has no time has bounds all the same.
    let (mut random, b0) = (Random(8), 1.5);
    let scene = room_of_boxes(|room, _| {
        let rho = random.between(0.1, 0.8);
        room.material(&[rho], &[(1.0 - rho) * b0])
    });
    struct Hurry(bool);
    impl Observer for Hurry {
        fn cancelled(&self) -> bool {
            self.0
        }
    }
    for hurry in [false, true] {
        let options = SolveOptions { error: 0.2, bounds: Bounds::Guaranteed, ..SolveOptions::default() };
        let (evaluator, report) = pipeline::solve(scene.clone(), &options, &RunOptions::default(), &Hurry(hurry)).unwrap();
        let (bounds, found) = (evaluator.bounds().unwrap(), bounds_of(&report));
        assert_eq!(found.certainty, Certainty::Guaranteed);
        assert!(hurry || found.evidence.iter().any(|share| share.evidence == Evidence::Boxes && share.pairs > 0));
        for node in evaluator.solution().hierarchy().ids() {
            let (lower, upper) = (bounds.lower(node)[0], bounds.upper(node)[0]);
            assert!(lower <= b0 * (1.0 + 1e-12) && b0 <= upper * (1.0 + 1e-12), "{node:?}: [{lower}, {upper}]");
        }
    }
}

#[test]
fn the_more_work_the_narrower_the_bounds_of_clusters() {
    let scene = room_of_boxes(|room, k| if k == 13 { room.material(&[0.0], &[1.0]) } else { room.material(&[0.5], &[0.0]) });
    let points: Vec<_> = points_of(&scene, 300, &mut Random(9)).into_iter().map(|(point, _)| point).collect();
    let mut powers: Vec<[f64; 2]> = Vec::new();
    // The most that may be asked for is more than there is to do here.
    let most = 1 << 24;
    for work in [0, 1000, 10_000, most] {
        let options = SolveOptions { error: 0.02, bounds: Bounds::Guaranteed, bounds_work: Some(work), ..SolveOptions::default() };
        let (evaluator, report) = bounded(scene.clone(), &options);
        let found = bounds_of(&report);
        let boxes = found.evidence.iter().find(|share| share.evidence == Evidence::Boxes).map_or(0, |share| share.pairs);
        println!("work {work}: {boxes} pairs of boxes, {:?}", found.channels);
        assert_eq!(boxes == 0, work == most);
        powers.push([found.channels[0].lower_power, found.channels[0].upper_power]);

        // What paths of light find does not know of the bounds, but for values being kept within them at last.
        let options = SolveOptions { bounds: Bounds::Estimate, ..options };
        let (free, _) = solve(scene.clone(), &options);
        let (values, bounds) = (values(&free, &points), evaluator.bounds_at(&points).unwrap());
        let size = (values.iter().map(|b| b * b).sum::<f64>() / values.len() as f64).sqrt();
        for (value, (lower, upper)) in values.iter().zip(bounds.lower.iter().zip(&bounds.upper)) {
            let (lower, upper) = (f64::from(*lower) - 0.2 * size, f64::from(*upper) + 0.2 * size);
            assert!((lower..=upper).contains(value), "{value} is not in [{lower}, {upper}]");
        }
    }
    println!("{powers:?}");
    // Little work may leave the lower power at what emitters alone are proved to send.
    assert!(powers.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[1][1] < pair[0][1]), "{powers:?}");
    assert!(powers[0][0] < powers[3][0], "{powers:?}");
    // Boxes alone leave more than twice as much open as all the work does (three times; empirical).
    assert!(powers[3][1] < 0.5 * powers[0][1]);
}

#[test]
fn concentric_spheres_lie_within_the_bounds() {
    for (exitance, expected) in [
        // Kirchhoff's, which holds for polyhedra as well; and the case of true spheres, for means over either.
        ([0.5, 0.3], [1.0, 1.0]),
        ([1.0, 0.0], ["inner", "outer"].map(|name| solution_value(&format!("concentric_spheres_B_{name}"), &format!("B_{name}")))),
    ] {
        let mut room = Room::default();
        let (inner, outer) = (room.material(&[0.5], &[exitance[0]]), room.material(&[0.7], &[exitance[1]]));
        icosphere(0.5, 1).iter().for_each(|triangle| room.face(triangle, inner));
        icosphere(1.0, 1).iter().for_each(|&[a, b, c]| room.face(&[a, c, b], outer));
        let (evaluator, report) = bounded(room.scene(), &uniform(1.0));
        let bounds = evaluator.bounds().unwrap();
        let (mut sums, mut areas) = ([[0.0; 2]; 2], [0.0; 2]);
        for surface in 0..160 {
            let node = evaluator.solution().hierarchy().node_of(SurfaceId(surface));
            let (area, sphere) = (evaluator.solution().hierarchy().area(node), usize::from(surface >= 80));
            let found = [bounds.lower(node)[0], bounds.upper(node)[0]];
            assert!(exitance[0] != 0.5 || (found[0] <= 1.0 + 1e-12 && 1.0 - 1e-12 <= found[1]), "{surface}: {found:?}");
            areas[sphere] += area;
            (0..2).for_each(|end| sums[sphere][end] += area * found[end]);
        }
        for sphere in 0..2 {
            let [lower, upper] = sums[sphere].map(|sum| sum / areas[sphere]);
            println!("sphere {sphere}: {} in [{lower:.4}, {upper:.4}]; {:?}", expected[sphere], bounds_of(&report).evidence);
            assert!(lower <= expected[sphere] && expected[sphere] <= upper);
            // Well below `E / (1 - rho)` of the largest of either, which holds in any room.
            assert!(upper < 0.7 * exitance[0] / (1.0 - 0.7), "{upper} is hardly better than what is trivially true");
        }
    }
}

#[test]
fn values_are_kept_within_the_bounds_and_threads_change_nothing() {
    let furnace = kirchhoff(1, 3);
    let run = |threads| {
        let options = SolveOptions { error: 0.2, bounds: Bounds::Guaranteed, ..SolveOptions::default() };
        pipeline::solve(furnace.scene.clone(), &options, &RunOptions { threads, ..RunOptions::default() }, &Silent).unwrap()
    };
    let ((one, report), (two, _)) = (run(1), run(2));
    assert_eq!(one.bounds(), two.bounds());
    let points: Vec<_> = points_of(&furnace.scene, 200, &mut Random(5)).into_iter().map(|(point, _)| point).collect();
    let (values, bounds) = (values(&one, &points), one.bounds_at(&points).unwrap());
    assert_eq!(values.len(), bounds.lower.len());
    for (value, (lower, upper)) in values.iter().zip(bounds.lower.iter().zip(&bounds.upper)) {
        assert!((f64::from(*lower)..=f64::from(*upper)).contains(value));
    }

    // A stored solution is bounded again when it is opened, to the same bits.
    let again = Evaluator::new(one.solution().clone(), &RunOptions::default()).unwrap();
    assert_eq!(again.bounds(), one.bounds());
    assert!(bounds_of(&report).relative_error > 0.0);
}

#[test]
fn what_overlaps_in_one_plane_leaves_nothing_guaranteed() {
    // A lamp in the plane of the ceiling: points below see both, so form factors add up to more than 1.
    let room = |lift: f64| {
        let mut room = Room::default();
        let (wall, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
        room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| wall);
        room.quad([0.4, 0.4, 1.0 - lift], [0.0, 0.2, 0.0], [0.2, 0.0, 0.0], lamp);
        let (evaluator, _) = solve(room.scene(), &SolveOptions { error: 0.5, ..SolveOptions::default() });
        evaluator.bound(FormFactorRule::QuasiConcave).1.certainty
    };
    assert_eq!((room(0.0), room(0.01)), (Certainty::Estimate, Certainty::Guaranteed));
}

#[test]
fn strategies_that_forget_pairs_are_refused() {
    let options = SolveOptions { bounds: Bounds::Guaranteed, strategy: Strategy::Culling94, ..SolveOptions::default() };
    let message = options.validate().unwrap_err().to_string();
    assert!(message.contains("bounds is guaranteed") && message.contains("estimate for the strategies of 1994"), "{message}");
}
