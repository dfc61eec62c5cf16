//! What must not matter: the unit of length, where a scene stands and how it is turned, how its faces are cut and ordered.

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{LinkOptions, Solution, SolveOptions, Strategy, UniformOptions};
use rooms::{Room, solve, straight, turned};
use triangles::{Random, add, cross, times, unit};

/// Of the faces of a cube, in the order in which [`Room::cuboid`] makes them; the first emits 1.
const REFLECTANCES: [f64; 6] = [0.2, 0.8, 0.5, 0.4, 0.3, 0.7];

/// The unit cube seen from inside, with its corner at `corner` and the sides `sides`.
fn cube(corner: [f64; 3], sides: [[f64; 3]; 3]) -> Scene {
    let mut room = Room::default();
    room.cuboid(corner, sides, true, |room, face| room.material(&[REFLECTANCES[face]], &[if face == 0 { 1.0 } else { 0.0 }]));
    room.scene()
}

/// 16 elements a face, exact form factors.
fn exact(side: f64) -> SolveOptions {
    SolveOptions {
        strategy: Strategy::Uniform,
        error: 0.5,
        uniform: UniformOptions { element_area: Some(1.001 * side * side / 16.0) },
        links: LinkOptions { form_factor_accuracy: 0.0, leaf_rays: Some(0), sweep_tolerance: 1e-13, ..LinkOptions::default() },
        ..SolveOptions::default()
    }
}

fn radiosity(solution: &Solution, surface: usize) -> f64 {
    solution.radiosity().of(solution.hierarchy().node_of(SurfaceId(surface as u32)))[0]
}

fn face_radiosities(scene: Scene, side: f64) -> [f64; 6] {
    let (evaluator, report) = solve(scene, &exact(side));
    assert_eq!(report.counts.elements, 6 * (1 + 4 + 16));
    std::array::from_fn(|face| radiosity(evaluator.solution(), face))
}

/// Exact form factors are good to 1e-10, so 1e-9 is nothing but rounding, reflected again and again.
#[track_caller]
fn assert_same(found: &[f64; 6], expected: &[f64; 6], tolerance: f64) {
    for (face, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found / expected - 1.0).abs() <= tolerance, "face {face}: {found} instead of {expected}");
    }
}

/// Three random sides of length 1, at right angles.
fn random_frame(random: &mut Random) -> [[f64; 3]; 3] {
    let w = random.direction();
    let u = unit(cross(w, random.direction()));
    [u, cross(w, u), w]
}

#[test]
fn scale_rotation_and_place_do_not_matter() {
    let reference = face_radiosities(cube([0.0; 3], straight(1.0, 1.0, 1.0)), 1.0);
    for scale in [1e-6, 1e6] {
        assert_same(&face_radiosities(cube([0.0; 3], straight(scale, scale, scale)), scale), &reference, 1e-9);
    }
    let mut random = Random(31);
    for _ in 0..5 {
        let frame = random_frame(&mut random);
        assert_same(&face_radiosities(cube([0.0; 3], frame), 1.0), &reference, 1e-9);
        // A million sizes away ten digits of the coordinates are left.
        assert_same(&face_radiosities(cube(times(random.direction(), 1e6), frame), 1.0), &reference, 1e-6);
    }
}

#[test]
fn the_cut_and_the_order_of_faces_do_not_matter() {
    let reference = face_radiosities(cube([0.0; 3], straight(1.0, 1.0, 1.0)), 1.0);
    let scene = cube([0.0; 3], straight(1.0, 1.0, 1.0));

    // Each face in four quarters, all in random order, each from a random corner on.
    let mut random = Random(32);
    let mut quarters: Vec<(usize, [[f64; 3]; 4])> = Vec::new();
    for face in 0..6 {
        let corners: Vec<[f64; 3]> = scene.surface(SurfaceId(face as u32)).polygon.vertices().collect();
        let middle = |a: [f64; 3], b: [f64; 3]| times(add(a, b), 0.5);
        for k in 0..4 {
            let [before, corner, after] = [corners[(k + 3) % 4], corners[k], corners[(k + 1) % 4]];
            let mut quarter = [corner, middle(corner, after), middle(corners[0], corners[2]), middle(before, corner)];
            quarter.rotate_left(random.below(4));
            quarters.insert(random.below(quarters.len() + 1), (face, quarter));
        }
    }
    let mut room = Room::default();
    let materials: Vec<u32> =
        (0..6).map(|face| room.material(&[REFLECTANCES[face]], &[if face == 0 { 1.0 } else { 0.0 }])).collect();
    quarters.iter().for_each(|(face, quarter)| room.face(quarter, materials[*face]));

    let (evaluator, report) = solve(room.scene(), &exact(1.0));
    assert_eq!(report.counts.elements, 24 * (1 + 4));
    let mut means = [0.0; 6];
    for (surface, (face, _)) in quarters.iter().enumerate() {
        means[*face] += 0.25 * radiosity(evaluator.solution(), surface);
    }
    assert_same(&means, &reference, 1e-9);
}

/// A room with boxes and a lamp, in lengths of `unit` metres.
fn furnished(unit: f64) -> Scene {
    let mut room = Room::default();
    let scaled = |sides: [[f64; 3]; 3]| sides.map(|side| times(side, unit));
    let wall = room.material(&[0.6, 0.5, 0.4], &[0.0; 3]);
    let lamp = room.material(&[0.0; 3], &[10.0, 9.0, 8.0]);
    room.cuboid([0.0; 3], scaled(straight(3.0, 3.0, 2.5)), true, |_, _| wall);
    room.cuboid(times([0.4, 0.5, 0.0], unit), scaled(turned(0.6, 0.5, 1.0, 0.3)), false, |_, _| wall);
    room.cuboid(times([1.6, 1.7, 0.7], unit), scaled(turned(0.7, 0.7, 0.2, 0.5)), false, |_, _| wall);
    room.quad(times([1.0, 1.0, 2.49], unit), times([0.0, 0.5, 0.0], unit), times([0.5, 0.0, 0.0], unit), lamp);
    room.scene()
}

/// A power of two leaves every bit of a computation in which no length is told from another by its number of metres: refinement, rays,
/// exposure, sweeps.
#[test]
fn a_unit_that_is_a_power_of_two_changes_no_bit_of_the_leaves() {
    let options = SolveOptions {
        links: LinkOptions { tolerance: Some(0.15), leaf_rays: Some(0), ..LinkOptions::default() },
        ..SolveOptions::default()
    };
    let leaves = |unit: f64| -> (u64, Vec<f32>) {
        let (evaluator, report) = solve(furnished(unit), &options);
        let mut radiosities = Vec::new();
        evaluator.solution().for_each_leaf(|_, _, radiosity| radiosities.extend_from_slice(radiosity));
        (report.counts.links, radiosities)
    };
    let reference = leaves(1.0);
    assert!(reference.0 > 1000 && reference.1.len() > 300, "{} links, {} values", reference.0, reference.1.len());
    for exponent in [-20, 20] {
        let scaled = leaves(2f64.powi(exponent));
        assert_eq!(scaled.0, reference.0, "links in units of 2^{exponent} m");
        assert!(scaled.1 == reference.1, "radiosities in units of 2^{exponent} m");
    }
}

/// A rug that lies in the very plane of the floor: the two exchange nothing, and nothing else is harmed.
#[test]
fn faces_that_overlap_in_one_plane_exchange_nothing() {
    let mut room = Room::default();
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |room, face| {
        room.material(&[REFLECTANCES[face]], &[if face == 0 { 1.0 } else { 0.0 }])
    });
    let rug = room.material(&[0.9], &[0.5]);
    room.quad([0.2, 0.3, 0.0], [0.5, 0.0, 0.0], [0.0, 0.4, 0.0], rug);
    let (evaluator, _) = solve(room.scene(), &SolveOptions::default());
    let solution = evaluator.solution();

    // Faces 0 and 6 share their plane.
    let in_the_plane = |node| solution.hierarchy().surface_of(node).is_some_and(|surface| [0, 6].contains(&surface.0));
    assert!(!solution.links().is_empty());
    assert!(solution.links().iter().all(|(receiver, link)| !(in_the_plane(receiver) && in_the_plane(link.source))));
    for surface in 0..7 {
        let b = radiosity(solution, surface);
        assert!(b.is_finite() && b > 0.0 && b < 100.0, "surface {surface}: {b}");
    }
}
