//! How far radiosities vary over each leaf: an estimate that is narrower than bounds, and no bound (Lischinski 1994, section 5.2.1).
//!
//! It assumes that a leaf is wrong because its own links are, not because its sources are. So light travels once, from the radiosities
//! as they are found. What all links bring is added up at each point before extremes are taken, so that links that vary in opposite
//! directions make up for each other:
//!
//! ```text
//! least, most of  E + rho sum over links of F(x) B_source      for x the centre and the vertices of the leaf
//! ```
//!
//! Where clusters are linked, a link brings the same to all points of a leaf. Pairs without a link bring nothing.

use rayon::prelude::*;

use super::form_factors::{FormFactorRule, PairBounds};
use super::radiosity_bounds::RadiosityBounds;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};

/// The range of every leaf, from the `radiosity` of all nodes by channel; inner nodes have the extremes of their leaves.
pub(crate) fn estimate_ranges(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, radiosity: &[f64]) -> RadiosityBounds {
    let channels = scene.channels();
    let pair_bounds = PairBounds::new(scene, hierarchy, FormFactorRule::CentreAndVertices);
    let of_leaf = |&leaf: &NodeId| leaf_range(scene, hierarchy, links, radiosity, &pair_bounds, leaf);
    let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let found: Vec<Vec<[f64; 2]>> = leaves.par_iter().map(of_leaf).collect();

    let mut ranges = RadiosityBounds {
        channels,
        lower: vec![f64::INFINITY; channels * hierarchy.len()],
        upper: vec![f64::NEG_INFINITY; channels * hierarchy.len()],
        elements: None,
    };
    for (leaf, range) in leaves.iter().zip(&found) {
        for (channel, &[lower, upper]) in range.iter().enumerate() {
            ranges.lower[leaf.index() * channels + channel] = lower;
            ranges.upper[leaf.index() * channels + channel] = upper;
        }
    }
    for node in hierarchy.ids().rev() {
        let Some(parent) = hierarchy.parent(node) else { continue };
        for channel in 0..channels {
            let (own, above) = (node.index() * channels + channel, parent.index() * channels + channel);
            ranges.lower[above] = ranges.lower[above].min(ranges.lower[own]);
            ranges.upper[above] = ranges.upper[above].max(ranges.upper[own]);
        }
    }
    ranges
}

/// The least and the most of a leaf, by channel.
fn leaf_range(
    scene: &Scene,
    hierarchy: &Hierarchy,
    links: &LinkSet,
    radiosity: &[f64],
    pair_bounds: &PairBounds<'_>,
    leaf: NodeId,
) -> Vec<[f64; 2]> {
    // Add up what arrives at each point over the links of the leaf and of all above it.
    let channels = scene.channels();
    let points = 1 + hierarchy.facet(leaf).vertices.len();
    let mut irradiance = vec![0.0; points * channels];
    let mut above = Some(leaf);
    while let Some(node) = above {
        for link in links.of(node) {
            let factors = if hierarchy.is_cluster(node) || hierarchy.is_cluster(link.source) {
                vec![link.occluded_form_factor(); points]
            } else {
                pair_bounds.point_factors(leaf, link.source).0
            };
            let brought = &radiosity[link.source.index() * channels..][..channels];
            for (at_point, factor) in irradiance.chunks_mut(channels).zip(factors) {
                at_point.iter_mut().zip(brought).for_each(|(h, b)| *h += factor * b);
            }
        }
        above = hierarchy.parent(node);
    }

    // Reflect, and take the extremes.
    let material = scene.material_of(SurfaceId(hierarchy.node(leaf).surface));
    let range = |channel: usize| {
        let at_points = irradiance.iter().skip(channel).step_by(channels);
        let [least, most] = at_points.fold([f64::INFINITY, 0.0], |[least, most], &h| [h.min(least), h.max(most)]);
        [least, most].map(|h| material.exitance[channel] + material.reflectance[channel] * h)
    };
    (0..channels).map(range).collect()
}
