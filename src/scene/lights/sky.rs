//! Light from all directions.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::seen::is_unit;

/// A sky over the ground, without a sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sky {
    /// Unit vector to the zenith.
    pub up: DVec3,
}

impl Sky {
    pub(super) fn wrong(&self) -> Option<&'static str> {
        (!is_unit(self.up)).then_some("its zenith is no unit vector")
    }

    /// Its radiance in a direction, times pi, for each unit of strength.
    pub(crate) fn radiosity(&self, towards: DVec3) -> f64 {
        if self.up.dot(towards) > 0.0 { 1.0 } else { 0.0 }
    }

    /// The direction number `u`, `v` in the unit square of the light that the sky sends, with one over its density for each steradian.
    pub(crate) fn sampled_direction(&self, u: f64, v: f64) -> (DVec3, f64) {
        let (azimuth, r) = (std::f64::consts::TAU * v, (1.0 - u * u).sqrt());
        let frame = crate::geometry::Frame::around(self.up);
        (frame.to_world(DVec3::new(r * azimuth.cos(), r * azimuth.sin(), u)), std::f64::consts::TAU)
    }
}
