//! Surfaces of one plane number that lie over each other.
//!
//! Surfaces count as being in one plane if they are nearer to it than the digits of files tell (`scene::planes`), and then neither hide
//! anything from each other nor exchange light. Side by side that is as good as true. But where one lies over the other, with a gap
//! between them, light may travel in the gap: such a pair is a **stack**, and is treated by its vertices as they are. Where there is no
//! gap, and both face the same way, both are visible at the same place: they **overlap**, form factors to all surfaces may add up to more
//! than 1, and the bounds rest on a sum of at most 1.

use std::collections::{BTreeMap, HashSet};

use glam::DVec3;

use crate::geometry::{Facet, edges, plane_noise};
use crate::scene::{Scene, SurfaceId};

/// Surfaces lie over each other if they reach into each other by more than this part of the size of the larger one; less may be due to
/// files that round to six or seven digits.
const TOUCHING: f64 = 1e-6;

/// Pairs of surfaces of one plane number, with a gap between them that can be seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Stacks {
    pairs: HashSet<(SurfaceId, SurfaceId)>,
}

impl Stacks {
    /// Finds all. O(n log n), unless many share a plane and a strip of it.
    pub fn find(scene: &Scene) -> Self {
        let mut pairs = HashSet::new();
        for_each_overlap(scene, |a, b, gap| {
            if gap > 0.0 {
                pairs.insert((a, b));
                pairs.insert((b, a));
            }
        });
        Self { pairs }
    }

    /// Whether two surfaces of one plane number lie over each other.
    pub fn are_stacked(&self, a: SurfaceId, b: SurfaceId) -> bool {
        !self.pairs.is_empty() && self.pairs.contains(&(a, b))
    }
}

/// Calls `visit` for every two surfaces of one plane number that lie over each other, with the largest distance of a vertex of either
/// from the plane of the other: 0 where rounding alone can have made it.
pub(super) fn for_each_overlap(scene: &Scene, mut visit: impl FnMut(SurfaceId, SurfaceId, f64)) {
    let mut groups: BTreeMap<u32, Vec<SurfaceId>> = BTreeMap::new();
    for (index, surface) in scene.surfaces().iter().enumerate() {
        groups.entry(surface.plane()).or_default().push(SurfaceId(index as u32));
    }
    for group in groups.into_values().filter(|group| group.len() > 1) {
        // Sort along an edge: a surface can overlap those alone that begin before it ends, and neither beside it.
        let facet = |id: SurfaceId| scene.surface(id).polygon.facet();
        let first = facet(group[0]);
        let along = (first.vertices[1] - first.vertices[0]).normalize_or(DVec3::X);
        let across = first.normal.cross(along);
        let ranges = |&id: &SurfaceId| (id, [along, across].map(|axis| range(&facet(id), axis)));
        let mut group: Vec<(SurfaceId, [[f64; 2]; 2])> = group.iter().map(ranges).collect();
        group.sort_by(|(_, [a, _]), (_, [b, _])| a[0].total_cmp(&b[0]));
        for (k, &(id, [[_, end], [low, high]])) in group.iter().enumerate() {
            let own = facet(id);
            let begun = group[k + 1..].iter().take_while(|(_, [along, _])| along[0] < end);
            for &(other, _) in begun.filter(|(_, [_, across])| across[0] < high && across[1] > low) {
                let is_twin = scene.surface(id).twin() == Some(other);
                if !is_twin && overlap(&own, &facet(other), TOUCHING * own.radius.max(facet(other).radius)) {
                    visit(id.min(other), id.max(other), gap(&own, &facet(other)).max(gap(&facet(other), &own)));
                }
            }
        }
    }
}

/// The largest distance of a vertex of one polygon from the plane of another; 0 if it is what rounding leaves.
fn gap(front: &Facet<'_>, other: &Facet<'_>) -> f64 {
    let off = |&vertex: &DVec3| {
        let height = front.height(vertex).abs();
        if height <= plane_noise(vertex, front.vertices[0]) { 0.0 } else { height }
    };
    other.vertices.iter().map(off).fold(0.0, f64::max)
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
