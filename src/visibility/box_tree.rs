//! A tree of boxes: which of many come near a place, or reach between some planes.

use std::time::Duration;

use ::obvhs::{
    BvhBuildParams,
    aabb::Aabb as TreeBox,
    bvh2::{Bvh2, builder::build_bvh2, node::Bvh2Node},
};
use glam::{DVec3, Vec3A};

use crate::geometry::Aabb;

/// Boxes by number.
pub(crate) struct BoxTree {
    /// `None` where there is no box.
    tree: Option<Bvh2>,
}

/// The points `p` with `normal . p >= offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace {
    pub normal: DVec3,
    pub offset: f64,
}

impl HalfSpace {
    /// What is in front of the plane through `point`.
    pub fn at(point: DVec3, normal: DVec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// Whether a box lies wholly outside.
    #[inline]
    fn excludes(&self, bounds: &TreeBox) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let highest = DVec3::select(self.normal.cmpgt(DVec3::ZERO), max, min);
        self.normal.dot(highest) < self.offset
    }
}

impl BoxTree {
    /// A tree of boxes, which are numbered in this order.
    pub fn of(boxes: impl Iterator<Item = Aabb>) -> Self {
        let boxes: Vec<TreeBox> = boxes.map(|bounds| tree_box(&bounds)).collect();
        let mut time = Duration::ZERO;
        let tree = (!boxes.is_empty()).then(|| build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut time));
        Self { tree }
    }

    /// Calls `visit` for each box that may touch `bounds`, in no order that means anything, but always the same.
    pub fn for_each_near(&self, bounds: &Aabb, mut visit: impl FnMut(u32)) {
        let Some(tree) = &self.tree else { return };
        tree.aabb_traverse(tree_box(bounds), |tree, leaf| {
            numbers_of(tree, &tree.nodes[leaf as usize]).iter().for_each(|&number| visit(number));
            true
        });
    }

    /// Calls `visit` for each box of which `may_meet` says so, and of all boxes around it, each given by its centre and half its extent, until it
    /// says that this is enough; in an order as above.
    pub fn until_enough_where(&self, may_meet: impl Fn(DVec3, DVec3) -> bool, mut visit: impl FnMut(u32) -> bool) {
        let Some(tree) = &self.tree else { return };
        let mut waiting = Vec::with_capacity(STACK);
        waiting.push(0);
        while let Some(index) = waiting.pop() {
            let node = &tree.nodes[index as usize];
            let [low, high] = [node.aabb().min, node.aabb().max].map(|corner| corner.as_dvec3());
            if !may_meet(0.5 * (low + high), 0.5 * (high - low)) {
                continue;
            }
            if node.is_leaf() {
                if numbers_of(tree, node).iter().any(|&number| visit(number)) {
                    return;
                }
            } else {
                waiting.extend([node.first_index, node.first_index + 1]);
            }
        }
    }

    /// Calls `visit` for each box that may touch `bounds` and lies wholly outside none of the half-spaces, until it says that this is
    /// enough; in an order as above.
    pub fn until_enough_between(&self, bounds: &Aabb, within: &[HalfSpace], mut visit: impl FnMut(u32) -> bool) {
        let Some(tree) = &self.tree else { return };
        let around = tree_box(bounds);
        let mut waiting = Vec::with_capacity(STACK);
        waiting.push(0);
        while let Some(index) = waiting.pop() {
            let node = &tree.nodes[index as usize];
            if !node.aabb().intersect_aabb(&around) || within.iter().any(|half| half.excludes(node.aabb())) {
                continue;
            }
            if node.is_leaf() {
                if numbers_of(tree, node).iter().any(|&number| visit(number)) {
                    return;
                }
            } else {
                waiting.extend([node.first_index, node.first_index + 1]);
            }
        }
    }
}

/// Places for nodes that wait: deeper trees make room for themselves.
const STACK: usize = 64;

/// The boxes of a leaf.
fn numbers_of<'a>(tree: &'a Bvh2, leaf: &Bvh2Node) -> &'a [u32] {
    let first = leaf.first_index as usize;
    &tree.primitive_indices[first..first + leaf.prim_count as usize]
}

/// A box in f32 that contains one in f64.
fn tree_box(bounds: &Aabb) -> TreeBox {
    let rounded = |corner: DVec3, outwards: fn(f32) -> f32| Vec3A::from(corner.to_array().map(|x| outwards(x as f32)));
    TreeBox::new(rounded(bounds.min, f32::next_down), rounded(bounds.max, f32::next_up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    #[test]
    fn nothing_that_reaches_between_the_planes_is_missed() {
        let random = |k: u64| sampling::unit(sampling::hash(k, 3));
        let point = |k: u64| DVec3::new(random(3 * k), random(3 * k + 1), random(3 * k + 2));
        let boxes: Vec<Aabb> = (0..500).map(|k| Aabb::around([point(k), point(k) + 0.1 * point(k + 1000)])).collect();
        let tree = BoxTree::of(boxes.iter().copied());
        let (mut inside, mut all) = (0, 0);
        for k in 0..200 {
            let bounds = Aabb::around([point(2000 + k), point(3000 + k)]);
            let within =
                [0, 1, 2].map(|plane| HalfSpace::at(point(4000 + 3 * k + plane), (point(5000 + 3 * k + plane) - 0.5).normalize()));
            let mut found = vec![0; boxes.len()];
            tree.until_enough_between(&bounds, &within, |number| {
                found[number as usize] += 1;
                false
            });

            // Corners inside of everything prove that a box reaches in.
            assert!(found.iter().all(|&times| times <= 1));
            all += found.iter().sum::<usize>();
            for (number, of) in boxes.iter().enumerate() {
                let corner = |k: u32| DVec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), of.max, of.min);
                let reaches_in = (0..8).map(corner).any(|p| {
                    let is_near = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
                    is_near && within.iter().all(|half| half.normal.dot(p) >= half.offset)
                });
                inside += usize::from(reaches_in);
                assert!(!reaches_in || found[number] == 1);
            }
        }
        // Leaves hold several boxes, of which some are found in vain.
        assert!(inside > 500 && all < 10 * inside, "{inside} reach in, {all} were found");
    }
}
