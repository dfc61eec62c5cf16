//! Where surfaces touch or cross: lines across which irradiance itself jumps (Lischinski 1994, section 2.4.1; D0).
//!
//! A face that reaches in front of a surface and meets its plane does so along a segment: a side that lies on the surface, or the line along which
//! it passes through. The part on the surface is the contact. Places where a single corner touches are no line, and are left out.

use glam::DVec3;

use super::curves::Found;
use super::faces::{Faces, Plane};
use crate::geometry::{Facet, edges as sides_of};
use crate::scene::SurfaceId;

/// Adds the contacts on one surface.
pub(super) fn find(faces: &Faces<'_>, receiver: SurfaceId, found: &mut Found) {
    let facet = faces.facet(receiver);
    let plane = Plane { origin: facet.centroid, normal: facet.normal };
    for id in faces.along(&plane, &faces.scene.surface(receiver).polygon.bounds()) {
        if faces.scene.surface(id).plane() == faces.scene.surface(receiver).plane() {
            continue;
        }
        let Some(line) = meeting(faces.facet(id).vertices, &plane, faces.on_plane()) else { continue };
        let Some(ends) = inside(&facet, line, faces.tolerance) else { continue };
        if found.admit(faces, receiver, ends) {
            found.add_contact(receiver, ends);
        }
    }
}

/// Where a polygon that reaches in front of a plane meets it: the corners in the plane and the crossings, the two that are farthest apart.
fn meeting(vertices: &[DVec3], plane: &Plane, tolerance: f64) -> Option<[DVec3; 2]> {
    let height = |vertex: DVec3| {
        let height = plane.height(vertex);
        if height.abs() <= tolerance { 0.0 } else { height }
    };
    if !vertices.iter().any(|&vertex| height(vertex) > 0.0) {
        return None;
    }
    let mut points = Vec::with_capacity(4);
    for (start, edge) in sides_of(vertices) {
        let (from, to) = (height(start), height(start + edge));
        if from == 0.0 {
            points.push(start);
        } else if from * to < 0.0 {
            points.push(start + edge * (from / (from - to)));
        }
    }
    let &first = points.first()?;
    let farthest =
        |from: DVec3| points.iter().copied().max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)));
    let one = farthest(first)?;
    Some([one, farthest(one)?])
}

/// The part of a segment of the plane that is on a polygon, sides included.
pub(super) fn inside(facet: &Facet<'_>, [from, to]: [DVec3; 2], tolerance: f64) -> Option<[DVec3; 2]> {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for (start, edge) in sides_of(facet.vertices) {
        let Some(inward) = facet.normal.cross(edge).try_normalize() else { continue };
        let [a, b] = [from, to].map(|point| inward.dot(point - start) + tolerance);
        match (a >= 0.0, b >= 0.0) {
            (true, true) => {}
            (true, false) => high = high.min(a / (a - b)),
            (false, true) => low = low.max(a / (a - b)),
            (false, false) => return None,
        }
    }
    (low < high).then(|| [from.lerp(to, low), from.lerp(to, high)])
}
