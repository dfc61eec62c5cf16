//! What a refinement is asked to do, with what is known of the nodes: reflectances, radiosities, rays.

use std::sync::atomic::AtomicU64;

use super::link_set::Pair;
use super::oracle::RefinementOracle;
use super::skips::Skips;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;
use crate::transmittance::Rays;
use crate::transmittance::maps::Maps;

/// What refinement decides by: everything but the hierarchy, which grows.
pub(crate) struct RefineContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// What is asked before rays are.
    pub maps: Option<MapsOfLinks<'a>>,
    pub oracle: &'a dyn RefinementOracle,
    /// `scene.channels()` radiosities per node; nodes that are newer take their nearest older ancestor's.
    pub radiosity: &'a [f64],
    /// Whether clusters gather and emit; otherwise they are split down to their surfaces.
    pub clusters: bool,
    /// Largest reflectance below each cluster, `scene.channels()` each.
    pub cluster_reflectance: &'a [f64],
    /// Relative accuracy of form factors; 0 asks for exact ones.
    pub form_factor_accuracy: f64,
    /// Visibility rays for a link between reflecting surfaces.
    pub rays_per_link: u32,
    /// Visibility rays for a link from a lamp.
    pub rays_per_light_link: u32,
    /// What is left out.
    pub skips: Skips,
    pub seed: u64,
    /// Spent on form factors of links, added over threads.
    pub form_factor_nanoseconds: AtomicU64,
}

/// Maps, and how wrong they may be.
#[derive(Clone, Copy)]
pub(crate) struct MapsOfLinks<'a> {
    pub maps: &'a Maps<'a>,
    /// The standard error that the transmittance of a link may have by them.
    pub tolerance: f64,
}

impl RefineContext<'_> {
    /// Visibility rays for the value of a link of this pair; as many again decide whether it is one.
    pub(super) fn rays_for(&self, hierarchy: &Hierarchy, pair: Pair) -> u32 {
        let is_lamp = hierarchy.surface_of(pair.source).is_some_and(|surface| self.scene.material_of(surface).emits());
        if is_lamp { self.rays_per_light_link } else { self.rays_per_link }
    }

    /// The reflectance of a node by channel, of a cluster the mean over its area.
    pub(super) fn reflectance(&self, hierarchy: &Hierarchy, node: NodeId) -> &[f64] {
        match hierarchy.surface_of(node) {
            Some(surface) => &self.scene.material_of(surface).reflectance,
            None => &self.cluster_reflectance[node.index() * self.scene.channels()..][..self.scene.channels()],
        }
    }

    /// The radiosity of a node, or of its nearest ancestor that is old enough to have one.
    pub(super) fn radiosity_of(&self, hierarchy: &Hierarchy, node: NodeId) -> &[f64] {
        let channels = self.scene.channels();
        let known = self.radiosity.len() / channels;
        let mut node = node;
        while node.index() >= known {
            node = hierarchy.node(node).parent;
        }
        &self.radiosity[node.index() * channels..][..channels]
    }
}
