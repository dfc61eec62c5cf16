//! Samples of the kernel between nodes, and what they tell of the nodes above.
//!
//! Along a common edge the kernel grows as 1/r^2 towards points that nearly touch. There means of samples are still unbiased, but
//! have no finite variance: now and then one sample makes up most of a form factor.

use glam::DVec3;
use rayon::prelude::*;

use super::context::SampledContext;
use super::trees::{Nodes, ids};
use crate::form_factor::kernel;
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::SurfaceId;
use crate::visibility::Segment;

/// What samples tell of the kernel between two nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Kernel {
    /// The largest that gets through, in 1/m^2.
    pub largest: f64,
    /// `A_p A_q <G>` in m^2, as if nothing were in between.
    pub unoccluded: f64,
    /// The same of what gets through.
    pub exchange: f64,
}

impl Kernel {
    /// Of two pairs of nodes together.
    fn and(self, other: Self) -> Self {
        Self {
            largest: self.largest.max(other.largest),
            unoccluded: self.unoccluded + other.unoccluded,
            exchange: self.exchange + other.exchange,
        }
    }
}

/// The kernels between all nodes of two levels.
#[derive(Clone, Debug)]
pub(super) struct Table {
    first: Nodes,
    second: Nodes,
    /// Row after row, a row for each of the first.
    kernels: Vec<Kernel>,
}

impl Table {
    /// Made of `kernel(first, second)`.
    pub fn new(first: &Nodes, second: &Nodes, kernel: impl Fn(NodeId, NodeId) -> Kernel) -> Self {
        let kernels = ids(first).flat_map(|a| ids(second).map(move |b| (a, b))).map(|(a, b)| kernel(a, b)).collect();
        Self { first: first.clone(), second: second.clone(), kernels }
    }

    /// Between two nodes.
    pub fn at(&self, first: NodeId, second: NodeId) -> Kernel {
        let (row, column) = (first.0 - self.first.start, second.0 - self.second.start);
        self.kernels[row as usize * self.second.len() + column as usize]
    }

    /// Between what some nodes make up together.
    pub fn over(&self, first: &Nodes, second: &Nodes) -> Kernel {
        ids(first).flat_map(|a| ids(second).map(move |b| self.at(a, b))).fold(Kernel::default(), Kernel::and)
    }

    /// All pairs of nodes with their kernels, in order.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, NodeId, Kernel)> {
        let pairs = ids(&self.first).flat_map(|first| ids(&self.second).map(move |second| (first, second)));
        pairs.zip(&self.kernels).map(|((first, second), &kernel)| (first, second, kernel))
    }
}

/// Rays that are asked together, as far as a single row does not take more.
const CHUNK_RAYS: usize = 4096;

impl SampledContext<'_> {
    /// Samples the kernel between all nodes of two levels, in parallel.
    pub(super) fn sample(&self, hierarchy: &Hierarchy, first: &Nodes, second: &Nodes) -> Table {
        let points: Vec<DVec3> = ids(second).flat_map(|node| self.points_on(hierarchy, node)).collect();
        let rows = (CHUNK_RAYS / (points.len() * self.samples as usize)).max(1) as u32;
        let chunks = (first.len() as u32).div_ceil(rows);
        let kernels: Vec<Vec<Kernel>> = (0..chunks)
            .into_par_iter()
            .map(|chunk| {
                let start = first.start + chunk * rows;
                self.sample_rows(hierarchy, &(start..(start + rows).min(first.end)), second, &points)
            })
            .collect();
        Table { first: first.clone(), second: second.clone(), kernels: kernels.concat() }
    }

    /// Samples between some nodes and those of `second`, whose points are given, row after row.
    fn sample_rows(&self, hierarchy: &Hierarchy, first: &Nodes, second: &Nodes, points: &[DVec3]) -> Vec<Kernel> {
        let plane = |node: NodeId| self.scene.surface(SurfaceId(hierarchy.node(node).surface)).plane;
        let per_node = self.samples as usize;
        let mut kernels = vec![Kernel::default(); first.len() * second.len()];

        // Between all points, where they look at each other: kernel, ray, and whose they are.
        let (mut segments, mut samples) = (Vec::new(), Vec::new());
        for (row, receiver) in ids(first).enumerate() {
            let (normal, from_plane) = (hierarchy.normal(receiver), plane(receiver));
            for x in self.points_on(hierarchy, receiver) {
                for (column, (source, points)) in ids(second).zip(points.chunks(per_node)).enumerate() {
                    for &y in points {
                        let value = kernel(x, normal, y, hierarchy.normal(source));
                        if value > 0.0 {
                            samples.push((row * second.len() + column, value));
                            let (from, to) = (x.to_array(), y.to_array());
                            segments.push(Segment { from, to, from_plane, to_plane: plane(source) });
                        }
                    }
                }
            }
        }
        let mut occluded = Vec::new();
        self.rays.occluded(&segments, &mut occluded);

        // The largest that gets through, and the means.
        for (&(place, value), occluded) in samples.iter().zip(occluded) {
            let found = &mut kernels[place];
            found.unoccluded += value;
            if !occluded {
                found.exchange += value;
                found.largest = found.largest.max(value);
            }
        }
        for (row, receiver) in ids(first).enumerate() {
            for (column, source) in ids(second).enumerate() {
                let found = &mut kernels[row * second.len() + column];
                let weight = hierarchy.area(receiver) * hierarchy.area(source) / (per_node * per_node) as f64;
                found.unoccluded *= weight;
                found.exchange *= weight;
            }
        }
        kernels
    }

    /// The sample points of a node, jittered: each uniform by area, together spread evenly.
    fn points_on<'h>(&self, hierarchy: &'h Hierarchy, node: NodeId) -> impl Iterator<Item = DVec3> + use<'h> {
        let place = sampling::shifted_sobol_2d(sampling::hash(self.seed, u64::from(node.0)));
        let facet = hierarchy.facet(node);
        (0..self.samples).map(move |index| {
            let [u, v] = place(index);
            facet.point_at(u, v)
        })
    }
}
