//! The system of a scene: its leaves, and the form factors of its pairs as entries.

use rayon::prelude::*;

use super::enclosure::Enclosure;
use super::form_factors::BoundedPair;
use super::system::{Entry, Leaf, System};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// Leaves of which one task asks whether they are enclosed.
const LEAVES_A_TASK: usize = 64;

/// The system of all leaves of a hierarchy that gather over `pairs`, which are ordered by receiver.
pub(super) fn assemble<'a>(scene: &'a Scene, hierarchy: &Hierarchy, pairs: &[BoundedPair]) -> System<'a> {
    let enclosure = Enclosure::find(scene);
    let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let leaf = |&node: &NodeId| {
        let surface = SurfaceId(hierarchy.node(node).surface);
        let material = scene.material_of(surface);
        let enclosed = enclosure.as_ref().is_some_and(|enclosure| enclosure.holds(surface, &hierarchy.facet(node)));
        Leaf { node: node.0, exitance: &material.exitance, reflectance: &material.reflectance, enclosed }
    };
    let mut starts = vec![0; hierarchy.len() + 1];
    pairs.iter().for_each(|(receiver, ..)| starts[receiver.index() + 1] += 1);
    for node in 0..hierarchy.len() {
        starts[node + 1] += starts[node];
    }
    System {
        channels: scene.channels(),
        parents: hierarchy.ids().map(|node| hierarchy.node(node).parent.0).collect(),
        starts,
        entries: pairs.iter().map(|(_, source, f)| Entry { source: source.0, lower: f.lower, upper: f.upper }).collect(),
        leaves: leaves.par_iter().with_min_len(LEAVES_A_TASK).map(leaf).collect(),
        plans: None,
    }
}
