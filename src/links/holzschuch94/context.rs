//! What linking and refining decide by, and what they ask of nodes: brightness, exchange, plane.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::form_factor::{estimate_exchange, exact_exchange};
use crate::geometry::Facet;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;

/// What linking and refining decide by: everything but the hierarchy, which grows.
pub(crate) struct MutualContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// `scene.channels()` radiosities per node; nodes that are newer take their nearest older ancestor's.
    pub radiosity: &'a [f64],
    /// Relative accuracy of form factors.
    pub form_factor_accuracy: f64,
    /// eps_refine in W/m^2: links that carry more irradiance than this are refined.
    pub refine_tolerance: f64,
    /// eps_reduce: refinement that changes form factors by less is taken back. `None` leaves links unreduced.
    pub reduce_tolerance: Option<f64>,
    /// Nodes of this area or less are not split, in m^2: the paper's MinArea.
    pub min_area: f64,
    pub seed: u64,
    /// Spent on form factors of links, added over threads.
    pub form_factor_nanoseconds: AtomicU64,
}

impl MutualContext<'_> {
    /// The brightest channel of a node's radiosity in W/m^2; of a new node that of its nearest ancestor that is old enough.
    pub(super) fn brightness(&self, hierarchy: &Hierarchy, node: NodeId) -> f64 {
        let channels = self.scene.channels();
        let known = self.radiosity.len() / channels;
        let mut node = node;
        while node.index() >= known {
            node = hierarchy.node(node).parent;
        }
        self.radiosity[node.index() * channels..][..channels].iter().copied().fold(0.0, f64::max)
    }

    /// The product BF: the larger of the irradiances that two nodes send each other, in W/m^2, as if nothing were in between.
    pub(super) fn largest_irradiance(&self, hierarchy: &Hierarchy, first: NodeId, second: NodeId, exchange: f64) -> f64 {
        let to_first = self.brightness(hierarchy, second) / hierarchy.area(first);
        let to_second = self.brightness(hierarchy, first) / hierarchy.area(second);
        exchange * to_first.max(to_second)
    }

    /// `A F` between two polygons in m^2, as if nothing were in between.
    pub(super) fn estimate_exchange(&self, first: &Facet<'_>, second: &Facet<'_>) -> f64 {
        if self.form_factor_accuracy > 0.0 {
            estimate_exchange(first, second, self.form_factor_accuracy).value
        } else {
            exact_exchange(first, second)
        }
    }

    /// Notes the time since `start` as spent on form factors.
    pub(super) fn note_form_factors(&self, start: Instant) {
        self.form_factor_nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// The plane in which a surface or element lies.
    pub(super) fn plane(&self, hierarchy: &Hierarchy, node: NodeId) -> u32 {
        self.scene.surface(SurfaceId(hierarchy.node(node).surface)).plane
    }
}
