//! Lights: what sends light and is no surface. They are not seen and hide nothing; what they send is direct light of a solve.

mod intensity_table;
mod light_error;
mod luminaire;
mod photometric;
mod point_light;
mod seen;
mod sky;
mod spot;
mod sun;

use glam::DVec3;
use serde::{Deserialize, Serialize};

pub use intensity_table::IntensityTable;
pub use light_error::LightError;
pub use luminaire::Luminaire;
pub use photometric::LUMENS_PER_WATT;
pub(crate) use photometric::luminance;
pub use point_light::{Distribution, PointLight};
pub(crate) use seen::Seen;
pub use sky::{Sky, SkyLight};
pub use spot::Spot;
pub use sun::Sun;

use super::SceneError;

/// Light that comes from no surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Its name in the input, not empty.
    pub name: String,
    /// How much it sends per channel: 0, or from 1e-30 to 1e20; what that measures is said by its shape.
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

/// Below this squares of what it brings vanish in f64, as of exitances; above, what is reflected of it near by might not be told in f32.
const LEAST_STRENGTH: f64 = 1e-30;
const MOST_STRENGTH: f64 = 1e20;

impl Light {
    /// Whether any channel sends light.
    pub fn is_on(&self) -> bool {
        self.strength.iter().any(|&strength| strength > 0.0)
    }

    /// What kind of light it is, in a word or two.
    pub fn kind(&self) -> &'static str {
        match &self.shape {
            LightShape::Point(light) => match light.distribution() {
                Distribution::Uniform => "point",
                Distribution::Spot(_) => "spot",
                Distribution::Luminaire(_) => "ies",
            },
            LightShape::Sun(_) => "sun",
            LightShape::Sky(sky) => match sky.light() {
                SkyLight::Uniform => "uniform sky",
                SkyLight::Overcast => "overcast sky",
                SkyLight::Clear { .. } => "clear sky",
            },
        }
    }

    /// The flux of a light at a point, by channel in W; `None` of suns and skies, which send as much as there is to meet it.
    pub fn flux(&self) -> Option<Vec<f64>> {
        let LightShape::Point(light) = &self.shape else { return None };
        let solid_angle = light.solid_angle();
        Some(self.strength.iter().map(|strength| strength * solid_angle).collect())
    }

    /// The strength in the brightest channel.
    pub(crate) fn brightest(&self) -> f64 {
        self.strength.iter().copied().fold(0.0, f64::max)
    }

    pub(super) fn validate(&self, channels: usize) -> Result<(), SceneError> {
        self.wrong(channels).map_or(Ok(()), |reason| Err(SceneError::BadLight { name: self.name.clone(), reason }))
    }

    /// For what it is no light of a scene of so many channels.
    pub(crate) fn wrong(&self, channels: usize) -> Option<String> {
        if self.name.is_empty() {
            return Some("it has no name".to_owned());
        }
        if self.strength.len() != channels {
            return Some(format!("it has {} channels, the scene {channels}", self.strength.len()));
        }
        let is_in_range = |strength: f64| strength == 0.0 || (LEAST_STRENGTH..=MOST_STRENGTH).contains(&strength);
        if let Some(strength) = self.strength.iter().find(|strength| !is_in_range(**strength)) {
            return Some(format!("strength {strength:e} is neither 0 nor from {LEAST_STRENGTH:e} to {MOST_STRENGTH:e}"));
        }
        let wrong = match &self.shape {
            LightShape::Point(light) => light.wrong(),
            LightShape::Sun(sun) => sun.wrong(),
            // Whatever makes a sky is checked where it is made.
            LightShape::Sky(_) => None,
        };
        wrong.map(str::to_owned)
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
