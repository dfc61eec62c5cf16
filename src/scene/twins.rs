//! The two sides of sheets.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::surfaces::Surfaces;
use super::{Scene, Sides, Surface, SurfaceId};
use crate::geometry::{Polygon, sampling};

impl Scene {
    /// Finds the surfaces that are two sides of one sheet, and with [`Sides::Both`] puts the missing side behind every other one.
    ///
    /// Two surfaces on the same vertices, of equal coordinates, with opposite winding are such a sheet. Cost: O(n log n).
    pub(super) fn add_twins(&mut self) {
        // Surfaces on the same vertices come together, in their order; those whose vertices only seem to be the same are told apart below.
        let surfaces = self.surfaces.par_iter().enumerate();
        let mut by_vertices: Vec<(u64, u32)> = surfaces.map(|(index, surface)| (hash_of_vertices(surface), index as u32)).collect();
        by_vertices.par_sort_unstable();
        for same in by_vertices.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            self.pair_sides(same.iter().map(|&(_, index)| index));
        }
        if self.sides == Sides::Front {
            return;
        }

        // Each surface that is alone is followed by its back, so the numbers shift.
        let mut number = Vec::with_capacity(self.surfaces.len());
        let mut next = 0;
        for surface in self.surfaces.iter() {
            number.push(next);
            next += if surface.twin.is_some() { 1 } else { 2 };
        }
        let back = |surface: &Surface| surface.twin.is_none().then(|| surface.polygon.reversed());
        let backs: Vec<Option<Polygon>> = self.surfaces.par_iter().map(back).collect();
        let mut surfaces = Vec::with_capacity(next as usize);
        for (mut surface, back) in self.surfaces.take().into_iter().zip(backs) {
            let own = surfaces.len() as u32;
            if let Some(twin) = surface.twin {
                surface.twin = Some(SurfaceId(number[twin.index()]));
                surfaces.push(surface);
            } else if let Some(polygon) = back {
                surface.twin = Some(SurfaceId(own + 1));
                let back = Surface { polygon, twin: Some(SurfaceId(own)), ..surface };
                surfaces.extend([surface, back]);
            }
        }
        self.surfaces = Surfaces::new(surfaces);
    }

    /// Pairs each of these surfaces with one before it that is its reverse and has no twin yet.
    fn pair_sides(&mut self, candidates: impl Iterator<Item = u32>) {
        let mut waiting: HashMap<Vec<[u64; 3]>, Vec<u32>> = HashMap::new();
        let surfaces = self.surfaces.but_polygons_mut();
        for index in candidates {
            let (own, reverse) = windings(&surfaces[index as usize]);
            if let Some(twin) = waiting.get_mut(&reverse).and_then(Vec::pop) {
                surfaces[index as usize].twin = Some(SurfaceId(twin));
                surfaces[twin as usize].twin = Some(SurfaceId(index));
            } else {
                waiting.entry(own).or_default().push(index);
            }
        }
    }
}

/// Equal for surfaces on the same vertices, whatever their order; adding 0 makes -0 and 0 the same.
fn hash_of_vertices(surface: &Surface) -> u64 {
    let vertices = surface.polygon.facet().vertices;
    vertices.iter().map(|&vertex| sampling::seed_at(vertex + DVec3::ZERO, 0)).fold(0, u64::wrapping_add)
}

/// The vertices in the order of the front and of the back, each from the least vertex on.
fn windings(surface: &Surface) -> (Vec<[u64; 3]>, Vec<[u64; 3]>) {
    // Adding 0 makes -0 and 0 the same.
    let mut own: Vec<[u64; 3]> = surface.polygon.vertices().map(|vertex| vertex.map(|x| (x + 0.0).to_bits())).collect();
    let least = (0..own.len()).min_by_key(|&k| own[k]).unwrap_or(0);
    own.rotate_left(least);
    let mut reverse = own.clone();
    reverse[1..].reverse();
    (own, reverse)
}
