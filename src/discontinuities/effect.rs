//! How much a curve can matter: bounds of irradiance from one source.
//!
//! A point at distance `d` or more from a source of radiosity `B`, area `A` and diameter `D` gets at most
//!
//! ```text
//! B min(1, cos_r cos_s A / (pi d^2))
//! ```
//!
//! from it. What an edge of length `l`, at distance `c` or more from the point, can pass over lies within a strip as wide as it looks: seen from
//! the point it is at most `min(pi, l / c)` wide and `min(pi, D / d)` long, so that it brings at most `B / pi cos_r` times the product. Turned around,
//! that tells how far behind an edge its shadow has to be followed.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::emitters::Emitter;
use super::faces::{Faces, Plane};
use crate::geometry::Aabb;
use crate::scene::SurfaceId;

/// Curves are bounded in pieces of this part of their distance from the source, which bounds that to as much.
const PIECE: f64 = 0.25;

/// The most pieces of a curve: they keep the cost of a curve small.
const MOST_PIECES: f64 = 32.0;

/// What passes before the source along a curve.
#[derive(Clone, Copy, Debug)]
pub(super) enum Passing {
    /// Edges that lie between two points, with their length together.
    Edge([DVec3; 2], f64),
    /// The source itself comes over its horizon.
    Horizon,
}

/// At most what `passing` can hide of the source from the points of a curve on `receiver`, in W/m^2.
pub(super) fn bound_change(faces: &Faces<'_>, emitter: &Emitter, receiver: SurfaceId, curve: [DVec3; 2], passing: Passing) -> f64 {
    let facet = faces.facet(receiver);
    let plane = Plane { origin: facet.centroid, normal: facet.normal };
    let distance = distance_to_segment(emitter.plane.origin, curve);
    let count = (curve[0].distance(curve[1]) / (PIECE * distance)).ceil().clamp(1.0, MOST_PIECES);
    let reach = 0.5 * curve[0].distance(curve[1]) / count;
    let piece = |k: usize| {
        let middle = curve[0].lerp(curve[1], (k as f64 + 0.5) / count);
        match passing {
            Passing::Horizon => irradiance(faces, emitter, &plane, middle, reach, true),
            Passing::Edge(edge, edges) => {
                let whole = irradiance(faces, emitter, &plane, middle, reach, false);
                let (from_source, cos) = seen_from(faces, emitter, &plane, middle, reach);
                let from_edge = (distance_to_segment(middle, edge) - reach).max(0.0);
                let strip = (edges / from_edge).min(PI) * (emitter.diameter / from_source).min(PI);
                whole.min(emitter.radiosity / PI * cos * strip)
            }
        }
    };
    (0..count as usize).map(piece).fold(0.0, f64::max)
}

/// The receivers that get more from an emitter than they tolerate.
pub(super) struct Lit<'a> {
    pub emitter: &'a Emitter,
    /// Ascending.
    receivers: Vec<SurfaceId>,
    /// What the most demanding of them tolerates, in W/m^2.
    least: f64,
    /// Around them and the emitter: shadows are cast from within.
    bounds: Aabb,
}

impl<'a> Lit<'a> {
    /// `least` is the least tolerance of all surfaces.
    pub fn by(faces: &Faces<'_>, emitter: &'a Emitter, tolerance: &(dyn Fn(SurfaceId) -> f64 + Sync), least: f64) -> Self {
        let mut receivers = Vec::new();
        let may_meet = |centre, half| bound_beyond(emitter, &Aabb { min: centre - half, max: centre + half }) > least;
        faces.boxes.until_enough_where(may_meet, |id| {
            receivers.push(id);
            false
        });
        receivers.par_sort_unstable();
        let receivers: Vec<SurfaceId> =
            receivers.into_par_iter().filter(|&id| bound_irradiance(faces, emitter, id) > tolerance(id)).collect();
        let least = receivers.iter().map(|&id| tolerance(id)).fold(f64::INFINITY, f64::min);
        let all = receivers.iter().chain(&emitter.pieces);
        let bounds = all.map(|&id| faces.scene.surface(id).polygon.bounds()).fold(Aabb::EMPTY, Aabb::union);
        Self { emitter, receivers, least, bounds }
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        self.receivers.len()
    }

    pub fn has(&self, receiver: SurfaceId) -> bool {
        self.receivers.binary_search(&receiver).is_ok()
    }

    /// Whether what lies within some bounds may cast a shadow of the emitter on any of them that is more than tolerated.
    pub fn may_be_shadowed_by(&self, bounds: &Aabb) -> bool {
        let is_between = bounds.min.cmple(self.bounds.max).all() && bounds.max.cmpge(self.bounds.min).all();
        is_between && bound_beyond(self.emitter, bounds) > self.least
    }

    /// Within this distance lie all points from which edges within `bounds`, of this length together, can hide more than is tolerated.
    pub fn reach(&self, bounds: &Aabb, length: f64) -> f64 {
        let (_, distance) = nearest_beyond(self.emitter, bounds);
        let looks = (self.emitter.diameter / distance).min(PI);
        self.emitter.radiosity / PI * length * looks / self.least
    }

    /// Within this distance of the emitter lie all points near its horizon that get more from it than is tolerated.
    pub fn reach_of_horizon(&self) -> f64 {
        (self.emitter.radiosity * self.emitter.area * self.emitter.diameter / (PI * self.least)).cbrt()
    }
}

/// At most what a point within some bounds gets from an emitter, or one beyond, of which light through the bounds would reach it; in W/m^2.
///
/// Along a line that leaves a convex set, such as a box around the emitter, or what is below its plane, the distance from the set never becomes less.
fn bound_beyond(emitter: &Emitter, bounds: &Aabb) -> f64 {
    let (is_in_front, distance) = nearest_beyond(emitter, bounds);
    let factor = emitter.area / (PI * distance * distance);
    if is_in_front { emitter.radiosity * factor.min(1.0) } else { 0.0 }
}

/// Whether some bounds reach in front of an emitter, and at least how far from it they and what is beyond lie.
fn nearest_beyond(emitter: &Emitter, bounds: &Aabb) -> (bool, f64) {
    let plane = &emitter.plane;
    let (middle, reach) = (plane.height(bounds.centre()), plane.normal.abs().dot(0.5 * bounds.extent()));
    (middle + reach > 0.0, (middle - reach).max(emitter.bounds.distance_to(bounds)))
}

/// At most what a receiver gets from an emitter anywhere, in W/m^2.
fn bound_irradiance(faces: &Faces<'_>, emitter: &Emitter, receiver: SurfaceId) -> f64 {
    let facet = faces.facet(receiver);
    let in_front = |plane: &Plane, points: &[DVec3]| points.iter().any(|&point| plane.height(point) > 0.0);
    let plane = Plane { origin: facet.centroid, normal: facet.normal };
    let is_faced = emitter.pieces.iter().any(|&piece| in_front(&plane, faces.facet(piece).vertices));
    if !in_front(&emitter.plane, facet.vertices) || !is_faced {
        return 0.0;
    }
    irradiance(faces, emitter, &plane, facet.centroid, facet.radius, false)
}

/// The least distance of the source from points within `reach` of `middle`, and the largest cosine there at the receiver.
fn seen_from(faces: &Faces<'_>, emitter: &Emitter, receiver: &Plane, middle: DVec3, reach: f64) -> (f64, f64) {
    let pieces = || emitter.pieces.iter().map(|&id| faces.facet(id));
    let distance = (pieces().map(|facet| facet.distance_to(middle)).fold(f64::INFINITY, f64::min) - reach).max(0.0);
    let heights = pieces().flat_map(|facet| facet.vertices.iter().map(|&v| receiver.height(v)));
    (distance, (heights.fold(0.0, f64::max) / distance).min(1.0))
}

/// At most what points within `reach` of `middle` get, or with `is_near_horizon` points within a diameter of the source from there.
fn irradiance(faces: &Faces<'_>, emitter: &Emitter, receiver: &Plane, middle: DVec3, reach: f64, is_near_horizon: bool) -> f64 {
    let (distance, cos_receiver) = seen_from(faces, emitter, receiver, middle, reach);
    let height = if is_near_horizon { emitter.diameter } else { emitter.plane.height(middle) + reach };
    let cos_source = (height.max(0.0) / distance).min(1.0);
    let factor = cos_receiver * cos_source * emitter.area / (PI * distance * distance);
    emitter.radiosity * if factor.is_nan() { 1.0 } else { factor.min(1.0) }
}

pub(super) fn distance_to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let length_sq = along.length_squared();
    let part = if length_sq > 0.0 { ((point - a).dot(along) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + part * along)
}
