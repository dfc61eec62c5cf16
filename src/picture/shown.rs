//! What a pixel shows of the light at a place.

use std::f64::consts::PI;

use glam::DVec3;

use crate::scene::{Material, Scene};

/// What a pixel shows of the light at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// The radiance L = B / pi.
    Radiance,
    /// The irradiance H = (B - E) / rho, over pi; 0 where nothing is reflected, since B says nothing of it there.
    Irradiance,
}

impl Shown {
    /// The number of a pixel for a radiosity.
    pub fn of(self, material: &Material, channel: usize, radiosity: f64) -> f64 {
        match self {
            Self::Radiance => radiosity / PI,
            Self::Irradiance => self.of_difference(material, channel, radiosity - material.exitance[channel]).max(0.0),
        }
    }

    /// Adds `share` of what a pixel shows of the sky in a direction.
    pub fn add_sky(self, scene: &Scene, direction: DVec3, share: f64, pixel: &mut [f32]) {
        if self == Self::Radiance && scene.has_sky() {
            let mut radiosity = vec![0.0; pixel.len()];
            scene.add_sky_radiosity(direction, share / PI, &mut radiosity);
            pixel.iter_mut().zip(radiosity).for_each(|(pixel, radiance)| *pixel += radiance as f32);
        }
    }

    /// What a difference of radiosities makes of it.
    pub fn of_difference(self, material: &Material, channel: usize, difference: f64) -> f64 {
        match self {
            Self::Radiance => difference / PI,
            Self::Irradiance => match material.reflectance[channel] {
                rho if rho > 0.0 => difference / (rho * PI),
                _ => 0.0,
            },
        }
    }
}
