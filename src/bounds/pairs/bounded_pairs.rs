//! Which pairs are bounded, and how closely: together they account for every pair of leaves that can exchange light.
//!
//! Where surfaces alone are linked, every link is bounded for each leaf below its receiver. Where clusters are linked, that would be too
//! much: the pair that may carry most is split first, until a given amount of work is done.

use rayon::prelude::*;

use super::unlinked::unlinked_pairs;
use super::worst_first::{Light, Waiting, Worst, WorstFirst};
use crate::bounds::evidence::Evidence;
use crate::bounds::form_factors::{BoundedPair, FormFactorBounds, PairBounds};
use crate::bounds::input::BoundsInput;
use crate::hierarchy::NodeId;
use crate::links::Pair;

/// Links of surfaces are bounded leaf by leaf while that makes no more pairs than this, or than there are links.
const MOST_LINKED: usize = 2_000_000;

/// The work of bounding two polygons, in units of splitting a pair.
const WORK_OF_POLYGONS: u64 = 4;

/// Pairs that one task bounds: of links, and of those that were split down to polygons.
const LINKED_A_TASK: usize = 64;
const POLYGONS_A_TASK: usize = 16;

/// The work if none is asked for, in units of splitting a pair.
fn default_work(input: &BoundsInput<'_>) -> u64 {
    (1 << 13) + (16.0 * input.scene.surfaces().len() as f64 * (0.1 / input.error).sqrt()) as u64
}

/// All pairs, ordered by receiver and source.
pub(in crate::bounds) fn bounded_pairs(input: &BoundsInput<'_>) -> Vec<BoundedPair> {
    let pair_bounds = PairBounds::new(input.scene, input.hierarchy, input.rule);
    let is_cluster = |node| input.hierarchy.is_cluster(node);
    let mut pairs = if input.links.iter().any(|(receiver, link)| is_cluster(receiver) || is_cluster(link.source)) {
        worst_pairs(input, &pair_bounds.fairly())
    } else {
        let mut pairs = linked_pairs(input, &pair_bounds);
        pairs.extend(unlinked_pairs(input, &pair_bounds));
        pairs
    };
    pairs.sort_by_key(|(receiver, source, _)| (*receiver, *source));
    pairs
}

/// Everything that can be proved of a pair; once it is late, what is known cheaply.
pub(in crate::bounds) fn bounds_in_time(
    input: &BoundsInput<'_>,
    pair_bounds: &PairBounds<'_>,
    receiver: NodeId,
    source: NodeId,
) -> FormFactorBounds {
    if (input.stop)() { pair_bounds.bounds_unoccluded(receiver, source) } else { pair_bounds.bounds(receiver, source) }
}

/// Where clusters are linked: splits the pair that may carry most, again and again, until `input.work` is done. Of the pairs that came down
/// to polygons all is proved that can be; the others keep the bounds that are known cheaply.
fn worst_pairs(input: &BoundsInput<'_>, pair_bounds: &PairBounds<'_>) -> Vec<BoundedPair> {
    let BoundsInput { scene, hierarchy, links, radiosity, .. } = *input;
    let linked: Vec<Pair> = links.iter().map(|(receiver, link)| Pair { receiver, source: link.source }).collect();
    let all = linked.par_iter().chain(links.dormant()).chain(links.unseen()).copied();
    let mut waiting = WorstFirst::new(Light { scene, hierarchy, radiosity }, all);
    let (mut polygons, mut work) = (Vec::new(), 0);
    let most_work = input.work.unwrap_or_else(|| default_work(input));
    while work < most_work && !(input.stop)() {
        match waiting.split_worst() {
            Some(Worst::Split) => work += 1,
            Some(Worst::Polygons(pair)) => {
                polygons.push(pair);
                work += WORK_OF_POLYGONS;
            }
            None => break,
        }
    }

    let prove = |&Waiting { pair: Pair { receiver, source }, upper, .. }: &Waiting| {
        let bounds = bounds_in_time(input, pair_bounds, receiver, source);
        (receiver, source, FormFactorBounds { upper: bounds.upper.min(upper).max(bounds.lower), ..bounds })
    };
    let mut found: Vec<BoundedPair> = polygons.par_iter().with_min_len(POLYGONS_A_TASK).map(prove).collect();
    found.extend(waiting.into_rest().map(|Waiting { pair: Pair { receiver, source }, upper, .. }| {
        let has_cluster = [receiver, source].iter().any(|&node| hierarchy.is_cluster(node));
        let evidence = if has_cluster { Evidence::Boxes } else { Evidence::Unproved };
        (receiver, source, FormFactorBounds::guaranteed(0.0, upper, evidence))
    }));
    found
}

/// Where surfaces alone are linked: what each leaf gathers over its links and those above it, each bounded for the leaf itself, because
/// a receiver smaller than the link's leaves less open. Where that makes too many pairs, links are bounded as they are.
fn linked_pairs(input: &BoundsInput<'_>, pair_bounds: &PairBounds<'_>) -> Vec<BoundedPair> {
    let BoundsInput { hierarchy, links, .. } = *input;
    let mut at_leaves = Vec::new();
    'leaves: for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let mut above = Some(leaf);
        while let Some(node) = above {
            at_leaves.extend(links.of(node).iter().map(|link| (leaf, link.source)));
            if at_leaves.len() > MOST_LINKED.max(links.len()) {
                break 'leaves;
            }
            above = hierarchy.parent(node);
        }
    }
    let pairs = if at_leaves.len() > MOST_LINKED.max(links.len()) {
        links.iter().map(|(receiver, link)| (receiver, link.source)).collect()
    } else {
        at_leaves
    };
    let bound = |&(receiver, source): &(NodeId, NodeId)| (receiver, source, bounds_in_time(input, pair_bounds, receiver, source));
    pairs.par_iter().with_min_len(LINKED_A_TASK).map(bound).collect()
}
