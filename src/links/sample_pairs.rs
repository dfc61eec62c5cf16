//! Pairs of points, one on the receiver and one on the source, that stand for a pair of nodes.

use crate::form_factor::kernel;
use crate::geometry::{Facet, sampling};
use crate::visibility::Segment;

/// Appends `count` segments between points spread over receiver and source, each with its kernel value.
pub(crate) fn sampled_pairs(
    (receiver, receiver_plane): (&Facet<'_>, u32),
    (source, source_plane): (&Facet<'_>, u32),
    count: u32,
    seed: u64,
    segments: &mut Vec<Segment>,
    kernels: &mut Vec<f64>,
) {
    for index in 0..count {
        let [u, v, s, t] = sampling::sobol_4d(index, seed);
        let (x, y) = (receiver.point_at(u, v), source.point_at(s, t));
        segments.push(Segment { from: x.to_array(), to: y.to_array(), from_plane: receiver_plane, to_plane: source_plane });
        kernels.push(kernel(x, receiver.normal, y, source.normal));
    }
}

/// The part of the light that gets through: visibilities weighted by the kernel, so that their correlation is kept.
///
/// Where the kernel vanishes at every sample, the plain mean.
pub(crate) fn sampled_transmittance(kernels: &[f64], occluded: &[bool]) -> f64 {
    let total: f64 = kernels.iter().sum();
    let visible = kernels.iter().zip(occluded).filter(|(_, occluded)| !**occluded);
    if total > 0.0 {
        (visible.map(|(kernel, _)| kernel).sum::<f64>() / total).min(1.0)
    } else {
        visible.count() as f64 / kernels.len().max(1) as f64
    }
}

/// The part of the form factor to a source of `source_area` that is blocked, from sample points uniform by area; without bias.
///
/// Taken from the exact form factor it leaves no noise where nothing is blocked. The quotient of two sampled sums, as in
/// [`sampled_transmittance`], is biased by up to some percent with few rays.
pub(crate) fn sampled_blocked_form_factor(source_area: f64, kernels: &[f64], occluded: &[bool]) -> f64 {
    let blocked: f64 = kernels.iter().zip(occluded).filter(|(_, occluded)| **occluded).map(|(kernel, _)| kernel).sum();
    source_area * blocked / kernels.len() as f64
}
