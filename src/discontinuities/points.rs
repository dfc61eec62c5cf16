//! Points that are one within a tolerance.

use std::collections::HashMap;

use glam::DVec3;

/// The points so far, in cells a tolerance wide.
pub(super) struct Welder {
    tolerance: f64,
    cells: HashMap<[i64; 3], Vec<DVec3>>,
}

impl Welder {
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, cells: HashMap::new() }
    }

    /// The first point within the tolerance of `point`, and whether it is `point` itself, new.
    pub fn weld(&mut self, point: DVec3) -> (DVec3, bool) {
        let cell = (point / self.tolerance).floor().as_i64vec3().to_array();
        let around = [-1, 0, 1].into_iter().flat_map(|x| [-1, 0, 1].into_iter().flat_map(move |y| [-1, 0, 1].map(|z| [x, y, z])));
        for offset in around {
            let neighbour: [i64; 3] = std::array::from_fn(|k| cell[k].saturating_add(offset[k]));
            let known = self
                .cells
                .get(&neighbour)
                .and_then(|points| points.iter().find(|known| known.distance_squared(point) <= self.tolerance * self.tolerance));
            if let Some(&known) = known {
                return (known, false);
            }
        }
        self.cells.entry(cell).or_default().push(point);
        (point, true)
    }
}
