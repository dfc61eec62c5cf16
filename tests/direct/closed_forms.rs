//! Visible form factors that are known.

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::scene::{Scene, SurfaceId};
use serde_json::Value;

use crate::exact;
use crate::fixtures::{form_factor_cases, value, vector, vectors};
use crate::rooms::Room;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// A receiver, a source that emits 1, and thin black blockers between them.
fn scene(receiver: &[[f64; 3]], source: &[[f64; 3]], blockers: &[Vec<[f64; 3]>]) -> Scene {
    let mut room = Room::default();
    let (black, lamp) = (room.material(&[0.0], &[0.0]), room.material(&[0.0], &[1.0]));
    room.face(receiver, black);
    room.face(source, lamp);
    blockers.iter().for_each(|blocker| room.sheet(blocker, black));
    room.scene()
}

fn of_case(geometry: &Value, receiver: &[[f64; 3]], source: &str) -> Scene {
    let blockers: Vec<_> = geometry["blockers"].as_array().unwrap().iter().map(vectors).collect();
    scene(receiver, &vectors(&geometry["polygons"][source]), &blockers)
}

/// A square of this half side around a point, facing up or down.
fn square([x, y, z]: [f64; 3], half: f64, is_up: bool) -> Vec<[f64; 3]> {
    let mut corners = vec![[x - half, y - half, z], [x + half, y - half, z], [x + half, y + half, z], [x - half, y + half, z]];
    if !is_up {
        corners.reverse();
    }
    corners
}

#[test]
fn points_of_the_reference_cases_are_exact() {
    let cases = form_factor_cases();
    let of_points = cases.iter().filter(|case| case["group"] == "A4" && case["quantity"] == "F_visible(dA->P)");
    let mut count = 0;
    for case in of_points {
        let point = vector(&case["geometry"]["receiver_point"]);
        let scene = of_case(&case["geometry"], &square(point, 1.0, true), "emitter");
        let found = exact(&scene, &[(SurfaceId(0), point)])[0];
        assert!((found - value(case)).abs() < 1e-14, "{}: {found}", case["name"]);
        count += 1;
    }
    assert_eq!(count, 3);
}

/// Midpoints of a fine grid: the visible form factor has kinks where shadows end, so the rule is good to the square of its step, and to the step
/// itself times the jump where a wall stands on the receiver: there a line of the grid is the wall's.
#[test]
fn means_over_a_square_are_those_of_the_reference_cases() {
    const SIDE: usize = 128;
    let at = |k: usize| (k as f64 + 0.5) / SIDE as f64;
    let points: Vec<_> = (0..SIDE * SIDE).map(|k| (SurfaceId(0), [at(k % SIDE), at(k / SIDE), 0.0])).collect();
    let cases = form_factor_cases();
    let of_pairs = cases.iter().filter(|case| case["group"] == "A4" && case["quantity"] == "F_visible(P1->P2)");
    let mut count = 0;
    for case in of_pairs {
        let scene = of_case(&case["geometry"], &vectors(&case["geometry"]["polygons"]["P1"]), "P2");
        let mean = exact(&scene, &points).iter().sum::<f64>() / points.len() as f64;
        assert!((mean - value(case)).abs() < 2e-5, "{}: {mean}", case["name"]);
        count += 1;
    }
    assert_eq!(count, 8);
}

#[test]
fn nothing_in_between_is_lambert_s_sum() {
    let source = square([0.3, 0.2, 0.7], 0.4, false);
    let scene = scene(&square([0.0; 3], 1.0, true), &source, &[]);
    for k in 0..50 {
        let point = [f64::from(k) * 0.618 % 2.0 - 1.0, f64::from(k) * 0.755 % 2.0 - 1.0, 0.0];
        let expected = point_form_factor(point, UP, &Polygon::new(&source).unwrap());
        assert!((exact(&scene, &[(SurfaceId(0), point)])[0] - expected).abs() < 1e-15);
    }
}

#[test]
fn half_of_a_source_behind_a_half_plane_counts() {
    // Seen from below the middle, a wide sheet whose edge lies under the middle line hides one half.
    let source = square([0.0, 0.0, 1.0], 0.5, false);
    let sheet = vec![[0.0, -9.0, 0.4], [9.0, -9.0, 0.4], [9.0, 9.0, 0.4], [0.0, 9.0, 0.4]];
    let half = Polygon::new(&[[-0.5, -0.5, 1.0], [-0.5, 0.5, 1.0], [0.0, 0.5, 1.0], [0.0, -0.5, 1.0]]).unwrap();
    let scene = scene(&square([0.0; 3], 1.0, true), &source, &[sheet]);
    for y in [0.0, 0.3, -0.8] {
        let point = [0.0, y, 0.0];
        assert!((exact(&scene, &[(SurfaceId(0), point)])[0] - point_form_factor(point, UP, &half)).abs() < 1e-15);
    }
    // Where the sheet hides all is umbra: not a bit of light.
    assert_eq!(exact(&scene, &[(SurfaceId(0), [0.9, 0.1, 0.0])]), [0.0]);
}

#[test]
fn a_grid_of_blockers_hides_their_shadows() {
    // Blockers halfway up throw shadows of twice their size on the source, which neither overlap nor leave it.
    let (source, count) = (square([0.0, 0.0, 1.0], 1.0, false), 8);
    let at = |k: u32| -0.49 + 0.98 * (f64::from(k) + 0.5) / f64::from(count);
    let corners = |shadow: f64| {
        let place = move |k: u32| [shadow * at(k % count), shadow * at(k / count), 0.5 * shadow];
        (0..count * count).map(move |k| square(place(k), shadow * 0.02, false))
    };
    let scene = scene(&square([0.0; 3], 1.0, true), &source, &corners(1.0).collect::<Vec<_>>());
    let form_factor = |corners: &[[f64; 3]]| point_form_factor([0.0; 3], UP, &Polygon::new(corners).unwrap());
    let expected = form_factor(&source) - corners(2.0).map(|shadow| form_factor(&shadow)).sum::<f64>();
    let found = exact(&scene, &[(SurfaceId(0), [0.0; 3])])[0];
    assert!((found - expected).abs() < 1e-13, "{found} instead of {expected}");
}

#[test]
fn tiles_that_share_edges_let_nothing_through() {
    // Tiles whose common edges do not run along the axes, over all of the source, each hiding a little.
    let source = square([0.0, 0.0, 1.0], 0.5, false);
    let (sin, cos) = 0.3_f64.sin_cos();
    let corner = |i: i32, j: i32| {
        let (s, t) = (0.17 * f64::from(i) + 0.01 * f64::from(j), 0.13 * f64::from(j));
        [s * cos - t * sin, s * sin + t * cos, 0.5 + 0.05 * s - 0.02 * t]
    };
    let tile = |k: i32| (k % 16 - 8, k / 16 - 8);
    let tiles = (0..256).map(tile).map(|(i, j)| vec![corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
    let scene = scene(&square([0.0; 3], 1.0, true), &source, &tiles.collect::<Vec<_>>());
    for k in 0..200 {
        let point = [f64::from(k) * 0.618 % 1.0 - 0.5, f64::from(k) * 0.755 % 1.0 - 0.5, 0.0];
        let found = exact(&scene, &[(SurfaceId(0), point)])[0];
        assert!(found < 1e-11, "{found} from {point:?}");
    }
}
