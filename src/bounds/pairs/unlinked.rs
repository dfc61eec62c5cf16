//! Pairs without a link: dormant ones, and those of which no ray arrived. They may carry what they can, and need not carry anything.

use crate::bounds::evidence::Evidence;
use crate::bounds::form_factors::{BoundedPair, FormFactorBounds, PairBounds};
use crate::bounds::input::BoundsInput;
use crate::links::Pair;

/// Pairs are split into so many, or into as many as there are links.
const LEAST_UNLINKED: usize = 100_000;

/// All pairs without a link, as long as their receiver reflects and light can travel between them.
///
/// Clusters are split, because most of their surfaces cannot see each other at all. Where that makes too many pairs, or once it is late,
/// the rest stay whole.
pub(in crate::bounds) fn unlinked_pairs(input: &BoundsInput<'_>, pair_bounds: &PairBounds<'_>) -> Vec<BoundedPair> {
    let BoundsInput { scene, hierarchy, links, .. } = *input;
    let most = LEAST_UNLINKED.max(links.len());
    let mut waiting: Vec<Pair> = links.dormant().iter().chain(links.unseen()).copied().collect();
    let mut found = Vec::new();
    while let Some(pair) = waiting.pop() {
        // Leave out what cannot carry anything.
        let is_black = |surface| scene.material_of(surface).reflectance.iter().all(|&rho| rho == 0.0);
        if hierarchy.surface_of(pair.receiver).is_some_and(is_black) {
            continue;
        }
        let late = (input.stop)();
        let bound = if late { PairBounds::upper_quickly } else { PairBounds::upper_unlinked };
        let upper = bound(pair_bounds, pair.receiver, pair.source);
        if upper == 0.0 {
            continue;
        }

        // Split the only cluster of the two, or the larger one.
        let [receiver_is_cluster, source_is_cluster] = [pair.receiver, pair.source].map(|node| hierarchy.is_cluster(node));
        let receiver_is_larger = hierarchy.area(pair.receiver) >= hierarchy.area(pair.source);
        if late || waiting.len() + found.len() >= most || !(receiver_is_cluster || source_is_cluster) {
            found.push((pair.receiver, pair.source, FormFactorBounds::guaranteed(0.0, upper, Evidence::Unlinked)));
        } else if receiver_is_cluster && (receiver_is_larger || !source_is_cluster) {
            waiting.extend(hierarchy.children(pair.receiver).map(|receiver| Pair { receiver, ..pair }));
        } else {
            waiting.extend(hierarchy.children(pair.source).map(|source| Pair { source, ..pair }));
        }
    }
    found
}
