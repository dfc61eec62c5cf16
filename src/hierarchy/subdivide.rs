//! Regular subdivision: a polygon into similar pieces, at most four for triangles and quads.

use glam::DVec3;

use super::{Hierarchy, Node, NodeId};
use crate::geometry::{Facet, for_each_piece};

impl Hierarchy {
    /// Splits a surface or element into elements, if it is not split yet; returns its first child.
    ///
    /// A quad is cut at the middle of its longer sides, or of all four if it is less than twice as long as wide; a triangle at the
    /// middle of its longest side, or of all three; a polygon of n > 4 corners into n quads around its centroid.
    pub(crate) fn split(&mut self, node: NodeId) -> NodeId {
        debug_assert!(!self.is_cluster(node), "clusters are split when they are built");
        if !self.is_leaf(node) {
            return self.node(node).first_child;
        }
        let surface = self.node(node).surface;
        let mut pieces: Vec<Vec<DVec3>> = Vec::new();
        for_each_piece(&self.facet(node), |piece| pieces.push(piece.to_vec()));
        let first = NodeId(self.nodes.len() as u32);
        let count = pieces.len() as u32;
        for piece in pieces {
            self.push_polygon(node, surface, piece);
        }
        let parent = &mut self.nodes[node.index()];
        (parent.first_child, parent.child_count) = (first, count);
        first
    }

    /// How many pieces splitting a leaf makes at most, and how many bytes they add.
    pub(crate) fn cost_of_split(&self, leaf: NodeId) -> (usize, u64) {
        let pieces = self.facet(leaf).vertices.len().max(4);
        (pieces, (pieces * (size_of::<Node>() + 4 * size_of::<DVec3>())) as u64)
    }

    /// Appends a node for a piece of a surface.
    pub(super) fn push_polygon(&mut self, parent: NodeId, surface: u32, vertices: impl IntoIterator<Item = DVec3>) {
        let first_vertex = self.vertices.len();
        self.vertices.extend(vertices);
        let Facet { area, centroid, radius, .. } = Facet::of_part(&self.vertices[first_vertex..], self.normals[surface as usize]);
        let vertex_count = (self.vertices.len() - first_vertex) as u32;
        self.nodes.push(Node {
            parent,
            first_child: NodeId::ROOT,
            child_count: 0,
            surface,
            first_vertex: first_vertex as u32,
            vertex_count,
            area,
            centroid,
            radius,
        });
    }
}
