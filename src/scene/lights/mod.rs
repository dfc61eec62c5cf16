//! Lights: what sends light and is no surface. They are not seen and hide nothing; what they send is direct light of a solve.

mod point_light;
mod seen;
mod sky;
mod sun;

use glam::DVec3;
use serde::{Deserialize, Serialize};

pub use point_light::PointLight;
pub(crate) use seen::Seen;
pub use sky::Sky;
pub use sun::Sun;

use super::{Material, SceneError};

/// Light that comes from no surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Its name in the input, not empty.
    pub name: String,
    /// How much it sends per channel, 0 or more; what that measures is said by its shape.
    pub strength: Vec<f64>,
    /// What kind of light it is, and where.
    pub shape: LightShape,
}

/// Kinds of light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum LightShape {
    /// From a point. Strength: radiant intensity in W/sr, where its distribution is 1.
    Point(PointLight),
    /// From so far that it is parallel, or fills a small disc of the sky. Strength: irradiance in W/m^2 of what faces it.
    Sun(Sun),
    /// From all directions. Strength: irradiance in W/m^2 of the ground under the whole sky.
    Sky(Sky),
}

impl Light {
    /// Whether any channel sends light.
    pub fn is_on(&self) -> bool {
        self.strength.iter().any(|&strength| strength > 0.0)
    }

    /// The strength in the brightest channel.
    pub(crate) fn brightest(&self) -> f64 {
        self.strength.iter().copied().fold(0.0, f64::max)
    }

    pub(super) fn validate(&self, channels: usize) -> Result<(), SceneError> {
        let bad = |reason: String| Err(SceneError::BadLight { name: self.name.clone(), reason });
        if self.name.is_empty() {
            return bad("it has no name".to_owned());
        }
        if self.strength.len() != channels {
            return bad(format!("it has {} channels, the scene {channels}", self.strength.len()));
        }
        if let Some(strength) = self.strength.iter().find(|s| !(0.0..=Material::MOST_RADIOSITY).contains(*s)) {
            return bad(format!("strength {strength} is negative or not finite"));
        }
        let wrong = match &self.shape {
            LightShape::Point(light) => light.wrong(),
            LightShape::Sun(sun) => sun.wrong(),
            LightShape::Sky(sky) => sky.wrong(),
        };
        wrong.map_or(Ok(()), |reason| bad(reason.to_owned()))
    }
}

impl LightShape {
    /// How the light is seen from a point; of a sun that is a disc, its point number `u`, `v` in the unit square. `None` for a sky, and where it sends
    /// nothing.
    pub(crate) fn seen_from(&self, point: DVec3, [u, v]: [f64; 2]) -> Option<Seen> {
        match self {
            Self::Point(light) => light.seen_from(point),
            Self::Sun(sun) => {
                let towards = sun.sampled_direction(u, v);
                Some(Seen { towards, distance: f64::INFINITY, irradiance: sun.towards.dot(towards).recip() })
            }
            Self::Sky(_) => None,
        }
    }

    /// Whether all points see it in one direction, so that one ray tells whether they see it.
    pub(crate) fn is_point(&self) -> bool {
        match self {
            Self::Point(_) => true,
            Self::Sun(sun) => sun.diameter == 0.0,
            Self::Sky(_) => false,
        }
    }
}
