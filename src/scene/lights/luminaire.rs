//! A measured luminaire: its table of intensities, and how it hangs.

use std::f64::consts::TAU;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::seen::is_unit;
use super::{IntensityTable, LightError};

/// Measured intensities about an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Luminaire {
    table: IntensityTable,
    /// Unit vector where the polar angle is 0: straight down, of a luminaire as it is measured.
    axis: DVec3,
    /// Unit vector across, where the azimuth is 0. Azimuths go counter-clockwise as seen from behind, against the axis: from above, if it hangs.
    front: DVec3,
}

impl Luminaire {
    /// A luminaire with the polar angles of its table about `axis`, and its azimuths from where `front` lies, across the axis; both of any length above 0.
    ///
    /// # Errors
    /// Says which of these vectors has no direction, or that they lie along each other.
    pub fn new(table: IntensityTable, axis: [f64; 3], front: [f64; 3]) -> Result<Self, LightError> {
        let unit = |v: DVec3| v.try_normalize().ok_or(LightError("its direction or its front is no vector of a length above 0"));
        let (axis, front) = (unit(axis.into())?, unit(front.into())?);
        let across = front - axis * axis.dot(front);
        if across.length() < 1e-6 {
            return Err(LightError("its front lies along its direction, it must point aside"));
        }
        Ok(Self { table, axis, front: across.normalize() })
    }

    pub(super) fn wrong(&self) -> Option<&'static str> {
        let fits = is_unit(self.axis) && is_unit(self.front) && self.axis.dot(self.front).abs() < 1e-9;
        (!fits).then_some("its axis and front are no unit vectors across each other")
    }

    /// Where the azimuth is a quarter of a turn.
    fn side(&self) -> DVec3 {
        self.front.cross(self.axis)
    }

    pub(super) fn solid_angle(&self) -> f64 {
        self.table.flux()
    }

    /// The intensity in the direction of a unit vector.
    pub(super) fn intensity(&self, direction: DVec3) -> f64 {
        let [along, front, side] = [self.axis, self.front, self.side()].map(|axis| axis.dot(direction));
        // Of atan2, so that directions near the axis keep their digits.
        let polar = front.hypot(side).atan2(along);
        let azimuth = side.atan2(front);
        self.table.at(polar, if azimuth < 0.0 { azimuth + TAU } else { azimuth })
    }

    /// The direction number `u`, `v` in the unit square, even over what is sent.
    pub(super) fn sampled_direction(&self, u: f64, v: f64) -> DVec3 {
        let [polar, azimuth] = self.table.sampled(u, v);
        let ((sin, cos), (sin_azimuth, cos_azimuth)) = (polar.sin_cos(), azimuth.sin_cos());
        (cos * self.axis + sin * (cos_azimuth * self.front + sin_azimuth * self.side())).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hanging_luminaire_has_its_azimuths_counter_clockwise_from_above() {
        let quarters = [0.0, 0.25 * TAU, 0.5 * TAU, 0.75 * TAU, TAU].to_vec();
        let column = |value: f64| [1.0, value, value];
        let values = [column(1.0), column(2.0), column(3.0), column(4.0), column(1.0)].concat();
        let table = IntensityTable::new(vec![0.0, 0.25, 3.0], quarters, values).unwrap();
        // z up: north is x, so east of it, seen from above, is -y.
        let light = Luminaire::new(table, [0.0, 0.0, -1.0], [2.0, 0.0, 5.0]).unwrap();
        for (direction, expected) in
            [(DVec3::NEG_Z, 1.0), (DVec3::X, 1.0), (DVec3::Y, 2.0), (DVec3::NEG_X, 3.0), (DVec3::NEG_Y, 4.0), (DVec3::Z, 0.0)]
        {
            assert!((light.intensity(direction) - expected).abs() < 1e-12, "{direction}: {}", light.intensity(direction));
        }
    }

    #[test]
    fn its_front_points_aside() {
        let table = IntensityTable::new(vec![0.0, 1.0], vec![0.0, TAU], vec![1.0; 4]).unwrap();
        assert!(Luminaire::new(table.clone(), [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]).is_err());
        assert!(Luminaire::new(table, [0.0; 3], [0.0, 0.0, 1.0]).is_err());
    }
}
