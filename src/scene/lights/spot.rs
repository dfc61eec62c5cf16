//! Light within a cone.
//!
//! Within the inner cone the intensity is 1, outside of the outer one 0, and between them `((cos a - cos o) / (cos i - cos o))^2` at the angle `a` to the
//! axis, with `i` and `o` the angles of the cones: the falloff that glTF recommends (Khronos, KHR_lights_punctual, "Inner and Outer Cone Angles").

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::LightError;
use super::seen::is_unit;
use crate::geometry::Frame;

/// A cone of light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    /// Unit vector in the middle of the light.
    axis: DVec3,
    /// Angles to the axis in radians.
    inner: f64,
    outer: f64,
}

impl Spot {
    /// A cone about `axis`, of any length above 0, with the angles to it in radians: `0 <= inner <= outer <= pi / 2`, `outer` above 0.
    ///
    /// # Errors
    /// Says which of them is out of range.
    pub fn new(axis: [f64; 3], inner: f64, outer: f64) -> Result<Self, LightError> {
        let axis = DVec3::from(axis).try_normalize().ok_or(LightError("its direction is no vector of a length above 0"))?;
        let spot = Self { axis, inner, outer };
        spot.wrong().map_or(Ok(spot), |why| Err(LightError(why)))
    }

    pub(super) fn wrong(&self) -> Option<&'static str> {
        if !is_unit(self.axis) {
            return Some("its axis is no unit vector");
        }
        let fits = 0.0 <= self.inner && self.inner <= self.outer && 0.0 < self.outer && self.outer <= FRAC_PI_2 + 1e-12;
        (!fits).then_some("its cones are not 0 <= inner <= outer <= 90 degrees, with outer above 0")
    }

    /// The intensity in the direction of a unit vector.
    pub(super) fn intensity(&self, direction: DVec3) -> f64 {
        let (cos, inner, outer) = (self.axis.dot(direction), self.inner.cos(), self.outer.cos());
        match cos {
            _ if cos >= inner => 1.0,
            _ if cos <= outer => 0.0,
            _ => ((cos - outer) / (inner - outer)).powi(2),
        }
    }

    /// The integrals of the intensity over the inner cone and over what is around it, in sr.
    fn parts(&self) -> [f64; 2] {
        // 1 - cos i without cancellation.
        let within = TAU * 2.0 * (0.5 * self.inner).sin().powi(2);
        let around = TAU / 3.0 * (self.inner.cos() - self.outer.cos());
        [within, around]
    }

    pub(super) fn solid_angle(&self) -> f64 {
        let [within, around] = self.parts();
        within + around
    }

    /// The direction number `u`, `v` in the unit square, even over what is sent.
    pub(super) fn sampled_direction(&self, u: f64, v: f64) -> DVec3 {
        let [within, around] = self.parts();
        let (sent, inner, outer) = (u * (within + around), self.inner.cos(), self.outer.cos());
        let cos = if sent < within {
            1.0 - sent / TAU
        } else {
            // The light of the falloff below t is as t^3.
            outer + (inner - outer) * ((within + around - sent) / around).cbrt()
        };
        let (r, (sin_azimuth, cos_azimuth)) = ((1.0 - cos * cos).max(0.0).sqrt(), (2.0 * PI * v).sin_cos());
        Frame::around(self.axis).to_world(DVec3::new(r * cos_azimuth, r * sin_azimuth, cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// KHR_lights_punctual: lightAngleScale, lightAngleOffset, and the square of what is left of them.
    #[test]
    fn the_falloff_is_that_of_gltf() {
        let spot = Spot::new([0.0, 0.0, -2.0], 0.4, 0.9).unwrap();
        let scale = 1.0 / (0.4_f64.cos() - 0.9_f64.cos());
        let offset = -0.9_f64.cos() * scale;
        for angle in [0.0, 0.2, 0.4, 0.5, 0.7, 0.9, 1.2, 3.0] {
            let direction = DVec3::new(f64::sin(angle), 0.0, -f64::cos(angle));
            let expected = (f64::cos(angle) * scale + offset).clamp(0.0, 1.0).powi(2);
            assert!((spot.intensity(direction) - expected).abs() < 1e-14, "{angle}");
        }
    }

    #[test]
    fn an_even_cone_has_its_solid_angle() {
        let half = Spot::new([0.0, 1.0, 0.0], FRAC_PI_2, FRAC_PI_2).unwrap();
        assert!((half.solid_angle() - TAU).abs() < 1e-14);
        let narrow = Spot::new([0.0, 1.0, 0.0], 1e-6, 1e-6).unwrap();
        assert!((narrow.solid_angle() / (PI * 1e-12) - 1.0).abs() < 1e-12);
        // Without an inner cone all is falloff.
        let soft = Spot::new([0.0, 1.0, 0.0], 0.0, FRAC_PI_2).unwrap();
        assert!((soft.solid_angle() - TAU / 3.0).abs() < 1e-14);
    }

    #[test]
    fn cones_have_a_range() {
        for (axis, inner, outer) in [([0.0; 3], 0.1, 0.2), ([1.0, 0.0, 0.0], 0.3, 0.2), ([1.0, 0.0, 0.0], -0.1, 0.2)] {
            assert!(Spot::new(axis, inner, outer).is_err());
        }
        let axis = [1.0, 0.0, 0.0];
        assert!(
            Spot::new(axis, 0.0, 0.0).is_err() && Spot::new(axis, 0.0, 1.6).is_err() && Spot::new(axis, f64::NAN, 1.0).is_err()
        );
        assert!(Spot::new([f64::NAN, 0.0, 0.0], 0.1, 0.2).is_err() && Spot::new([f64::INFINITY, 0.0, 0.0], 0.1, 0.2).is_err());
    }
}
