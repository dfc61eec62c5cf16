//! Lights at a point.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::seen::Seen;
use super::{Luminaire, Spot};

/// From nearer than this, in metres, a light is seen as from there: no lamp is so small, and irradiances stay finite.
const NEAREST: f64 = 1e-6;

/// A light at a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointLight {
    /// Where it is.
    pub(crate) position: DVec3,
    /// What it sends in each direction, for each unit of strength.
    pub(crate) distribution: Distribution,
}

/// What a light at a point sends in each direction, as a factor of its strength.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Distribution {
    /// The same in all directions: 1.
    Uniform,
    /// Within a cone.
    Spot(Spot),
    /// As it was measured.
    Luminaire(Luminaire),
}

impl PointLight {
    /// A light that sends the same in all directions, at a position in metres.
    pub fn uniform(position: [f64; 3]) -> Self {
        Self::new(position, Distribution::Uniform)
    }

    /// A light at a position in metres.
    pub fn new(position: [f64; 3], distribution: Distribution) -> Self {
        Self { position: position.into(), distribution }
    }

    /// Where it is, in metres.
    pub fn position(&self) -> [f64; 3] {
        self.position.to_array()
    }

    /// What it sends in each direction.
    pub fn distribution(&self) -> &Distribution {
        &self.distribution
    }

    /// All that it sends, in sr: the flux in W for each W/sr of strength.
    pub fn solid_angle(&self) -> f64 {
        match &self.distribution {
            Distribution::Uniform => 4.0 * PI,
            Distribution::Spot(spot) => spot.solid_angle(),
            Distribution::Luminaire(luminaire) => luminaire.solid_angle(),
        }
    }

    pub(super) fn wrong(&self) -> Option<&'static str> {
        if !self.position.is_finite() {
            return Some("its position is not finite");
        }
        match &self.distribution {
            Distribution::Uniform => None,
            Distribution::Spot(spot) => spot.wrong(),
            Distribution::Luminaire(luminaire) => luminaire.wrong(),
        }
    }

    /// The intensity in the direction of a unit vector, for each unit of strength.
    pub(crate) fn intensity(&self, direction: DVec3) -> f64 {
        match &self.distribution {
            Distribution::Uniform => 1.0,
            Distribution::Spot(spot) => spot.intensity(direction),
            Distribution::Luminaire(luminaire) => luminaire.intensity(direction),
        }
    }

    /// How it is seen from a point; `None` from where it is, and where it sends nothing.
    pub(super) fn seen_from(&self, point: DVec3) -> Option<Seen> {
        let to = self.position - point;
        let distance = to.length();
        if distance == 0.0 {
            return None;
        }
        let towards = to / distance;
        let intensity = self.intensity(-towards);
        (intensity > 0.0).then(|| Seen { towards, distance, irradiance: intensity * distance.max(NEAREST).powi(-2) })
    }

    /// The direction of the light number `u`, `v` in the unit square, even over what it sends, and all of that, in sr for each unit of strength.
    pub(crate) fn sampled_direction(&self, u: f64, v: f64) -> (DVec3, f64) {
        let direction = match &self.distribution {
            Distribution::Uniform => {
                let (z, (sin, cos)) = (1.0 - 2.0 * u, (TAU * v).sin_cos());
                let r = (1.0 - z * z).max(0.0).sqrt();
                DVec3::new(r * cos, r * sin, z)
            }
            Distribution::Spot(spot) => spot.sampled_direction(u, v),
            Distribution::Luminaire(luminaire) => luminaire.sampled_direction(u, v),
        };
        (direction, self.solid_angle())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::IntensityTable;

    /// All distributions, each about a slanting axis.
    fn lights() -> Vec<PointLight> {
        let axis = [0.36, -0.48, 0.8];
        let table = |polar: &[f64], azimuths: &[f64], values: &[f64]| {
            let of = |degrees: &[f64]| degrees.iter().map(|angle| angle.to_radians()).collect();
            let table = IntensityTable::new(of(polar), of(azimuths), values.to_vec()).unwrap();
            Distribution::Luminaire(Luminaire::new(table, axis, [0.8, 0.6, 0.0]).unwrap())
        };
        let distributions = [
            Distribution::Uniform,
            Distribution::Spot(Spot::new(axis, 0.3, 0.7).unwrap()),
            Distribution::Spot(Spot::new(axis, 0.0, 1.5).unwrap()),
            table(&[0.0, 30.0, 90.0], &[0.0, 360.0], &[1.0, 0.5, 0.0, 1.0, 0.5, 0.0]),
            table(&[0.0, 60.0, 180.0], &[0.0, 90.0, 360.0], &[0.4, 1.0, 0.0, 0.4, 0.1, 0.0, 0.4, 1.0, 0.0]),
            table(&[90.0, 120.0, 180.0], &[0.0, 180.0, 360.0], &[0.3, 1.0, 0.2, 0.0, 0.0, 0.2, 0.3, 1.0, 0.2]),
        ];
        distributions.into_iter().map(|distribution| PointLight::new([1.0, 2.0, 3.0], distribution)).collect()
    }

    /// The integral of `f` over all directions, on a grid.
    pub fn over_the_sphere(f: impl Fn(DVec3) -> f64) -> f64 {
        const BANDS: usize = 1000;
        let mut sum = 0.0;
        for band in 0..BANDS {
            let z = 1.0 - (2.0 * band as f64 + 1.0) / BANDS as f64;
            for step in 0..BANDS {
                let (sin, cos) = (TAU * (step as f64 + 0.5) / BANDS as f64).sin_cos();
                let r = (1.0 - z * z).sqrt();
                sum += f(DVec3::new(r * cos, r * sin, z));
            }
        }
        sum * 4.0 * PI / (BANDS * BANDS) as f64
    }

    #[test]
    fn the_whole_is_the_integral_over_all_directions() {
        for light in lights() {
            let found = over_the_sphere(|direction| light.intensity(direction));
            assert!((found / light.solid_angle() - 1.0).abs() < 2e-3, "{light:?}: {found} {}", light.solid_angle());
        }
    }

    /// Directions that are even over what is sent have the moments that what is sent has.
    #[test]
    fn directions_are_even_over_what_is_sent() {
        const SIDE: usize = 400;
        for light in lights() {
            let parts: [&dyn Fn(DVec3) -> f64; 5] =
                [&|d| d.x, &|d| d.y, &|d| d.z, &|d| d.x * d.y, &|d| if d.z > 0.6 && d.x > 0.0 { 1.0 } else { 0.0 }];
            for (number, part) in parts.into_iter().enumerate() {
                let expected = over_the_sphere(|direction| part(direction) * light.intensity(direction));
                let mut sum = 0.0;
                for (i, j) in (0..SIDE * SIDE).map(|k| (k / SIDE, k % SIDE)) {
                    let unit = |k: usize| (k as f64 + 0.5) / SIDE as f64;
                    let (direction, weight) = light.sampled_direction(unit(i), unit(j));
                    assert!((direction.length() - 1.0).abs() < 1e-12 && light.intensity(direction) > 0.0);
                    sum += part(direction) * weight;
                }
                let found = sum / (SIDE * SIDE) as f64;
                assert!((found - expected).abs() < 5e-3 * light.solid_angle(), "{light:?}, {number}: {found} {expected}");
            }
        }
    }

    #[test]
    fn light_falls_off_with_the_square_of_the_distance() {
        let light = PointLight::new([0.0, 2.0, 0.0], Distribution::Spot(Spot::new([0.0, -1.0, 0.0], 0.5, 0.6).unwrap()));
        let seen = light.seen_from(DVec3::ZERO).unwrap();
        assert_eq!((seen.towards, seen.distance, seen.irradiance), (DVec3::Y, 2.0, 0.25));
        assert_eq!(light.seen_from(DVec3::new(0.0, 3.0, 0.0)), None);
        assert_eq!(light.seen_from(light.position), None);
        assert_eq!(PointLight::uniform([0.0; 3]).seen_from(DVec3::ZERO), None);
    }
}
