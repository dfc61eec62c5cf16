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

/// A box in f32 that contains one in f64.
fn tree_box(bounds: &Aabb) -> TreeBox {
    let rounded = |corner: DVec3, outwards: fn(f32) -> f32| Vec3A::from(corner.to_array().map(|x| outwards(x as f32)));
    TreeBox::new(rounded(bounds.min, f32::next_down), rounded(bounds.max, f32::next_up))
}
