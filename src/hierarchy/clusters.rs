//! Builds the clusters: a binary tree over the surfaces, cut where the two halves are most compact.
//!
//! Emitters get a subtree of their own below the root, so that no cluster mixes emitters with others. Surfaces that are large for
//! their cluster are cut off first, so that the walls of a hall do not enlarge the clusters of the cups in it. The rest is cut by
//! the surface area heuristic (MacDonald, Booth 1990), at bins. O(n log n), in parallel; deterministic, because ties are broken by
//! surface number.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Aabb, Facet, Lobes};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};

use super::{Hierarchy, Node, NodeId};

/// A surface is large if its box is longer than this part of the box around the centres of its cluster's surfaces.
const LARGE: f64 = 0.5;

/// Places along each axis where a cut is considered.
const BINS: usize = 16;

/// Below this depth clusters are cut at the median, so that no arrangement of surfaces makes the tree deep.
const MAX_DEPTH: u32 = 48;

/// Clusters with fewer surfaces are cut on one thread: a millisecond.
const PARALLEL: usize = 4096;

/// Clusters that are measured together.
const MEASURED_AT_ONCE: usize = 1024;

/// Clusters with fewer surfaces are cut to the end: asking whether to stop would take its part of the time.
const UNSTOPPABLE: usize = 128;

/// A cluster while the tree is built: its surfaces, or its halves.
enum Tree<'a> {
    Leaf(&'a [u32]),
    Cut(Box<[Tree<'a>; 2]>),
}

fn build(scene: &Scene, stop: Stop<'_>) -> Hierarchy {
    let surfaces = scene.surfaces();
    let bounds: Vec<Aabb> = surfaces.par_iter().with_min_len(PARALLEL).map(|surface| surface.polygon.bounds()).collect();

    // Emitters in one subtree, everything else in the other.
    let mut order: Vec<u32> = (0..surfaces.len() as u32).collect();
    let emitters = partition(&mut order, |surface| scene.exitance_as_solved(SurfaceId(surface)).iter().any(|&e| e > 0.0));
    let tree = match order.split_at_mut(emitters) {
        ([], all) | (all, []) => cut(all, &bounds, 0, stop),
        (emitters, others) => {
            let (emitters, others) = rayon::join(|| cut(emitters, &bounds, 1, stop), || cut(others, &bounds, 1, stop));
            Tree::Cut(Box::new([emitters, others]))
        }
    };

    // Number the clusters breadth first, so that parents come before children.
    let mut clusters: Vec<(&Tree, NodeId)> = vec![(&tree, NodeId::ROOT)];
    let mut next = 0;
    while next < clusters.len() {
        if let Tree::Cut(halves) = clusters[next].0 {
            clusters.extend(halves.iter().map(|half| (half, NodeId(next as u32))));
        }
        next += 1;
    }
    let mut hierarchy = Hierarchy {
        nodes: Vec::with_capacity(clusters.len() + surfaces.len()),
        vertices: Vec::new(),
        surfaces: scene.shared_surfaces(),
        surface_nodes: vec![NodeId::ROOT; surfaces.len()],
        cluster_bounds: vec![Aabb::EMPTY; clusters.len()],
        cluster_faces: rayon::iter::repeat_n(Lobes::default(), clusters.len()).collect(),
        cuts: None,
    };
    let (mut first_cluster, mut first_surface) = (1, clusters.len());
    for &(tree, parent) in &clusters {
        let (first, count, next) = match tree {
            Tree::Cut(halves) => (first_cluster, halves.len(), &mut first_cluster),
            Tree::Leaf(surfaces) => (first_surface, surfaces.len(), &mut first_surface),
        };
        *next += count;
        hierarchy.nodes.push(Node { child_count: count as u32, ..Node::cluster(parent, NodeId(first as u32)) });
    }

    // The surfaces follow, cluster by cluster.
    let mut members = Vec::with_capacity(surfaces.len());
    for (&(tree, _), parent) in clusters.iter().zip(0..) {
        if let Tree::Leaf(surfaces) = tree {
            members.extend(surfaces.iter().map(|&surface| (NodeId(parent), surface)));
        }
    }
    hierarchy.push_surfaces(&members);
    rayon::join(|| drop(tree), || hierarchy.measure_clusters(&bounds));
    hierarchy
}

impl Hierarchy {
    /// A cluster of so many surfaces or fewer is not cut any further.
    pub(super) const LEAF_SURFACES: usize = 4;

    /// Clusters over the surfaces of a scene; nothing is subdivided yet. O(n log n).
    pub fn new(scene: &Scene) -> Self {
        build(scene, &|| false)
    }

    /// The same; once stopped, what is left is cut anywhere.
    pub(crate) fn new_unless(scene: &Scene, stop: Stop<'_>) -> Self {
        build(scene, stop)
    }

    /// Appends the nodes of surfaces, each with the cluster above it.
    fn push_surfaces(&mut self, members: &[(NodeId, u32)]) {
        for (&(_, surface), node) in members.iter().zip(self.nodes.len() as u32..) {
            self.surface_nodes[surface as usize] = NodeId(node);
        }
        let Self { nodes, surfaces, .. } = self;
        nodes.par_extend(members.par_iter().map(|&(parent, surface)| {
            let Facet { vertices, normal, .. } = surfaces[surface as usize].polygon.facet();
            Node::of_polygon((parent, surface), 0, Facet::of_part(vertices, normal))
        }));
    }

    /// Boxes, areas and faces of the clusters, from the children up.
    pub(super) fn measure_clusters(&mut self, bounds: &[Aabb]) {
        let clusters = self.cluster_count();
        for level in self.levels().into_iter().rev().filter(|level| level.start < clusters) {
            let ids = level.clone().into_par_iter().with_min_len(MEASURED_AT_ONCE);
            let measured: Vec<_> = ids.map(|index| self.measured_cluster(NodeId(index as u32), bounds)).collect();
            for (index, of_cluster) in level.zip(measured) {
                (self.nodes[index], self.cluster_bounds[index], self.cluster_faces[index]) = of_cluster;
            }
        }
    }

    /// A cluster with its area, centre and radius, its box and its faces, by its children; `bounds` are those of the surfaces. Its centre is
    /// the centroid of its area.
    fn measured_cluster(&self, cluster: NodeId, bounds: &[Aabb]) -> (Node, Aabb, Lobes) {
        let (mut around, mut faces) = (Aabb::EMPTY, Lobes::default());
        let (mut area, mut moment) = (0.0, DVec3::ZERO);
        for child in self.children(cluster) {
            let node = self.node(child);
            area += node.area;
            moment += node.area * node.centroid;
            if self.is_cluster(child) {
                around = around.union(self.cluster_bounds[child.index()]);
                faces += self.cluster_faces[child.index()];
            } else {
                around = around.union(bounds[node.surface as usize]);
                faces.add(node.area, self.normal_of(node.surface));
            }
        }
        let centroid = moment / area;
        let radius = (around.max - centroid).max(centroid - around.min).length();
        (Node { area, centroid, radius, ..*self.node(cluster) }, around, faces)
    }
}

/// Cuts a group of surfaces in two, again and again; once stopped, into halves of equal number as they come.
fn cut<'a>(surfaces: &'a mut [u32], bounds: &[Aabb], depth: u32, stop: Stop<'_>) -> Tree<'a> {
    if surfaces.len() <= Hierarchy::LEAF_SURFACES {
        return Tree::Leaf(surfaces);
    }
    let number = surfaces.len();
    let of_first = if number >= UNSTOPPABLE && stop() {
        number / 2
    } else {
        cut_off_large(surfaces, bounds).unwrap_or_else(|| cut_in_space(surfaces, bounds, depth))
    };
    let (first, second) = surfaces.split_at_mut(of_first);
    let cut = |surfaces| cut(surfaces, bounds, depth + 1, stop);
    let halves = if number >= PARALLEL { rayon::join(|| cut(first), || cut(second)).into() } else { [cut(first), cut(second)] };
    Tree::Cut(Box::new(halves))
}

/// Puts those that are wanted before the others, both in their order, and returns how many they are.
fn partition(surfaces: &mut [u32], is_wanted: impl Fn(u32) -> bool) -> usize {
    let (mut count, mut others) = (0, Vec::new());
    for k in 0..surfaces.len() {
        if is_wanted(surfaces[k]) {
            surfaces[count] = surfaces[k];
            count += 1;
        } else {
            others.push(surfaces[k]);
        }
    }
    surfaces[count..].copy_from_slice(&others);
    count
}

/// Puts the large surfaces first and returns how many they are; `None` if all or none are large.
fn cut_off_large(surfaces: &mut [u32], bounds: &[Aabb]) -> Option<usize> {
    let centres = Aabb::around(surfaces.iter().map(|&surface| bounds[surface as usize].centre()));
    let length = |bounds: &Aabb| bounds.extent().max_element();
    let limit = LARGE * length(&centres);
    let is_large = |surface: u32| length(&bounds[surface as usize]) > limit;
    let large = surfaces.iter().filter(|&&surface| is_large(surface)).count();
    (0 < large && large < surfaces.len()).then(|| partition(surfaces, is_large))
}

/// Puts the surfaces on one side of the best cut across an axis before those on the other, and returns how many they are.
fn cut_in_space(surfaces: &mut [u32], bounds: &[Aabb], depth: u32) -> usize {
    let centre = |surface: u32| bounds[surface as usize].centre();
    let around = Aabb::around(surfaces.iter().map(|&surface| centre(surface)));
    let extent = around.extent();

    // The surfaces by bins along each axis.
    let is_cut = |axis: usize| extent[axis] > 0.0 && depth < MAX_DEPTH;
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for bounds in surfaces.iter().map(|&surface| &bounds[surface as usize]) {
        let centre = bounds.centre();
        for axis in (0..3).filter(|&axis| is_cut(axis)) {
            bins[axis][bin_of(centre[axis], around.min[axis], extent[axis])].add(&Bin { bounds: *bounds, count: 1 });
        }
    }

    // The cut between bins, along any axis, with the least sum of box area times number of surfaces.
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| is_cut(axis)) {
        let mut after = [Bin::EMPTY; BINS + 1];
        for first in (1..BINS).rev() {
            after[first] = after[first + 1];
            after[first].add(&bins[axis][first]);
        }
        let mut before = Bin::EMPTY;
        for first in 1..BINS {
            before.add(&bins[axis][first - 1]);
            let cost = before.cost() + after[first].cost();
            if before.count > 0 && after[first].count > 0 && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, first));
            }
        }
    }
    if let Some((_, axis, first)) = best {
        return partition(surfaces, |surface| bin_of(centre(surface)[axis], around.min[axis], extent[axis]) < first);
    }

    // All centres at one point, or the tree is too deep: halves of equal number.
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let middle = surfaces.len() / 2;
    surfaces.select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    middle
}

/// Some surfaces: the box around them and how many they are.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    fn add(&mut self, other: &Self) {
        *self = Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count };
    }

    /// The area of half the box times the number of surfaces.
    fn cost(&self) -> f64 {
        let size = self.bounds.extent();
        (size.x * size.y + size.y * size.z + size.z * size.x) * self.count as f64
    }
}

fn bin_of(place: f64, start: f64, extent: f64) -> usize {
    ((BINS as f64 * (place - start) / extent) as usize).min(BINS - 1)
}
