//! What a convex polygon in the way hides of a source: umbra and penumbra of a receiver, which may be a single point.
//!
//! **Penumbra.** Let a plane part receiver and blocker: `f(x) <= 0` for all x of the receiver, `f(q) >= 0` for all q of the blocker. What x
//! does not see because of q lies beyond q, at `y = x + t (q - x)` with `t >= 1`, so `f(y) >= f(q)`. Hence all that any point of the
//! receiver does not see lies in front of all such planes, moved up to the blocker. Tight are those through an edge of one and a vertex
//! of the other, and the blocker's own. Where a plane cannot be trusted it is left out, which makes the region larger.
//!
//! **Umbra.** If all segments between the vertices of two convex polygons on opposite sides of the blocker's plane pass through the blocker,
//! all segments between the two polygons do: a point projects a convex set on that plane as a convex set, first the one, then the other.
//! The candidate is the source, cut by the planes through edges of the blocker and vertices of the receiver and made a little smaller;
//! the proof is this test of its vertices, in which each point may be off by what rounding does.
//!
//! (Nishita, Nakamae 1983, for lights and polyhedra.)

use glam::DVec3;

use crate::geometry::{Clip, ClippedFacet, Facet, clip_to_front, edges};

/// Roundings of the largest coordinate that a height above a plane through computed points may be off by: three products and sums, of points
/// that were cut off themselves, with room to spare.
const ROUNDINGS: f64 = 64.0;

/// An umbra must be made smaller by no more than this part of the blocker's radius, or rounding decides too much.
const MOST_SHRUNK: f64 = 1e-3;

/// A receiver (its vertices, or a point), a source that is in front of it, and a polygon in front of both.
pub(super) struct InTheWay<'a> {
    pub receiver: &'a [DVec3],
    pub source: &'a Facet<'a>,
    pub blocker: &'a Facet<'a>,
    /// What is nearer to each other counts as touching, in metres.
    pub contact: f64,
}

/// A convex region: what is in front of all planes, each given by a point and the unit normal towards the inside.
pub(super) struct Region(Vec<(DVec3, DVec3)>);

impl InTheWay<'_> {
    /// How far rounding may take a computed point off a plane, in metres.
    fn noise(&self) -> f64 {
        let all = self.receiver.iter().chain(self.source.vertices).chain(self.blocker.vertices);
        ROUNDINGS * f64::EPSILON * all.map(|point| point.abs().max_element()).fold(0.0, f64::max)
    }

    /// No point of the source is farther from a point of the receiver.
    fn reach(&self) -> f64 {
        let from = self.receiver.iter().map(|x| x.distance(self.source.centroid)).fold(0.0, f64::max);
        from + self.source.radius
    }

    /// Outside of it nothing is hidden from any point of the receiver.
    pub fn penumbra(&self) -> Region {
        let (noise, blocker, receiver) = (self.noise(), self.blocker.vertices, self.receiver);
        let mut planes: Vec<(DVec3, f64, f64)> = Vec::with_capacity(8);
        let mut add = |direction: DVec3| {
            if let Some(found) = self.parted(direction, noise) {
                planes.push(found);
            }
        };
        add(self.blocker.normal);
        for (start, edge) in edges(blocker) {
            receiver.iter().for_each(|&x| add(edge.cross(x - start)));
        }
        for (start, edge) in edges(receiver).filter(|(_, edge)| *edge != DVec3::ZERO) {
            blocker.iter().for_each(|&q| add(edge.cross(q - start)));
        }

        // Where rounding hides which of two comes first, what it leaves grows with the distance behind the blocker.
        let apart = planes.iter().map(|&(_, _, gap)| gap - 2.0 * noise).fold(self.contact, f64::max);
        let growth = self.reach() / apart;
        let plane = |(normal, nearest, gap): (DVec3, f64, f64)| {
            let doubt = (2.0 * noise - gap).max(0.0);
            (self.blocker.centroid + (nearest - 2.0 * noise - growth * doubt) * normal, normal)
        };
        Region(planes.into_iter().map(plane).collect())
    }

    /// If a plane across `direction` parts receiver and blocker: its unit normal towards the blocker, how high above the blocker's centroid
    /// the blocker begins, and the gap between both.
    fn parted(&self, direction: DVec3, noise: f64) -> Option<(DVec3, f64, f64)> {
        let length = direction.length();
        // A direction of which rounding is a part would still part them, or fail to; a zero one is none.
        if length.is_nan() || length <= 0.0 {
            return None;
        }
        let normal = direction / length;
        let origin = self.blocker.centroid;
        let range = |points: &[DVec3]| {
            let heights = points.iter().map(|&point| normal.dot(point - origin));
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| [low.min(height), high.max(height)])
        };
        let ([low, high], [blocker_low, blocker_high]) = (range(self.receiver), range(self.blocker.vertices));
        if blocker_low - high >= -noise {
            Some((normal, blocker_low, blocker_low - high))
        } else if low - blocker_high >= -noise {
            Some((-normal, -blocker_high, low - blocker_high))
        } else {
            None
        }
    }

    /// A part of the source that is hidden from the whole receiver; `None` where no such part is found.
    pub fn umbra(&self) -> Option<ClippedFacet> {
        // Receiver in front of the blocker's plane, hidden part behind it; turn the plane if need be.
        let (blocker, origin, noise) = (self.blocker, self.blocker.centroid, self.noise());
        let turned = if blocker.normal.dot(self.receiver[0] - origin) < 0.0 { -1.0 } else { 1.0 };
        let up = turned * blocker.normal;
        let lowest = self.receiver.iter().map(|&x| up.dot(x - origin)).fold(f64::INFINITY, f64::min);
        if lowest <= 2.0 * noise {
            return None;
        }
        let margin = 4.0 * noise * (1.0 + self.reach() / lowest).powi(2);
        if margin.is_nan() || margin > MOST_SHRUNK * blocker.radius {
            return None;
        }

        // Cut away what a vertex may see beside the blocker.
        let mut hidden = front_part(self.source, origin - margin * up, -up)?;
        for (start, edge) in edges(blocker.vertices).filter(|(_, edge)| edge.length() > 0.0) {
            for &x in self.receiver {
                let mut inward = edge.cross(x - start);
                inward *= if inward.dot(origin - start) < 0.0 { -1.0 } else { 1.0 };
                let inward = inward.try_normalize()?;
                hidden = front_part(&hidden.facet(), start + margin * inward, inward)?;
            }
        }

        // Proof: every segment passes through the blocker.
        let passes = |x: DVec3, y: DVec3| {
            let (above, below) = (up.dot(x - origin), up.dot(y - origin));
            let off = noise * (1.0 + x.distance(y) / (above - below));
            let crossing = x + (y - x) * (above / (above - below));
            let inside = |(start, edge): (DVec3, DVec3)| {
                edge == DVec3::ZERO || turned * up.cross(edge).normalize().dot(crossing - start) >= off
            };
            above > noise && below < -noise && edges(blocker.vertices).all(inside)
        };
        let hides = self.receiver.iter().all(|&x| hidden.facet().vertices.iter().all(|&y| passes(x, y)));
        hides.then_some(hidden)
    }
}

impl Region {
    /// The inside of a polygon, among points of its plane, made smaller by a margin in metres.
    pub fn inside(facet: &Facet<'_>, margin: f64) -> Self {
        let line = |(start, edge): (DVec3, DVec3)| {
            let inward = facet.normal.cross(edge).normalize();
            (start + margin * inward, inward)
        };
        Self(edges(facet.vertices).filter(|(_, edge)| edge.length_squared() > 0.0).map(line).collect())
    }

    /// Whether a plane shows that a polygon lies outside: "no" proves nothing.
    pub fn misses(&self, facet: &Facet<'_>) -> bool {
        self.0.iter().any(|&(origin, inward)| {
            let centre = inward.dot(facet.centroid - origin);
            centre <= -facet.radius || facet.vertices.iter().all(|&vertex| inward.dot(vertex - origin) < 0.0)
        })
    }

    /// Whether a polygon lies inside.
    pub fn holds(&self, facet: &Facet<'_>) -> bool {
        self.0.iter().all(|&(origin, inward)| facet.vertices.iter().all(|&vertex| inward.dot(vertex - origin) >= 0.0))
    }

    /// The part of a polygon that lies inside.
    pub fn keep(&self, polygon: ClippedFacet) -> Option<ClippedFacet> {
        self.0.iter().try_fold(polygon, |left, &(origin, inward)| front_part(&left.facet(), origin, inward))
    }

    /// Appends the part of a polygon that lies outside, as convex parts.
    pub fn cut_out(&self, polygon: ClippedFacet, parts: &mut Vec<ClippedFacet>) {
        if self.misses(&polygon.facet()) {
            parts.push(polygon);
            return;
        }
        let mut left = polygon;
        for &(origin, inward) in &self.0 {
            parts.extend(front_part(&left.facet(), origin, -inward));
            match front_part(&left.facet(), origin, inward) {
                Some(inside) => left = inside,
                None => return,
            }
        }
    }
}

/// What is in front of a plane; nothing where it has no area.
fn front_part(facet: &Facet<'_>, origin: DVec3, normal: DVec3) -> Option<ClippedFacet> {
    match clip_to_front(facet, origin, normal) {
        Clip::Whole => Some(ClippedFacet::copy_of(facet)),
        Clip::Part(part) => Some(part),
        Clip::Nothing => None,
    }
}
