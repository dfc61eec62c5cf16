//! The two sides of sheets.

use std::collections::HashMap;

use super::{Scene, Sides, Surface, SurfaceId};

impl Scene {
    /// Finds the surfaces that are two sides of one sheet, and with [`Sides::Both`] puts the missing side behind every other one.
    ///
    /// Two surfaces on the same vertices, of equal coordinates, with opposite winding are such a sheet. Cost: O(n) expected.
    pub(super) fn add_twins(&mut self) {
        // Pair each surface with one before it that is its reverse and has no twin yet.
        let mut waiting: HashMap<Vec<[u64; 3]>, Vec<u32>> = HashMap::with_capacity(self.surfaces.len());
        for index in 0..self.surfaces.len() {
            let (own, reverse) = windings(&self.surfaces[index]);
            let twin = waiting.get_mut(&reverse).and_then(Vec::pop);
            if let Some(twin) = twin {
                self.surfaces[index].twin = Some(SurfaceId(twin));
                self.surfaces[twin as usize].twin = Some(SurfaceId(index as u32));
            } else {
                waiting.entry(own).or_default().push(index as u32);
            }
        }
        if self.sides == Sides::Front {
            return;
        }

        // Each surface that is alone is followed by its back, so the numbers shift.
        let mut number = Vec::with_capacity(self.surfaces.len());
        let mut next = 0;
        for surface in &self.surfaces {
            number.push(next);
            next += if surface.twin.is_some() { 1 } else { 2 };
        }
        let mut surfaces = Vec::with_capacity(next as usize);
        for mut surface in std::mem::take(&mut self.surfaces) {
            let own = surfaces.len() as u32;
            if let Some(twin) = surface.twin {
                surface.twin = Some(SurfaceId(number[twin.index()]));
                surfaces.push(surface);
            } else {
                let back = Surface { polygon: surface.polygon.reversed(), twin: Some(SurfaceId(own)), ..surface };
                surface.twin = Some(SurfaceId(own + 1));
                surfaces.extend([surface, back]);
            }
        }
        self.surfaces = surfaces;
    }
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
