//! What an oracle sees of a pair of nodes.

use super::context::RefineContext;
use super::link_set::Pair;
use super::oracle::Candidate;
use crate::hierarchy::{Hierarchy, NodeId};

/// The variation of reflected light over a surface that was not split yet, relative to its mean.
const UNKNOWN_VARIATION: f64 = 0.5;

impl RefineContext<'_> {
    /// The numbers that an oracle sees.
    pub(super) fn candidate(&self, hierarchy: &Hierarchy, pair: Pair, form_factor: f64, transmittance: Option<f64>) -> Candidate {
        let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
        let radiosity = self.radiosity_of(hierarchy, pair.source);
        let reflectance = self.reflectance(hierarchy, pair.receiver);
        let reflected_radiosity =
            reflectance.iter().zip(&radiosity[..self.scene.deciding()]).map(|(rho, b)| rho * b).fold(0.0, f64::max);
        Candidate {
            form_factor,
            transmittance,
            reflected_radiosity,
            source_variation: self.variation(hierarchy, pair.source),
            receiver_area: receiver.area,
            receiver_radius: receiver.radius,
            source_area: source.area,
            source_radius: source.radius,
            distance: receiver.centroid.distance(source.centroid),
            clusters: hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source),
        }
    }

    /// How much B varies over a node, relative to B: measured between its children, else guessed as half of what is reflected.
    fn variation(&self, hierarchy: &Hierarchy, node: NodeId) -> f64 {
        let brightest = |radiosity: &[f64]| radiosity[..self.scene.deciding()].iter().copied().fold(0.0, f64::max);
        let mean = brightest(self.radiosity_of(hierarchy, node));
        if mean <= 0.0 {
            return 0.0;
        }
        let known = self.radiosity.len() / self.scene.channels();
        let measured = hierarchy.children(node).filter(|child| child.index() < known);
        match measured.map(|child| (brightest(self.radiosity_of(hierarchy, child)) - mean).abs()).reduce(f64::max) {
            Some(difference) => difference / mean,
            None => {
                let emitted =
                    hierarchy.surface_of(node).map_or(0.0, |surface| brightest(&self.scene.material_of(surface).exitance));
                UNKNOWN_VARIATION * (1.0 - emitted / mean).clamp(0.0, 1.0)
            }
        }
    }
}
