//! Light from so far that it is parallel, or fills a small disc of the sky.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::seen::is_unit;
use crate::geometry::Frame;

/// A sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sun {
    /// Unit vector to its middle.
    pub towards: DVec3,
    /// Its diameter as an angle, in radians, below pi / 2: 0 for parallel light, 0.0093 for ours. Its radiance is even.
    pub diameter: f64,
}

impl Sun {
    pub(super) fn wrong(&self) -> Option<&'static str> {
        if !is_unit(self.towards) {
            return Some("its direction is no unit vector");
        }
        (!(0.0..std::f64::consts::FRAC_PI_2).contains(&self.diameter)).then_some("its diameter is not from 0 to pi / 2")
    }

    /// The direction number `u`, `v` in the unit square: so spread that each brings as much to what faces the sun.
    pub(crate) fn sampled_direction(&self, u: f64, v: f64) -> DVec3 {
        if self.diameter == 0.0 {
            return self.towards;
        }
        // Even in the disc that its cosine projects it to.
        let (r, azimuth) = ((0.5 * self.diameter).sin() * u.sqrt(), std::f64::consts::TAU * v);
        Frame::around(self.towards).to_world(DVec3::new(r * azimuth.cos(), r * azimuth.sin(), (1.0 - r * r).max(0.0).sqrt()))
    }
}
