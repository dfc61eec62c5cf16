//! Radiosities that are proved: no value that is known exactly may lie outside, and where all is visible they must be near it.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use fixtures::{form_factor_cases, solution_cases, solution_value, value, vector, vectors};
use kirchhoff::{Kirchhoff, kirchhoff};
use patchlight::bounds::{BoundsReport, Certainty, Evidence, FormFactorRule, RadiosityBounds, bound_pair};
use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::{Observer, Silent};
use patchlight::reconstruct::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Bounds, RunOptions, SolveOptions, SolveReport, Strategy};
use patchlight::visibility::{self, Backend, OccluderMesh, Segment, Visibility};
use rooms::{Room, cube, icosphere, points_of, room_of_boxes, solve, straight, values};
use triangles::Random;
use two_squares::TwoSquares;

/// Elements of side `h` where surfaces are squares, bounded; the values themselves cost little.
fn uniform(h: f64) -> SolveOptions {
    SolveOptions {
        bounds: Bounds::Guaranteed,
        strategy: Strategy::Uniform,
        element_area: Some(h * h),
        rays_per_link: 1,
        rays_per_light_link: 1,
        point_rays: Some(1),
        leaf_rays: Some(0),
        error: 0.5,
        ..SolveOptions::default()
    }
}

fn bounded(scene: Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    let (evaluator, report) = solve(scene, options);
    let found = report.bounds.as_ref().unwrap();
    assert_eq!(found.certainty, Certainty::Guaranteed);
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

/// Asserts that exact values at points are within the bounds there, as rounded outwards to f32.
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

/// The visible form factors of the cases with blockers: the source emits 1, the receiver reflects 1/2, so twice the radiosity is
/// the form factor.
#[test]
fn occluded_cases_lie_within_the_bounds() {
    let mut checked = 0;
    for case in form_factor_cases().iter().filter(|case| case["group"] == "A4") {
        let (name, geometry, exact) = (case["name"].as_str().unwrap(), &case["geometry"], value(case));
        let of_point = case["quantity"] == "F_visible(dA->P)";
        let (receiver, source) = if of_point {
            let position = vector(&geometry["receiver_point"]);
            let corner = |dx: f64, dy: f64| [position[0] + dx, position[1] + dy, position[2]];
            let square = vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
            (square, vectors(&geometry["polygons"]["emitter"]))
        } else {
            (vectors(&geometry["polygons"]["P1"]), vectors(&geometry["polygons"]["P2"]))
        };
        let scene = || {
            let mut room = Room::default();
            let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
            room.face(&receiver, grey);
            room.face(&source, lamp);
            for blocker in geometry["blockers"].as_array().unwrap() {
                room.sheet(&vectors(blocker), black);
            }
            room.scene()
        };
        let mut widths = Vec::new();
        for h in [1.0, 0.5, 0.25, 0.125] {
            let (evaluator, report) = bounded(scene(), &uniform(h));
            let bounds = evaluator.bounds().unwrap();
            let [lower, upper] = mean_bounds(&evaluator, bounds, 0).map(|b| 2.0 * b);
            if of_point {
                let point = SurfacePoint { position: vector(&geometry["receiver_point"]), normal: [0.0, 0.0, 1.0] };
                assert_at_points(name, &evaluator, &[(point, 0.5 * exact)], 1e-12);
            } else {
                assert!(lower - 1e-12 <= exact && exact <= upper + 1e-12, "{name}, h {h}: {exact} is not in [{lower}, {upper}]");
            }
            assert!(bounds_of(&report).evidence.iter().all(|share| share.evidence != Evidence::Boxes), "{report:?}");
            widths.push(upper - lower);
            checked += 1;
        }
        println!("{name}: mean widths {widths:.4?}");
        // Shadows of blockers in the middle are known: the bounds close in with the elements.
        let touches = name == "occl_vertical_partition_full";
        assert!(touches || widths[3] < 0.35 * widths[1] || widths[3] < 1e-9, "{name}: {widths:?}");
    }
    assert_eq!(checked, 11 * 4);
}

#[test]
fn a_blocker_that_covers_all_hides_all() {
    let mut room = Room::default();
    let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
    room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    room.quad([-0.5, -0.5, 0.5], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], black);
    let scene = room.scene();
    let hierarchy = patchlight::hierarchy::Hierarchy::new(&scene);
    let [floor, ceiling, sheet] = [0, 1, 2].map(|surface| hierarchy.node_of(SurfaceId(surface)));
    let hidden = bound_pair(&scene, &hierarchy, floor, ceiling, FormFactorRule::QuasiConcave);
    assert_eq!((hidden.lower, hidden.upper, hidden.evidence), (0.0, 0.0, Evidence::Shadows));
    let seen = bound_pair(&scene, &hierarchy, floor, sheet, FormFactorRule::QuasiConcave);
    assert_eq!(seen.evidence, Evidence::Sight);
    assert!(seen.lower > 0.7 && seen.upper < 0.95, "{seen:?}");
    let by_samples = bound_pair(&scene, &hierarchy, floor, sheet, FormFactorRule::CentreAndVertices);
    assert_eq!(by_samples.certainty, Certainty::Estimate);
}

/// Form factors with anything in the way, by rays from points: `n * n` of them to cells of equal area, each with its exact form
/// factor.
fn form_factor_by_rays(scene: &Scene, visibility: &dyn Visibility, x: SurfacePoint, n: usize) -> [f64; 2] {
    let [receiver, source] = [0, 1].map(|surface| scene.surface(SurfaceId(surface)));
    let corners: Vec<[f64; 3]> = source.polygon.vertices().collect();
    let at = |s: f64, t: f64| -> [f64; 3] {
        std::array::from_fn(|k| corners[0][k] + s * (corners[1][k] - corners[0][k]) + t * (corners[3][k] - corners[0][k]))
    };
    // A cell counts for both where its corners do not agree.
    let place = |k: usize| k as f64 / n as f64;
    let segment = |k: usize| Segment {
        from: x.position,
        to: at(place(k % (n + 1)), place(k / (n + 1))),
        from_plane: receiver.plane(),
        to_plane: source.plane(),
    };
    let segments: Vec<Segment> = (0..(n + 1) * (n + 1)).map(segment).collect();
    let mut occluded = vec![false; segments.len()];
    visibility.occluded(&segments, &mut occluded);
    let (mut visible, mut doubtful) = (0.0, 0.0);
    for i in 0..n {
        for j in 0..n {
            let hidden = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].iter().filter(|(i, j)| occluded[j * (n + 1) + i]).count();
            if hidden == 4 {
                continue;
            }
            let (a, b) = (at(place(i), place(j)), at(place(i + 1), place(j + 1)));
            let cell = Polygon::new(&[a, at(place(i + 1), place(j)), b, at(place(i), place(j + 1))]).unwrap();
            let factor = point_form_factor(x.position, x.normal, &cell);
            *(if hidden == 0 { &mut visible } else { &mut doubtful }) += factor;
        }
    }
    [visible, visible + doubtful]
}

#[test]
fn random_blockers_anywhere_never_lead_to_a_wrong_proof() {
    let mut random = Random(31);
    let mut kinds = [0; 3];
    for round in 0..300 {
        // Two parallelograms that see each other, and one to three others, some on the floor, some with an edge or a plane in
        // common.
        let mut room = Room::default();
        let (grey, black) = (room.material(&[0.5], &[0.1]), room.material(&[0.0], &[0.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        if round % 2 == 0 {
            let [x, y, z] = [random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(0.7, 1.2)];
            room.quad(
                [x, y, z],
                [random.between(-0.2, 0.2), random.between(0.6, 1.0), 0.0],
                [random.between(0.6, 1.0), 0.0, 0.0],
                grey,
            );
        } else {
            room.quad([random.between(-0.5, 0.0), 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, random.between(0.3, 1.5)], grey);
        }
        for _ in 0..1 + round % 3 {
            let corner = [random.between(-0.2, 0.8), random.between(-0.2, 0.8), random.between(0.05, 0.6)];
            let (u, v) = match round % 5 {
                0 => ([random.between(0.05, 1.0), 0.0, 0.0], [0.0, random.between(0.05, 1.0), 0.0]),
                1 => ([0.0, random.between(0.05, 0.8), 0.0], [0.0, 0.0, -corner[2]]),
                _ => (random.point(0.6), random.point(0.6)),
            };
            room.quad(corner, u, v, black);
        }
        let scene = room.scene();
        let hierarchy = patchlight::hierarchy::Hierarchy::new(&scene);
        let visibility = visibility::build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let nodes = [0, 1].map(|surface| hierarchy.node_of(SurfaceId(surface)));
        let found = bound_pair(&scene, &hierarchy, nodes[0], nodes[1], FormFactorRule::QuasiConcave);
        kinds[found.evidence as usize] += 1;
        for _ in 0..6 {
            let x = rooms::point_of(&scene.surfaces()[0].polygon, &mut random);
            let [least, most] = form_factor_by_rays(&scene, &*visibility, x, 32);
            // Even if something thinner than a cell was missed on the way, the bounds may not contradict what was seen by so much.
            let slack = 0.01 * most + 1e-9;
            assert!(
                found.lower <= most + slack && least <= found.upper + slack,
                "round {round}, {:?}: [{least}, {most}] was seen, {found:?}",
                x.position
            );
        }
    }
    println!("whole, in part with known shadows, unproved: {kinds:?}");
    assert!(kinds.iter().all(|&count| count > 15), "{kinds:?}");
}

#[test]
fn uniform_furnaces_and_isothermal_rooms_lie_within_the_bounds() {
    for (rho, exact) in [
        (0.5, solution_value("furnace_cube_rho0.5", "B(x) everywhere")),
        (0.9, solution_value("furnace_cube_rho0.9", "B(x) everywhere")),
    ] {
        for h in [1.0, 0.25] {
            // All that is seen is equally bright, and form factors add up to 1: the bounds close in entirely.
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
            assert_at_points("two squares", &evaluator, &random_points, 2e-10);
            for square in 0..2 {
                let [lower, upper] = mean_bounds(&evaluator, bounds, square);
                assert!(lower <= exact.mean(square as usize) && exact.mean(square as usize) <= upper);
            }

            // The largest error of an element's value, at its corners, against the widest bounds.
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
                widest = widest.max(bounds.upper(leaf)[0] - bounds.lower(leaf)[0]);
            }
            println!("blocker {blocker}, h {h}: widest {widest:.5}, largest error {largest:.5}, {:.2} times", widest / largest);
            println!("    {:?}", bounds_of(&report).evidence);
            assert!(blocker || widest <= 5.0 * largest, "h {h}: {widest} for errors up to {largest}");
            widths.push(bounds_of(&report).channels[0].l1);
        }
        println!("blocker {blocker}: L1 widths {widths:.5?}");
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
        // The published values are numerical, to five digits.
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
    for work in [0, 1000, 10_000, u64::MAX] {
        let options = SolveOptions { error: 0.02, bounds: Bounds::Guaranteed, bounds_work: Some(work), ..SolveOptions::default() };
        let (evaluator, report) = bounded(scene.clone(), &options);
        let found = bounds_of(&report);
        let boxes = found.evidence.iter().find(|share| share.evidence == Evidence::Boxes).map_or(0, |share| share.pairs);
        println!("work {work}: {boxes} pairs of boxes, {:?}", found.channels);
        assert_eq!(boxes == 0, work == u64::MAX);
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
    assert!(powers.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[1][1] < pair[0][1]), "{powers:?}");
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
            assert!(upper < 3.4, "no better than what is trivially true");
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
    assert!(message.contains("bounds is guaranteed") && message.contains("none or estimate"), "{message}");
}
