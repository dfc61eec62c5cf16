//! Lines on surfaces where irradiance is not smooth: cases by hand, irradiance itself as the witness, and scenes that must go through.

mod exact;
mod jumps;
#[path = "../random_polygons/mod.rs"]
#[allow(dead_code, reason = "a part of it is used")]
mod random;
mod scenes;

use patchlight::discontinuities::Segment;
use patchlight::geometry::Polygon;
use patchlight::scene::{Material, Scene, Sides};

/// A scene of polygons, of which the first emits 1 W/m^2.
fn lit_by_first(polygons: &[Polygon]) -> Scene {
    let material = |exitance: f64| Material { name: "m".to_owned(), reflectance: vec![0.5], exitance: vec![exitance] };
    let faces = polygons.iter().zip(0..).map(|(polygon, face)| (polygon.clone(), u32::from(face > 0), face)).collect();
    Scene::new(1, vec![material(1.0), material(0.0)], faces, Sides::Front).unwrap()
}

/// A rectangle from a corner along two edges; the front is where these turn counter-clockwise.
fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Polygon {
    let at = |s: f64, t: f64| std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k]);
    Polygon::new(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).unwrap()
}

/// The faces of a box from a corner along three edges that form a right-handed frame, seen from outside.
fn box_faces(corner: [f64; 3], [u, v, w]: [[f64; 3]; 3]) -> Vec<Polygon> {
    let add = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| a[k] + b[k]);
    vec![
        rectangle(corner, v, u),
        rectangle(corner, w, v),
        rectangle(corner, u, w),
        rectangle(add(corner, w), u, v),
        rectangle(add(corner, u), v, w),
        rectangle(add(corner, v), w, u),
    ]
}

/// Whether segments cover the straight way between two points, to 1e-6.
fn cover(segments: &[Segment], from: [f64; 3], to: [f64; 3]) -> bool {
    (0..=64).all(|k| {
        let part = f64::from(k) / 64.0;
        let point: [f64; 3] = std::array::from_fn(|axis| from[axis] + part * (to[axis] - from[axis]));
        segments.iter().any(|segment| distance(point, segment.ends()) < 1e-5)
    })
}

/// The distance of a point from a segment.
fn distance(point: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let [point, a, b] = [point, a, b].map(glam::DVec3::from);
    let part = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    point.distance(a.lerp(b, part))
}
