//! Complete subdivision: a surface down to elements of one depth, as far as none is smaller than A_eps (Chang, Shih 1998, section
//! 3.3).

use std::ops::Range;

use crate::geometry::Facet;
use crate::geometry::for_each_piece;
use crate::hierarchy::{Hierarchy, NodeId};

/// Nodes with consecutive ids.
pub(super) type Nodes = Range<u32>;

/// The nodes of a surface by level: the smallest elements at level 0, the surface itself at the top.
///
/// The nodes of a level have consecutive ids, in the order of their parents.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    levels: Vec<Nodes>,
}

/// So much smaller than A_eps an element may be by rounding.
const ROUNDING: f64 = 1e-6;

impl Tree {
    /// Splits a surface, which is not split yet, again and again.
    pub fn complete(hierarchy: &mut Hierarchy, surface: NodeId, min_area: f64) -> Self {
        debug_assert!(hierarchy.is_leaf(surface), "elements of a level have consecutive ids only if they are made together");
        let mut bottom = one(surface);
        let mut levels = vec![bottom.clone()];
        while ids(&bottom).all(|node| smallest_piece(&hierarchy.facet(node)) >= (1.0 - ROUNDING) * min_area) {
            let first = hierarchy.len() as u32;
            for node in ids(&bottom) {
                hierarchy.split(node);
            }
            bottom = first..hierarchy.len() as u32;
            levels.push(bottom.clone());
        }
        levels.reverse();
        Self { levels }
    }

    /// The nodes of a level, from 0 to [`Tree::top`].
    pub fn level(&self, level: usize) -> &Nodes {
        &self.levels[level]
    }

    /// The level of the surface itself.
    pub fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// The surface itself.
    pub fn root(&self) -> NodeId {
        NodeId(self.levels[self.top()].start)
    }

    /// How many elements there are at the bottom.
    pub fn elements(&self) -> u64 {
        self.levels[0].len() as u64
    }
}

/// A node alone.
pub(super) fn one(node: NodeId) -> Nodes {
    node.0..node.0 + 1
}

/// The nodes one by one.
pub(super) fn ids(nodes: &Nodes) -> impl Iterator<Item = NodeId> + use<> {
    nodes.clone().map(NodeId)
}

/// The children of a node.
pub(super) fn children(hierarchy: &Hierarchy, node: NodeId) -> Nodes {
    let node = hierarchy.node(node);
    node.first_child.0..node.first_child.0 + node.child_count
}

fn smallest_piece(polygon: &Facet<'_>) -> f64 {
    let mut smallest = f64::INFINITY;
    for_each_piece(polygon, |corners| smallest = smallest.min(Facet::of_part(corners, polygon.normal).area));
    smallest
}
