//! Methods A to D of Lischinski 1994 where what they must give is known in closed form: a lamp, and a sheet that hides a part of it.
//!
//! The lamp is a unit square at height 1 that reflects nothing, the floor below it reflects 1/2 and nothing else reflects:
//! `B(x) = E F(x, visible part) / 2`. The black sheet lies halfway up. What it hides from x of the lamp's plane is its image, `2 m - x`
//! for m in the sheet, so the form factor of what is hidden is that of a rectangle.

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::pipeline::Evaluator;
use patchlight::scene::{SurfaceId, SurfacePoint};
use patchlight::solve::{LinkOptions, SolveOptions, Solver};
use patchlight::values::ShadingMethod;
use rooms::{Room, solve, values};

const EXITANCE: f64 = 3.0;
const UP: [f64; 3] = [0.0, 0.0, 1.0];
/// From where to where the sheet goes, along x and y.
const SHEET: [f64; 2] = [0.3, 0.6];

/// What rounding of values to f32 may do.
const ROUNDING: f64 = 2e-7;

/// A square at some height that faces down.
fn facing_down([low, high]: [f64; 2], z: f64) -> [[f64; 3]; 4] {
    [[low, low, z], [low, high, z], [high, high, z], [high, low, z]]
}

fn solved(has_sheet: bool) -> Evaluator {
    let mut room = Room::default();
    let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[EXITANCE]), room.material(&[0.0], &[0.0]));
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
    room.face(&facing_down([0.0, 1.0], 1.0), lamp);
    if has_sheet {
        room.sheet(&facing_down(SHEET, 0.5), black);
    }
    let links = LinkOptions { tolerance: Some(0.01), leaf_rays: Some(0), ..LinkOptions::default() };
    let options = SolveOptions { solver: Solver::Links, error: 0.9, point_rays: Some(8), links, ..SolveOptions::default() };
    solve(room.scene(), &options).0
}

/// Points of the floor, spread evenly and on no line between elements.
fn points() -> Vec<SurfacePoint> {
    let at = |k: u32| [f64::from(k) * 0.754_877_666 % 1.0, f64::from(k) * 0.569_840_291 % 1.0, 0.0];
    (1..200).map(|k| SurfacePoint { position: at(k), normal: UP }).collect()
}

/// The form factor of the lamp from a point of the floor.
fn whole(point: &SurfacePoint) -> f64 {
    point_form_factor(point.position, UP, &Polygon::new(&facing_down([0.0, 1.0], 1.0)).unwrap())
}

/// That of what the sheet hides.
fn hidden(point: &SurfacePoint) -> f64 {
    let [x, y, _] = point.position;
    let shadow = |x: f64| SHEET.map(|m| (2.0 * m - x).clamp(0.0, 1.0));
    let ([west, east], [south, north]) = (shadow(x), shadow(y));
    if east <= west || north <= south {
        return 0.0;
    }
    let corners = [[west, south, 1.0], [west, north, 1.0], [east, north, 1.0], [east, south, 1.0]];
    point_form_factor(point.position, UP, &Polygon::new(&corners).unwrap())
}

fn assert_close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= ROUNDING * EXITANCE, "{what}: {found} instead of {expected}");
}

#[test]
fn a_lamp_with_nothing_between_is_lambert_s_sum_by_all_methods_but_a() {
    let (evaluator, points) = (solved(false), points());
    for method in [ShadingMethod::FormFactors, ShadingMethod::Visibility, ShadingMethod::EmitterVisibility] {
        for (found, point) in evaluator.shade(&points, method).iter().zip(&points) {
            assert_close(f64::from(*found), 0.5 * EXITANCE * whole(point), &format!("{method:?} at {:?}", point.position));
        }
    }
}

#[test]
fn the_shadow_of_a_sheet_is_exact_by_c_d_and_the_library_s_own_gather() {
    let (evaluator, points) = (solved(true), points());
    let own = values(&evaluator, &points);
    let [c, d] = [ShadingMethod::Visibility, ShadingMethod::EmitterVisibility].map(|method| evaluator.shade(&points, method));
    let mut in_penumbra = 0;
    for (k, point) in points.iter().enumerate() {
        let expected = 0.5 * EXITANCE * (whole(point) - hidden(point));
        for (name, found) in [("C", f64::from(c[k])), ("D", f64::from(d[k])), ("own", own[k])] {
            assert_close(found, expected, &format!("{name} at {:?}", point.position));
        }
        in_penumbra += u32::from(hidden(point) > 0.0);
    }
    assert!(in_penumbra > 50, "{in_penumbra}");
}

/// Methods A and B by their definitions: the leaf under the point, and the links of all nodes above it with their transmittances.
#[test]
fn a_is_the_radiosity_of_the_leaf_and_b_takes_transmittances_from_links() {
    let (evaluator, points) = (solved(true), points());
    let (solution, hierarchy) = (evaluator.solution(), evaluator.solution().hierarchy());
    let [a, b] = [ShadingMethod::Leaf, ShadingMethod::FormFactors].map(|method| evaluator.shade(&points, method));
    let contains = |leaf: NodeId, [x, y, _]: [f64; 3]| {
        let range = |axis: usize| {
            let places = hierarchy.polygon(leaf).into_iter().map(|corner| corner[axis]);
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [x.min(low), x.max(high)])
        };
        let [[west, east], [south, north]] = [range(0), range(1)];
        (west..east).contains(&x) && (south..north).contains(&y)
    };
    let mut links = 0;
    for (k, point) in points.iter().enumerate() {
        let is_under =
            |&id: &NodeId| hierarchy.is_leaf(id) && hierarchy.surface_of(id) == Some(SurfaceId(0)) && contains(id, point.position);
        let leaf = hierarchy.ids().find(is_under).expect("the floor is covered by its leaves");
        assert_close(f64::from(a[k]), solution.radiosity().of(leaf)[0], "A");

        let (mut irradiance, mut node) = (0.0, Some(leaf));
        while let Some(above) = node {
            for link in solution.links().of(above) {
                let source = Polygon::new(&hierarchy.polygon(link.source)).unwrap();
                let seen = f64::from(link.transmittance) * point_form_factor(point.position, UP, &source);
                irradiance += seen * solution.radiosity().of(link.source)[0];
                links += 1;
            }
            node = hierarchy.parent(above);
        }
        assert_close(f64::from(b[k]), 0.5 * irradiance, "B");
    }
    assert!(links >= points.len(), "{links}");
}

#[test]
fn a_point_on_no_surface_has_no_value() {
    let nowhere = SurfacePoint { position: [0.5, 0.5, 0.25], normal: UP };
    for method in [ShadingMethod::Leaf, ShadingMethod::Visibility] {
        assert!(solved(false).shade(&[nowhere], method)[0].is_nan());
    }
}
