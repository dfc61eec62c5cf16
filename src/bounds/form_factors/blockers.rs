//! Which parts of a source are certainly visible from a whole receiver, and which are possibly: proofs over the surfaces of the scene.
//!
//! A surface can hide something only if it meets the convex hull of receiver and source, in front of both planes. If none does, all
//! is visible. Each one that does takes its penumbra region away from what is certainly visible, and its umbra from what is possibly.
//! The receiver may be a single point: then both differ by rounding alone. Surfaces in the plane of either end hide nothing, as
//! everywhere, unless they lie over it (see `stacks`). Cost: a descent through the clusters whose boxes are met, and a separation
//! test for each surface below them.

use glam::DVec3;

use super::shadow::{InTheWay, Region};
use crate::bounds::stacks::Stacks;
use crate::geometry::{Aabb, ClippedFacet, Facet, in_front, is_apart};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// So many surfaces in the way are taken into account at most. With so many, nothing is certainly visible.
const MAX_BLOCKERS: usize = 32;

/// With more visible parts than this, nothing is certainly visible.
const MAX_PARTS: usize = 64;

/// Within this part of the size of the scene things touch, as in
/// [`OccluderMesh::contact_tolerance`](crate::visibility::OccluderMesh).
pub(in crate::bounds) const CONTACT_OF_SIZE: f64 = 1e-12;

/// What a receiver sees of a source.
pub(super) enum Sight {
    /// All of it, from everywhere.
    Whole,
    /// What the shadows leave of it.
    Shadowed(Shadows),
}

/// The shadows of all that is in the way between a receiver and a source.
#[derive(Default)]
pub(in crate::bounds) struct Shadows {
    /// Outside of each of these one blocker hides nothing from any point of the receiver.
    penumbras: Vec<Region>,
    /// Parts of the source that are hidden from the whole receiver, each by one blocker.
    umbras: Vec<ClippedFacet>,
    /// The same, a little smaller.
    umbra_regions: Vec<Region>,
    /// Whether one blocker hides all of the source from the whole receiver.
    hide_all: bool,
    /// Whether these are the shadows of all that is in the way.
    is_complete: bool,
}

/// What shadows leave of a part of the source.
pub(in crate::bounds) struct Lit {
    /// Visible from everywhere.
    pub certain: Vec<ClippedFacet>,
    /// Everything outside of these is hidden from everywhere.
    pub possible: Vec<ClippedFacet>,
    /// The parts in penumbra, one for each blocker: all that is hidden from any point is in one of them. `None` if that is not known.
    pub shaded: Option<Vec<ClippedFacet>>,
}

/// What single points see of a source.
pub(super) enum Views {
    /// Each of them sees all of it.
    Whole,
    /// The parts that each point sees, up to rounding.
    Parts(Vec<Vec<ClippedFacet>>),
    /// There is too much in the way to tell.
    Unknown,
}

/// The surfaces of a scene, as what may be in the way.
pub(in crate::bounds) struct Blockers<'a> {
    scene: &'a Scene,
    hierarchy: &'a Hierarchy,
    stacks: Stacks,
    contact: f64,
}

impl<'a> Blockers<'a> {
    pub fn new(scene: &'a Scene, hierarchy: &'a Hierarchy) -> Self {
        Self { scene, hierarchy, stacks: Stacks::find(scene), contact: CONTACT_OF_SIZE * scene.bounds().diagonal() }
    }

    /// Whether no light travels between two surfaces because they lie side by side in one plane.
    pub fn share_a_plane(&self, a: SurfaceId, b: SurfaceId) -> bool {
        self.scene.surface(a).plane == self.scene.surface(b).plane && !self.stacks.are_stacked(a, b)
    }

    /// The polygon of a surface.
    pub fn facet(&self, surface: SurfaceId) -> Facet<'_> {
        self.scene.surface(surface).polygon.facet()
    }

    /// What all of `receiver` sees of `source`, two surfaces or elements, as far as they are in front of each other.
    pub(super) fn sight(&self, receiver: NodeId, source: NodeId) -> Sight {
        let [receiver_surface, source_surface] = [receiver, source].map(|node| SurfaceId(self.hierarchy.node(node).surface));
        let (receiver, source) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));
        let (receiver_part, source_part) = (in_front(&receiver, &source), in_front(&source, &receiver));
        let (Some(receiver_part), Some(source_part)) = (receiver_part, source_part) else { return Sight::Whole };
        let pair = Pair { receiver: &receiver_part.facet(), source: &source_part.facet() };
        self.shadows(&pair, [receiver_surface, source_surface]).map_or(Sight::Whole, Sight::Shadowed)
    }

    /// The shadows that a point of a surface sees on a source; `None` if nothing is in the way.
    pub fn shadows_at(&self, x: DVec3, on: SurfaceId, source: SurfaceId) -> Option<Shadows> {
        let point = point_facet(&x, self.facet(on).normal);
        let part = in_front(&self.facet(source), &point)?;
        self.shadows(&Pair { receiver: &point, source: &part.facet() }, [on, source])
    }

    /// What `points` of `receiver` see of `source`, two surfaces or elements.
    pub(super) fn views(&self, receiver: NodeId, source: NodeId, points: &[DVec3]) -> Views {
        let shadows = match self.sight(receiver, source) {
            Sight::Whole => return Views::Whole,
            Sight::Shadowed(shadows) if !shadows.is_complete => return Views::Unknown,
            Sight::Shadowed(shadows) => shadows,
        };
        drop(shadows);
        let [on, from] = [receiver, source].map(|node| SurfaceId(self.hierarchy.node(node).surface));
        let source = self.hierarchy.facet(source);
        let normal = self.hierarchy.facet(receiver).normal;
        let view = |x: &DVec3| {
            let point = point_facet(x, normal);
            match self.shadows(&Pair { receiver: &point, source: &source }, [on, from]) {
                Some(shadows) => shadows.lit(&source).certain,
                None => vec![ClippedFacet::copy_of(&source)],
            }
        };
        Views::Parts(points.iter().map(view).collect())
    }

    /// The shadows of all that is in the way of a pair.
    fn shadows(&self, pair: &Pair<'_>, ends: [SurfaceId; 2]) -> Option<Shadows> {
        let blockers = self.in_the_way(pair, ends);
        if blockers.is_empty() {
            return None;
        }
        let mut shadows = Shadows { is_complete: blockers.len() < MAX_BLOCKERS, ..Shadows::default() };
        for blocker in &blockers {
            let in_the_way = InTheWay {
                receiver: pair.receiver.vertices,
                source: pair.source,
                blocker: &blocker.facet(),
                contact: self.contact,
            };
            if shadows.is_complete {
                shadows.penumbras.push(in_the_way.penumbra());
            }
            if let Some(umbra) = in_the_way.umbra() {
                shadows.hide_all |= umbra.facet().vertices == pair.source.vertices;
                shadows.umbra_regions.push(Region::inside(&umbra.facet(), self.contact));
                shadows.umbras.push(umbra);
            }
        }
        Some(shadows)
    }

    /// The parts of surfaces that meet the hull of the pair: all, or the first [`MAX_BLOCKERS`].
    fn in_the_way(&self, pair: &Pair<'_>, ends: [SurfaceId; 2]) -> Vec<ClippedFacet> {
        let around = Aabb::around(pair.receiver.vertices.iter().chain(pair.source.vertices).copied());
        let mut found = Vec::new();
        let mut stack = vec![NodeId::ROOT];
        while let Some(node) = stack.pop() {
            if self.hierarchy.is_cluster(node) {
                let bounds = self.hierarchy.bounds(node);
                if !self.is_beside(pair, &around, bounds) {
                    stack.extend(self.hierarchy.children(node));
                }
                continue;
            }
            let id = SurfaceId(self.hierarchy.node(node).surface);
            let surface = self.scene.surface(id);
            let is_second_side = surface.twin.is_some_and(|twin| twin.0 < id.0);
            let is_in_plane = |end: SurfaceId| end == id || self.share_a_plane(end, id);
            if is_second_side || ends.into_iter().any(is_in_plane) || self.is_beside(pair, &around, &surface.polygon.bounds()) {
                continue;
            }
            let part = in_front(&self.hierarchy.facet(node), pair.receiver)
                .and_then(|part| in_front(&part.facet(), pair.source))
                .filter(|part| !is_apart(pair.receiver.vertices, pair.source.vertices, &part.facet(), self.contact));
            found.extend(part);
            if found.len() == MAX_BLOCKERS {
                break;
            }
        }
        found
    }

    /// Whether nothing in a box can be in the way of a pair, around which is another.
    fn is_beside(&self, pair: &Pair<'_>, around: &Aabb, bounds: &Aabb) -> bool {
        bounds.min.cmpgt(around.max + self.contact).any()
            || bounds.max.cmplt(around.min - self.contact).any()
            || behind(pair.receiver, bounds, self.contact)
            || behind(pair.source, bounds, self.contact)
    }
}

impl Shadows {
    /// Whether the shadows of all that is in the way are known: then what is certain and what is possible approach each other as the
    /// receiver gets smaller.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Whether no shadow falls on a part of the source.
    pub fn miss(&self, part: &Facet<'_>) -> bool {
        self.is_complete && self.penumbras.iter().all(|penumbra| penumbra.misses(part))
    }

    /// Whether a part of the source is hidden from the whole receiver, by one blocker.
    pub fn hide(&self, part: &Facet<'_>) -> bool {
        self.hide_all || self.umbra_regions.iter().any(|umbra| umbra.holds(part))
    }

    /// What is left of a part of the source.
    pub fn lit(&self, part: &Facet<'_>) -> Lit {
        let whole = || vec![ClippedFacet::copy_of(part)];
        let (mut certain, mut possible) = (whole(), whole());
        let mut shaded = self.is_complete.then(Vec::new);
        for penumbra in &self.penumbras {
            let mut lit = Vec::new();
            certain.into_iter().for_each(|part| penumbra.cut_out(part, &mut lit));
            certain = lit;
            if let Some(shaded) = &mut shaded {
                shaded.extend(penumbra.keep(ClippedFacet::copy_of(part)));
            }
        }
        if !self.is_complete || certain.len() > MAX_PARTS {
            certain.clear();
        }
        if self.hide_all {
            return Lit { certain: Vec::new(), possible: Vec::new(), shaded };
        }
        for umbra in &self.umbra_regions {
            if possible.len() > MAX_PARTS {
                break;
            }
            let mut lit = Vec::new();
            possible.into_iter().for_each(|part| umbra.cut_out(part, &mut lit));
            possible = lit;
        }
        Lit { certain, possible, shaded }
    }

    /// Parts of the source that are hidden from the whole receiver; they may overlap.
    pub fn umbras(&self) -> &[ClippedFacet] {
        &self.umbras
    }
}

/// A receiver and a source, as far as they are in front of each other.
struct Pair<'a> {
    receiver: &'a Facet<'a>,
    source: &'a Facet<'a>,
}

/// A point with a normal, as a polygon of one corner.
fn point_facet(x: &DVec3, normal: DVec3) -> Facet<'_> {
    Facet { vertices: std::slice::from_ref(x), normal, area: 0.0, centroid: *x, radius: 0.0 }
}

/// Whether a box is behind the plane of a polygon.
fn behind(front: &Facet<'_>, bounds: &Aabb, tolerance: f64) -> bool {
    front.height(DVec3::select(front.normal.cmpgt(DVec3::ZERO), bounds.max, bounds.min)) <= tolerance
}
