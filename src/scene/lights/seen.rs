//! How lights are seen.

use glam::DVec3;

/// How a light is seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    /// Unit vector to it.
    pub towards: DVec3,
    /// In metres; infinite for a sun.
    pub distance: f64,
    /// The irradiance of what faces it, if nothing is in between, for each unit of strength.
    pub irradiance: f64,
}

/// Whether a direction is a unit vector, but for rounding.
pub(super) fn is_unit(direction: DVec3) -> bool {
    (direction.length() - 1.0).abs() < 1e-9
}
