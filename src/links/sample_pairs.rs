//! Pairs of points, one on the receiver and one on the source, that stand for a pair of nodes.

use glam::DVec3;

use super::link_set::Pair;
use crate::form_factor::kernel;
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::Segment;

/// Where a cluster takes part, so many pairs of points are tried for one whose faces look at each other.
const TRIES: u32 = 4;

/// Segments between pairs of points, one after the other, each with its kernel value in 1/m^2.
#[derive(Default)]
pub(super) struct SamplePairs {
    pub segments: Vec<Segment>,
    pub kernels: Vec<f64>,
    /// What passes along some of them, by maps: from which segment on, one after the other.
    pub by_maps: Vec<(usize, Vec<f64>)>,
}

impl SamplePairs {
    /// Appends up to `count` segments between points spread over receiver and source; returns how many, and the form factor by all points
    /// that were tried, without bias. Polygons get all; where a cluster takes part, points that turn away from each other are left out,
    /// and none may remain.
    pub fn add(&mut self, scene: &Scene, hierarchy: &Hierarchy, pair: Pair, count: u32, seed: u64) -> (u32, f64) {
        let plane = |leaf| scene.surface(SurfaceId(hierarchy.node(leaf).surface)).plane;
        let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
        let (tries, first) = (if clusters { TRIES * count } else { count }, self.segments.len());
        let mut sum = 0.0;
        for index in 0..tries {
            let [u, v, s, t] = sampling::sobol_4d(index, seed);
            let (receiver, x) = point_in(hierarchy, pair.receiver, u, v);
            let (source, y) = point_in(hierarchy, pair.source, s, t);
            let kernel = kernel(x, hierarchy.normal(receiver), y, hierarchy.normal(source));
            sum += kernel;
            if self.segments.len() - first < count as usize && (kernel > 0.0 || !clusters) {
                let (from_plane, to_plane) = (plane(receiver), plane(source));
                self.segments.push(Segment { from: x.to_array(), to: y.to_array(), from_plane, to_plane });
                self.kernels.push(kernel);
            }
        }
        ((self.segments.len() - first) as u32, hierarchy.area(pair.source) * sum / f64::from(tries))
    }
}

/// A point of a node: of a polygon itself, of a cluster on one of its leaves.
fn point_in(hierarchy: &Hierarchy, node: NodeId, u: f64, v: f64) -> (NodeId, DVec3) {
    if hierarchy.is_cluster(node) { hierarchy.point_in_leaf(node, u, v) } else { (node, hierarchy.facet(node).point_at(u, v)) }
}

/// The part of the light that gets through, of what `passes` along each segment, 0 to 1: weighted by the kernel, so that their correlation is kept.
///
/// Where the kernel vanishes at every sample, the plain mean.
pub(super) fn sampled_transmittance(kernels: &[f64], passes: impl Iterator<Item = f64> + Clone) -> f64 {
    let total: f64 = kernels.iter().sum();
    if total > 0.0 {
        (kernels.iter().zip(passes).map(|(kernel, passes)| kernel * passes).sum::<f64>() / total).min(1.0)
    } else {
        passes.sum::<f64>() / kernels.len().max(1) as f64
    }
}

/// What passes along a segment that is occluded, or is not.
pub(super) fn passes(&occluded: &bool) -> f64 {
    f64::from(u8::from(!occluded))
}

/// The part of the exact form factor to a source of `source_area` that gets through, from sample points uniform by area; without bias.
///
/// As a control variate it takes the part `expected` of the form factor, known by other samples: so there is no noise where nothing is
/// blocked, and no light where everything is. The quotient of two sampled sums, as in [`sampled_transmittance`], is biased by up to some
/// percent with few rays.
pub(super) fn sampled_visible_form_factor(
    form_factor: f64,
    expected: f64,
    source_area: f64,
    kernels: &[f64],
    passes: &[f64],
) -> f64 {
    let beyond: f64 = kernels.iter().zip(passes).map(|(kernel, passes)| kernel * (passes - expected)).sum();
    expected * form_factor + source_area * beyond / kernels.len() as f64
}
