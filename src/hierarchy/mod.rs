//! The tree of nodes: clusters of surfaces above, the surfaces, elements below, made on demand.
//!
//! Nodes stand in an array, by [`NodeId`]. A parent's id is smaller than its children's, and the children of a node have
//! consecutive ids; so a loop over the array visits parents before their children, and the reverse loop after them.

mod clusters;
mod cuts;
mod locate;
mod node_id;
mod restore;
mod subdivide;

use std::ops::Range;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::geometry::{Aabb, Facet, Lobes};
use crate::scene::{SurfaceId, Surfaces};
pub(crate) use cuts::Cut;
use cuts::Cuts;
pub use node_id::NodeId;

/// What all nodes have; which fields mean something depends on the kind of node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Node {
    /// The node above; the root is its own parent.
    pub parent: NodeId,
    /// The first child; the root (which is nobody's child) stands for "none".
    pub first_child: NodeId,
    /// How many children follow from `first_child`.
    pub child_count: u32,
    /// The surface that the node is or is a piece of; [`Node::NO_SURFACE`] for a cluster.
    pub surface: u32,
    /// Where the vertices of an element start in the pool; nothing for a surface, whose own they are.
    pub first_vertex: u32,
    /// How many vertices there are; none for a cluster.
    pub vertex_count: u32,
    /// Area in m^2; for a cluster the sum over its surfaces.
    #[serde(skip)]
    pub area: f64,
    /// Centroid of the area.
    #[serde(skip)]
    pub centroid: DVec3,
    /// Distance from the centroid to the farthest point; for a cluster to the farthest point of its box.
    #[serde(skip)]
    pub radius: f64,
}

impl Node {
    const NO_SURFACE: u32 = u32::MAX;

    /// A leaf: a surface, or a piece of one, whose vertices start there in the pool; with the node above it.
    fn of_polygon((parent, surface): (NodeId, u32), first_vertex: usize, facet: Facet<'_>) -> Self {
        let Facet { vertices, area, centroid, radius, .. } = facet;
        let (first_vertex, vertex_count) = (first_vertex as u32, vertices.len() as u32);
        Self { parent, first_child: NodeId::ROOT, child_count: 0, surface, first_vertex, vertex_count, area, centroid, radius }
    }

    /// A cluster that is still to be measured.
    fn cluster(parent: NodeId, first_child: NodeId) -> Self {
        let (surface, centroid) = (Self::NO_SURFACE, DVec3::ZERO);
        Self { parent, first_child, child_count: 0, surface, first_vertex: 0, vertex_count: 0, area: 0.0, centroid, radius: 0.0 }
    }
}

/// Clusters, surfaces and elements.
///
/// What follows from the scene is not stored: [`Hierarchy::restore`] must pass before one that was deserialized is used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hierarchy {
    nodes: Vec<Node>,
    /// Vertices of elements, each polygon's in a row.
    vertices: Vec<DVec3>,
    /// Those of the scene.
    #[serde(skip)]
    surfaces: Surfaces,
    /// The node of each surface.
    #[serde(skip)]
    surface_nodes: Vec<NodeId>,
    /// Boxes of the clusters, by node id: clusters come first.
    #[serde(skip)]
    cluster_bounds: Vec<Aabb>,
    /// The area that each cluster shows to a direction, as if nothing in it hid anything else.
    #[serde(skip)]
    cluster_faces: Vec<Lobes>,
    /// Along what elements are still to be cut, if not into regular pieces: for a solve at work, no part of a solution.
    #[serde(skip)]
    cuts: Option<Cuts>,
}

impl Hierarchy {
    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node; a hierarchy made of a scene always has some.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// How many nodes are clusters; they come first.
    pub fn cluster_count(&self) -> usize {
        self.cluster_bounds.len()
    }

    /// All ids, parents before children.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// All nodes in runs, downward. Parents of the nodes of a run lie before it and children behind it, so what reads only either
    /// of these may be done for a run in parallel. No run has both clusters and others.
    pub(crate) fn levels(&self) -> Vec<Range<usize>> {
        let mut levels = Vec::new();
        let (mut start, clusters) = (0, self.cluster_count());
        for (index, node) in self.nodes.iter().enumerate().skip(1) {
            if node.parent.index() >= start || index == clusters {
                levels.push(start..index);
                start = index;
            }
        }
        levels.push(start..self.len());
        levels
    }

    /// The node of a surface.
    pub fn node_of(&self, surface: SurfaceId) -> NodeId {
        self.surface_nodes[surface.index()]
    }

    /// The surface that a node is or is a piece of; `None` for a cluster.
    pub fn surface_of(&self, node: NodeId) -> Option<SurfaceId> {
        let surface = self.node(node).surface;
        (surface != Node::NO_SURFACE).then_some(SurfaceId(surface))
    }

    /// The children of a node, none for a leaf.
    pub fn children(&self, node: NodeId) -> impl DoubleEndedIterator<Item = NodeId> + ExactSizeIterator + use<> {
        let node = self.node(node);
        (node.first_child.0..node.first_child.0 + node.child_count).map(NodeId)
    }

    /// The box around a cluster.
    pub(crate) fn bounds(&self, cluster: NodeId) -> &Aabb {
        &self.cluster_bounds[cluster.index()]
    }

    /// The area in m^2 that the faces of a cluster show to a direction, as if nothing in it hid anything else.
    pub(crate) fn shown_area(&self, cluster: NodeId, direction: DVec3) -> f64 {
        self.cluster_faces[cluster.index()].at(direction)
    }

    /// The unit direction from the middle of one node to that of another.
    pub(crate) fn direction(&self, from: NodeId, to: NodeId) -> DVec3 {
        (self.node(to).centroid - self.node(from).centroid).normalize_or(DVec3::Z)
    }

    /// The unit normal of a surface or element. Panics on a cluster, which has none.
    pub(crate) fn normal(&self, node: NodeId) -> DVec3 {
        self.normal_of(self.node(node).surface)
    }

    fn normal_of(&self, surface: u32) -> DVec3 {
        self.surfaces[surface as usize].polygon.facet().normal
    }

    /// The leaves depth first, so that neighbours in space are mostly neighbours in the list.
    pub(crate) fn leaves_in_order(&self) -> Vec<NodeId> {
        let mut leaves = Vec::new();
        let mut stack = vec![NodeId::ROOT];
        while let Some(node) = stack.pop() {
            if self.is_leaf(node) {
                leaves.push(node);
            }
            stack.extend(self.children(node).rev());
        }
        leaves
    }

    /// The node above; `None` for the root.
    pub fn parent(&self, node: NodeId) -> Option<NodeId> {
        (node != NodeId::ROOT).then(|| self.node(node).parent)
    }

    /// Whether the node has no children.
    pub fn is_leaf(&self, node: NodeId) -> bool {
        self.node(node).child_count == 0
    }

    /// Whether the node is a cluster.
    pub fn is_cluster(&self, node: NodeId) -> bool {
        node.index() < self.cluster_bounds.len()
    }

    /// Area in m^2, of a cluster the sum over its surfaces.
    pub fn area(&self, node: NodeId) -> f64 {
        self.node(node).area
    }

    /// The polygon of a surface or element, counter-clockwise; empty for a cluster.
    pub fn polygon(&self, node: NodeId) -> Vec<[f64; 3]> {
        if self.is_cluster(node) {
            return Vec::new();
        }
        self.facet(node).vertices.iter().map(|vertex| vertex.to_array()).collect()
    }

    pub(crate) fn node(&self, node: NodeId) -> &Node {
        &self.nodes[node.index()]
    }

    /// The polygon of a surface or element. Panics on a cluster, which has none.
    pub(crate) fn facet(&self, node: NodeId) -> Facet<'_> {
        let &Node { parent, surface, first_vertex, vertex_count, area, centroid, radius, .. } = self.node(node);
        let Facet { vertices, normal, .. } = self.surfaces[surface as usize].polygon.facet();
        let vertices =
            if self.is_cluster(parent) { vertices } else { &self.vertices[first_vertex as usize..][..vertex_count as usize] };
        Facet { vertices, normal, area, centroid, radius }
    }

    /// Bytes that so many surfaces take in so many clusters.
    pub(crate) fn bytes_of(surfaces: usize, clusters: usize) -> u64 {
        let of_surface = size_of::<Node>() + size_of::<NodeId>();
        let of_cluster = size_of::<Node>() + size_of::<Aabb>() + size_of::<Lobes>();
        (surfaces * of_surface + clusters * of_cluster) as u64
    }

    /// Bytes that the nodes take.
    pub fn memory_bytes(&self) -> u64 {
        let clusters = size_of_val(&self.cluster_bounds[..]) + size_of_val(&self.cluster_faces[..]);
        let cuts = self.cuts.as_ref().map_or(0, Cuts::memory_bytes);
        let elements = size_of_val(&self.nodes[..]) + size_of_val(&self.vertices[..]) + size_of_val(&self.surface_nodes[..]);
        (clusters + elements + cuts) as u64
    }
}
