//! The most that two nodes can exchange by the boxes around them and the cones of their normals: all that is known of clusters.
//!
//! A sphere of radius R at distance d is seen under the solid angle `w = 2 pi (1 - sqrt(1 - (R / d)^2))`. Its form factor is at most
//! `w cos / pi`, and at most `(R / d)^2`; that of faces of area A at distance d or more is at most `A cos cos / (pi d^2)`. The cosines, at
//! the receiver and at the source, are bounded by the cones of normals, that of a polygon also by its greatest height over d.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::{Aabb, Cone};
use crate::hierarchy::{Hierarchy, NodeId};

/// What is computed from boxes is widened by this part of itself: their arithmetic rounds by some 1e-15.
const WIDENED: f64 = 1e-12;

/// The boxes and normals of all nodes.
pub(super) struct Boxes<'a> {
    hierarchy: &'a Hierarchy,
    /// Around the normals of all faces of each cluster, by node id.
    cones: Vec<Cone>,
}

impl<'a> Boxes<'a> {
    pub fn new(hierarchy: &'a Hierarchy) -> Self {
        Self { hierarchy, cones: cones_of_clusters(hierarchy) }
    }

    /// No point of the receiver's box, with any of the receiver's normals, has a larger form factor to the source. 1 where the boxes meet.
    pub fn upper(&self, receiver: NodeId, source: NodeId) -> f64 {
        let (from, to) = (self.box_of(receiver), self.box_of(source));
        let gap = (from.min - to.max).max(to.min - from.max).max(DVec3::ZERO);
        let distance = gap.length() * (1.0 - WIDENED);

        // Bounds of both cosines.
        let towards = Cone::between(to.centre() - from.centre(), 0.5 * (from.diagonal() + to.diagonal()) * (1.0 + WIDENED));
        let of_receiver = self.cosine(receiver, &to, &towards, distance);
        let of_source = self.cosine(source, &from, &towards.reversed(), distance);
        if of_receiver == 0.0 || of_source == 0.0 {
            return 0.0;
        }

        // By the sphere around the source's box, then by the source's area.
        let (centre, radius) = (to.centre(), 0.5 * to.diagonal() * (1.0 + WIDENED));
        let to_centre = (from.min - centre).max(centre - from.max).max(DVec3::ZERO).length();
        let by_sphere = if to_centre > radius {
            let sine_sq = (radius / to_centre).powi(2);
            sine_sq.min(2.0 * of_receiver * sine_sq / (1.0 + (1.0 - sine_sq).sqrt()))
        } else {
            1.0
        };
        if distance == 0.0 {
            return by_sphere;
        }
        let by_area = self.hierarchy.area(source) * of_receiver * of_source / (PI * distance * distance);
        by_area.min(by_sphere) * (1.0 + WIDENED)
    }

    /// The largest cosine between a normal of `node` and a direction of the cone that leads to `other`, a box no nearer than `distance`.
    fn cosine(&self, node: NodeId, other: &Aabb, towards: &Cone, distance: f64) -> f64 {
        if self.hierarchy.is_cluster(node) {
            return self.cones[node.index()].bound_cosine(towards);
        }
        let facet = self.hierarchy.facet(node);
        let highest = facet.height(DVec3::select(facet.normal.cmpgt(DVec3::ZERO), other.max, other.min)) * (1.0 + WIDENED);
        let by_height = if distance > 0.0 { (highest / distance).clamp(0.0, 1.0) } else { 1.0 };
        by_height.min(Cone::of(facet.normal).bound_cosine(towards))
    }

    fn box_of(&self, node: NodeId) -> Aabb {
        if self.hierarchy.is_cluster(node) {
            *self.hierarchy.bounds(node)
        } else {
            Aabb::around(self.hierarchy.facet(node).vertices.iter().copied())
        }
    }
}

/// The cone around the normals of each cluster's faces, by node id: clusters come first, children after their parents.
fn cones_of_clusters(hierarchy: &Hierarchy) -> Vec<Cone> {
    let mut cones = vec![Cone::ALL; hierarchy.cluster_count()];
    for cluster in (0..cones.len() as u32).rev().map(NodeId) {
        let of = |child: NodeId| if hierarchy.is_cluster(child) { cones[child.index()] } else { Cone::of(hierarchy.normal(child)) };
        let around = hierarchy.children(cluster).map(of).reduce(Cone::union);
        cones[cluster.index()] = around.unwrap_or(Cone::ALL);
    }
    cones
}
