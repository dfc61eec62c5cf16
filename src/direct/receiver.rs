//! Where light arrives.

use glam::DVec3;

use crate::scene::Surface;

/// Where light arrives: a point on a surface, or a sensor in space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub point: DVec3,
    /// Unit normal of the side that light arrives at.
    pub normal: DVec3,
    /// The number of the plane that it lies in, [`NO_PLANE`](crate::visibility::NO_PLANE) in space.
    pub plane: u32,
    /// Of the random numbers of its rays.
    pub seed: u64,
}

impl Receiver {
    /// A point on a surface.
    pub fn on(surface: &Surface, point: DVec3, seed: u64) -> Self {
        Self { point, normal: surface.polygon.facet().normal, plane: surface.plane(), seed }
    }
}
