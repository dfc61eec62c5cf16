//! What becomes of light at the leaves: it is reflected.

use super::{Change, Closure, LightIrradiance};
use crate::hierarchy::NodeId;
use crate::scene::{Scene, SurfaceId};

/// Reflection at the leaves.
#[derive(Clone, Copy)]
pub(crate) struct Reflection<'a> {
    pub scene: &'a Scene,
    /// Scales reflected light where the links need it.
    pub closure: Option<&'a Closure>,
    /// What arrives there over no link.
    pub lights: &'a LightIrradiance,
}

impl Reflection<'_> {
    /// Sets `B = E + rho H` of a leaf in every channel; returns what that changed.
    pub fn reflect(&self, leaf: NodeId, surface: SurfaceId, irradiance: &mut [f64], radiosity: &mut [f64]) -> Change {
        if let Some(closure) = self.closure {
            closure.close(leaf, irradiance);
        }
        self.lights.add(leaf, irradiance);
        let material = self.scene.material_of(surface);
        let (mut change, reflected) = (Change::default(), irradiance);
        reflected.iter_mut().zip(&material.reflectance).for_each(|(h, rho)| *h *= rho);
        for reflected in &reflected[..self.scene.deciding()] {
            change.brightest = change.brightest.max(reflected.abs());
        }
        // Links are unbiased samples: in the dark their noise may take the irradiance below zero.
        self.scene.clear_dark(reflected);
        for (channel, b) in radiosity.iter_mut().enumerate() {
            let new = material.exitance[channel] + reflected[channel];
            if channel < self.scene.deciding() {
                change.largest = change.largest.max((new - *b).abs());
            }
            *b = new;
        }
        change
    }
}
