//! Closure: what the form factors of a leaf must add up to, and how its reflected light is scaled to that.
//!
//! Links of clusters have estimated form factors, and some pairs are dormant. In a closed scene the form factors of each leaf
//! should add up to 1. What is missing is filled with the mean of the reflected light that the leaf gathers (the ambient term of
//! Holzschuch, Sillion, Drettakis 1994, section 2.2, but by the leaf's own surroundings instead of one ambient radiosity for the
//! scene). Where the sum exceeds 1, in open scenes too, reflected light is scaled down, so that sweeps converge whatever the links
//! say. Emitted light is left alone.
//!
//! Without clusters the sums are off by noise alone, and scaling down those above 1 would turn noise into a bias. So there only the
//! leaves are scaled at which sweeps might diverge: those where `rho` times the sum reaches 1.

use super::{Exposure, Radiosity, gather, push};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};

/// The reflected light of a leaf is multiplied by at most this. Safety limit.
const MOST: f64 = 4.0;

/// What reflected light at every leaf is multiplied by.
#[derive(Clone, Debug)]
pub(crate) struct Closure {
    channels: usize,
    /// The factor on reflected light, by node; used at leaves.
    factors: Vec<f64>,
    /// The irradiance by emitted light, in W/m^2, by node and channel.
    emitted: Vec<f64>,
}

impl Closure {
    /// What sweeps over `links` need: all leaves closed if clusters are linked, else those at which sweeps might diverge.
    pub fn needed(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure, clusters: bool) -> Option<Self> {
        if clusters {
            Some(Self::of_estimates(scene, hierarchy, links, exposure))
        } else {
            Self::of_divergent(scene, hierarchy, links, exposure)
        }
    }

    /// Closes every leaf, for links with estimated form factors.
    pub(super) fn of_estimates(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure) -> Self {
        let most = if exposure.is_closed() { MOST } else { 1.0 };
        let close = |_, sum: f64| if sum > 0.0 { (1.0 / sum).min(most) } else { 1.0 };
        Self::by(close, scene, hierarchy, links, exposure)
    }

    /// Closes the leaves at which sweeps might diverge; `None` if there are none.
    fn of_divergent(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure) -> Option<Self> {
        let close = |leaf: NodeId, sum: f64| {
            let reflectance = &scene.material_of(SurfaceId(hierarchy.node(leaf).surface)).reflectance;
            if reflectance.iter().any(|rho| rho * sum >= 1.0) { 1.0 / sum } else { 1.0 }
        };
        let closure = Self::by(close, scene, hierarchy, links, exposure);
        closure.factors.iter().any(|&factor| factor != 1.0).then_some(closure)
    }

    /// With the factor that `close` gives for a leaf and the sum of its form factors.
    fn by(close: impl Fn(NodeId, f64) -> f64, scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure) -> Self {
        let arriving = |sent: Radiosity| push(hierarchy, gather(hierarchy, links, exposure, &sent), sent.channels());
        let sums = arriving(Radiosity::ones(hierarchy, exposure));
        let factor = |node: NodeId| if hierarchy.is_leaf(node) { close(node, sums[node.index()]) } else { 1.0 };
        let factors = hierarchy.ids().map(factor).collect();
        drop(sums);
        Self { channels: scene.channels(), factors, emitted: arriving(Radiosity::emitted(scene, hierarchy, exposure)) }
    }

    /// The factor on reflected light at a leaf.
    pub(super) fn factor(&self, leaf: NodeId) -> f64 {
        self.factors[leaf.index()]
    }

    /// The exitance with which a leaf of this material would have the same radiosity if emitted light were multiplied, too:
    /// `E + rho f H + rho (1 - f) H_E`, H_E being the irradiance by emitted light, is `E' + rho f H`.
    #[cfg(test)]
    pub(super) fn effective_exitance(&self, leaf: NodeId, material: &crate::scene::Material) -> Vec<f64> {
        let emitted = &self.emitted[leaf.index() * self.channels..][..self.channels];
        let arriving = emitted.iter().map(|h| (1.0 - self.factor(leaf)) * h);
        material.exitance.iter().zip(&material.reflectance).zip(arriving).map(|((e, rho), h)| e + rho * h).collect()
    }

    /// Scales the reflected part of the irradiance at a leaf.
    pub(crate) fn close(&self, leaf: NodeId, irradiance: &mut [f64]) {
        let factor = self.factor(leaf);
        for (h, emitted) in irradiance.iter_mut().zip(&self.emitted[leaf.index() * self.channels..]) {
            *h = emitted + factor * (*h - emitted);
        }
    }
}
