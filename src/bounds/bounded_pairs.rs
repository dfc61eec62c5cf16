//! Which pairs are bounded, and how closely: together they cover every pair of leaves that can exchange light.

use rayon::prelude::*;

use super::pair::PairBounds;
use super::worst_first::{Light, Looked, Waiting, WorstFirst};
use super::{BoundsInput, Evidence, FormFactorBounds};
use crate::hierarchy::NodeId;
use crate::links::Pair;

/// Links of surfaces are bounded leaf by leaf while that makes no more pairs than this, or than there are links.
const MOST_LINKED: usize = 2_000_000;

/// Pairs without a link are taken apart into so many, or as many as there are links.
const LEAST_UNLINKED: usize = 100_000;

/// What a pair of polygons takes, in pairs that are taken apart.
const WORK_OF_POLYGONS: u64 = 4;

/// A receiver, a source, and what their form factor is at least and at most.
pub(super) type BoundedPair = (NodeId, NodeId, FormFactorBounds);

/// All pairs, ordered by receiver and source.
pub(super) fn bounded_pairs(input: &BoundsInput<'_>) -> Vec<BoundedPair> {
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

/// Where clusters are linked: what may carry most is taken apart first, down to polygons, of which all is proved that can be, until so
/// much work is done. The rest is bounded as it stands, cheaply.
fn worst_pairs(input: &BoundsInput<'_>, pair_bounds: &PairBounds<'_>) -> Vec<BoundedPair> {
    let BoundsInput { scene, hierarchy, links, radiosity, .. } = *input;
    let linked: Vec<Pair> = links.iter().map(|(receiver, link)| Pair { receiver, source: link.source }).collect();
    let all = linked.par_iter().chain(links.dormant()).chain(links.unseen()).copied();
    let mut waiting = WorstFirst::new(Light { scene, hierarchy, radiosity }, all);
    let (mut polygons, mut work) = (Vec::new(), 0);
    while work < input.work && !(input.stop)() {
        match waiting.look() {
            Some(Looked::TakenApart) => work += 1,
            Some(Looked::Polygons(pair)) => {
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
    let mut found: Vec<BoundedPair> = polygons.par_iter().with_min_len(16).map(prove).collect();
    found.extend(waiting.into_rest().map(|Waiting { pair: Pair { receiver, source }, upper, .. }| {
        let evidence =
            if [receiver, source].iter().any(|&node| hierarchy.is_cluster(node)) { Evidence::Boxes } else { Evidence::Unproved };
        (receiver, source, FormFactorBounds::guaranteed(0.0, upper, evidence))
    }));
    found
}

/// With all that can be proved, while there is time.
pub(super) fn bounds_in_time(
    input: &BoundsInput<'_>,
    pair_bounds: &PairBounds<'_>,
    receiver: NodeId,
    source: NodeId,
) -> FormFactorBounds {
    if (input.stop)() { pair_bounds.bounds_unoccluded(receiver, source) } else { pair_bounds.bounds(receiver, source) }
}

/// What each leaf gathers over its links and those above it, each bounded for the leaf itself: a smaller receiver than the link's
/// leaves less open. Where that makes too many pairs, links are bounded as they are.
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
    pairs.par_iter().with_min_len(64).map(bound).collect()
}

/// Dormant pairs, and those of which no ray arrived: they may carry what they can, and need not carry anything.
///
/// Clusters are taken apart: most of their surfaces cannot see each other at all. Where that makes too many pairs, or time is up, the
/// rest stay whole.
pub(super) fn unlinked_pairs(input: &BoundsInput<'_>, pair_bounds: &PairBounds<'_>) -> Vec<BoundedPair> {
    let BoundsInput { scene, hierarchy, links, .. } = *input;
    let most = LEAST_UNLINKED.max(links.len());
    let mut waiting: Vec<Pair> = links.dormant().iter().chain(links.unseen()).copied().collect();
    let mut found = Vec::new();
    while let Some(pair) = waiting.pop() {
        let is_black = |surface| scene.material_of(surface).reflectance.iter().all(|&rho| rho == 0.0);
        if hierarchy.surface_of(pair.receiver).is_some_and(is_black) {
            continue;
        }
        let late = (input.stop)();
        let of = if late { PairBounds::upper_quickly } else { PairBounds::upper_unlinked };
        let upper = of(pair_bounds, pair.receiver, pair.source);
        if upper == 0.0 {
            continue;
        }
        let receiver_is_larger = hierarchy.area(pair.receiver) >= hierarchy.area(pair.source);
        match (hierarchy.is_cluster(pair.receiver), hierarchy.is_cluster(pair.source)) {
            _ if waiting.len() + found.len() >= most || late => {}
            (true, source) if receiver_is_larger || !source => {
                waiting.extend(hierarchy.children(pair.receiver).map(|receiver| Pair { receiver, ..pair }));
                continue;
            }
            (_, true) => {
                waiting.extend(hierarchy.children(pair.source).map(|source| Pair { source, ..pair }));
                continue;
            }
            _ => {}
        }
        found.push((pair.receiver, pair.source, FormFactorBounds::guaranteed(0.0, upper, Evidence::Unlinked)));
    }
    found
}
