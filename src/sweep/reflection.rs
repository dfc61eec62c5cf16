//! What becomes of light at the leaves: it is reflected.

use super::{Change, Closure};
use crate::hierarchy::NodeId;
use crate::scene::{Scene, SurfaceId};

/// Reflection at the leaves.
pub(super) struct Reflection<'a> {
    pub scene: &'a Scene,
    /// Scales reflected light where the links need it.
    pub closure: Option<&'a Closure>,
}

impl Reflection<'_> {
    /// Sets `B = E + rho H` of a leaf in every channel; returns what that changed.
    pub fn reflect(&self, leaf: NodeId, surface: SurfaceId, irradiance: &mut [f64], radiosity: &mut [f64]) -> Change {
        if let Some(closure) = self.closure {
            closure.close(leaf, irradiance);
        }
        let material = self.scene.material_of(surface);
        let mut change = Change::default();
        for (channel, b) in radiosity.iter_mut().enumerate() {
            let reflected = material.reflectance[channel] * irradiance[channel];
            // Links are unbiased samples: in the dark their noise may take the irradiance below zero.
            let new = material.exitance[channel] + reflected.max(0.0);
            change = change.and(Change { largest: (new - *b).abs(), brightest: reflected.abs() });
            *b = new;
        }
        change
    }
}
