//! Form factors of single pairs with something between them.

use patchlight::bounds::{Certainty, Evidence, FormFactorRule, bound_pair};
use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::{self, Backend, OccluderMesh, Segment, Visibility};

use super::fixtures::{form_factor_cases, value, vector, vectors};
use super::rooms::{self, Room};
use super::triangles::Random;
use super::{assert_at_points, bounded, bounds_of, mean_bounds, uniform};

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
            let own = evaluator.bounds().unwrap();
            let [lower, upper] = mean_bounds(&evaluator, own, 0).map(|b| 2.0 * b);
            assert!(of_point || (lower - 1e-12 <= exact && exact <= upper + 1e-12), "{name}: {exact} is not in [{lower}, {upper}]");

            // Over the elements of the solve, whose size is known.
            let (bounds, _) = evaluator.bound(FormFactorRule::QuasiConcave);
            let [lower, upper] = mean_bounds(&evaluator, &bounds, 0).map(|b| 2.0 * b);
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
        // Shadows of blockers in the middle are known: the bounds close in with the elements, to a quarter once these are finer.
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
    // Exact are 0.715 above the corners and 0.831 above the middle (Howell's B-3).
    assert!(seen.lower > 0.7 && seen.upper < 0.95, "{seen:?}");
    let by_samples = bound_pair(&scene, &hierarchy, floor, sheet, FormFactorRule::CentreAndVertices);
    assert_eq!(by_samples.certainty, Certainty::Estimate);
}

/// Form factors with anything in the way, by rays from points: `n * n` of them to cells of equal area, each with its exact form
/// factor.
pub fn form_factor_by_rays(scene: &Scene, visibility: &dyn Visibility, x: SurfacePoint, n: usize) -> [f64; 2] {
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
    assert!(kinds[..2].iter().all(|&count| count > 15), "{kinds:?}");
}
