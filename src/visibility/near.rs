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

    /// Calls `visit` for each surface of which `may_meet` says so of its box and of all boxes around it, each given by its centre and half its
    /// extent. In no order that means anything, but always the same.
    pub fn for_each_where(&self, may_meet: impl Fn(DVec3, DVec3) -> bool, mut visit: impl FnMut(SurfaceId)) {
        let Some(tree) = &self.tree else { return };
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let node = &tree.nodes[index as usize];
            let [low, high] = [node.aabb().min, node.aabb().max].map(|corner| DVec3::from(corner.to_array().map(f64::from)));
            if !may_meet(0.5 * (low + high), 0.5 * (high - low)) {
                continue;
            }
            if node.is_leaf() {
                let (first, count) = (node.first_index as usize, node.prim_count as usize);
                tree.primitive_indices[first..first + count].iter().for_each(|&surface| visit(SurfaceId(surface)));
            } else {
                open.extend([node.first_index, node.first_index + 1]);
            }
        }
    }
}
