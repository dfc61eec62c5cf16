//! Exposure: the part of a node that nothing stands on.
//!
//! The floor under a box is part of the floor's polygon, yet it neither sends nor receives light. If its darkness were averaged
//! into the floor around, it would count twice: in the radiosity, and in the visibility of the hidden part. So radiosities are
//! means over the exposed part, form factors and visibilities are those of the whole, and the irradiance that a node gathers is
//! divided by its exposure.
//!
//! Exposure is sampled by cosine-distributed rays. A point is hidden if all its rays first meet backs: one that meets anything else shows
//! that light may come there, however many backs there are around. It is hidden, too, if rays leave the scene and the point lies on a
//! surface of the same plane that faces the other way, such as the underside of a box on a floor: rays ignore what lies in their own
//! plane. A point is hidden as well if something lies over it that is close for the size of the node, unless that covers the whole node:
//! others hardly see it, and little light comes there. Smaller nodes tell it apart.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::PARALLEL;
use crate::geometry::{Facet, Frame, sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId, largest};
use crate::transmittance::Rays;
use crate::visibility::{Hit, NO_PLANE, Ray, Segment};

/// The exposed part of every node, 0 to 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Exposure {
    by_node: Vec<f32>,
    /// Rays cast, and those of them that have left the scene.
    rays: u64,
    outside: u64,
}

/// A scene is closed if no larger part of the rays leaves it: one in millions slips through where edges meet.
const LEAKS: f64 = 1e-5;

/// Rays from a surface that tell whether something stands on it: fewer where surfaces are many, so that all of them take
/// [`ALL_SAMPLES`], but within this range. Where the least would be too many, only the largest surfaces are sampled; the others, each less
/// than a part in 60,000 of what is there, count as exposed.
const SURFACE_SAMPLES: std::ops::RangeInclusive<u32> = 8..=64;
const ALL_SAMPLES: u32 = 1 << 19;

/// Points of a piece of a surface that something stands on.
pub(super) const PIECE_SAMPLES: u32 = 16;

/// A point is hidden if so many rays all meet backs. One from which light can come by a tenth of the directions is taken for hidden once in
/// thirty times.
const HIDDEN_RAYS: u32 = 32;

impl Exposure {
    /// The exposed part of a node, 0 to 1.
    pub fn of(&self, node: NodeId) -> f64 {
        f64::from(self.by_node[node.index()])
    }

    /// Whether no light leaves the scene, as far as rays from its surfaces tell.
    pub(crate) fn is_closed(&self) -> bool {
        self.outside as f64 <= LEAKS * self.rays as f64
    }

    /// Turns the irradiance of the whole node into that of its exposed part, where all of the light arrives.
    pub(crate) fn concentrate(&self, node: NodeId, irradiance: &mut [f64]) {
        let exposure = self.of(node);
        if exposure > 0.0 && exposure < 1.0 {
            irradiance.iter_mut().for_each(|h| *h /= exposure);
        }
    }

    /// How many nodes it knows.
    pub(crate) fn len(&self) -> usize {
        self.by_node.len()
    }

    /// Whether all exposures are in [0, 1], and no more rays left the scene than were cast.
    pub(crate) fn is_valid(&self) -> bool {
        self.by_node.iter().all(|exposure| (0.0..=1.0).contains(exposure)) && self.outside <= self.rays
    }

    /// Samples the exposure of new nodes. Pieces of a surface that is wholly exposed are exposed; once stopped, so is what is left.
    pub(crate) fn grow(&mut self, scene: &Scene, hierarchy: &Hierarchy, rays: &Rays<'_>, seed: u64, stop: Stop<'_>) {
        let known = self.by_node.len();
        if known == hierarchy.len() {
            return;
        }
        self.by_node.resize(hierarchy.len(), 1.0);
        let first = known.max(hierarchy.cluster_count());
        let surface_of = |node: usize| hierarchy.node_of(SurfaceId(hierarchy.node(NodeId(node as u32)).surface));
        let may_be_hidden = |node: usize| surface_of(node).index() == node || self.of(surface_of(node)) < 1.0;
        if stop() || !(first..hierarchy.len()).any(may_be_hidden) {
            return;
        }

        // Surfaces, and pieces of surfaces that something stands on, by rays.
        let by_plane = ByPlane::new(scene);
        let (least, most) = SURFACE_SAMPLES.into_inner();
        let surface_samples = (ALL_SAMPLES / scene.surfaces().len() as u32).clamp(least, most);
        let surfaces = scene.surfaces().len();
        let mut is_sampled = vec![false; surfaces];
        largest(scene, (0..surfaces).collect(), (ALL_SAMPLES / least) as usize)
            .into_iter()
            .for_each(|number| is_sampled[number] = true);
        let (levels, share) = (hierarchy.levels(), rays.share());
        for level in levels.iter().map(|level| level.start.max(first)..level.end).filter(|level| !level.is_empty()) {
            let mut sampled: Vec<Sampled> = (level.clone().into_par_iter())
                .map(|node| {
                    let node = NodeId(node as u32);
                    let surface = hierarchy.node_of(SurfaceId(hierarchy.node(node).surface));
                    let is_small = surface == node && !is_sampled[hierarchy.node(node).surface as usize];
                    if stop() || is_small || !share.has(node.index() - level.start) {
                        Sampled::EXPOSED
                    } else if surface == node {
                        sampled_exposure(hierarchy, &by_plane, rays, surface, surface_samples, seed)
                    } else if self.of(surface) == 1.0 {
                        Sampled::EXPOSED
                    } else {
                        sampled_exposure(hierarchy, &by_plane, rays, node, PIECE_SAMPLES, seed)
                    }
                })
                .collect();
            share.exchange(&mut sampled);
            for (exposure, found) in self.by_node[level].iter_mut().zip(sampled) {
                *exposure = found.exposure;
                self.rays += u64::from(found.rays);
                self.outside += u64::from(found.outside);
            }
        }

        self.pull(hierarchy, levels);
    }

    /// Nodes that are split take the mean of their children.
    fn pull(&mut self, hierarchy: &Hierarchy, levels: Vec<Range<usize>>) {
        for level in levels.into_iter().rev() {
            let (own, below) = self.by_node[level.start..].split_at_mut(level.len());
            own.par_iter_mut().with_min_len(PARALLEL).enumerate().for_each(|(index, exposure)| {
                let (mut exposed, mut area) = (0.0, 0.0);
                for child in hierarchy.children(NodeId((level.start + index) as u32)) {
                    exposed += hierarchy.area(child) * f64::from(below[child.index() - level.end]);
                    area += hierarchy.area(child);
                }
                if area > 0.0 {
                    *exposure = ((exposed / area) as f32).min(1.0);
                }
            });
        }
    }
}

/// Tells which points of surfaces are hidden: those around which there are backs, but for a gap or two, whatever lies close over them.
pub(crate) struct HiddenPoints<'a> {
    by_plane: ByPlane<'a>,
    rays: &'a Rays<'a>,
}

/// Points are looked at closely if one of so many rays meets a back: a point inside of something that is open by a hundredth is overlooked once in
/// ten thousand times.
const FIRST_LOOKS: u32 = 2;

/// A point that is looked at closely is hidden if no more than this part of its rays meets anything but backs: solids are open where others stand
/// in their place.
const MOST_OPEN: f64 = 0.1;

impl<'a> HiddenPoints<'a> {
    pub(crate) fn of(scene: &'a Scene, rays: &'a Rays<'a>) -> Self {
        Self { by_plane: ByPlane::new(scene), rays }
    }

    /// Whether each of some points of a surface is hidden.
    pub(crate) fn among(&self, surface: SurfaceId, points: &[DVec3], seed: u64) -> Vec<bool> {
        let few = self.count_backs(surface, points, (FIRST_LOOKS, seed));
        let doubtful: Vec<usize> = (0..points.len()).filter(|&index| few[index] > 0).collect();
        let closely: Vec<DVec3> = doubtful.iter().map(|&index| points[index]).collect();
        let many = self.count_backs(surface, &closely, (HIDDEN_RAYS, sampling::hash(seed, streams::EXPOSURE_AGAIN)));

        let mut is_hidden = vec![false; points.len()];
        for (index, backs) in doubtful.into_iter().zip(many) {
            is_hidden[index] = f64::from(backs) >= (1.0 - MOST_OPEN) * f64::from(HIDDEN_RAYS);
        }
        is_hidden
    }

    /// How many of so many rays from each of some points meet backs.
    fn count_backs(&self, surface: SurfaceId, points: &[DVec3], (count, seed): (u32, u64)) -> Vec<u32> {
        let Self { by_plane, rays } = self;
        let of_scene = by_plane.scene.surface(surface);
        let (facet, plane) = (of_scene.polygon.facet(), of_scene.plane);
        let mut from = PointsOfNode { by_plane, rays, facet, surface, plane, opposite: None, points: Vec::new() };
        let (directions, frame) = (sampling::shifted_sobol_2d(seed), Frame::around(facet.normal));
        let ray = |number: u32| {
            let [s, t] = directions(number);
            let origin = points[(number / count) as usize].to_array();
            Ray { origin, direction: frame.sampled_by_cosine(s, t).to_array(), origin_plane: plane }
        };
        let ends = from.ends(&(0..count * points.len() as u32).map(ray).collect::<Vec<Ray>>());
        let backs = |ends: &[(End, f64)]| ends.iter().filter(|(end, _)| *end == End::Back).count() as u32;
        ends.chunks(count as usize).map(backs).collect()
    }
}

/// What rays from a node tell.
#[derive(Serialize, Deserialize)]
struct Sampled {
    exposure: f32,
    rays: u32,
    outside: u32,
}

impl Sampled {
    /// Of what is taken as wholly exposed.
    const EXPOSED: Self = Self { exposure: 1.0, rays: 0, outside: 0 };
}

/// Samples the exposed part of a node.
fn sampled_exposure(
    hierarchy: &Hierarchy,
    by_plane: &ByPlane<'_>,
    rays: &Rays<'_>,
    node: NodeId,
    samples: u32,
    seed: u64,
) -> Sampled {
    let (mut exposed, mut outside) = (0, 0);
    for point in sampled_points(hierarchy, by_plane, rays, node, samples, seed) {
        exposed += u32::from(!point.is_hidden);
        outside += u32::from(point.end == End::Outside);
    }
    Sampled { exposure: exposed as f32 / samples as f32, rays: samples, outside }
}

/// The surfaces of every plane.
pub(crate) struct ByPlane<'a> {
    scene: &'a Scene,
    order: Vec<SurfaceId>,
}

impl<'a> ByPlane<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let mut order: Vec<SurfaceId> = (0..scene.surfaces().len() as u32).map(SurfaceId).collect();
        order.par_sort_by_key(|&surface| scene.surface(surface).plane);
        Self { scene, order }
    }

    /// The surfaces in the plane of `surface` that face the other way, without the other side of its own sheet.
    fn opposite(&self, surface: SurfaceId) -> impl Iterator<Item = Facet<'a>> {
        let (scene, own) = (self.scene, self.scene.surface(surface));
        let first = self.order.partition_point(|&other| scene.surface(other).plane < own.plane);
        let in_plane = self.order[first..].iter().take_while(|&&other| scene.surface(other).plane == own.plane);
        let others = in_plane.filter(|&&other| own.twin != Some(other)).map(|&other| scene.surface(other).polygon.facet());
        others.filter(|other| other.normal.dot(own.polygon.facet().normal) < 0.0)
    }
}

/// What lies over a point within this part of the node's size hides it. A slot that is so many times as wide as high gets about this part of
/// the light, so little is lost by calling it dark; larger values lose what stands beside walls.
const CLOSE_OVER: f64 = 0.02;

/// Where a ray from a point ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Front,
    Back,
    Outside,
}

/// A point of a node.
pub(super) struct SampledPoint {
    pub point: DVec3,
    /// Where its first ray ends, and how high over the node's plane, in metres.
    end: End,
    height: f64,
    pub is_hidden: bool,
}

/// Points of a node, uniform by area.
pub(super) fn sampled_points(
    hierarchy: &Hierarchy,
    by_plane: &ByPlane<'_>,
    rays: &Rays<'_>,
    node: NodeId,
    samples: u32,
    seed: u64,
) -> impl Iterator<Item = SampledPoint> {
    let facet = hierarchy.facet(node);
    let surface = SurfaceId(hierarchy.node(node).surface);
    let plane = by_plane.scene.surface(surface).plane;
    let seed = sampling::hash(seed, streams::EXPOSURE + u64::from(node.0));
    let mut from = PointsOfNode { by_plane, rays, facet, surface, plane, opposite: None, points: Vec::new() };
    from.cast(samples, seed);
    from.cast_again_where_hidden(seed);
    from.hide_covered();
    from.points.into_iter()
}

/// Points of a node on their way to being known as hidden or not.
struct PointsOfNode<'a> {
    by_plane: &'a ByPlane<'a>,
    rays: &'a Rays<'a>,
    facet: Facet<'a>,
    surface: SurfaceId,
    plane: u32,
    /// Surfaces in the same plane that face the other way, once they are asked for.
    opposite: Option<Vec<Facet<'a>>>,
    points: Vec<SampledPoint>,
}

impl PointsOfNode<'_> {
    /// Draws the points, and casts a ray from each.
    fn cast(&mut self, samples: u32, seed: u64) {
        let (facet, frame) = (self.facet, Frame::around(self.facet.normal));
        let ray = |sample| {
            let [u, v, s, t] = sampling::sobol_4d(sample, seed);
            let (origin, direction) = (facet.point_at(u, v).to_array(), frame.sampled_by_cosine(s, t).to_array());
            Ray { origin, direction, origin_plane: self.plane }
        };
        let rays: Vec<Ray> = (0..samples).map(ray).collect();
        for (ray, (end, height)) in rays.iter().zip(self.ends(&rays)) {
            self.points.push(SampledPoint { point: DVec3::from(ray.origin), end, height, is_hidden: end == End::Back });
        }
    }

    /// Casts more rays from points whose rays met backs, until one does not.
    fn cast_again_where_hidden(&mut self, seed: u64) {
        let frame = Frame::around(self.facet.normal);
        for round in 1..HIDDEN_RAYS {
            let hidden: Vec<usize> = (0..self.points.len()).filter(|&index| self.points[index].is_hidden).collect();
            if hidden.is_empty() {
                break;
            }
            let directions = sampling::shifted_sobol_2d(sampling::hash(seed, streams::EXPOSURE_AGAIN + u64::from(round)));
            let ray = |(number, &index): (u32, &usize)| {
                let [s, t] = directions(number);
                let (origin, direction) = (self.points[index].point.to_array(), frame.sampled_by_cosine(s, t).to_array());
                Ray { origin, direction, origin_plane: self.plane }
            };
            let rays: Vec<Ray> = (0..).zip(&hidden).map(ray).collect();
            for (index, (end, _)) in hidden.into_iter().zip(self.ends(&rays)) {
                self.points[index].is_hidden = end == End::Back;
            }
        }
    }

    /// Hides points over which something lies close, unless that are all: only where the first ray has met something as low.
    fn hide_covered(&mut self) {
        let height = CLOSE_OVER * self.facet.area.sqrt();
        let low = |index: &usize| !self.points[*index].is_hidden && self.points[*index].height <= height;
        let low: Vec<usize> = (0..self.points.len()).filter(low).collect();
        let upwards = |&index: &usize| {
            let from = self.points[index].point;
            let to = (from + height * self.facet.normal).to_array();
            Segment { from: from.to_array(), to, from_plane: self.plane, to_plane: NO_PLANE }
        };
        let mut occluded = Vec::new();
        self.rays.occluded(&low.iter().map(upwards).collect::<Vec<_>>(), &mut occluded);
        let covered: Vec<usize> = low.into_iter().zip(occluded).filter(|(_, occluded)| *occluded).map(|(index, _)| index).collect();
        if self.points.iter().filter(|point| !point.is_hidden).count() > covered.len() {
            covered.into_iter().for_each(|index| self.points[index].is_hidden = true);
        }
    }

    /// Where rays from the node end, and how high over its plane.
    fn ends(&mut self, rays: &[Ray]) -> Vec<(End, f64)> {
        let mut hits = Vec::new();
        self.rays.first_hits(rays, &mut hits);
        let Self { by_plane, surface, facet, opposite, .. } = self;
        let end = |(ray, hit): (&Ray, Option<Hit>)| match hit {
            None => {
                let opposite = opposite.get_or_insert_with(|| by_plane.opposite(*surface).collect());
                let is_hidden = opposite.iter().any(|facing| facing.contains(DVec3::from(ray.origin)));
                (if is_hidden { End::Back } else { End::Outside }, f64::INFINITY)
            }
            Some(hit) => {
                let direction = DVec3::from(ray.direction);
                let side = by_plane.scene.side_towards(SurfaceId(hit.surface), -direction);
                (side.map_or(End::Back, |_| End::Front), hit.distance * facet.normal.dot(direction))
            }
        };
        rays.iter().zip(hits).map(end).collect()
    }
}
