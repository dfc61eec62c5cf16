//! Push-pull: irradiance goes down to the leaves, radiosity comes up.

use super::{Change, Emission, Exposure, Radiosity, Reflection};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

/// Hands the gathered `irradiance` of every node down to the leaves, reflects it there, and takes means upward.
pub(crate) fn push_pull(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    emission: Emission<'_>,
    mut irradiance: Vec<f64>,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();

    // Push: what a node gathers arrives at all its children.
    for node in 1..hierarchy.len() {
        let parent = hierarchy.node(NodeId(node as u32)).parent.index();
        let (above, below) = irradiance.split_at_mut(node * channels);
        for (h, from_parent) in below[..channels].iter_mut().zip(&above[parent * channels..][..channels]) {
            *h += from_parent;
        }
    }

    // Reflect at the leaves, and pull.
    let reflection = Reflection { scene, emission };
    let mut change = Change::default();
    for node in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let irradiance = &irradiance[node.index() * channels..][..channels];
        reflection.reflect(node, hierarchy.node(node).surface, irradiance, radiosity.of_mut(node), &mut change);
    }
    radiosity.pull(hierarchy, exposure);
    change
}
