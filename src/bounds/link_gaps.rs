//! Which links leave how much open: what error-driven refinement goes by.
//!
//! Here links are bounded as they stand, not leaf by leaf as for [`bound_radiosities`](super::bound_radiosities). For a link takes its form
//! factor for equal over its receiver: where that varies, all leaves of the receiver are wrong, however small they are.

use std::collections::HashMap;

use rayon::prelude::*;

use super::assembly::assemble;
use super::attribution::{Share, attribute};
use super::evidence::Evidence;
use super::form_factors::{BoundedPair, FormFactorBounds, PairBounds};
use super::input::BoundsInput;
use super::iteration::{MOST_SWEEPS, SWEEP_TOLERANCE};
use super::pairs::{bounds_in_time, unlinked_pairs};
use crate::hierarchy::NodeId;
use crate::progress::Stop;

/// Form factors of links that were bounded before: those of a pair stay the same while the hierarchy grows.
#[derive(Default)]
pub(crate) struct KnownPairs(HashMap<(NodeId, NodeId), FormFactorBounds>);

/// Links that one task bounds.
const LINKS_A_TASK: usize = 64;

/// What a link leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinkGap {
    pub receiver: NodeId,
    pub source: NodeId,
    /// Its part of [`LinkGaps::gap`].
    pub share: f64,
    /// How wrong the receiver's irradiance may be because the form factor varies over the receiver: `(F_max - F_min) U_source` in W/m^2,
    /// channels added.
    pub by_form_factor: f64,
    /// The same because the radiosity varies over the source: `F_max (U_source - L_source)`.
    pub by_source: f64,
}

/// What all links leave open.
pub(crate) struct LinkGaps {
    /// Ordered by receiver and source.
    pub links: Vec<LinkGap>,
    /// `<R, upper - lower>` in W, channels added: the shares of all links and of all pairs without one.
    pub gap: f64,
    /// What pairs without a link add to that.
    pub unlinked: f64,
}

/// Bounds all links, and finds what each adds to `<R, upper - lower>`; `initial` is R by node and channel. `None` if `halt` says so before.
pub(crate) fn link_gaps(input: &BoundsInput<'_>, known: &mut KnownPairs, initial: &[f64], halt: Stop<'_>) -> Option<LinkGaps> {
    // The form factors of new links, and of pairs without one.
    let pair_bounds = PairBounds::new(input.scene, input.hierarchy, input.rule);
    let bound = |(receiver, source): (NodeId, NodeId)| {
        let found = known.0.get(&(receiver, source)).copied();
        let found = found.or_else(|| (!halt()).then(|| bounds_in_time(input, &pair_bounds, receiver, source)));
        found.map(|found| (receiver, source, found))
    };
    let linked: Vec<(NodeId, NodeId)> = input.links.iter().map(|(receiver, link)| (receiver, link.source)).collect();
    let mut pairs: Vec<BoundedPair> = linked.into_par_iter().with_min_len(LINKS_A_TASK).map(bound).collect::<Option<_>>()?;
    known.0 = pairs.iter().map(|&(receiver, source, form_factor)| ((receiver, source), form_factor)).collect();
    pairs.extend(unlinked_pairs(input, &pair_bounds));
    if halt() {
        return None;
    }
    pairs.par_sort_by_key(|(receiver, source, _)| (*receiver, *source));

    // Both systems, and what each pair adds to the gap between them.
    if halt() {
        return None;
    }
    let system = assemble(input.scene, input.hierarchy, &pairs);
    let (iterate, _) = system.solve(SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);
    let shares = attribute(&system, &iterate, initial, halt);
    let of_source =
        |values: &[f64], source: NodeId| -> f64 { values[source.index() * system.channels..][..system.channels].iter().sum() };
    if halt() {
        return None;
    }
    let mut gaps = LinkGaps { links: Vec::with_capacity(pairs.len()), gap: 0.0, unlinked: 0.0 };
    for (&(receiver, source, FormFactorBounds { lower, upper, evidence, .. }), share) in
        pairs.iter().zip(shares.iter().map(Share::total))
    {
        gaps.gap += share;
        if evidence == Evidence::Unlinked {
            gaps.unlinked += share;
            continue;
        }
        let (dimmest, brightest) = (of_source(&iterate.lower, source), of_source(&iterate.upper, source));
        let (by_form_factor, by_source) = ((upper - lower) * brightest, upper * (brightest - dimmest));
        gaps.links.push(LinkGap { receiver, source, share, by_form_factor, by_source });
    }
    Some(gaps)
}
