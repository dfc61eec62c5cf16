//! Whether surfaces of one plane and facing lie on each other.
//!
//! Surfaces in one plane do not hide each other. Where two of them overlap, both are visible at the same place, and the form factors to
//! all surfaces may add up to more than 1; but the bounds rest on a sum of at most 1.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::{Facet, edges};
use crate::scene::Scene;

/// Surfaces overlap if they reach into each other by more than this part of the size of the scene; less may be due to files that round
/// to six or seven digits.
const TOUCHING: f64 = 1e-6;

/// Whether any two surfaces with the same normal in one plane overlap. O(n log n), unless many share a plane and a strip of it.
pub(super) fn has_overlap(scene: &Scene) -> bool {
    let tolerance = TOUCHING * scene.bounds().diagonal();
    let mut first_normal: HashMap<u32, DVec3> = HashMap::new();
    let mut groups: HashMap<(u32, bool), Vec<Facet<'_>>> = HashMap::new();
    for surface in scene.surfaces() {
        let facet = surface.polygon.facet();
        let facing = first_normal.entry(surface.plane).or_insert(facet.normal).dot(facet.normal) > 0.0;
        groups.entry((surface.plane, facing)).or_default().push(facet);
    }
    groups.into_values().any(|mut group| {
        // Sort along an edge: a surface can overlap those alone that begin before it ends.
        let along = (group[0].vertices[1] - group[0].vertices[0]).normalize();
        let range = |facet: &Facet<'_>| range(facet, along);
        group.sort_by(|a, b| range(a)[0].total_cmp(&range(b)[0]));
        (0..group.len()).any(|k| {
            let end = range(&group[k])[1] - tolerance;
            let next = group[k + 1..].iter().take_while(|other| range(other)[0] < end);
            next.into_iter().any(|other| overlap(&group[k], other, tolerance))
        })
    })
}

fn range(facet: &Facet<'_>, axis: DVec3) -> [f64; 2] {
    let along = facet.vertices.iter().map(|&vertex| axis.dot(vertex));
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// Two convex polygons of a plane overlap, unless an edge of either separates them.
fn overlap(a: &Facet<'_>, b: &Facet<'_>, tolerance: f64) -> bool {
    let parted = |front: &Facet<'_>, other: &Facet<'_>| {
        edges(front.vertices).any(|(start, edge)| {
            let outward = edge.cross(front.normal).normalize_or_zero();
            outward != DVec3::ZERO && other.vertices.iter().all(|&vertex| outward.dot(vertex - start) >= -tolerance)
        })
    };
    !parted(a, b) && !parted(b, a)
}
