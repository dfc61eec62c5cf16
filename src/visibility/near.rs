//! Which surfaces come near a place.

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
}
