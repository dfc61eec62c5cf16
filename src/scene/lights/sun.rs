//! Light from so far that it is parallel, or fills a small disc of the sky.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::LightError;
use super::seen::is_unit;
use crate::geometry::Frame;

/// A sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sun {
    /// Unit vector to its middle.
    pub(crate) towards: DVec3,
    /// Its diameter as an angle, in radians, below pi / 2: 0 for parallel light, 0.0093 for ours. Its radiance is even.
    pub(crate) diameter: f64,
}

impl Sun {
    /// A sun in the direction of `towards`, of any length above 0, with its diameter in radians.
    ///
    /// # Errors
    /// Says which of them is out of range.
    pub fn new(towards: [f64; 3], diameter: f64) -> Result<Self, LightError> {
        let towards = DVec3::from(towards).try_normalize().ok_or(LightError("its direction is no vector of a length above 0"))?;
        let sun = Self { towards, diameter };
        sun.wrong().map_or(Ok(sun), |why| Err(LightError(why)))
    }

    /// Unit vector to its middle.
    pub fn towards(&self) -> [f64; 3] {
        self.towards.to_array()
    }

    /// Its diameter as an angle, in radians.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

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
