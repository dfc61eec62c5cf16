//! obvhs, in pure Rust: its trees find candidates, the test of triangles is ours.
//!
//! A probe passes through a triangle by the signs of three edge volumes in f32 (as in `brute_force`), each computed
//! from its edge alone, so that triangles that share an edge leave no gap between them. The trees' boxes are made larger by what
//! their own f32 arithmetic may lose.

use std::time::Duration;

use ::obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2, reinsertion::ReinsertionOptimizer},
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh},
    ploc::PlocBuilder,
    ray::{Ray as TreeRay, RayHit},
};
use glam::Vec3A;

use super::{
    Hit, OccluderMesh, Ray, Segment, Visibility,
    occluders::{HALF_SIDE, Probe, Question, RayFrame, Sides},
};

/// By how much boxes are enlarged on each side, in the frame: 4e-7 of its size. The slab test of the trees rounds each
/// distance a few times, to 2^-24 of the size each, and bends directions by up to 1.2e-7.
const PADDING: f32 = 8e-7 * HALF_SIDE as f32;

/// Which tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tree {
    /// Binary: one box per child.
    Bvh2,
    /// Eight-way, with boxes of 8 bits per coordinate (Ylitie et al. 2017).
    CwBvh,
}

enum Built {
    Nothing,
    Bvh2(Bvh2),
    CwBvh(CwBvh),
}

/// All per-triangle data is in the order of the tree's leaves.
pub(super) struct Obvhs {
    tree: Built,
    frame: RayFrame,
    corners: Vec<[Vec3A; 3]>,
    sides: Sides,
    surfaces: Vec<u32>,
}

/// What `obvhs::cwbvh::builder::build_cwbvh` makes, without its test of the tree in debug builds: that allows quantized boxes to
/// stand out of their parents by 1e-5 in absolute terms, less than a rounding at [`HALF_SIDE`], and panics.
fn wide_tree(boxes: &[Aabb], parameters: BvhBuildParams) -> CwBvh {
    let BvhBuildParams { ploc_search_distance, sort_precision, search_depth_threshold, .. } = parameters;
    let indices = (0..boxes.len() as u32).collect();
    let mut narrow =
        PlocBuilder::with_capacity(boxes.len()).build(ploc_search_distance, boxes, indices, sort_precision, search_depth_threshold);
    ReinsertionOptimizer::default().run(&mut narrow, parameters.reinsertion_batch_ratio, None);
    bvh2_to_cwbvh(&narrow, parameters.max_prims_per_leaf.clamp(1, 3), true, false)
}

impl Obvhs {
    pub(super) fn new(mesh: &OccluderMesh, tree: Tree) -> Self {
        let frame = RayFrame::new(mesh);
        let sides = Sides::new(mesh, &frame);
        let corners: Vec<[Vec3A; 3]> =
            mesh.triangles.iter().map(|t| t.map(|v| Vec3A::from(frame.point(mesh.vertices[v as usize]).as_vec3()))).collect();

        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|[a, b, c]| Aabb::new(a.min(*b).min(*c) - Vec3A::splat(PADDING), a.max(*b).max(*c) + Vec3A::splat(PADDING)))
            .collect();
        let parameters = BvhBuildParams::medium_build();
        let (tree, order) = match tree {
            _ if boxes.is_empty() => (Built::Nothing, Vec::new()),
            Tree::Bvh2 => {
                let mut time = Duration::ZERO;
                let mut bvh = build_bvh2(&boxes, parameters, &mut time);
                let order = std::mem::take(&mut bvh.primitive_indices);
                (Built::Bvh2(bvh), order)
            }
            Tree::CwBvh => {
                let mut bvh = wide_tree(&boxes, parameters);
                let order = std::mem::take(&mut bvh.primitive_indices);
                (Built::CwBvh(bvh), order)
            }
        };

        Self {
            tree,
            frame,
            corners: order.iter().map(|&k| corners[k as usize]).collect(),
            sides: sides.reordered(&order),
            surfaces: order.iter().map(|&k| mesh.surfaces[k as usize]).collect(),
        }
    }

    fn is_blocked(&self, probe: &Probe) -> bool {
        let (origin, direction) = (Vec3A::from(probe.origin), Vec3A::from(probe.direction));
        let test = |_: &TreeRay, k: usize| {
            if passes(&self.corners[k], origin, direction) && self.sides.blocks(k, probe) { 0.0 } else { f32::INFINITY }
        };
        let (ray, _) = tree_ray(origin, direction);
        match &self.tree {
            Built::Nothing => false,
            Built::Bvh2(bvh) => !bvh.ray_traverse_miss(ray, test),
            Built::CwBvh(bvh) => !bvh.ray_traverse_miss(ray, test),
        }
    }

    fn first_blocking(&self, probe: &Probe) -> Option<usize> {
        // The tree prunes by the f32 distance; which triangle is first is decided by the f64 distance, then by order.
        let (origin, direction) = (Vec3A::from(probe.origin), Vec3A::from(probe.direction));
        let (ray, length) = tree_ray(origin, direction);
        let mut first: Option<(f64, usize)> = None;
        let test = |_: &TreeRay, k: usize| {
            if !passes(&self.corners[k], origin, direction) || !self.sides.blocks(k, probe) {
                return f32::INFINITY;
            }
            let crossing = self.sides.crossing(k, probe);
            if first.is_some_and(|(best, index)| (best, index) <= (crossing, k)) {
                return f32::INFINITY;
            }
            first = Some((crossing, k));
            ((crossing - probe.start) / (probe.end - probe.start)) as f32 * length
        };
        let mut hit = RayHit::none();
        match &self.tree {
            Built::Nothing => false,
            Built::Bvh2(bvh) => bvh.ray_traverse(ray, &mut hit, test),
            Built::CwBvh(bvh) => bvh.ray_traverse(ray, &mut hit, test),
        };
        first.map(|(_, k)| k)
    }
}

/// The ray for the tree, with a direction of length about 1, and the length that it was divided by. No component is -0: the tree
/// would take its inverse for negative and the component for positive.
fn tree_ray(origin: Vec3A, direction: Vec3A) -> (TreeRay, f32) {
    let length = direction.abs().max_element();
    (TreeRay::new(origin, direction / length + Vec3A::ZERO, 0.0, length * 1.000_01), length)
}

/// Whether the line through `origin` passes the edges of a triangle all on the same side. At vertices, where many triangles meet,
/// one rounding of the sum is allowed, as in Embree.
#[inline]
fn passes(corners: &[Vec3A; 3], origin: Vec3A, direction: Vec3A) -> bool {
    let [a, b, c] = corners.map(|corner| corner - origin);
    let volume = |p: Vec3A, q: Vec3A| (q - p).cross(q + p).dot(direction);
    let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
    let rounding = f32::EPSILON * (u + v + w).abs();
    u.min(v).min(w) >= -rounding || u.max(v).max(w) <= rounding
}

impl Visibility for Obvhs {
    fn description(&self) -> String {
        match self.tree {
            Built::Bvh2(_) => "obvhs 0.4 (bvh2)".to_owned(),
            Built::Nothing | Built::CwBvh(_) => "obvhs 0.4 (cwbvh)".to_owned(),
        }
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        for (segment, occluded) in segments.iter().zip(occluded) {
            *occluded = match self.frame.segment(segment) {
                Question::Answered(answer) => answer,
                Question::Open(probe) => self.is_blocked(&probe),
            };
        }
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.frame.ray(ray).and_then(|(probe, length)| {
                let k = self.first_blocking(&probe)?;
                Some(self.sides.hit(k, self.surfaces[k], &probe, length))
            });
        }
    }
}
