//! The positions of cells: a random point in each, and one for each path that leaves it.

use rayon::prelude::*;

use crate::geometry::{sampling, streams};
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
            let point = paths.open_part(surface, grid, index)?.sampled_point(seed);
            Some(Place { point, surface, seed })
        };
        (0..grid.len()).map(position).collect()
    };
    grids.par_iter().with_min_len(64).flat_map_iter(of_grid).collect()
}

/// Where so many paths of a cell start: at random points where it has a value, whatever its position.
pub(super) fn starts_of_paths<'a>(paths: &'a LightPaths<'_>, position: Place, count: usize) -> impl Iterator<Item = Place> + 'a {
    let grid = paths.grids.at(position.surface, position.point);
    let part = grid.and_then(|grid| paths.open_part(position.surface, grid, grid.index_at(position.point)));
    (0..count).map(move |number| {
        let seed = sampling::hash(position.seed, streams::START_OF_PATH + number as u64);
        let point = part.as_ref().map_or(position.point, |part| part.sampled_point(seed));
        Place { point, seed, ..position }
    })
}
