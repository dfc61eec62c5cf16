//! The positions of cells: a random point in each.

use rayon::prelude::*;

use crate::geometry::sampling;
use crate::paths::{Grid, LightPaths, Place};
use crate::progress::Stop;

/// A random position in every cell, where it has a value; `None` where a cell has none anywhere, and in all that follow once stopped.
pub(super) fn sampled_positions(paths: &LightPaths<'_>, seed: u64, stop: Stop<'_>) -> Vec<Option<Place>> {
    let grids: Vec<_> = paths.grids.grids().collect();
    let of_grid = |&(surface, grid): &(_, &Grid)| -> Vec<Option<Place>> {
        let is_late = stop();
        let position = |index: usize| {
            if is_late {
                return None;
            }
            let seed = sampling::hash(seed, u64::from(grid.first) + index as u64);
            let point = paths.sampled_point(surface, grid, index, seed)?;
            Some(Place { point, surface, seed })
        };
        (0..grid.len()).map(position).collect()
    };
    grids.par_iter().with_min_len(64).flat_map_iter(of_grid).collect()
}
