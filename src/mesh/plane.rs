//! Coordinates in the plane of a surface.

use glam::{DVec2, DVec3};

use crate::geometry::Frame;
use crate::scene::{Scene, SurfaceId};

/// Right-handed coordinates in the plane of a surface, in metres from its centroid: counter-clockwise is as seen from the front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    frame: Frame,
    origin: DVec3,
}

impl Plane {
    pub fn of(scene: &Scene, surface: SurfaceId) -> Self {
        let facet = scene.surface(surface).polygon.facet();
        Self { frame: Frame::around(facet.normal), origin: facet.centroid }
    }

    pub fn to_plane(self, point: DVec3) -> DVec2 {
        let from = point - self.origin;
        DVec2::new(self.frame.tangent.dot(from), self.frame.bitangent.dot(from))
    }

    pub fn to_space(self, at: DVec2) -> DVec3 {
        self.origin + self.frame.to_world(at.extend(0.0))
    }
}
