//! Bounds on importance: between which numbers lies what a unit of exitance anywhere adds to what is wanted.
//!
//! Let r be the density of the initial importance R, and K light's way to a point, `(K B)(x) = integral of k(x, y) V(x, y) B(y)`. The
//! kernel is symmetric, so what is wanted of `B = E + rho K B` is
//!
//! ```text
//! <r, B> = <z, E>        z = r + K w        w = rho r + rho K w
//! ```
//!
//! (Lischinski 1994, equation 5.9, before discretisation.) w is the radiosity of surfaces that emit `rho r`. So the systems that bound
//! radiosities bound w, too, with the same form factors; and z at a point is r plus the irradiance there.

use rayon::prelude::*;

use super::assembly::assemble;
use super::evidence::Certainty;
use super::input::BoundsInput;
use super::iteration::{MOST_SWEEPS, SWEEP_TOLERANCE};
use super::knapsack::Knapsack;
use super::pairs::bounded_pairs;
use super::report::certainty;
use super::rounding::rounding;
use super::system::{Iterate, Leaf, System};
use crate::hierarchy::NodeId;

/// Leaves of which one task computes the irradiance.
const LEAVES_A_TASK: usize = 64;

/// Lower and upper importance of every node for a square metre of it: they hold at every point. In units of the initial importance R of a
/// square metre, which is 1 where the answer is wanted for all surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceBounds {
    channels: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Between these lies `<R, B>`, R being distributed evenly over each leaf; in W by channel.
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

/// Bounds the importance of every node. `initial` is R by node and channel; only that of leaves counts. In the current rayon pool; the same
/// for any number of threads.
pub(crate) fn bound_importance(input: &BoundsInput<'_>, initial: &[f64]) -> ImportanceBounds {
    let pairs = bounded_pairs(input);
    let lit = assemble(input.scene, input.hierarchy, &pairs);
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
    let System { parents, starts, entries, leaves: emitting, plans, .. } = lit;
    let system = System { channels, parents, starts, entries, leaves, plans };
    let (reflected, _) = system.solve(SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);

    // z = r + K w.
    let mut knapsacks = Knapsack::of_channels(&system);
    knapsacks.iter_mut().for_each(|knapsack| knapsack.sort(&reflected));
    let of_leaf = |leaf: &Leaf<'_>| -> Vec<[f64; 2]> {
        let irradiance = |channel: usize| knapsacks[channel].irradiance(leaf.node, leaf.enclosed, &reflected, |_, _, _| {});
        let widened = |[lower, upper]: [f64; 2]| [lower * (1.0 - rounding(0)), upper * (1.0 + rounding(0))];
        (0..channels).map(|channel| widened(irradiance(channel).map(|h| density(leaf, channel) + h))).collect()
    };
    let found: Vec<Vec<[f64; 2]>> = system.leaves.par_iter().with_min_len(LEAVES_A_TASK).map(of_leaf).collect();

    // By node, and the product with the exitance: `<z, E>`.
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
    ImportanceBounds { channels, lower, upper, wanted, certainty: certainty(input.scene, &pairs) }
}
