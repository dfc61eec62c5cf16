//! Light from all directions.
//!
//! A sky is even, or as the CIE has it (CIE S 011/E:2003, ISO 15469:2004, "Spatial distribution of daylight"), with Z the angle to the zenith and X that to the sun:
//!
//! - overcast, the traditional one (type 16): L = L_z (1 + 2 cos Z) / 3;
//! - clear, with little turbidity (type 12): L ~ (1 - exp(-0.32 / cos Z)) (1 + 10 (exp(-3 X) - exp(-3 pi / 2)) + 0.45 cos^2 X).
//!
//! Each is scaled to an irradiance of 1 on the ground: the even one is 1 / pi, for the overcast one L_z = 9 / (7 pi), and the clear one is integrated
//! numerically. Below the horizon is ground, which reflects a part of that irradiance evenly.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::LightError;
use crate::geometry::{Frame, gauss_rule};

/// A sky over the ground, without a sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Said", into = "Said")]
pub struct Sky {
    said: Said,
    /// What the luminance by its formula is multiplied by to have an irradiance of pi on the ground.
    scale: f64,
}

/// What a sky is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Said {
    /// Unit vector to the zenith.
    up: DVec3,
    light: SkyLight,
    /// The part of the irradiance that the ground reflects.
    ground: f64,
}

/// How the light of a sky is spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SkyLight {
    /// Evenly.
    Uniform,
    /// As the traditional overcast sky of the CIE: three times as bright at the zenith as at the horizon.
    Overcast,
    /// As the clear sky of the CIE of low luminance turbidity (type 12), brightest around the sun, whose own light it does not hold.
    Clear {
        /// Vector to the sun, of any length above 0, above the horizon or on it.
        sun: [f64; 3],
    },
}

impl TryFrom<Said> for Sky {
    type Error = LightError;

    fn try_from(said: Said) -> Result<Self, Self::Error> {
        Self::new(said.up.to_array(), said.light, said.ground)
    }
}

impl From<Sky> for Said {
    fn from(sky: Sky) -> Self {
        sky.said
    }
}

impl Sky {
    /// A sky with its zenith in the direction of `up`, of any length above 0. The ground reflects the part `ground`, from 0 to below 1, of the light of this
    /// sky on it, not that of other lights.
    ///
    /// # Errors
    /// Says what is out of range.
    pub fn new(up: [f64; 3], light: SkyLight, ground: f64) -> Result<Self, LightError> {
        let unit = |v: [f64; 3]| DVec3::from(v).try_normalize();
        let up = unit(up).ok_or(LightError("its zenith is no vector of a length above 0"))?;
        if !(0.0..1.0).contains(&ground) {
            return Err(LightError("the reflectance of its ground is not from 0 to below 1"));
        }
        let light = match light {
            SkyLight::Clear { sun } => {
                let sun = unit(sun).ok_or(LightError("the direction of its sun is no vector of a length above 0"))?;
                if sun.dot(up) < -1e-9 {
                    return Err(LightError("its sun is below the horizon"));
                }
                SkyLight::Clear { sun: sun.to_array() }
            }
            other => other,
        };
        let mut sky = Self { said: Said { up, light, ground }, scale: 1.0 };
        sky.scale = sky.scale();
        Ok(sky)
    }

    /// The even sky.
    ///
    /// # Errors
    /// As for [`Sky::new`].
    pub fn uniform(up: [f64; 3]) -> Result<Self, LightError> {
        Self::new(up, SkyLight::Uniform, 0.0)
    }

    /// Unit vector to the zenith.
    pub fn up(&self) -> [f64; 3] {
        self.said.up.to_array()
    }

    /// How its light is spread.
    pub fn light(&self) -> SkyLight {
        self.said.light
    }

    /// The part of its light on the ground that the ground reflects.
    pub fn ground(&self) -> f64 {
        self.said.ground
    }

    /// Its radiance in a direction, times pi, for each unit of strength.
    pub(crate) fn radiosity(&self, towards: DVec3) -> f64 {
        let cos = self.said.up.dot(towards);
        if cos > 0.0 { self.scale * relative(self.said.light, cos, towards) } else { self.said.ground }
    }

    /// The direction number `u`, `v` in the unit square of the light that comes from sky and ground, with one over its density for each steradian.
    pub(crate) fn sampled_direction(&self, u: f64, v: f64) -> (DVec3, f64) {
        // Even over either half of the sphere. The ground has its share of the light of an even sky.
        let of_sky = 1.0 / (1.0 + self.said.ground);
        let (cos, share) = if u < of_sky { (u / of_sky, of_sky) } else { (-((u - of_sky) / (1.0 - of_sky)), 1.0 - of_sky) };
        let ((sin_azimuth, cos_azimuth), r) = ((TAU * v).sin_cos(), (1.0 - cos * cos).max(0.0).sqrt());
        let direction = Frame::around(self.said.up).to_world(DVec3::new(r * cos_azimuth, r * sin_azimuth, cos));
        (direction, TAU / share)
    }

    /// Makes the irradiance on the ground 1.
    fn scale(&self) -> f64 {
        match self.said.light {
            SkyLight::Uniform => 1.0,
            SkyLight::Overcast => 9.0 / 7.0,
            SkyLight::Clear { sun } => PI / ground_irradiance(self.said.up, self.said.light, sun.into()),
        }
    }
}

/// The luminance by the formula of a sky, in a direction with the cosine `cos` to the zenith, above 0.
fn relative(light: SkyLight, cos: f64, towards: DVec3) -> f64 {
    match light {
        SkyLight::Uniform => 1.0,
        SkyLight::Overcast => (1.0 + 2.0 * cos) / 3.0,
        SkyLight::Clear { sun } => {
            let to_sun = DVec3::from(sun).dot(towards).clamp(-1.0, 1.0);
            gradation(cos) * indicatrix(to_sun)
        }
    }
}

/// How a clear sky fades from the horizon to the zenith: phi(Z), with a = -1 and b = -0.32.
fn gradation(cos: f64) -> f64 {
    -libm::expm1(-0.32 / cos)
}

/// How it fades away from the sun: f(X), with c = 10, d = -3 and e = 0.45.
fn indicatrix(cos: f64) -> f64 {
    1.0 + 10.0 * (libm::exp(-3.0 * libm::acos(cos)) - libm::exp(-3.0 * FRAC_PI_2)) + 0.45 * cos * cos
}

/// The irradiance on the ground under a clear sky by its formula: over bands of the cosine, and over half of the azimuths, since it is the same on either
/// side of the sun.
fn ground_irradiance(up: DVec3, light: SkyLight, sun: DVec3) -> f64 {
    const BANDS: usize = 8;
    const AZIMUTHS: usize = 256;
    let across = (sun - up * up.dot(sun)).try_normalize().unwrap_or(Frame::around(up).tangent);
    let side = up.cross(across);
    let mut sum = 0.0;
    for band in 0..BANDS {
        for &(at, weight) in gauss_rule(32) {
            let cos = (band as f64 + at) / BANDS as f64;
            let r = (1.0 - cos * cos).sqrt();
            let ring: f64 = (0..AZIMUTHS)
                .map(|azimuth| {
                    let (sin, cos_azimuth) = (PI * (azimuth as f64 + 0.5) / AZIMUTHS as f64).sin_cos();
                    relative(light, cos, cos * up + r * (cos_azimuth * across + sin * side))
                })
                .sum();
            sum += weight * cos * ring;
        }
    }
    sum * TAU / (BANDS * AZIMUTHS) as f64
}

#[cfg(test)]
mod tests {
    use super::super::point_light::tests::over_the_sphere;
    use super::*;

    fn skies() -> Vec<Sky> {
        let up = [0.48, 0.6, 0.64];
        let suns = [up, [0.8, 0.0, -0.6], [1.0, 1.0, 1.0]];
        let clear = suns.map(|sun| SkyLight::Clear { sun });
        let lights = [SkyLight::Uniform, SkyLight::Overcast].into_iter().chain(clear);
        lights.flat_map(|light| [0.0, 0.25].map(|ground| Sky::new(up, light, ground).unwrap())).collect()
    }

    #[test]
    fn the_irradiance_on_the_ground_is_the_strength() {
        for sky in skies() {
            let found = over_the_sphere(|direction| sky.radiosity(direction) * sky.said.up.dot(direction).max(0.0)) / PI;
            assert!((found - 1.0).abs() < 1e-4, "{sky:?}: {found}");
            // From below comes what the ground reflects.
            let below = over_the_sphere(|direction| sky.radiosity(direction) * (-sky.said.up.dot(direction)).max(0.0)) / PI;
            assert!((below - sky.said.ground).abs() < 1e-3, "{sky:?}: {below}");
        }
    }

    #[test]
    fn directions_are_drawn_with_their_densities() {
        // A multiple of 5: the ground's share of the square, a fifth, ends between samples.
        const SIDE: usize = 300;
        for sky in skies() {
            let mut sums = [0.0; 3];
            for (i, j) in (0..SIDE * SIDE).map(|k| (k / SIDE, k % SIDE)) {
                let unit = |k: usize| (k as f64 + 0.5) / SIDE as f64;
                let (direction, weight) = sky.sampled_direction(unit(i), unit(j));
                let cos = sky.said.up.dot(direction);
                let brought = sky.radiosity(direction) * weight / (SIDE * SIDE) as f64 / PI;
                sums[0] += brought * cos.max(0.0);
                sums[1] += brought * (-cos).max(0.0);
                sums[2] += brought * direction.x;
            }
            let expected = over_the_sphere(|direction| sky.radiosity(direction) * direction.x) / PI;
            assert!((sums[0] - 1.0).abs() < 5e-3 && (sums[1] - sky.said.ground).abs() < 5e-3, "{sky:?}: {sums:?}");
            assert!((sums[2] - expected).abs() < 1e-2, "{sky:?}: {sums:?}, {expected}");
        }
    }

    /// CIE S 011: an overcast sky is three times as bright at the zenith as at the horizon, and L_z = 9 / (7 pi) of the irradiance.
    #[test]
    fn skies_are_those_of_the_cie() {
        let overcast = Sky::new([0.0, 0.0, 1.0], SkyLight::Overcast, 0.0).unwrap();
        assert!((overcast.radiosity(DVec3::Z) - 9.0 / 7.0).abs() < 1e-15);
        assert!((overcast.radiosity(DVec3::new(1.0, 0.0, 1e-12)) - 3.0 / 7.0).abs() < 1e-11);
        assert_eq!(overcast.radiosity(DVec3::NEG_Z), 0.0);

        // The element of the sky at 45 degrees opposite of a sun at 30 degrees: the Python package colour-science, sky_luminance_distribution_CIE2003(12, ...).
        let at = |zenith: f64, azimuth: f64| {
            let ((sin, cos), (across, along)) = (zenith.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
            [sin * along, sin * across, cos]
        };
        let clear = Sky::new([0.0, 0.0, 1.0], SkyLight::Clear { sun: at(30.0, 0.0) }, 0.0).unwrap();
        let ratio = clear.radiosity(at(45.0, 180.0).into()) / clear.radiosity(DVec3::Z);
        assert!((ratio - 0.454_452_4).abs() < 1e-7, "{ratio}");
    }

    #[test]
    fn what_makes_no_sky_is_refused_also_where_it_is_read_back() {
        let sky = |up, light, ground| Sky::new(up, light, ground).is_ok();
        let z = [0.0, 0.0, 2.0];
        assert!(sky(z, SkyLight::Uniform, 0.99) && sky(z, SkyLight::Clear { sun: [1.0, 0.0, 0.0] }, 0.0));
        assert!(!sky([0.0; 3], SkyLight::Uniform, 0.0) && !sky(z, SkyLight::Uniform, 1.0) && !sky(z, SkyLight::Uniform, f64::NAN));
        assert!(!sky(z, SkyLight::Clear { sun: [1.0, 0.0, -0.1] }, 0.0) && !sky(z, SkyLight::Clear { sun: [0.0; 3] }, 0.0));
        let clear = Sky::new(z, SkyLight::Clear { sun: [1.0, 2.0, 3.0] }, 0.25).unwrap();
        let text = serde_json::to_string(&clear).unwrap();
        assert_eq!(serde_json::from_str::<Sky>(&text).unwrap(), clear);
        assert!(serde_json::from_str::<Sky>(&text.replace("0.25", "-0.25")).is_err());
    }
}
