//! What a polygon in the way hides of a source: umbra and penumbra of a whole receiver, exactly.
//!
//! From a point x of the receiver, q of the blocker throws its shadow on the source's plane at `(h(x) q - h(q) x) / (h(x) - h(q))`,
//! h being the height above that plane. As x is a mean of the receiver's vertices, the shadow is a mean of their shadows: it lies
//! in the convex hull of the shadows from all vertices, the **penumbra region**. Where receiver and source lie on opposite sides of the
//! blocker's plane, a point of the source projects the receiver on that plane as a convex set: a point that is in shadow from all
//! vertices is in shadow from the whole receiver. These points are the **umbra**.

use glam::DVec3;

use crate::geometry::{Clip, ClippedFacet, Facet, Frame, clip_to_front, edges};

/// A blocker must be lower than every vertex of the receiver by this part of the vertex's height above the source, or its shadow
/// reaches too far.
const LEAST_CLEARANCE: f64 = 1e-6;

/// An edge of a contour that is shorter than this part of the longest edge is what rounding leaves.
const SHORTEST_EDGE: f64 = 1e-9;

/// A convex region of a plane: what is in front of all lines, each given by a point and the unit normal towards the inside.
pub(super) struct Region(Vec<(DVec3, DVec3)>);

/// Where a blocker's shadow falls on the plane of the source.
pub(super) struct Shadow {
    /// Outside of it nothing is hidden from any point of the receiver.
    pub penumbra: Region,
    /// What lies inside all of these is hidden from the whole receiver; `None` where no umbra is known.
    pub umbra: Option<Vec<Region>>,
}

/// The shadow of `blocker`, all of which is in front of the source; `None` where it reaches as high above the source as the
/// receiver does. Regions are `margin` metres larger or smaller, to be on the safe side.
pub(super) fn shadow(receiver: &[DVec3], source: &Facet<'_>, blocker: &Facet<'_>, margin: f64) -> Option<Shadow> {
    let frame = Frame::around(source.normal);
    let flat = |point: DVec3| [frame.tangent.dot(point), frame.bitangent.dot(point)];
    let highest = blocker.vertices.iter().map(|&q| source.height(q)).fold(f64::NEG_INFINITY, f64::max);
    if receiver.iter().any(|&x| source.height(x) * (1.0 - LEAST_CLEARANCE) <= highest) {
        return None;
    }

    // The shadows from all vertices.
    let cast = |x: DVec3, q: DVec3| {
        let (height_x, height_q) = (source.height(x), source.height(q));
        (q * height_x - x * height_q) / (height_x - height_q)
    };
    let shadows: Vec<Vec<DVec3>> = receiver.iter().map(|&x| blocker.vertices.iter().map(|&q| cast(x, q)).collect()).collect();
    let hull = convex_hull(shadows.iter().flatten().map(|&point| (flat(point), point)).collect());

    let side = |points: &[DVec3]| {
        let heights = points.iter().map(|&point| blocker.height(point));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| [low.min(height), high.max(height)])
    };
    let ([low, high], [source_low, source_high]) = (side(receiver), side(source.vertices));
    let opposite = (low > margin && source_high < -margin) || (high < -margin && source_low > margin);
    let umbra = opposite.then(|| shadows.iter().map(|shadow| Region::within(shadow, source.normal, margin)).collect());
    Some(Shadow { penumbra: Region::around(&hull, source.normal, margin), umbra })
}

impl Region {
    /// The inside of a convex contour, made larger by a margin. Edges too short to have a direction are left out, which makes it
    /// larger still.
    fn around(contour: &[DVec3], normal: DVec3, margin: f64) -> Self {
        let longest = edges(contour).map(|(_, edge)| edge.length()).fold(0.0, f64::max);
        Self::of(contour, normal, margin, SHORTEST_EDGE * longest)
    }

    /// The inside of a convex contour, made smaller by a margin.
    fn within(contour: &[DVec3], normal: DVec3, margin: f64) -> Self {
        Self::of(contour, normal, -margin, 0.0)
    }

    fn of(contour: &[DVec3], normal: DVec3, margin: f64, shortest: f64) -> Self {
        let around: DVec3 = edges(contour).map(|(start, edge)| (start - contour[0]).cross(edge)).sum();
        let turn = if around.dot(normal) < 0.0 { -1.0 } else { 1.0 };
        let line = |(start, edge): (DVec3, DVec3)| {
            let inward = turn * normal.cross(edge).normalize();
            (start - margin * inward, inward)
        };
        Self(edges(contour).filter(|(_, edge)| edge.length() > shortest).map(line).collect())
    }

    /// The inside of a polygon.
    pub fn inside(facet: &Facet<'_>) -> Self {
        Self::within(facet.vertices, facet.normal, 0.0)
    }

    /// The part of a polygon that lies inside.
    pub fn keep(&self, polygon: ClippedFacet) -> Option<ClippedFacet> {
        self.0.iter().try_fold(polygon, |left, &(origin, inward)| front_part(&left.facet(), origin, inward))
    }

    /// Appends the part of a polygon that lies outside, as convex parts.
    pub fn cut_out(&self, polygon: ClippedFacet, parts: &mut Vec<ClippedFacet>) {
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

/// The convex hull of points given by their coordinates in a plane, counter-clockwise (Andrew 1979).
fn convex_hull(mut points: Vec<([f64; 2], DVec3)>) -> Vec<DVec3> {
    points.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = ([f64; 2], DVec3)>| {
        let mut chain: Vec<([f64; 2], DVec3)> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if turns_left(a.0, b.0, point.0) {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull.into_iter().map(|(_, point)| point).collect()
}
