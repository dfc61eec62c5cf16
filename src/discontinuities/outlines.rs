//! Outlines of what stands close over a surface, at their feet on it.
//!
//! Behind a row of books a wall is dark, and above them it is lit. Whatever the light, it changes across the foot of such an edge over a strip about as
//! wide as the edge is high, which is next to nothing beside its length: a step for all but the finest elements. No source is needed to know that, and
//! none is asked, so that such lines serve light from everywhere.

use glam::DVec3;

use super::contacts::inside;
use super::curves::Found;
use super::faces::{Faces, Plane};
use crate::geometry::{Aabb, edges as sides_of};
use crate::scene::SurfaceId;

/// An edge stands close over a surface if it is no higher than this part of its length: the strip is narrow beside it. Lines serve from 0.1 to 0.3 alike.
const CLOSE: f64 = 0.1;

/// What is left of an edge above a surface is at least so many times as long as the edge is high: the strip's ends are no narrower than it.
const LONG: f64 = 2.0;

/// Adds the feet of the edges of one face on all surfaces that it stands close over.
pub(super) fn find(faces: &Faces<'_>, occluder: SurfaceId, found: &mut Found) {
    let vertices = faces.facet(occluder).vertices;
    let longest = sides_of(vertices).map(|(_, edge)| edge.length()).fold(0.0, f64::max);
    let bounds = faces.scene.surface(occluder).polygon.bounds();
    let room = DVec3::splat(CLOSE * longest);
    for below in faces.near(&Aabb { min: bounds.min - room, max: bounds.max + room }) {
        if faces.scene.surface(below).plane() == faces.scene.surface(occluder).plane() {
            continue;
        }
        let sides = [Some(below), faces.scene.surface(below).twin()];
        sides.into_iter().flatten().for_each(|receiver| find_on(faces, receiver, vertices, found));
    }
}

/// Adds the feet on one surface.
fn find_on(faces: &Faces<'_>, receiver: SurfaceId, vertices: &[DVec3], found: &mut Found) {
    let facet = faces.facet(receiver);
    let plane = Plane { origin: facet.centroid, normal: facet.normal };
    for (start, edge) in sides_of(vertices) {
        // Close over the surface, all along.
        let heights = [plane.height(start), plane.height(start + edge)];
        if !heights.iter().all(|&height| height > faces.on_plane() && height <= CLOSE * edge.length()) {
            continue;
        }

        // Its foot, as far as it is on the surface.
        let feet = [start - heights[0] * plane.normal, start + edge - heights[1] * plane.normal];
        let Some(ends) = inside(&facet, feet, faces.tolerance) else { continue };
        let is_long = ends[0].distance(ends[1]) >= LONG * heights[0].max(heights[1]);
        if is_long && found.admit(faces, receiver, ends) {
            found.add_foot(receiver, ends);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::discontinuities::{Degree, Segment, of_shape};
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides, SurfaceId};

    /// A floor of 4 m, and a sheet of 1 m by 2 m over it at a height.
    fn scene(height: f64, sides: Sides) -> Scene {
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let floor = Polygon::new(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]]).unwrap();
        let sheet = [[1.0, 1.0, height], [2.0, 1.0, height], [2.0, 3.0, height], [1.0, 3.0, height]];
        let faces = [floor, Polygon::new(&sheet).unwrap()].map(|polygon| (polygon, 0, 0)).into();
        Scene::new(1, vec![grey], faces, sides).unwrap()
    }

    #[test]
    fn the_outline_of_what_stands_close_is_found_on_the_side_that_it_covers() {
        let close = of_shape(&scene(0.05, Sides::Front), &|| false);
        let of = close.of(SurfaceId(0));
        assert_eq!(of.len(), 4);
        for Segment { degree, ends, source, .. } in of {
            assert_eq!((*degree, *source), (Degree::D1, None));
            assert!(ends.iter().all(|end| end.z.abs() < 1e-9 && [1.0, 2.0].iter().any(|x| (end.x - x).abs() < 1e-6)));
        }
        // The sheet looks up, away from the floor.
        assert!(close.of(SurfaceId(1)).is_empty());
    }

    #[test]
    fn what_stands_higher_is_left_out_edge_by_edge() {
        assert_eq!(of_shape(&scene(0.15, Sides::Front), &|| false).of(SurfaceId(0)).len(), 2);
        assert_eq!(of_shape(&scene(0.25, Sides::Front), &|| false).of(SurfaceId(0)).len(), 0);
    }

    #[test]
    fn both_sides_of_a_sheet_are_covered_by_what_stands_over_each() {
        let both = scene(0.05, Sides::Both);
        let found = of_shape(&both, &|| false);
        let with_lines = (0..both.surfaces().len() as u32).filter(|&id| !found.of(SurfaceId(id)).is_empty());
        // The floor's upper side; and the sheet's lower side has the floor's edges too high.
        assert_eq!(with_lines.count(), 1);
    }
}
