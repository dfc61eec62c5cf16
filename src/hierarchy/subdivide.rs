//! Regular subdivision: a polygon into similar pieces, at most four for triangles and quads.

use glam::DVec3;

use super::{Hierarchy, Node, NodeId};
use crate::geometry::Facet;

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

/// A polygon that is this many times longer than wide is cut in two, not in four.
const ELONGATED: f64 = 2.0;

/// Calls `visit` with the pieces of a polygon, three or four corners each, counter-clockwise like the polygon.
pub(crate) fn for_each_piece(polygon: &Facet<'_>, mut visit: impl FnMut(&[DVec3])) {
    let vertices = polygon.vertices;
    let count = vertices.len();
    let middle = |k: usize| 0.5 * (vertices[k] + vertices[if k + 1 == count { 0 } else { k + 1 }]);
    let side = |k: usize| vertices[k].distance(vertices[if k + 1 == count { 0 } else { k + 1 }]);
    match *vertices {
        [a, b, c] => {
            let longest = (0..3).max_by(|&i, &j| side(i).total_cmp(&side(j))).unwrap_or(0);
            let height = 2.0 * polygon.area / side(longest);
            if side(longest) > ELONGATED * height * 2.0 {
                let (start, end, apex) = (vertices[longest], vertices[(longest + 1) % 3], vertices[(longest + 2) % 3]);
                visit(&[start, middle(longest), apex]);
                visit(&[middle(longest), end, apex]);
            } else {
                let (ab, bc, ca) = (middle(0), middle(1), middle(2));
                visit(&[a, ab, ca]);
                visit(&[ab, b, bc]);
                visit(&[ca, bc, c]);
                visit(&[ab, bc, ca]);
            }
        }
        [a, b, c, d] => {
            let (length, width) = (side(0) + side(2), side(1) + side(3));
            let (ab, bc, cd, da) = (middle(0), middle(1), middle(2), middle(3));
            if length > ELONGATED * width {
                visit(&[a, ab, cd, d]);
                visit(&[ab, b, c, cd]);
            } else if width > ELONGATED * length {
                visit(&[a, b, bc, da]);
                visit(&[da, bc, c, d]);
            } else {
                let centre = 0.5 * (ab + cd);
                visit(&[a, ab, centre, da]);
                visit(&[ab, b, bc, centre]);
                visit(&[centre, bc, c, cd]);
                visit(&[da, centre, cd, d]);
            }
        }
        _ => {
            for (k, &corner) in vertices.iter().enumerate() {
                visit(&[polygon.centroid, middle(if k == 0 { count - 1 } else { k - 1 }), corner, middle(k)]);
            }
        }
    }
}
