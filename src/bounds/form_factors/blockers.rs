//! Which parts of a source are certainly visible from a whole receiver, and which are possibly: proofs over the surfaces of the scene.
//!
//! A surface can hide something only if it meets the convex hull of receiver and source, in front of both planes. If none does, all
//! is visible. Each one that does takes its penumbra region away from what is certainly visible, and its umbra from what is possibly.
//! Surfaces in the plane of either end hide nothing, as everywhere. Cost: a descent through the clusters whose boxes are met, and a
//! separation test for each surface below them.

use glam::DVec3;

use super::shadow::{Region, shadow};
use crate::geometry::{Aabb, Clip, ClippedFacet, Facet, clip_to_front, in_front, is_apart};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// So many surfaces in the way are taken into account at most. With so many, nothing is certainly visible.
const MAX_BLOCKERS: usize = 16;

/// With more visible parts than this, nothing is certainly visible.
const MAX_PARTS: usize = 64;

/// Within this part of the size of the scene things touch, as in
/// [`OccluderMesh::contact_tolerance`](crate::visibility::OccluderMesh).
const CONTACT_OF_SIZE: f64 = 1e-12;

/// What a receiver sees of a source.
pub(super) enum Sight {
    /// All of it, from everywhere.
    Whole,
    /// Some of it.
    Partial {
        /// Visible from everywhere.
        certain: Vec<ClippedFacet>,
        /// Everything outside of these is hidden from everywhere.
        possible: Vec<ClippedFacet>,
        /// Whether the shadow of every surface in the way is known: then both approach each other as the receiver gets smaller.
        shadowed: bool,
    },
}

/// What single points see of a source.
pub(super) enum Views {
    /// Each of them sees all of it.
    Whole,
    /// The parts that each point sees, up to the rounding of clips.
    Parts(Vec<Vec<ClippedFacet>>),
    /// There is too much in the way to tell.
    Unknown,
}

/// A point sees a blocker edge-on if it is nearer to the blocker's plane than this part of the blocker's radius.
const EDGE_ON: f64 = 1e-9;

/// What casts a shadow from a point must be lower than the point by this part of its height above the source.
const LEAST_DROP: f64 = 2e-6;

/// The surfaces of a scene, as what may be in the way.
pub(super) struct Blockers<'a> {
    scene: &'a Scene,
    hierarchy: &'a Hierarchy,
    tolerance: f64,
}

impl<'a> Blockers<'a> {
    pub fn new(scene: &'a Scene, hierarchy: &'a Hierarchy) -> Self {
        Self { scene, hierarchy, tolerance: CONTACT_OF_SIZE * scene.bounds().diagonal() }
    }

    /// What all of `receiver` sees of `source`, two surfaces or elements.
    pub fn sight(&self, receiver: NodeId, source: NodeId) -> Sight {
        let plane = |node| self.scene.surface(SurfaceId(self.hierarchy.node(node).surface)).plane;
        let planes = [plane(receiver), plane(source)];
        let (receiver, source) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));

        // Light travels between the parts that are in front of each other.
        let (receiver_part, source_part) = (in_front(&receiver, &source), in_front(&source, &receiver));
        let (Some(receiver_part), Some(source_part)) = (receiver_part, source_part) else { return Sight::Whole };
        let pair = Pair { receiver: &receiver_part.facet(), source: &source_part.facet() };
        let blockers = self.in_the_way(&pair, planes);
        if blockers.is_empty() {
            return Sight::Whole;
        }

        // Take shadows away, one blocker after the other.
        let whole = || vec![ClippedFacet::copy_of(&source)];
        let (mut certain, mut possible) = (whole(), whole());
        let mut shadowed = blockers.len() < MAX_BLOCKERS;
        for blocker in &blockers {
            let Some(shadow) = shadow(pair.receiver.vertices, &source, &blocker.facet(), self.tolerance) else {
                shadowed = false;
                continue;
            };
            let mut lit = Vec::new();
            certain.into_iter().for_each(|part| shadow.penumbra.cut_out(part, &mut lit));
            certain = lit;
            shadowed &= certain.len() <= MAX_PARTS;
            let umbra = shadow
                .umbra
                .and_then(|shadows| shadows.iter().try_fold(ClippedFacet::copy_of(&source), |left, region| region.keep(left)));
            if let Some(umbra) = umbra.filter(|_| possible.len() <= MAX_PARTS) {
                let umbra = Region::inside(&umbra.facet());
                let mut lit = Vec::new();
                possible.into_iter().for_each(|part| umbra.cut_out(part, &mut lit));
                possible = lit;
            }
        }
        if !shadowed {
            certain.clear();
        }
        Sight::Partial { certain, possible, shadowed }
    }

    /// What `points` of `receiver` see of `source`, two surfaces or elements (Nishita, Nakamae 1983).
    pub fn views(&self, receiver: NodeId, source: NodeId, points: &[DVec3]) -> Views {
        let plane = |node| self.scene.surface(SurfaceId(self.hierarchy.node(node).surface)).plane;
        let planes = [plane(receiver), plane(source)];
        let (receiver, source) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));
        let (receiver_part, source_part) = (in_front(&receiver, &source), in_front(&source, &receiver));
        let (Some(receiver_part), Some(source_part)) = (receiver_part, source_part) else { return Views::Whole };
        let blockers = self.in_the_way(&Pair { receiver: &receiver_part.facet(), source: &source_part.facet() }, planes);
        match blockers.len() {
            0 => Views::Whole,
            MAX_BLOCKERS.. => Views::Unknown,
            _ => Views::Parts(points.iter().map(|&x| self.view(x, &source, &blockers)).collect()),
        }
    }

    /// What is left of `source` without the shadows that `blockers` cast from x.
    fn view(&self, x: DVec3, source: &Facet<'_>, blockers: &[ClippedFacet]) -> Vec<ClippedFacet> {
        let mut visible = vec![ClippedFacet::copy_of(source)];
        let height = source.height(x) * (1.0 - LEAST_DROP);
        for blocker in blockers {
            // Only what is lower than x lies between x and the source.
            let lower = match clip_to_front(&blocker.facet(), source.vertices[0] + height * source.normal, -source.normal) {
                Clip::Whole => ClippedFacet::copy_of(&blocker.facet()),
                Clip::Part(part) => part,
                Clip::Nothing => continue,
            };
            if lower.facet().height(x).abs() <= EDGE_ON * blocker.facet().radius {
                continue;
            }
            if let Some(shadow) = shadow(&[x], source, &lower.facet(), 0.0) {
                let mut lit = Vec::new();
                visible.into_iter().for_each(|part| shadow.penumbra.cut_out(part, &mut lit));
                visible = lit;
            }
        }
        visible
    }

    /// The parts of surfaces that meet the hull of the pair: all, or the first [`MAX_BLOCKERS`].
    fn in_the_way(&self, pair: &Pair<'_>, planes: [u32; 2]) -> Vec<ClippedFacet> {
        let around = Aabb::around(pair.receiver.vertices.iter().chain(pair.source.vertices).copied());
        let mut found = Vec::new();
        let mut stack = vec![NodeId::ROOT];
        while let Some(node) = stack.pop() {
            if self.hierarchy.is_cluster(node) {
                let bounds = self.hierarchy.bounds(node);
                let beside =
                    bounds.min.cmpgt(around.max + self.tolerance).any() || bounds.max.cmplt(around.min - self.tolerance).any();
                if !beside && !behind(pair.receiver, bounds, self.tolerance) && !behind(pair.source, bounds, self.tolerance) {
                    stack.extend(self.hierarchy.children(node));
                }
                continue;
            }
            let surface = self.scene.surface(SurfaceId(self.hierarchy.node(node).surface));
            let is_second_side = surface.twin.is_some_and(|twin| twin.0 < self.hierarchy.node(node).surface);
            if planes.contains(&surface.plane) || is_second_side {
                continue;
            }
            let part = in_front(&self.hierarchy.facet(node), pair.receiver)
                .and_then(|part| in_front(&part.facet(), pair.source))
                .filter(|part| !is_apart(pair.receiver.vertices, pair.source.vertices, &part.facet(), self.tolerance));
            found.extend(part);
            if found.len() == MAX_BLOCKERS {
                break;
            }
        }
        found
    }
}

/// A receiver and a source, as far as they are in front of each other.
struct Pair<'a> {
    receiver: &'a Facet<'a>,
    source: &'a Facet<'a>,
}

/// Whether a box is behind the plane of a polygon.
fn behind(front: &Facet<'_>, bounds: &Aabb, tolerance: f64) -> bool {
    front.height(DVec3::select(front.normal.cmpgt(DVec3::ZERO), bounds.max, bounds.min)) <= tolerance
}
