//! Building the clusters: a binary tree over the surfaces, split at the median along the longest axis.
//!
//! Surfaces that emit get a subtree of their own below the root, so that light and reflection are never mixed in a cluster.
//! O(n log n); deterministic, because ties are broken by surface number.

use std::ops::Range;

use super::{Hierarchy, Node, NodeId};
use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

pub(super) fn build(scene: &Scene) -> Hierarchy {
    let surfaces = scene.surfaces();
    let bounds: Vec<Aabb> = surfaces.iter().map(|surface| surface.polygon.bounds()).collect();

    // Emitters first, then everything else.
    let mut order: Vec<u32> = (0..surfaces.len() as u32).collect();
    order.sort_by_key(|&surface| !scene.material_of(SurfaceId(surface)).emits());
    let emitters = order.iter().filter(|&&surface| scene.material_of(SurfaceId(surface)).emits()).count();

    // Cut ranges of surfaces in two, breadth first, so that clusters get the first ids, parents before children.
    let mut ranges: Vec<(Range<usize>, NodeId)> = vec![(0..order.len(), NodeId::ROOT)];
    let mut children: Vec<Vec<usize>> = Vec::new(); // of a cluster: indices into `ranges`, or none if its surfaces are its children
    let mut next = 0;
    while next < ranges.len() {
        let (range, _) = ranges[next].clone();
        let mut cut = |middle: usize| {
            let first = ranges.len();
            ranges.push((range.start..middle, NodeId(next as u32)));
            ranges.push((middle..range.end, NodeId(next as u32)));
            children.push(vec![first, first + 1]);
        };
        if next == 0 && emitters > 0 && emitters < order.len() {
            cut(emitters);
        } else if range.len() > LEAF_SURFACES {
            cut(split_at_median(&mut order[range.clone()], &bounds) + range.start);
        } else {
            children.push(Vec::new());
        }
        next += 1;
    }

    // Number the nodes: clusters as they are, then the surfaces cluster by cluster.
    let clusters = ranges.len();
    let mut hierarchy = Hierarchy {
        nodes: Vec::with_capacity(clusters + surfaces.len()),
        vertices: Vec::new(),
        normals: surfaces.iter().map(|surface| surface.polygon.facet().normal).collect(),
        surface_nodes: vec![NodeId::ROOT; surfaces.len()],
        cluster_bounds: Vec::with_capacity(clusters),
    };
    let mut first_surface_node = clusters;
    for (index, (range, parent)) in ranges.iter().enumerate() {
        let inside = order[range.clone()].iter().map(|&surface| surface as usize);
        let around = inside.clone().map(|surface| bounds[surface]).fold(Aabb::EMPTY, Aabb::union);
        let (first_child, child_count) = match children[index][..] {
            [first, second] => (first, second - first + 1),
            _ => (first_surface_node, range.len()),
        };
        if children[index].is_empty() {
            first_surface_node += range.len();
        }
        hierarchy.cluster_bounds.push(around);
        hierarchy.nodes.push(Node {
            parent: *parent,
            first_child: NodeId(first_child as u32),
            child_count: child_count as u32,
            surface: Node::NO_SURFACE,
            first_vertex: 0,
            vertex_count: 0,
            area: inside.map(|surface| surfaces[surface].polygon.area()).sum(),
            centroid: around.centre(),
            radius: 0.5 * around.diagonal(),
        });
    }
    for (index, (range, _)) in ranges.iter().enumerate().filter(|(index, _)| children[*index].is_empty()) {
        for &surface in &order[range.clone()] {
            let polygon = surfaces[surface as usize].polygon.facet();
            hierarchy.surface_nodes[surface as usize] = NodeId(hierarchy.nodes.len() as u32);
            hierarchy.push_polygon(NodeId(index as u32), surface, polygon.vertices.iter().copied());
        }
    }
    hierarchy
}

/// A cluster of so few surfaces is not cut any further.
const LEAF_SURFACES: usize = 4;

/// Sorts `surfaces` so that the two halves are apart along the longest axis of their centres; returns where the second half starts.
fn split_at_median(surfaces: &mut [u32], bounds: &[Aabb]) -> usize {
    let centre = |surface: u32| bounds[surface as usize].centre();
    let extent = Aabb::around(surfaces.iter().map(|&surface| centre(surface))).extent();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let middle = surfaces.len() / 2;
    surfaces.select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    middle
}
