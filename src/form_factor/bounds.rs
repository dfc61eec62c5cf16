//! Bounds on the form factor from every point of a receiver to a polygon that it sees entirely.
//!
//! # Theorem
//! For a convex polygon P and a fixed normal n the form factor
//! `F(x) = Integral over P of h_P(x) h_R(x, y) / (pi |x - y|^4) dy` (h_P the height of x above the plane of P, h_R = n.(y - x),
//! each cut off at 0) is quasi-concave in x: on a segment it is nowhere less than at the lower end.
//!
//! Proof. Where both heights are positive `k^(-1/2) = sqrt(pi) |x - y|^2 / sqrt(h_P h_R)`. Both heights are affine in (x, y), so
//! their geometric mean is concave; `(u, t) -> |u|^2 / t` is convex and falls with t > 0; hence `k^(-1/2)` is convex in (x, y)
//! jointly, on a convex set. The Borell-Brascamp-Lieb inequality in n = 2 dimensions with s = -1/2 = -1/n then says that the
//! integral over y satisfies `F((1-l) x0 + l x1) >= min(F(x0), F(x1))`. QED. (The strip kernel `h_P h_R / 2 r^3` of two dimensions
//! has `k^-1` convex, s = -1, n = 1: the same.)
//!
//! # What follows
//! - The least form factor over a convex receiver is that at one of its vertices.
//! - Where F is larger than at a point g, `grad F(g).(x - g) >= 0`. So either a vertex from which F falls towards all others has
//!   the largest, or what is behind a point of the receiver can be cut away, again and again. A cut through the centroid takes at
//!   least 4/9 of the area (Gruenbaum 1960). What is left is bounded directly: by its kernel, by Taylor's formula, by the lune
//!   between both planes.
//!
//! All numbers are widened by what rounding may do. Cost: a form factor at each vertex where a vertex is the best; else also at no more
//! than [`Search::points`] points inside, with a descent into the source for each. Slivers near each other cost most.

use std::f64::consts::PI;

use glam::DVec3;

use super::gradient::{PointFactor, point_factor, point_value};
use super::lambert::point_to_polygon;
use crate::geometry::{Clip, ClippedFacet, Facet, clip_to_front, halves, plane_noise};

/// How closely the largest is searched for.
#[derive(Clone, Copy)]
pub(crate) struct Search {
    /// The most points inside the receiver at which the form factor is computed where no vertex is the best.
    points: u32,
    /// The most triangles of the source that are bounded for each of these points: a sliver beside a small part would take millions. What
    /// is not cut any further is bounded less tightly.
    triangles: u32,
}

impl Search {
    /// As tight as can be.
    pub const CLOSE: Self = Self { points: 40, triangles: 1 << 12 };
    /// Where many pairs count, each a little: a sixth of the time, looser for polygons beside each other.
    pub const FAIR: Self = Self { points: 10, triangles: 1 << 8 };
    /// To tell which pairs are worth more.
    pub const QUICK: Self = Self { points: 2, triangles: 1 << 4 };
}

/// A slope must exceed its rounding so many times to tell which way is up.
const LEAST_SLOPE: f64 = 16.0;

/// A part is long if the square of its radius exceeds this many times its area; of an equilateral triangle it is 0.77 times.
const LONGEST: f64 = 1.5;

/// An upper bound that is above a form factor which is attained by this part of the range over the receiver is good enough.
const GOOD_ENOUGH: f64 = 0.05;

/// Instead of a vertex that touches the source, a point is taken that lies this part of the way from it to the middle of the receiver.
const STEP_INWARD: f64 = 1.0 / (1 << 20) as f64;

/// Parts of the size of two polygons within which they count as touching: what rounding leaves of vertices that were computed
/// apart.
const CONTACT_OF_SIZE: f64 = 1e-12;

/// The least and the largest form factor from a point of the interior of `receiver` to `source`, if nothing is in between.
pub(crate) fn bound_unoccluded(receiver: &Facet<'_>, source: &Facet<'_>, search: Search) -> [f64; 2] {
    // Only what is above the receiver's horizon counts, and it is the same for all its points.
    let source_part = clip_to_front(source, receiver.centroid, receiver.normal);
    let source = match &source_part {
        Clip::Nothing => return [0.0, 0.0],
        Clip::Whole => *source,
        Clip::Part(part) => part.facet(),
    };
    match clip_to_front(receiver, source.vertices[0], source.normal) {
        Clip::Nothing => [0.0, 0.0],
        Clip::Whole => {
            let least = lower(receiver, &source);
            [least, upper(receiver, &source, least, search).max(least)]
        }
        Clip::Part(part) => [0.0, upper(&part.facet(), &source, 0.0, search)],
    }
}

/// Between these lies the form factor from a point with unit normal `normal` to `source`, if nothing is in between: as far apart as rounding
/// may take them. For points that do not touch the source.
pub(crate) fn bound_at_point(x: DVec3, normal: DVec3, source: &Facet<'_>) -> [f64; 2] {
    let source_part = clip_to_front(source, x, normal);
    let source = match &source_part {
        Clip::Nothing => return [0.0, 0.0],
        Clip::Whole => *source,
        Clip::Part(part) => part.facet(),
    };
    if source.height(x) <= plane_noise(x, source.vertices[0]) {
        return [0.0, 0.0];
    }
    let [value, noise] = point_value(x, normal, source.vertices);
    [(value - noise).max(0.0), (value + noise).clamp(0.0, 1.0)]
}

/// The range of the form factor over the receiver's centroid and vertices (Lischinski 1994, section 5.2): no bound, because the
/// largest may lie elsewhere.
pub(crate) fn estimate_unoccluded_range(receiver: &Facet<'_>, source: &Facet<'_>) -> [f64; 2] {
    let factors = centre_and_vertices(receiver).map(|x| point_to_polygon(x, receiver.normal, source));
    factors.fold([f64::INFINITY, 0.0], |[least, most], factor| [least.min(factor), most.max(factor)])
}

/// The centroid and the vertices of a receiver, these a little towards the middle: at a vertex that touches a source the form factor
/// has no value, but a limit.
pub(crate) fn centre_and_vertices<'a>(receiver: &Facet<'a>) -> impl Iterator<Item = DVec3> + use<'a> {
    let (vertices, centroid) = (receiver.vertices, receiver.centroid);
    std::iter::once(centroid).chain(vertices.iter().map(move |&vertex| vertex + STEP_INWARD * (centroid - vertex)))
}

/// The least over the vertices.
///
/// Where a vertex touches the source the form factor has no value, but limits that depend on the way there. Of the receiver shrunk
/// towards its centroid the theorem still holds, so the limit along that way counts. As the source is part of the cone that touches
/// it at the vertex, and that looks the same from everywhere on the way, the form factor at any step of the way is at most the
/// limit.
fn lower(receiver: &Facet<'_>, source: &Facet<'_>) -> f64 {
    let at = |&vertex: &DVec3| {
        let x = if touches(source, vertex, receiver.radius) { vertex + STEP_INWARD * (receiver.centroid - vertex) } else { vertex };
        if source.height(x) <= plane_noise(x, source.vertices[0]) {
            return 0.0;
        }
        let factor = point_factor(x, receiver.normal, source.vertices);
        (factor.value - factor.value_noise).max(0.0)
    };
    receiver.vertices.iter().map(at).fold(1.0, f64::min)
}

fn touches(source: &Facet<'_>, vertex: DVec3, size: f64) -> bool {
    let contact = CONTACT_OF_SIZE * (size + source.radius) + plane_noise(vertex, source.vertices[0]);
    source.height(vertex).abs() <= contact && source.distance_to(vertex) <= contact
}

/// The largest over the receiver, all of which is in front of the source; the least is known.
fn upper(receiver: &Facet<'_>, source: &Facet<'_>, least: f64, search: Search) -> f64 {
    let mut touching = receiver.vertices.iter().filter(|&&vertex| touches(source, vertex, receiver.radius));
    match (touching.next(), touching.next()) {
        (Some(&corner), None) => upper_around_corner(receiver, source, corner, least, search)
            .unwrap_or_else(|| searched_upper(receiver, source, least, search)),
        _ => searched_upper(receiver, source, least, search),
    }
}

/// The same where a corner of one is a corner of the other and nothing else touches; `None` if it is not like that.
///
/// Let C be the cone at the corner that P spans. Seen from x, P is part of C, and C looks the same from all points of a ray that
/// leaves the corner. So the largest over the receiver is at most the largest of C over a part that all these rays pass through,
/// and no less either, as P looks more and more like C on the way to the corner. Of C the part up to a distance K is taken; what is
/// beyond adds less than `d Integral of 16 / r^2 dr = 16 d / K` where the part is no farther than d and `K >= 2 d`.
fn upper_around_corner(receiver: &Facet<'_>, source: &Facet<'_>, corner: DVec3, least: f64, search: Search) -> Option<f64> {
    let neighbours = |polygon: &Facet<'_>| {
        let nearest = |&k: &usize| polygon.vertices[k].distance_squared(corner);
        let (count, at) = (polygon.vertices.len(), (0..polygon.vertices.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b)))?);
        let is_corner = polygon.vertices[at].distance(corner) <= CONTACT_OF_SIZE * (receiver.radius + source.radius);
        let towards = |k: usize| (polygon.vertices[k % count] - corner).normalize_or_zero();
        is_corner.then(|| [towards(at + 1), towards(at + count - 1)])
    };
    let ([next, previous], [source_next, source_previous]) = (neighbours(receiver)?, neighbours(source)?);

    // The part of the receiver, and the cone.
    let middle = (next + previous).normalize_or_zero();
    let nearest = receiver.vertices.iter().filter(|&&v| v != corner).map(|&v| middle.dot(v - corner)).fold(f64::INFINITY, f64::min);
    let Clip::Part(part) = clip_to_front(receiver, corner + 0.5 * nearest * middle, middle) else { return None };
    let reach = part.facet().vertices.iter().map(|v| v.distance(corner)).fold(0.0, f64::max);
    let ends = [source_next, source_previous].map(|direction| CONE_LENGTH * reach * direction);
    let triangle = [corner, corner + ends[0], corner + ends[1]];
    let cone = Facet::of_part(&triangle, source.normal);
    let chord = ends[1] - ends[0];
    let foot = (-ends[0].dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
    let cut_at = (ends[0] + foot * chord).length();
    let is_wide = cone.area > 0.0 && cut_at >= 2.0 * reach;
    is_wide.then(|| {
        (searched_upper(&part.facet(), &cone, least, search) + 16.0 * reach / cut_at).min(lune(receiver.normal, source.normal))
    })
}

/// A cone is cut off at so many times the distance to which the part of the receiver reaches.
const CONE_LENGTH: f64 = 1e5;

/// The same by search.
fn searched_upper(receiver: &Facet<'_>, source: &Facet<'_>, least: f64, search: Search) -> f64 {
    let lune = lune(receiver.normal, source.normal);
    let factor_at = |x| point_factor(x, receiver.normal, source.vertices);
    let most_of = |factor: &PointFactor| factor.value + factor.value_noise;

    // The vertices; the best may be the best of all.
    let mut best = 0.0_f64;
    let mut best_vertex = None;
    for &vertex in receiver.vertices.iter().filter(|&&vertex| !touches(source, vertex, receiver.radius)) {
        let factor = factor_at(vertex);
        if most_of(&factor) > best {
            best = most_of(&factor);
            best_vertex = Some((vertex, factor));
        }
    }
    if let Some((vertex, factor)) = best_vertex {
        let falls_towards = |&other: &DVec3| {
            let way = other - vertex;
            factor.gradient.dot(way) < -factor.gradient_noise * way.length()
        };
        if receiver.vertices.iter().filter(|&&other| other != vertex).all(falls_towards) {
            return best.min(lune);
        }
    }

    // Parts of the receiver that may hold the largest, each with a bound: go to the middle of the one with the highest.
    let cap = Cap { source, normal: receiver.normal, lune, most_triangles: search.triangles };
    let mut parts = vec![(lune, ClippedFacet::copy_of(receiver))];
    for _ in 0..search.points {
        let Some(highest) = (0..parts.len()).max_by(|&a, &b| parts[a].0.total_cmp(&parts[b].0)) else { break };
        if parts[highest].0 <= best + GOOD_ENOUGH * (best - least) {
            break;
        }
        let (bound, part) = parts.swap_remove(highest);
        let middle = factor_at(part.facet().centroid);
        best = best.max(most_of(&middle));
        let bound = bound.min(cap.over(&part.facet(), &middle));
        if bound <= best {
            continue;
        }

        // Cut away what cannot be higher than the middle, and halve what is long, or has a slope that rounding hides.
        let rest = uphill_part(part, &middle);
        match rest {
            Rest::Round(part) => parts.push((bound, part)),
            Rest::Halves(halves) => parts.extend(halves.into_iter().map(|half| (bound, half))),
        }
    }
    parts.iter().map(|&(bound, _)| bound).fold(best, f64::max).min(lune)
}

/// What may hold a higher form factor than the middle of a part.
enum Rest {
    Round(ClippedFacet),
    Halves(Vec<ClippedFacet>),
}

/// Takes from a part what is behind its centroid, seen uphill. What is cut away is lower than the centroid, within rounding.
fn uphill_part(part: ClippedFacet, middle: &PointFactor) -> Rest {
    let facet = part.facet();
    let uphill = middle.gradient - facet.normal * facet.normal.dot(middle.gradient);
    let slope = uphill.length();
    let mut rest = None;
    if slope > LEAST_SLOPE * middle.gradient_noise {
        let uphill = uphill / slope;
        let margin = 2.0 * facet.radius * middle.gradient_noise / slope + plane_noise(facet.centroid, facet.vertices[0]);
        if let Clip::Part(cut) = clip_to_front(&facet, facet.centroid - margin * uphill, uphill) {
            if cut.facet().radius.powi(2) <= LONGEST * cut.facet().area {
                return Rest::Round(cut);
            }
            rest = Some(cut);
        }
    }
    let whole = rest.unwrap_or(part);
    let pieces: Vec<ClippedFacet> = halves(&whole.facet()).collect();
    if pieces.len() == 2 { Rest::Halves(pieces) } else { Rest::Round(whole) }
}

/// What the whole half-plane of the source above the horizon takes of the view: the cosine-weighted share of directions that lead
/// there.
fn lune(receiver_normal: DVec3, source_normal: DVec3) -> f64 {
    (0.5 * (1.0 - receiver_normal.dot(source_normal)) + 4.0 * f64::EPSILON).clamp(0.0, 1.0)
}

/// Bounds the form factor over a part of the receiver from the outside.
struct Cap<'a> {
    source: &'a Facet<'a>,
    normal: DVec3,
    lune: f64,
    most_triangles: u32,
}

/// Sums over triangles of the source, each with what bounds its distance.
#[derive(Default)]
struct CapSums {
    /// Of the form factors' bounds.
    kernel: f64,
    /// Of the second derivatives' bounds, in 1/m^2.
    curvature: f64,
    triangles: u32,
}

impl Cap<'_> {
    /// Triangles of the source that are near are quartered so often.
    const MAX_QUARTERINGS: u32 = 20;

    /// A bound over `part`, at whose centroid the form factor is `middle`.
    fn over(&self, part: &Facet<'_>, middle: &PointFactor) -> f64 {
        let highest = part.vertices.iter().map(|&x| self.source.height(x)).fold(0.0, f64::max);
        let mut sums = CapSums::default();
        for corner in self.source.vertices[1..].windows(2) {
            self.add([self.source.vertices[0], corner[0], corner[1]], part, highest, 0, &mut sums);
        }

        // Taylor's formula around the centroid.
        let rise = |&x: &DVec3| middle.gradient.dot(x - part.centroid);
        let steepest = part.vertices.iter().map(rise).fold(0.0, f64::max) + middle.gradient_noise * part.radius;
        let taylor = middle.value + middle.value_noise + steepest + 0.5 * sums.curvature * part.radius * part.radius;
        (sums.kernel.min(taylor) * (1.0 + 64.0 * f64::EPSILON)).min(self.lune)
    }

    /// Adds the bounds of a triangle, in parts where it is near.
    ///
    /// With `r` the least distance, `F <= |T| h_P h_R / (pi r^4)`; the mean of the affine h_R is that at the centroid. Along a unit
    /// direction u in the plane of the receiver `(r^-4)'' <= 20 r^-6` and `|(r^-4)'| <= 4 r^-5`, so `F'' <= |T| h_R (20 h_P r^-6 +
    /// 8 |grad h_P| r^-5) / pi`.
    fn add(&self, triangle: [DVec3; 3], part: &Facet<'_>, highest: f64, quarterings: u32, sums: &mut CapSums) {
        let [a, b, c] = triangle;
        let centroid = (a + b + c) / 3.0;
        let radius = triangle.iter().map(|v| v.distance(centroid)).fold(0.0, f64::max);
        let distance = part.centroid.distance(centroid) * (1.0 - 4.0 * f64::EPSILON) - radius - part.radius;
        sums.triangles += 1;
        let may_quarter = quarterings < Self::MAX_QUARTERINGS && sums.triangles < self.most_triangles;
        if may_quarter && distance < 4.0 * radius && radius > part.radius {
            let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
            for quarter in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                self.add(quarter, part, highest, quarterings + 1, sums);
            }
            return;
        }
        if distance <= 0.0 {
            sums.kernel += self.lune;
            sums.curvature = f64::INFINITY;
            return;
        }
        let weight = 0.5 * (b - a).cross(c - a).length() * self.normal.dot(centroid - part.centroid).max(0.0) / PI;
        let slant = (self.source.normal - self.normal * self.normal.dot(self.source.normal)).length();
        let (r_sq, r) = (distance * distance, distance);
        sums.kernel += (weight * highest / (r_sq * r_sq)).min(self.lune);
        sums.curvature += weight * (20.0 * highest / r + 8.0 * slant) / (r_sq * r_sq * r);
    }
}
