//! Subdivision of elements: regular, into similar pieces, at most four for triangles and quads; or along given segments.

use glam::DVec3;

use super::{Cut, Cuts, Hierarchy, Node, NodeId};
use crate::geometry::{Facet, for_each_piece};
use crate::scene::SurfaceId;

impl Hierarchy {
    /// Cuts elements along segments of their surfaces from now on (see `cuts`); `tolerance` is the distance in metres up to which things touch. Nothing may
    /// be split yet.
    pub(crate) fn cut_along(&mut self, segments: impl Fn(SurfaceId) -> Vec<Cut>, tolerance: f64) {
        debug_assert!(self.surface_nodes.iter().all(|&node| self.is_leaf(node)), "segments belong to surfaces");
        let surfaces = (0..).map(SurfaceId).zip(&self.surface_nodes);
        self.cuts = Some(Cuts::new(surfaces.map(|(surface, &node)| (node, segments(surface))), tolerance));
    }

    /// The same without the segments that elements were not cut along yet.
    pub(crate) fn without_cuts(self) -> Self {
        Self { cuts: None, ..self }
    }

    /// Splits a surface or element into elements, if it is not split yet; returns its first child.
    ///
    /// A quad is cut at the middle of its longer sides, or of all four if it is less than twice as long as wide; a triangle at the
    /// middle of its longest side, or of all three; a polygon of n > 4 corners into n quads around its centroid. Where there are segments to
    /// cut along, every polygon is cut in two.
    pub(crate) fn split(&mut self, node: NodeId) -> NodeId {
        debug_assert!(!self.is_cluster(node), "clusters are split when they are built");
        if !self.is_leaf(node) {
            return self.node(node).first_child;
        }
        let first = NodeId(self.nodes.len() as u32);
        let bisection = self.cuts.as_ref().map(|cuts| cuts.bisect(node, &self.facet(node)));
        let pieces = bisection.as_ref().map_or_else(|| regular_pieces(&self.facet(node)), |bisection| bisection.parts.to_vec());
        if let (Some(cuts), Some(bisection)) = (&mut self.cuts, bisection) {
            cuts.hand_on(node, first, bisection);
        }

        let (surface, count) = (self.node(node).surface, pieces.len() as u32);
        for piece in pieces {
            self.push_polygon(node, surface, piece);
        }
        let parent = &mut self.nodes[node.index()];
        (parent.first_child, parent.child_count) = (first, count);
        first
    }

    /// The corners of the pieces that splitting a leaf makes.
    pub(crate) fn pieces(&self, leaf: NodeId) -> Vec<Vec<DVec3>> {
        let polygon = self.facet(leaf);
        self.cuts.as_ref().map_or_else(|| regular_pieces(&polygon), |cuts| cuts.bisect(leaf, &polygon).parts.into())
    }

    /// How many pieces splitting a leaf makes at most, and how many bytes they add.
    pub(crate) fn cost_of_split(&self, leaf: NodeId) -> (usize, u64) {
        let corners = self.facet(leaf).vertices.len();
        let (pieces, more_corners, of_cuts) = match &self.cuts {
            None => (corners.max(4), 4 * corners.max(4), 0),
            // Each end of the cut is a corner of both.
            Some(cuts) => (2, corners + 4, cuts.bytes_of_split(leaf)),
        };
        (pieces, (pieces * size_of::<Node>() + more_corners * size_of::<DVec3>() + of_cuts) as u64)
    }

    /// Appends a node for a piece of a surface.
    fn push_polygon(&mut self, parent: NodeId, surface: u32, vertices: impl IntoIterator<Item = DVec3>) {
        let first_vertex = self.vertices.len();
        self.vertices.extend(vertices);
        let facet = Facet::of_part(&self.vertices[first_vertex..], self.normal_of(surface));
        self.nodes.push(Node::of_polygon((parent, surface), first_vertex, facet));
    }
}

/// The corners of the pieces of regular subdivision.
fn regular_pieces(polygon: &Facet<'_>) -> Vec<Vec<DVec3>> {
    let mut pieces = Vec::new();
    for_each_piece(polygon, |piece| pieces.push(piece.to_vec()));
    pieces
}
