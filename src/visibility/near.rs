//! Which surfaces come near a place: a tree of boxes.

use std::time::Duration;

use ::obvhs::{
    BvhBuildParams,
    aabb::Aabb as TreeBox,
    bvh2::{Bvh2, builder::build_bvh2},
};
use glam::{DVec3, Vec3A};

use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

/// The boxes of all surfaces.
pub(crate) struct SurfaceBoxes {
    /// `None` in a scene without surfaces.
    tree: Option<Bvh2>,
}

impl SurfaceBoxes {
    pub fn of(scene: &Scene) -> Self {
        let boxes: Vec<TreeBox> = scene.surfaces().iter().map(|surface| tree_box(&surface.polygon.bounds())).collect();
        let mut time = Duration::ZERO;
        let tree = (!boxes.is_empty()).then(|| build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut time));
        Self { tree }
    }

    /// Calls `visit` for each surface whose box may touch `bounds`, in no order that means anything, but always the same.
    pub fn for_each_near(&self, bounds: &Aabb, mut visit: impl FnMut(SurfaceId)) {
        let Some(tree) = &self.tree else { return };
        tree.aabb_traverse(tree_box(bounds), |tree, leaf| {
            let leaf = &tree.nodes[leaf as usize];
            let (first, count) = (leaf.first_index as usize, leaf.prim_count as usize);
            tree.primitive_indices[first..first + count].iter().for_each(|&surface| visit(SurfaceId(surface)));
            true
        });
    }
}

/// A box in f32 that contains one in f64.
fn tree_box(bounds: &Aabb) -> TreeBox {
    let rounded = |corner: DVec3, outwards: fn(f32) -> f32| Vec3A::from(corner.to_array().map(|x| outwards(x as f32)));
    TreeBox::new(rounded(bounds.min, f32::next_down), rounded(bounds.max, f32::next_up))
}
