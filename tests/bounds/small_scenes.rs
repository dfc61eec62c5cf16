//! Bounds of scenes with few surfaces: narrow where something is in the way, too, and never violated.

use patchlight::bounds::{Certainty, ConditionKind};
use patchlight::geometry::Polygon;
use patchlight::scene::{Scene, SurfaceId, SurfacePoint};
use patchlight::solve::{Bounds, SolveOptions};
use patchlight::visibility::{self, Backend, OccluderMesh};

use super::pairs::form_factor_by_rays;
use super::rooms::{self, Room, points_of, solve};
use super::triangles::Random;
use super::two_squares::TwoSquares;
use super::{bounds_of, uniform};

/// Bounds at random points of the first two surfaces, with the surface.
fn bounds_at_points(
    scene: &Scene,
    options: &SolveOptions,
    count: usize,
    random: &mut Random,
) -> Vec<(SurfacePoint, usize, [f64; 2])> {
    let (evaluator, report) = solve(scene.clone(), options);
    assert_eq!(bounds_of(&report).certainty, Certainty::Guaranteed, "{:?}", bounds_of(&report).conditions);
    let points: Vec<(SurfacePoint, usize)> =
        points_of(scene, count, random).into_iter().filter(|(_, surface)| *surface < 2).collect();
    let places: Vec<SurfacePoint> = points.iter().map(|(point, _)| *point).collect();
    let bounds = evaluator.bounds_at(&places).unwrap();
    let found = bounds.lower.iter().zip(&bounds.upper).map(|(&lower, &upper)| [f64::from(lower), f64::from(upper)]);
    points.into_iter().zip(found).map(|((point, surface), bounds)| (point, surface, bounds)).collect()
}

#[test]
fn two_squares_are_bounded_closely_with_and_without_a_blocker() {
    // Relative to what is reflected alone, which is the harder figure: the lower square emits.
    for (blocker, most) in [(false, 0.05), (true, 0.2)] {
        let exact = TwoSquares::new(blocker);
        let options = SolveOptions { bounds: Bounds::Guaranteed, ..uniform(0.25) };
        let options = SolveOptions { error: 0.01, ..options };
        let found = bounds_at_points(&rooms::two_squares(blocker), &options, 600, &mut Random(5));
        let mut sum = 0.0;
        for (point, surface, [lower, upper]) in &found {
            let truth = exact.at(*surface, [point.position[0], point.position[1]]);
            // What the independent solution is known to; see tests/convergence.rs.
            assert!(lower - 2e-10 <= truth && truth <= upper + 2e-10, "{:?}: {truth} not in [{lower}, {upper}]", point.position);
            let emitted = if *surface == 0 { 1.0 } else { 0.0 };
            sum += (upper - lower) / (truth - emitted);
        }
        let mean = sum / found.len() as f64;
        println!("blocker {blocker}: mean relative width {mean:.4} at {} points", found.len());
        assert!(mean <= most, "blocker {blocker}: {mean}");
    }
}

/// A lamp that does not reflect over a floor that does: twice the radiosity of the floor is the form factor, which rays know to within cells
/// of the lamp that are partly hidden.
fn check_random_blockers(rounds: std::ops::Range<u64>, work: u64, cells: usize) {
    let (mut widths, mut partial) = (0.0, 0);
    for round in rounds.clone() {
        let mut random = Random(1000 + round);
        let mut room = Room::default();
        let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        let [x, y, z] = [random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(0.4, 1.5)];
        let (side, tilt) = (random.between(0.3, 1.0), random.between(-0.3, 0.3));
        room.quad([x, y, z], [0.0, side, 0.0], [side, 0.0, tilt], lamp);
        for blocker in 0..1 + round % 4 {
            let corner = [random.between(-0.2, 0.8), random.between(-0.2, 0.8), random.between(0.02, 0.6)];
            let (u, v) = match (round + blocker) % 4 {
                0 => ([random.between(0.05, 1.0), 0.0, 0.0], [0.0, random.between(0.05, 1.0), 0.0]),
                // Standing on the floor.
                1 => ([0.0, random.between(0.05, 0.8), 0.0], [0.0, 0.0, -corner[2]]),
                _ => (random.point(0.6), random.point(0.6)),
            };
            let [a, b] = [corner, std::array::from_fn(|k| corner[k] + u[k])];
            let [c, d] = [std::array::from_fn(|k| b[k] + v[k]), std::array::from_fn(|k| corner[k] + v[k])];
            if Polygon::new(&[a, b, c, d]).is_ok() {
                room.quad(corner, u, v, black);
            }
        }
        let scene = room.scene();
        let options = SolveOptions { bounds_work: Some(work), error: 0.01, ..uniform(0.5) };
        let found = bounds_at_points(&scene, &options, 60, &mut random);
        let visibility = visibility::build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        for (point, _, [lower, upper]) in found.iter().filter(|(_, surface, _)| *surface == 0).take(8) {
            let [least, most] = form_factor_by_rays(&scene, &*visibility, *point, cells);
            // What is thinner than a cell may be missed.
            let slack = 0.01 * most + 1e-9;
            let holds = 2.0 * lower <= most + slack && least <= 2.0 * upper + slack;
            assert!(holds, "round {round}, {:?}: [{least}, {most}] was seen, not 2 [{lower}, {upper}]", point.position);
            widths += 2.0 * (upper - lower);
            partial += 1;
        }
    }
    let mean = widths / f64::from(partial);
    println!("{partial} points: mean width {mean:.2e}");
    // What single points see of a lamp that does not reflect is known but for rounding, where shadows are known.
    assert!(mean < 1e-6, "{mean}");
}

#[test]
fn random_blockers_never_break_a_bound_at_a_point() {
    check_random_blockers(0..60, 1 << 11, 48);
}

/// More of them, against finer cells: `cargo test --release --test bounds -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn many_random_blockers_never_break_a_bound_at_a_point() {
    check_random_blockers(60..800, 1 << 12, 96);
}

#[test]
fn bounds_of_elements_hold_what_is_seen_from_their_points() {
    for round in 0..20 {
        let mut random = Random(77 + round);
        let mut room = Room::default();
        let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        let corner = [random.between(0.0, 0.6), random.between(0.0, 0.6), random.between(0.05, 0.8)];
        room.quad(corner, [random.between(0.1, 0.5), 0.0, 0.1], [0.0, random.between(0.1, 0.5), 0.0], black);
        let scene = room.scene();
        let (evaluator, _) = solve(scene.clone(), &SolveOptions { bounds_work: Some(1 << 12), ..uniform(0.125) });
        let (bounds, hierarchy) = (evaluator.bounds().unwrap(), evaluator.solution().hierarchy());
        let visibility = visibility::build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let is_floor = |node: &patchlight::hierarchy::NodeId| hierarchy.surface_of(*node) == Some(SurfaceId(0));
        for leaf in hierarchy.ids().filter(|node| hierarchy.is_leaf(*node) && is_floor(node)).step_by(5) {
            let point = rooms::point_of(&Polygon::new(&hierarchy.polygon(leaf)).unwrap(), &mut random);
            let [least, most] = form_factor_by_rays(&scene, &*visibility, point, 32);
            let (lower, upper) = (2.0 * bounds.lower(leaf)[0], 2.0 * bounds.upper(leaf)[0]);
            assert!(lower <= most + 1e-9 && least <= upper + 1e-9, "round {round}: [{least}, {most}], not [{lower}, {upper}]");
        }
    }
}

#[test]
fn a_narrow_gap_is_treated_as_it_is() {
    // Two squares 5 mm apart, and triangles so far away that the digits of the scene could not tell the squares apart.
    for far in [1, 6] {
        let mut room = Room::default();
        let (lower, upper) = (room.material(&[0.5], &[1.0]), room.material(&[0.7], &[0.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], lower);
        room.quad([0.0, 0.0, 0.005], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], upper);
        let black = room.material(&[0.0], &[0.0]);
        for k in 0..far {
            let x = 14_000.0 + 10.0 * f64::from(k);
            room.face(&[[x, 0.0, 3.0], [x, 1.0, 3.0], [x, 0.0, 4.0]], black);
        }
        let options = SolveOptions { bounds_work: Some(1 << 15), ..uniform(0.5) };
        let (evaluator, report) = solve(room.scene(), &options);
        let point = SurfacePoint { position: [0.5, 0.5, 0.0], normal: [0.0, 0.0, 1.0] };
        let bounds = evaluator.bounds_at(&[point]).unwrap();
        // Infinite plates: B = (E1 + rho1 E2) / (1 - rho1 rho2) = 1.538; the middle of squares 200 gaps wide has as much, but for 1e-4.
        let (least, most, plates) = (f64::from(bounds.lower[0]), f64::from(bounds.upper[0]), 1.0 / (1.0 - 0.35));
        println!("{far} far: [{least}, {most}], {:?}", bounds_of(&report).conditions);
        assert!(least <= plates && plates - 1e-3 <= most && least > 1.2 && most < 1.6, "{far}: [{least}, {most}]");
    }
}

#[test]
fn a_report_lists_what_the_proof_rests_on() {
    let kinds = |tilt: f64, overlap: f64| {
        let mut room = Room::default();
        let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        room.quad([1.0 - overlap, 0.0, tilt], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        let (_, report) = solve(room.scene(), &SolveOptions { bounds_work: Some(1 << 10), ..uniform(1.0) });
        let found = bounds_of(&report).clone();
        let listed = found.conditions.iter().filter(|condition| condition.kind != ConditionKind::Contacts);
        (found.certainty, listed.map(|condition| (condition.kind, condition.size, condition.face)).collect::<Vec<_>>())
    };
    assert_eq!(kinds(0.0, 0.0), (Certainty::Guaranteed, vec![]));
    let (certainty, listed) = kinds(5e-7, 0.0);
    assert_eq!((certainty, listed[0].0), (Certainty::Guaranteed, ConditionKind::MergedPlanes));
    assert!((listed[0].1 - 5e-7).abs() < 1e-12 && listed[0].2 == Some(2), "{listed:?}");
    let (certainty, listed) = kinds(0.0, 0.5);
    assert_eq!((certainty, listed[0].0), (Certainty::Estimate, ConditionKind::Overlaps));
    // One over the other, half a micrometre apart: what is in the gap is told, and treated as it is.
    let (certainty, listed) = kinds(5e-7, 0.5);
    assert!(listed.iter().any(|(kind, ..)| *kind == ConditionKind::Gaps), "{listed:?}");
    assert_eq!(certainty, Certainty::Guaranteed);
}
