//! Push-pull: irradiance goes down to the leaves, radiosity comes up.

use super::{Change, Closure, Exposure, Irradiance, Radiosity, Reflection};
use crate::hierarchy::Hierarchy;
use crate::scene::Scene;

/// Hands the gathered `irradiance` of every node down to the leaves, reflects it there, and takes means upward.
pub(crate) fn push_pull(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    closure: Option<&Closure>,
    irradiance: Irradiance,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();
    let mut values = push(hierarchy, irradiance, channels);

    // Reflect at the leaves, and pull.
    let reflection = Reflection { scene, closure };
    let mut change = Change::default();
    for node in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let irradiance = &mut values[node.index() * channels..][..channels];
        reflection.reflect(node, hierarchy.node(node).surface, irradiance, radiosity.of_mut(node), &mut change);
    }
    radiosity.pull(hierarchy, exposure);
    change
}

/// The irradiance of every surface and element with all that arrives above it, by channel, node after node: what a node gathers arrives at
/// all its children, from a cluster by the way their faces look.
pub(crate) fn push(hierarchy: &Hierarchy, irradiance: Irradiance, channels: usize) -> Vec<f64> {
    let Irradiance { mut values, mut lobes } = irradiance;
    for node in hierarchy.ids().skip(1) {
        let parent = hierarchy.node(node).parent;
        for channel in 0..channels {
            let (own, above) = (node.index() * channels + channel, parent.index() * channels + channel);
            if hierarchy.is_cluster(node) {
                let from_above = lobes[above];
                lobes[own] += from_above;
            } else if hierarchy.is_cluster(parent) {
                values[own] += lobes[above].at(hierarchy.normal(node));
            } else {
                values[own] += values[above];
            }
        }
    }
    values
}
