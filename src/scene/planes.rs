//! Groups of coplanar surfaces.
//!
//! A surface never hides anything from a point in its own plane, so visibility leaves the surfaces of both end planes alone. A wrong
//! split only costs false self-occlusion along shared edges, a wrong join lets light through a wall: joins are strict.
//!
//! # Tolerance
//! Surfaces are taken from the widest to the narrowest, since a wide one knows its normal best. The first surface of a group fixes its
//! plane, through its centroid. Another belongs to it if each of its vertices lies within [`DISTANCE_TOLERANCE`] times the scene's
//! diagonal of that plane, and its normal or the reverse is within [`ANGLE_TOLERANCE`]; of several planes the nearest is taken, so that
//! a number stands for one plane within the tolerance, however long a chain of nearly coplanar surfaces is. Twins always share one.
//!
//! # Cost
//! O(n log n): planes are found in cells of similar normals, sorted by their offset from the scene's centre. A surface that is narrow
//! beside the tolerance knows its own offset badly and looks at a wider range of planes.

use std::collections::{BTreeSet, HashMap};

use glam::DVec3;

use super::{Scene, Surface};

/// Distance from a plane that still counts as in it, as a fraction of the scene's diagonal: files give six or seven digits.
pub(super) const DISTANCE_TOLERANCE: f64 = 1e-6;

/// Angle in radians that normals may differ by. It keeps small facets of curved surfaces, which lie within the distance of many planes,
/// out of planes that only pass through them.
pub(super) const ANGLE_TOLERANCE: f64 = 1e-3;

/// Side of a cell of normals: large beside the angle, so that a surface rarely has to look into more than one.
const CELL: f64 = 16.0 * ANGLE_TOLERANCE;

/// A plane in Hessian form: `normal . (x - centre of the scene) = offset`.
#[derive(Clone, Copy)]
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Scene {
    /// Numbers the planes: two surfaces get the same number if and only if they lie in one plane, on either side of it.
    ///
    /// Numbers count from 0 in the order of the surfaces.
    pub(super) fn group_planes(&mut self) {
        let bounds = self.bounds();
        let centre = bounds.centre();
        let tolerance = DISTANCE_TOLERANCE * bounds.diagonal();

        // From the widest to the narrowest, in the input's order where equally wide; of two twins only the first.
        let width = |surface: &Surface| surface.polygon.area() / surface.polygon.facet().radius;
        let mut order: Vec<(f64, usize)> = (self.surfaces.iter().enumerate())
            .filter(|(index, surface)| surface.twin.is_none_or(|twin| twin.index() > *index))
            .map(|(index, surface)| (width(surface), index))
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

        let mut finder = PlaneFinder::default();
        let mut plane_of = vec![u32::MAX; self.surfaces.len()];
        for (_, index) in order {
            plane_of[index] = finder.find_or_add(&self.surfaces[index], centre, tolerance);
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            if let Some(twin) = surface.twin.filter(|twin| twin.index() < index) {
                plane_of[index] = plane_of[twin.index()];
            }
        }

        // Renumber in the order of the surfaces.
        let mut number = vec![u32::MAX; finder.planes.len()];
        let mut next = 0;
        for (surface, plane) in self.surfaces.iter_mut().zip(plane_of) {
            let number = &mut number[plane as usize];
            if *number == u32::MAX {
                *number = next;
                next += 1;
            }
            surface.plane = *number;
        }
    }
}

/// The planes so far, sorted by offset in cells of similar normals.
#[derive(Default)]
struct PlaneFinder {
    planes: Vec<Plane>,
    cells: HashMap<[i32; 3], BTreeSet<(u64, u32)>>,
}

impl PlaneFinder {
    /// The nearest plane that `surface` lies in, else a new one through it.
    fn find_or_add(&mut self, surface: &Surface, centre: DVec3, tolerance: f64) -> u32 {
        let facet = surface.polygon.facet();
        let arm = (facet.centroid - centre).length();

        // If all vertices lie within the tolerance of a plane, the normals differ by at most twice the tolerance over the least width of
        // the polygon, which is at least area / (2 radius). That bounds how far the offset along the own normal can be off.
        let angle = (4.0 * tolerance * facet.radius / facet.area).min(ANGLE_TOLERANCE) + 1e-12;
        let reach = tolerance + angle * arm + 1e-12 * arm;

        let mut best: Option<(f64, u32)> = None;
        for normal in [facet.normal, -facet.normal] {
            let offset = normal.dot(facet.centroid - centre);
            for cell in cells_around(normal) {
                let Some(cell) = self.cells.get(&cell) else { continue };
                for &(_, index) in cell.range((sortable(offset - reach), 0)..=(sortable(offset + reach), u32::MAX)) {
                    let plane = self.planes[index as usize];
                    if (plane.normal - normal).length() > ANGLE_TOLERANCE {
                        continue;
                    }
                    let distance =
                        (facet.vertices.iter()).map(|v| (plane.normal.dot(*v - centre) - plane.offset).abs()).fold(0.0, f64::max);
                    if distance <= tolerance && best.is_none_or(|best| (distance, index) < best) {
                        best = Some((distance, index));
                    }
                }
            }
        }
        if let Some((_, index)) = best {
            return index;
        }

        let index = self.planes.len() as u32;
        let plane = Plane { normal: facet.normal, offset: facet.normal.dot(facet.centroid - centre) };
        self.planes.push(plane);
        self.cells.entry(plane.normal.to_array().map(cell_of)).or_default().insert((sortable(plane.offset), index));
        index
    }
}

fn cell_of(coordinate: f64) -> i32 {
    (coordinate / CELL).floor() as i32
}

/// The cells that may hold normals within [`ANGLE_TOLERANCE`] of `normal`: one, up to eight near the borders.
fn cells_around(normal: DVec3) -> impl Iterator<Item = [i32; 3]> {
    let [x, y, z] = normal.to_array().map(|c| cell_of(c - ANGLE_TOLERANCE)..=cell_of(c + ANGLE_TOLERANCE));
    x.flat_map(move |x| {
        let z = z.clone();
        y.clone().flat_map(move |y| z.clone().map(move |z| [x, y, z]))
    })
}

/// Bits that sort as the number does, -0 as 0.
fn sortable(number: f64) -> u64 {
    let bits = (number + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}
