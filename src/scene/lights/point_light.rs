//! Lights at a point.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::seen::Seen;

/// A light at a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointLight {
    /// Where it is.
    pub position: DVec3,
}

impl PointLight {
    pub(super) fn wrong(&self) -> Option<&'static str> {
        (!self.position.is_finite()).then_some("its position is not finite")
    }

    /// How it is seen from a point; `None` from where it is.
    pub(super) fn seen_from(&self, point: DVec3) -> Option<Seen> {
        let to = self.position - point;
        let distance = to.length();
        (distance > 0.0).then(|| Seen { towards: to / distance, distance, irradiance: distance.powi(-2) })
    }

    /// The direction of the light number `u`, `v` in the unit square, even over what it sends, and all of that, in sr for each unit of strength.
    pub(crate) fn sampled_direction(&self, u: f64, v: f64) -> (DVec3, f64) {
        let (z, azimuth) = (1.0 - 2.0 * u, std::f64::consts::TAU * v);
        let r = (1.0 - z * z).max(0.0).sqrt();
        (DVec3::new(r * azimuth.cos(), r * azimuth.sin(), z), 4.0 * std::f64::consts::PI)
    }
}
