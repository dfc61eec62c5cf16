//! Shadows that are computed by hand.

use patchlight::discontinuities::{Degree, Segment, of_emitters, svg};
use patchlight::scene::{Scene, SurfaceId};

use super::{box_faces, cover, distance, lit_by_first, rectangle};

const LAMP: SurfaceId = SurfaceId(0);
const FLOOR: SurfaceId = SurfaceId(1);

/// A lamp from -`half` to `half` at height 2, looking down, and a floor of 10 x 10 m at height 0.
fn lamp_and_floor(half: f64) -> Vec<patchlight::geometry::Polygon> {
    let lamp = rectangle([-half, -half, 2.0], [0.0, 2.0 * half, 0.0], [2.0 * half, 0.0, 0.0]);
    let floor = rectangle([-5.0, -5.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]);
    vec![lamp, floor]
}

fn on(scene: &Scene, surface: SurfaceId) -> Vec<Segment> {
    of_emitters(scene, 0.0).of(surface).to_vec()
}

fn of_degree(segments: &[Segment], degree: Degree) -> Vec<Segment> {
    segments.iter().copied().filter(|segment| segment.degree == degree).collect()
}

/// Lamp of side 2 at height 2, square of side 4 at height 1: a lamp edge at x and an occluder edge at e meet the floor at 2 e - x, so the umbra
/// ends at 3 and the penumbra at 5; with an occluder of side 3 at 2 and 4.
#[test]
fn a_square_under_a_square_has_two_squares_of_shadow() {
    let mut polygons = lamp_and_floor(1.0);
    polygons.push(rectangle([-1.5, -1.5, 1.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]));
    let segments = on(&lit_by_first(&polygons), FLOOR);
    let sharp = of_degree(&segments, Degree::D1);
    assert!(of_degree(&segments, Degree::D0).is_empty());

    // Parallel edges: the lamp's at -1 and 1 with the occluder's at -1.5 and 1.5 give lines at 2 and 4 on either side, each as long as the far edge
    // of the lamp or the occluder lets it be.
    for side in [-1.0, 1.0] {
        for (at, reach) in [(2.0, 4.0), (4.0, 4.0)] {
            assert!(cover(&sharp, [side * at, -reach, 0.0], [side * at, reach, 0.0]), "x {at}");
            assert!(cover(&sharp, [-reach, side * at, 0.0], [reach, side * at, 0.0]), "y {at}");
        }
    }
    // And these are all: 4 + 4 lines, in pieces. A corner of one under an edge of the other lies on them.
    for segment in &segments {
        let [a, b] = segment.ends();
        let on_line =
            |axis: usize| (a[axis] - b[axis]).abs() < 1e-9 && [2.0, 4.0].iter().any(|at| (a[axis].abs() - at).abs() < 1e-9);
        assert!(on_line(0) || on_line(1), "{a:?} {b:?}");
        assert!(segment.degree == Degree::D1, "{a:?} {b:?}");
    }
    let length: f64 = segments.iter().map(|segment| glam::DVec3::from(segment.ends()[0]).distance(segment.ends()[1].into())).sum();
    assert!((length - 8.0 * 8.0).abs() < 1e-6, "{length}");
}

/// The same square turned by 45 degrees: no edges are parallel, so all curves are D2. The lamp's corner at (1, 1) with the edge from (r, 0) to
/// (0, r) gives the line x + y = 2 r - 2, from (2 r - 1, -1) to (-1, 2 r - 1).
#[test]
fn a_turned_square_has_curves_of_the_second_degree() {
    let r = 1.5;
    let mut polygons = lamp_and_floor(1.0);
    polygons.push(rectangle([r, 0.0, 1.0], [-r, r, 0.0], [-r, -r, 0.0]));
    let segments = on(&lit_by_first(&polygons), FLOOR);
    assert!(segments.iter().all(|segment| segment.degree == Degree::D2) && !segments.is_empty());
    assert!(cover(&segments, [2.0 * r - 1.0, -1.0, 0.0], [-1.0, 2.0 * r - 1.0, 0.0]), "corner of the lamp, edge of the square");
    assert!(
        cover(&segments, [2.0 * r + 1.0, 1.0, 0.0], [1.0, 2.0 * r + 1.0, 0.0]),
        "the opposite corner of the lamp, the outer line"
    );
    assert!(cover(&segments, [2.0 * r - 1.0, -1.0, 0.0], [2.0 * r - 1.0, 1.0, 0.0]), "edge of the lamp, corner of the square");
}

/// A second square between the first and the floor keeps the curves from it and carries them itself.
#[test]
fn a_wedge_ends_at_what_it_meets_first() {
    let mut polygons = lamp_and_floor(0.1);
    polygons.push(rectangle([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]));
    let free = on(&lit_by_first(&polygons), FLOOR);
    // Outer line of the first: 2 e - x = 2 + 0.1 at the floor, at half the way 1.5 + 0.05.
    assert!(cover(&of_degree(&free, Degree::D1), [2.1, -2.1, 0.0], [2.1, 2.1, 0.0]));
    polygons.push(rectangle([1.0, -0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let scene = lit_by_first(&polygons);
    let (floor, shelf) = (on(&scene, FLOOR), on(&scene, SurfaceId(3)));
    let outer = of_degree(&floor, Degree::D1);
    assert!(cover(&outer, [2.1, 0.8, 0.0], [2.1, 2.1, 0.0]) && cover(&outer, [2.1, -2.1, 0.0], [2.1, -0.8, 0.0]));
    let across = |segment: &Segment| segment.ends().iter().all(|end| (end[0] - 2.1).abs() < 1e-6 && end[1].abs() < 0.5);
    assert!(!floor.iter().any(across), "the shelf is in the way");
    assert!(cover(&of_degree(&shelf, Degree::D1), [1.55, -0.5, 0.5], [1.55, 0.5, 0.5]));
}

#[test]
fn a_box_on_the_floor_touches_it_along_four_lines() {
    let mut polygons = lamp_and_floor(0.5);
    polygons.extend(box_faces([1.0, 1.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
    let scene = lit_by_first(&polygons);
    let contacts = of_degree(&on(&scene, FLOOR), Degree::D0);
    assert_eq!(contacts.len(), 4);
    for [a, b] in [[[1.0, 1.0], [2.0, 1.0]], [[2.0, 1.0], [2.0, 2.0]], [[2.0, 2.0], [1.0, 2.0]], [[1.0, 2.0], [1.0, 1.0]]] {
        assert!(cover(&contacts, [a[0], a[1], 0.0], [b[0], b[1], 0.0]));
    }
    assert!(contacts.iter().all(|contact| contact.source.is_none() && contact.change == f64::INFINITY));
    // Nothing is found below the box.
    for segment in on(&scene, FLOOR).iter().filter(|segment| segment.degree != Degree::D0) {
        let [a, b] = segment.ends();
        let middle = [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
        assert!(!middle.iter().all(|x| (1.001..1.999).contains(x)), "{a:?} {b:?}");
    }
}

#[test]
fn polygons_that_cross_meet_on_both() {
    let mut polygons = lamp_and_floor(0.5);
    polygons.push(rectangle([-1.0, -1.0, -0.5], [0.0, 2.0, 0.0], [0.0, 0.0, 1.5]));
    let scene = lit_by_first(&polygons);
    let on_floor = of_degree(&on(&scene, FLOOR), Degree::D0);
    assert_eq!(on_floor.len(), 1);
    assert!(cover(&on_floor, [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]));
    let on_wall = of_degree(&on(&scene, SurfaceId(2)), Degree::D0);
    assert!(on_wall.len() == 1 && cover(&on_wall, [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]));
}

/// Where a wall is cut by the lamp's plane, light begins.
#[test]
fn the_horizon_of_a_lamp_is_a_line_on_the_wall() {
    let mut polygons = lamp_and_floor(0.5);
    polygons.push(rectangle([3.0, -2.0, 0.0], [0.0, 0.0, 4.0], [0.0, 4.0, 0.0]));
    let scene = lit_by_first(&polygons);
    let wall = on(&scene, SurfaceId(2));
    assert!(cover(&of_degree(&wall, Degree::D1), [3.0, -2.0, 2.0], [3.0, 2.0, 2.0]));
    assert!(on(&scene, LAMP).is_empty());
}

/// Whatever an occluder is cut into, and however its faces are divided, its shadow is the same.
#[test]
fn pieces_cast_the_shadow_of_the_whole() {
    let with = |occluders: Vec<patchlight::geometry::Polygon>| {
        let mut polygons = lamp_and_floor(0.3);
        polygons.extend(occluders);
        on(&lit_by_first(&polygons), FLOOR)
    };
    let piece = |x: [f64; 2], y: [f64; 2]| rectangle([x[0], y[0], 1.0], [x[1] - x[0], 0.0, 0.0], [0.0, y[1] - y[0], 0.0]);
    let whole = with(vec![piece([-1.0, 1.0], [-1.0, 1.0])]);
    // Three pieces whose sides meet in T.
    let pieces = with(vec![piece([-1.0, 0.2], [-1.0, 1.0]), piece([0.2, 1.0], [-1.0, 0.4]), piece([0.2, 1.0], [0.4, 1.0])]);
    assert_eq!(whole.len(), pieces.len());
    let same = |a: &Segment, b: &Segment| {
        let apart = |k: usize| glam::DVec3::from(a.ends()[k]).distance(b.ends()[k].into());
        a.degree == b.degree && apart(0) < 1e-9 && apart(1) < 1e-9
    };
    for segment in &whole {
        assert!(pieces.iter().any(|piece| same(segment, piece)), "{segment:?}");
    }
}

/// A lamp in pieces has the horizon, the corners and the edges of the whole.
#[test]
fn a_lamp_in_pieces_is_one() {
    let lamp = |x: [f64; 2], y: [f64; 2]| rectangle([x[0], y[0], 2.0], [0.0, y[1] - y[0], 0.0], [x[1] - x[0], 0.0, 0.0]);
    let scene = |lamps: Vec<patchlight::geometry::Polygon>| {
        let mut scene = vec![lamp_and_floor(1.0)[1].clone(), rectangle([0.5, -0.3, 1.0], [1.0, 0.3, 0.0], [-0.4, 0.9, 0.1])];
        let others = scene.len() as u32;
        scene.extend(lamps);
        let material =
            |exitance: f64| patchlight::scene::Material { name: "m".into(), reflectance: vec![0.5], exitance: vec![exitance] };
        let faces = scene.into_iter().zip(0..).map(|(polygon, face)| (polygon, u32::from(face >= others), face)).collect();
        Scene::new(1, vec![material(0.0), material(1.0)], faces, patchlight::scene::Sides::Front).unwrap()
    };
    let whole = on(&scene(vec![lamp([-1.0, 1.0], [-1.0, 1.0])]), SurfaceId(0));
    let parts = vec![lamp([-1.0, 0.0], [-1.0, 1.0]), lamp([0.0, 1.0], [-1.0, 0.5]), lamp([0.0, 1.0], [0.5, 1.0])];
    let pieces = on(&scene(parts), SurfaceId(0));
    for (some, others) in [(&whole, &pieces), (&pieces, &whole)] {
        for segment in some {
            let [a, b] = segment.ends();
            assert!(cover(others, a, b), "{segment:?}");
        }
    }
}

/// The bound of a curve is no less than what the occluder takes away there, and tolerances take out curves that cannot matter.
#[test]
fn what_cannot_matter_is_left_out_and_counted() {
    let mut polygons = lamp_and_floor(0.5);
    polygons.push(rectangle([-0.01, -0.01, 1.0], [0.02, 0.0, 0.0], [0.0, 0.02, 0.0]));
    let scene = lit_by_first(&polygons);
    let all = of_emitters(&scene, 0.0);
    assert!(all.counters().left_out == 0 && !all.of(FLOOR).is_empty());
    // The occluder hides at most its solid angle, 4e-4 over pi; a strip of the lamp as wide as it looks is more.
    assert!(all.of(FLOOR).iter().all(|segment| segment.change > 4e-4 / std::f64::consts::PI && segment.change < 0.02));
    let some = of_emitters(&scene, 0.05);
    let counters = some.counters();
    assert!(counters.weak_edges + counters.left_out + counters.short_wedges > 0 && some.of(FLOOR).len() < all.of(FLOOR).len());
    let none = of_emitters(&scene, 1.0);
    assert!(none.of(FLOOR).is_empty() && none.counters().weak_pairs > 0);
}

/// Wedges are followed only as far as they matter: what is found then was found without a tolerance as well, and of all that changes more than is
/// tolerated some part remains, where it does.
#[test]
fn what_matters_is_found_by_short_wedges_too() {
    let mut polygons = lamp_and_floor(0.3);
    polygons.extend(box_faces([0.1, -0.2, 0.4], [[0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]]));
    polygons.extend(box_faces([-0.5, 0.3, 0.0], [[0.02, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.3]]));
    polygons.extend(box_faces([-0.4, -0.4, 1.2], [[0.05, 0.0, 0.0], [0.0, 0.6, 0.0], [0.0, 0.0, 0.02]]));
    let scene = lit_by_first(&polygons);
    let all = of_emitters(&scene, 0.0);
    for tolerance in [1e-4, 1e-3, 1e-2] {
        let some = of_emitters(&scene, tolerance);
        assert!(some.counters().short_wedges > 0 && some.counters().unfollowed_edges == 0);
        let mut matter = 0;
        for surface in (0..polygons.len() as u32).map(SurfaceId) {
            for segment in some.of(surface) {
                let [from, to] = segment.ends();
                assert!(cover(all.of(surface), from, to), "{tolerance} {surface:?}: {segment:?}");
            }
            for segment in all.of(surface).iter().filter(|segment| segment.change > tolerance) {
                let [a, b] = segment.ends();
                let remains = |k: u32| {
                    let point = std::array::from_fn(|axis| a[axis] + (f64::from(k) + 0.5) / 64.0 * (b[axis] - a[axis]));
                    some.of(surface).iter().any(|other| distance(point, other.ends()) < 1e-5)
                };
                assert!((0..64).any(remains), "{tolerance} {surface:?}: {segment:?}");
                matter += 1;
            }
        }
        assert!(matter > 20, "{tolerance}: {matter}");
    }
}

/// An edge so long that it alone hides the whole lamp changes all of the lamp's irradiance; the bound says so, and not much more.
#[test]
fn a_long_edge_changes_all_that_the_lamp_brings() {
    let mut polygons = lamp_and_floor(0.1);
    polygons.push(rectangle([0.0, -20.0, 1.0], [0.0, 40.0, 0.0], [-20.0, 0.0, 0.0]));
    let scene = lit_by_first(&polygons);
    let sharp = of_degree(&on(&scene, FLOOR), Degree::D1);
    let at_edge = |segment: &&Segment| segment.ends().iter().all(|end| (end[0].abs() - 0.1).abs() < 1e-6);
    assert_eq!(sharp.iter().filter(at_edge).count(), 2);
    let under_lamp = patchlight::form_factor::point_form_factor([0.1, 0.0, 0.0], [0.0, 0.0, 1.0], &polygons[0]);
    for segment in sharp.iter().filter(at_edge) {
        assert!(segment.change > under_lamp && segment.change < 2.0 * under_lamp, "{} {under_lamp}", segment.change);
    }
}

#[test]
fn a_picture_shows_each_segment() {
    let mut polygons = lamp_and_floor(0.5);
    polygons.push(rectangle([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]));
    let scene = lit_by_first(&polygons);
    let found = of_emitters(&scene, 0.0);
    let text = svg(&scene, &found, FLOOR);
    assert_eq!(text.matches("<line").count(), found.of(FLOOR).len());
    assert!(text.starts_with("<svg") && text.ends_with("</svg>\n") && !text.contains("NaN"));
}
