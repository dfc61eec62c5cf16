//! Which surfaces come near a place.

use glam::DVec3;

use super::box_tree::BoxTree;
use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

/// The boxes of all surfaces.
pub(crate) struct SurfaceBoxes(BoxTree);

impl SurfaceBoxes {
    pub fn of(scene: &Scene) -> Self {
        Self(BoxTree::of(scene.surfaces().iter().map(|surface| surface.polygon.bounds())))
    }

    /// Calls `visit` for each surface whose box may touch `bounds`, in no order that means anything, but always the same.
    pub fn for_each_near(&self, bounds: &Aabb, mut visit: impl FnMut(SurfaceId)) {
        self.0.for_each_near(bounds, |surface| visit(SurfaceId(surface)));
    }

    /// Calls `visit` for each surface of which `may_meet` says so of its box and of all boxes around it, each given by its centre and half its
    /// extent, until it says that this is enough. In no order that means anything, but always the same.
    pub fn until_enough_where(&self, may_meet: impl Fn(DVec3, DVec3) -> bool, mut visit: impl FnMut(SurfaceId) -> bool) {
        self.0.until_enough_where(may_meet, |surface| visit(SurfaceId(surface)));
    }
}
