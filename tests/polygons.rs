//! Polygons: what must hold of any, and what must not matter.

use patchlight::geometry::{Polygon, PolygonError};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn distance(a: Vector, b: Vector) -> f64 {
    let difference: Vector = std::array::from_fn(|k| a[k] - b[k]);
    dot(difference, difference).sqrt()
}

/// A frame: two axes and their normal.
fn frame() -> impl Strategy<Value = [Vector; 3]> {
    let direction = prop::array::uniform3(-1.0..1.0).prop_filter("too short for a direction", |v: &Vector| dot(*v, *v) > 0.1);
    (direction.clone(), direction).prop_filter_map("no two directions", |(a, b)| {
        let normal = cross(a, b);
        (dot(normal, normal) > 0.01).then(|| {
            let (u, normal) = (unit(a), unit(normal));
            [u, cross(normal, u), normal]
        })
    })
}

/// Corners of an ellipse by angle: convex, from round to as flat as 1 : 1000.
fn corners() -> impl Strategy<Value = Vec<[f64; 2]>> {
    (prop::collection::vec(0.05..1.0, 3..12), -3.0..0.0).prop_map(|(steps, flatness): (Vec<f64>, f64)| {
        let whole: f64 = steps.iter().sum();
        let mut angle = 0.0;
        let corner = |step: &f64| {
            angle += std::f64::consts::TAU * step / whole;
            [f64::cos(angle), f64::sin(angle) * 10f64.powf(flatness)]
        };
        steps.iter().map(corner).collect()
    })
}

/// In the plane: the area and the centroid, by the shoelace formula.
fn area_and_centroid(corners: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let twice = a[0] * b[1] - a[1] * b[0];
        area += 0.5 * twice;
        (0..2).for_each(|axis| moment[axis] += twice * (a[axis] + b[axis]) / 6.0);
    }
    (area, moment.map(|moment| moment / area))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(5), ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn area_normal_and_centroid_are_those_of_the_plane(corners in corners(), axes in frame(), exponent in -6..7_i32, start in 0..12_usize) {
        let unit = 10f64.powi(exponent);
        let place = |[x, y]: [f64; 2]| -> Vector { std::array::from_fn(|k| unit * (x * axes[0][k] + y * axes[1][k])) };
        let mut vertices: Vec<Vector> = corners.iter().map(|&corner| place(corner)).collect();
        vertices.rotate_left(start % corners.len());
        let polygon = Polygon::new(&vertices).unwrap();
        let (area, centroid) = area_and_centroid(&corners);
        // Rounding, of which corners as flat as 1 : 1000 leave a thousand times as much.
        prop_assert!((polygon.area() / (area * unit * unit) - 1.0).abs() < 1e-9, "{} and {}", polygon.area(), area * unit * unit);
        prop_assert!(distance(polygon.normal(), axes[2]) < 1e-9, "{:?}", polygon.normal());
        prop_assert!(distance(polygon.centroid(), place(centroid)) < 1e-9 * unit, "{:?}", polygon.centroid());

        // The other side.
        let reversed = polygon.reversed();
        prop_assert_eq!(reversed.area(), polygon.area());
        prop_assert_eq!(reversed.normal(), polygon.normal().map(|x| -x));
        prop_assert_eq!(reversed.reversed(), polygon);
    }

    #[test]
    fn any_corners_give_a_polygon_or_say_why_not(
        corners in prop::collection::vec(prop::array::uniform3(prop_oneof![-4..5_i32, Just(1_000_000)]), 0..8),
        exponent in -300..300_i32,
        odd in prop::option::weighted(0.1, (0..8_usize, 0..3_usize, prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e308, -0.0]))),
    ) {
        let unit = 10f64.powi(exponent);
        let mut vertices: Vec<Vector> = corners.iter().map(|corner| corner.map(|x| f64::from(x) * unit)).collect();
        if let Some((corner, axis, value)) = odd && let Some(vertex) = vertices.get_mut(corner) {
            vertex[axis] = value;
        }
        if let Ok(polygon) = Polygon::new(&vertices) {
            prop_assert!(polygon.area() > 0.0 && polygon.area().is_finite(), "{polygon:?}");
            prop_assert!((dot(polygon.normal(), polygon.normal()) - 1.0).abs() < 1e-9, "{polygon:?}");
            prop_assert!(polygon.centroid().iter().all(|x| x.is_finite()), "{polygon:?}");
            prop_assert!(vertices.iter().flatten().all(|x| x.is_finite()));
        }
    }
}

/// Found by the above: an area of infinity along no normal at all.
#[test]
fn what_has_no_finite_area_is_refused() {
    let triangle = |size: f64| Polygon::new(&[[0.0; 3], [0.0, 0.0, size], [0.0, size, 0.0]]);
    assert_eq!(triangle(1e78).unwrap_err(), PolygonError::TooLarge);
    assert_eq!(triangle(1e-78).unwrap_err(), PolygonError::NoArea);
    assert!(triangle(1e74).unwrap().area() > 1e147 && triangle(1e-74).unwrap().area() < 1e-147);
}
