//! Which leaf, or which surface, a point lies on.

use glam::DVec3;

use super::{Hierarchy, NodeId};
use crate::scene::SurfaceId;

impl Hierarchy {
    /// The leaf of `surface` that `point` lies on, or the nearest one; deterministic on the lines between leaves.
    pub(crate) fn leaf_at(&self, surface: SurfaceId, point: DVec3) -> NodeId {
        let mut node = self.node_of(surface);
        while !self.is_leaf(node) {
            // The first child that contains the point; or the nearest, if by rounding none does.
            let nearest = || {
                let inside = |child: NodeId| self.inner_distance(child, point);
                self.children(node).reduce(|best, child| if inside(child) > inside(best) { child } else { best })
            };
            let first = self.children(node).find(|&child| self.facet(child).contains(point));
            node = first.or_else(nearest).unwrap_or(node);
        }
        node
    }

    /// A point of a node and the leaf it lies in; uniform `(u, v)` give points uniform by area.
    pub(crate) fn point_in_leaf(&self, node: NodeId, u: f64, v: f64) -> (NodeId, DVec3) {
        let (mut node, mut u) = (node, u);
        while !self.is_leaf(node) {
            // The child in whose share of the area `u` falls; `u` is stretched over that share.
            let mut left = u * self.area(node);
            let mut children = self.children(node);
            let mut child = self.node(node).first_child;
            while let Some(next) = children.next() {
                child = next;
                if left <= self.area(next) || children.len() == 0 {
                    break;
                }
                left -= self.area(next);
            }
            u = (left / self.area(child)).clamp(0.0, 1.0);
            node = child;
        }
        (node, self.facet(node).point_at(u, v))
    }

    /// The surface that `point` lies on, with a front that agrees with `normal`; `None` if none is within `tolerance` metres.
    pub(crate) fn surface_at(&self, point: DVec3, normal: DVec3, tolerance: f64) -> Option<SurfaceId> {
        // The nearest of the surfaces whose clusters' boxes contain the point.
        let mut best: Option<(f64, SurfaceId)> = None;
        let mut stack = vec![NodeId::ROOT];
        while let Some(node) = stack.pop() {
            if self.is_cluster(node) {
                let bounds = &self.cluster_bounds[node.index()];
                let (min, max) = (bounds.min - tolerance, bounds.max + tolerance);
                if point.cmpge(min).all() && point.cmple(max).all() {
                    stack.extend(self.children(node));
                }
                continue;
            }
            let surface = SurfaceId(self.node(node).surface);
            let facet = self.facet(node);
            let height = facet.height(point).abs();
            if height > tolerance || facet.normal.dot(normal) <= NORMAL_AGREEMENT {
                continue;
            }
            let distance = height.max(-self.inner_distance(node, point));
            if distance <= tolerance && best.is_none_or(|best| (distance, surface) < best) {
                best = Some((distance, surface));
            }
        }
        best.map(|(_, surface)| surface)
    }

    /// Distance of a point from the nearest edge line of a polygon, positive inside.
    fn inner_distance(&self, node: NodeId, point: DVec3) -> f64 {
        let facet = self.facet(node);
        let count = facet.vertices.len();
        let from_edge = |k: usize| {
            let (a, b) = (facet.vertices[k], facet.vertices[if k + 1 == count { 0 } else { k + 1 }]);
            let inward = facet.normal.cross(b - a);
            inward.dot(point - a) / inward.length()
        };
        (0..count).map(from_edge).fold(f64::INFINITY, f64::min)
    }
}

/// The cosine between a point's normal and its surface's: about 8 degrees apart at most, more than rounding in files makes.
const NORMAL_AGREEMENT: f64 = 0.99;
