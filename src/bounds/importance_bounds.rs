//! Bounds on importance: between which numbers lies what a unit of exitance anywhere adds to what is wanted.
//!
//! Let r be the density of the initial importance R, and K light's way to a point, `(K B)(x) = integral of k(x, y) V(x, y) B(y)`. The
//! kernel is symmetric, so what is wanted of `B = E + rho K B` is
//!
//! ```text
//! <r, B> = <z, E>        z = r + K w        w = rho r + rho K w
//! ```
//!
//! (Lischinski 1994, equation 5.9, before it is made discrete.) w is the radiosity of surfaces that emit `rho r`, so the systems that bound
//! radiosities bound it, too, with the same form factors; and z at a point is r and what arrives there.

use rayon::prelude::*;

use super::Certainty;
use super::bounded_pairs::bounded_pairs;
use super::radiosity_bounds::{BoundsInput, MOST_SWEEPS, SWEEP_TOLERANCE, certainty, system};
use super::system::{Iterate, Leaf, System, rounding};
use crate::hierarchy::NodeId;

/// Lower and upper importance of every node, for a square metre of it: they hold at every point. The unit is that of R for a square metre:
/// over all surfaces as they are, R adds up to their area.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceBounds {
    channels: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Between these lies `<R, B>`, R spread evenly over each leaf, in W by channel.
    pub wanted: Vec<[f64; 2]>,
    /// The weakest of all pairs, as of [`BoundsReport`](super::BoundsReport).
    pub certainty: Certainty,
}

impl ImportanceBounds {
    /// A unit of exitance on a square metre at any point of a node adds no less than this, by channel.
    pub fn lower(&self, node: NodeId) -> &[f64] {
        &self.lower[node.index() * self.channels..][..self.channels]
    }

    /// A unit of exitance on a square metre at any point of a node adds no more than this, by channel.
    pub fn upper(&self, node: NodeId) -> &[f64] {
        &self.upper[node.index() * self.channels..][..self.channels]
    }
}

/// Bounds the importance of every node; `initial` is R by node and channel, of which that of leaves counts. In the current rayon pool;
/// the same for any number of threads.
pub(crate) fn bound_importance(input: &BoundsInput<'_>, initial: &[f64]) -> ImportanceBounds {
    let pairs = bounded_pairs(input);
    let lit = system(input, &pairs);
    let channels = lit.channels;

    // The system of w: leaves emit rho r.
    let density = |leaf: &Leaf<'_>, channel: usize| {
        initial[leaf.node as usize * channels + channel] / input.hierarchy.area(NodeId(leaf.node))
    };
    let sent: Vec<f64> = lit
        .leaves
        .iter()
        .flat_map(|leaf| (0..channels).map(move |channel| leaf.reflectance[channel] * density(leaf, channel)))
        .collect();
    let leaves = lit.leaves.iter().zip(sent.chunks(channels)).map(|(leaf, exitance)| Leaf { exitance, ..*leaf }).collect();
    let System { parents, starts, entries, leaves: emitting, .. } = lit;
    let system = System { channels, parents, starts, entries, leaves };
    let (reflected, _) = system.solve(SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);

    // z = r + K w.
    let mut pourings = system.pourings();
    pourings.iter_mut().for_each(|pouring| pouring.look_at(&reflected));
    let of_leaf = |leaf: &Leaf<'_>| -> Vec<[f64; 2]> {
        let arrives = |channel: usize| pourings[channel].pour(leaf.node, leaf.enclosed, &reflected, |_, _, _| {});
        let widened = |[lower, upper]: [f64; 2]| [lower * (1.0 - rounding(0)), upper * (1.0 + rounding(0))];
        (0..channels).map(|channel| widened(arrives(channel).map(|h| density(leaf, channel) + h))).collect()
    };
    let found: Vec<Vec<[f64; 2]>> = system.leaves.par_iter().with_min_len(64).map(of_leaf).collect();
    let mut importance = Iterate { lower: vec![0.0; reflected.lower.len()], upper: vec![0.0; reflected.upper.len()] };
    let mut wanted = vec![[0.0; 2]; channels];
    for (leaf, bounds) in emitting.iter().zip(&found) {
        let area = input.hierarchy.area(NodeId(leaf.node));
        for (channel, &[lower, upper]) in bounds.iter().enumerate() {
            let at = leaf.node as usize * channels + channel;
            (importance.lower[at], importance.upper[at]) = (lower, upper);
            let sent = area * leaf.exitance[channel];
            wanted[channel][0] += sent * lower;
            wanted[channel][1] += sent * upper;
        }
    }
    system.pull(&mut importance);
    let widened = rounding(emitting.len());
    let wanted = wanted.into_iter().map(|[least, most]| [least * (1.0 - widened), most * (1.0 + widened)]).collect();
    let Iterate { lower, upper } = importance;
    ImportanceBounds { channels, lower, upper, wanted, certainty: certainty(input, &pairs) }
}
