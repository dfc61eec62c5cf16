//! What is computed over links: gather and push-pull, by Jacobi sweeps or in place; importance, against the direction of light.

mod closure;
mod defect;
mod exposure;
mod gather;
mod importance;
mod in_place;
mod missing;
mod push_pull;
mod radiosity;

pub(crate) use closure::Closure;
pub(crate) use defect::Reflections;
pub use exposure::Exposure;
pub(crate) use exposure::{ByPlane, sampled_exposed_point};
pub(crate) use gather::{Irradiance, gather};
pub(crate) use importance::Adjoint;
pub use importance::Importance;
pub(crate) use in_place::sweep_in_place;
pub(crate) use missing::{estimate_ambient, incorrect_energy, reflect_ambient, row_sums};
pub(crate) use push_pull::{push, push_pull};
pub use radiosity::Radiosity;
pub(crate) use radiosity::cluster_reflectance;

use crate::hierarchy::NodeId;
use crate::scene::{Scene, SurfaceId};

/// The largest ratio of successive changes that is believed: sweeps converge, because no scene reflects more than it receives.
const MAX_RATIO: f64 = 0.9999;

/// So many nodes are worth a thread of their own.
const PARALLEL: usize = 256;

/// What a sweep changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change {
    /// The largest change of any leaf's radiosity, in W/m^2.
    pub largest: f64,
    /// The largest reflected radiosity `rho H` of any leaf, in W/m^2.
    pub brightest: f64,
}

impl Change {
    /// What two sweeps of different leaves changed.
    fn and(self, other: Self) -> Self {
        Self { largest: self.largest.max(other.largest), brightest: self.brightest.max(other.brightest) }
    }

    /// What all later sweeps will change together, in W/m^2: changes fall like a geometric series whose ratio the last two tell.
    ///
    /// Infinite after the first sweep. `previous` is the largest change of the sweep before.
    pub fn estimate_to_come(&self, previous: f64) -> f64 {
        if previous.is_infinite() && self.largest > 0.0 {
            return f64::INFINITY;
        }
        let ratio = (self.largest / previous).min(MAX_RATIO);
        if self.largest == 0.0 { 0.0 } else { self.largest * ratio / (1.0 - ratio) }
    }
}

/// What push-pull does at the leaves.
struct Reflection<'a> {
    scene: &'a Scene,
    /// Where links are estimates; `None` where they are as exact as their form factors.
    closure: Option<&'a Closure>,
}

impl Reflection<'_> {
    /// Sets `B = E + rho H` of a leaf in every channel, and tells what that changed.
    fn reflect(&self, leaf: NodeId, surface: SurfaceId, irradiance: &mut [f64], radiosity: &mut [f64]) -> Change {
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
