//! The corners of a scene, welded, and how their faces look from somewhere: whether a corner of the outline is there.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::faces::{Faces, Plane};
use super::points::Welder;
use crate::geometry::{Aabb, Facet, Frame, edges as sides_of};
use crate::scene::SurfaceId;

/// A part of a face around a corner: between two directions, less than half a turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    between: [DVec3; 2],
}

/// A place where faces have corners.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub place: DVec3,
    pub sectors: Vec<Sector>,
    /// Its faces, and their planes.
    pub faces: Vec<SurfaceId>,
    pub planes: Vec<Plane>,
    /// The lengths of the two longest sides of faces that end there, together, in metres.
    pub arms: f64,
}

/// Angles that differ by less are one: tolerances of places seen over short sides.
const SAME_ANGLE: f64 = 1e-6;

/// All corners that can be corners of an outline.
pub(super) fn welded(faces: &Faces<'_>) -> Vec<Corner> {
    let mut welder = Welder::new(faces.tolerance);
    let vertices = faces.ids().flat_map(|id| faces.facet(id).vertices.iter().copied());
    let places: Vec<DVec3> = vertices.filter(|&vertex| welder.weld(vertex).1).collect();
    places.into_par_iter().filter_map(|place| corner_at(faces, place)).collect()
}

/// The corner at a place; `None` where a face goes on around it, or all lie in one plane and their border is straight.
fn corner_at(faces: &Faces<'_>, place: DVec3) -> Option<Corner> {
    let mut corner = Corner { place, sectors: Vec::new(), faces: Vec::new(), planes: Vec::new(), arms: 0.0 };
    let mut lengths = Vec::new();
    for id in faces.near(&Aabb::around([place])) {
        let facet = faces.facet(id);
        match sectors_around(&facet, place, faces.on_plane()) {
            Around::Nothing => continue,
            Around::Everything => return None,
            Around::Sectors(sectors) => corner.sectors.extend(sectors),
        }
        corner.faces.push(id);
        corner.planes.push(Plane { origin: place, normal: facet.normal });
        let touching = |&(start, edge): &(DVec3, DVec3)| {
            place.distance(start) <= faces.on_plane() || place.distance(start + edge) <= faces.on_plane()
        };
        lengths.extend(sides_of(facet.vertices).filter(touching).map(|(_, edge)| edge.length()));
    }
    lengths.sort_by(|a, b| b.total_cmp(a));
    corner.arms = lengths.iter().take(2).sum();

    let normal = corner.planes.first()?.normal;
    let is_flat = corner.planes.iter().all(|plane| plane.normal.cross(normal).length() < SAME_ANGLE);
    (!is_flat || is_outline(&corner.sectors, normal)).then_some(corner)
}

/// What of a polygon lies around a place.
enum Around {
    Nothing,
    Sectors(Vec<Sector>),
    Everything,
}

/// A corner of the polygon, half of its plane at a side, or all of it.
fn sectors_around(facet: &Facet<'_>, place: DVec3, tolerance: f64) -> Around {
    if facet.distance_to(place) > tolerance {
        return Around::Nothing;
    }
    let count = facet.vertices.len();
    if let Some(k) = (0..count).find(|&k| facet.vertices[k].distance(place) <= tolerance) {
        let arms = [facet.vertices[(k + 1) % count], facet.vertices[(k + count - 1) % count]].map(|end| end - facet.vertices[k]);
        return Around::Sectors(halves_of_wide(arms.map(DVec3::normalize_or_zero), facet.normal));
    }
    for (start, edge) in sides_of(facet.vertices) {
        let Some(along) = edge.try_normalize() else { continue };
        if (place - start).cross(along).length() <= tolerance {
            let inward = facet.normal.cross(along);
            return Around::Sectors(vec![Sector { between: [along, inward] }, Sector { between: [inward, -along] }]);
        }
    }
    Around::Everything
}

/// A corner as sectors well below half a turn: a straight one, of a vertex within a side, is two.
fn halves_of_wide([from, to]: [DVec3; 2], normal: DVec3) -> Vec<Sector> {
    if from.dot(to) > 0.0 {
        return vec![Sector { between: [from, to] }];
    }
    let middle = (from - to).cross(normal).normalize_or_zero();
    let middle = if middle.dot(normal.cross(from)) < 0.0 { -middle } else { middle };
    vec![Sector { between: [from, middle] }, Sector { between: [middle, to] }]
}

/// The sectors of some faces around a place.
pub(super) fn sectors_of<'a>(facets: impl Iterator<Item = Facet<'a>>, place: DVec3, tolerance: f64) -> Vec<Sector> {
    facets
        .filter_map(
            |facet| if let Around::Sectors(sectors) = sectors_around(&facet, place, tolerance) { Some(sectors) } else { None },
        )
        .flatten()
        .collect()
}

/// Whether faces around a point, seen along `direction`, have a corner of their outline there: they neither cover all that is around it nor
/// exactly one half.
pub(super) fn is_outline(sectors: &[Sector], direction: DVec3) -> bool {
    let frame = Frame::around(direction.normalize_or(DVec3::Z));
    let mut covered: Vec<[f64; 2]> = Vec::with_capacity(sectors.len());
    for Sector { between: [a, b] } in sectors {
        let angle = |arm: &DVec3| frame.bitangent.dot(*arm).atan2(frame.tangent.dot(*arm));
        let (from, to) = (angle(a), angle(b));
        let turn = (to - from).rem_euclid(TAU);
        let (start, turn) = if turn <= PI { (from, turn) } else { (to, TAU - turn) };
        // What is seen edge-on covers nothing.
        if (SAME_ANGLE..PI - SAME_ANGLE).contains(&turn) {
            covered.push([start.rem_euclid(TAU), turn]);
        }
    }
    covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let Some(&[first, _]) = covered.first() else { return false };

    // Gaps between what is covered, once around.
    let (mut reached, mut gaps) = (first, Vec::new());
    for [start, turn] in covered.iter().copied().chain([[first + TAU, 0.0]]) {
        if start - reached > SAME_ANGLE {
            gaps.push(start - reached);
        }
        reached = reached.max(start + turn);
    }
    match gaps[..] {
        [] => false,
        [gap] => (gap - PI).abs() > SAME_ANGLE,
        _ => true,
    }
}

/// The faces whose numbers are given, as facets.
pub(super) fn facets<'a>(faces: &'a Faces<'_>, ids: &'a [SurfaceId]) -> impl Iterator<Item = Facet<'a>> {
    ids.iter().map(|&id| faces.facet(id))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sectors(arms: &[[DVec3; 2]]) -> Vec<Sector> {
        arms.iter().map(|&between| Sector { between }).collect()
    }

    #[test]
    fn a_corner_is_on_the_outline_unless_what_is_seen_goes_around_or_straight_on() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let sheet = sectors(&[[x, y]]);
        assert!(is_outline(&sheet, z) && is_outline(&sheet, DVec3::new(0.3, 0.2, 1.0)));
        assert!(!is_outline(&sheet, x + y), "edge-on");

        // The corner of a box whose three faces run along x, y and z: on the outline only for those who do not see all three.
        let corner = sectors(&[[x, y], [y, z], [z, x]]);
        assert!(!is_outline(&corner, DVec3::new(1.0, 1.0, 1.0)) && !is_outline(&corner, DVec3::new(-1.0, -1.0, -1.0)));
        assert!(is_outline(&corner, DVec3::new(1.0, 1.0, -0.5)) && is_outline(&corner, DVec3::new(1.0, -0.2, -0.5)));

        // A sheet in two pieces beside a straight side.
        let straight = sectors(&[[x, DVec3::new(0.3, 1.0, 0.0)], [DVec3::new(0.3, 1.0, 0.0), -x]]);
        assert!(!is_outline(&straight, z) && !is_outline(&straight, DVec3::new(0.5, -0.3, 1.0)));
        assert!(!is_outline(&[], z));
    }
}
