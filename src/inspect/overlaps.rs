//! Faces that cover the same place in one plane and face the same way: nearer than visibility tells apart, so that the light that arrives
//! there arrives at each of them.
//!
//! Cost: O(n log n) for n surfaces, where few lie over each other.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Clip, ClippedFacet, Facet, clip_to_front, edges};
use crate::scene::{Scene, Surface, SurfaceId};
use crate::visibility::SurfaceBoxes;

/// Edges that touch by rounding cover less than this part of the smaller face.
const PART_WORTH_TELLING: f64 = 0.01;

/// The faces that overlap others: the 0-based number of each in the input and that of one other, ascending. Backs that were added to faces do not
/// count.
pub(super) fn overlapping_faces(scene: &Scene) -> Vec<(u32, u32)> {
    let (boxes, near) = (SurfaceBoxes::of(scene), scene.contact_tolerance());
    let planes = scene.surfaces().iter().map(|surface| surface.plane() as usize + 1).max().unwrap_or(0);
    let mut in_plane = vec![0_u32; planes];
    scene.surfaces().iter().for_each(|surface| in_plane[surface.plane() as usize] += 1);

    let other_of = |(index, surface): (usize, &Surface)| {
        if in_plane[surface.plane() as usize] < 2 || is_added_back(scene, index) {
            return None;
        }
        let bounds = surface.polygon.bounds();
        let (centre, half) = (bounds.centre(), 0.5 * bounds.extent() + near);
        let touches = |other: DVec3, other_half: DVec3| (other - centre).abs().cmple(half + other_half).all();
        let mut found = None;
        boxes.until_enough_where(touches, |id| {
            let other = scene.surface(id);
            let may_overlap = other.plane() == surface.plane() && other.face != surface.face && !is_added_back(scene, id.index());
            if may_overlap && overlap(&surface.polygon.facet(), &other.polygon.facet()) {
                found = Some((surface.face, other.face));
            }
            found.is_some()
        });
        found
    };
    let mut overlapping: Vec<(u32, u32)> = scene.surfaces().par_iter().enumerate().filter_map(other_of).collect();
    overlapping.sort_unstable();
    overlapping.dedup_by_key(|&mut (face, _)| face);
    overlapping
}

/// Whether a surface is the back that a face was given, not one that the input has.
fn is_added_back(scene: &Scene, index: usize) -> bool {
    let surface = &scene.surfaces()[index];
    surface.twin().is_some_and(|twin: SurfaceId| twin.index() < index && scene.surface(twin).face == surface.face)
}

/// Whether two polygons of one plane face the same way and cover a place together.
fn overlap(a: &Facet<'_>, b: &Facet<'_>) -> bool {
    if a.normal.dot(b.normal) <= 0.0 || a.centroid.distance(b.centroid) > a.radius + b.radius {
        return false;
    }
    let mut part = ClippedFacet::copy_of(a);
    for (start, edge) in edges(b.vertices) {
        match clip_to_front(&part.facet(), start, b.normal.cross(edge).normalize_or_zero()) {
            Clip::Whole => {}
            Clip::Part(rest) => part = rest,
            Clip::Nothing => return false,
        }
    }
    part.facet().area > PART_WORTH_TELLING * a.area.min(b.area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    fn scene(squares: &[([f64; 2], f64, bool)], sides: Sides) -> Scene {
        let faces = squares.iter().enumerate().map(|(number, &([x, y], z, up))| {
            let corners = [[x, y, z], [x + 1.0, y, z], [x + 1.0, y + 1.0, z], [x, y + 1.0, z]];
            let polygon = Polygon::new(&corners).unwrap();
            (if up { polygon } else { polygon.reversed() }, 0, number as u32)
        });
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
        Scene::new(1, vec![grey], faces.collect(), sides).unwrap()
    }

    #[test]
    fn what_lies_in_the_front_of_another_is_found_and_neighbours_are_not() {
        let beside = ([3.0, 3.0], 0.0, true);
        let over = ([2.5, 2.5], 0.0, true);
        let opposite = ([2.0, 2.5], 0.0, false);
        let above = ([2.0, 3.0], 0.01, true);
        let apart = ([3.0, 4.0], 0.0, true);
        let first = ([2.0, 3.0], 0.0, true);
        for sides in [Sides::Front, Sides::Both] {
            assert_eq!(overlapping_faces(&scene(&[first, beside, opposite, above, apart], sides)), []);
            assert_eq!(overlapping_faces(&scene(&[first, above, over], sides)), [(0, 2), (2, 0)]);
        }
    }

    #[test]
    fn a_gap_that_visibility_cannot_tell_counts_as_none() {
        let lifted = |z: f64| scene(&[([0.0, 0.0], 0.0, true), ([0.25, 0.0], z, true)], Sides::Front);
        assert_eq!(overlapping_faces(&lifted(1e-7)), [(0, 1), (1, 0)]);
        assert_eq!(overlapping_faces(&lifted(1e-4)), []);
    }
}
