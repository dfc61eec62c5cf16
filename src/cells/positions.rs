//! The positions of cells: a random point in each.

use rayon::prelude::*;

use crate::geometry::{sampling, streams};
use crate::paths::{Grid, LightPaths, Place};

/// Points tried in a cell until one lies on the surface.
const TRIES: u64 = 8;

/// A cell before its radiosity is known.
#[derive(Clone, Copy)]
pub(super) enum Cell {
    /// No point of the surface was found in it.
    Empty,
    /// A random point of the surface in it.
    Position(Place),
}

/// The positions of some cells; first, for each, the index of its cell.
pub(super) fn positions(cells: &[Cell]) -> (Vec<usize>, Vec<Place>) {
    let position = |(index, cell): (usize, &Cell)| match cell {
        Cell::Position(place) => Some((index, *place)),
        Cell::Empty => None,
    };
    cells.iter().enumerate().filter_map(position).unzip()
}

/// A random position in every cell that meets its surface.
pub(super) fn sampled_positions(paths: &LightPaths<'_>, seed: u64) -> Vec<Cell> {
    let grids: Vec<_> = paths.grids.grids().collect();
    let of_grid = |(surface, grid): &(_, &Grid)| -> Vec<Cell> {
        let facet = paths.scene.surface(*surface).polygon.facet();
        let mut cells: Vec<Cell> = (0..grid.len())
            .map(|index| {
                let seed = sampling::hash(seed, u64::from(grid.first) + index as u64);
                let tries = (0..TRIES).map(|attempt| sampling::hash(seed, attempt));
                let mut points = tries
                    .map(|draw| grid.point_in(index, sampling::unit(draw), sampling::unit(sampling::hash(draw, streams::SECOND))));
                let inside = points.find(|&point| facet.contains(point));
                inside.map_or(Cell::Empty, |point| Cell::Position(Place { point, surface: *surface, seed }))
            })
            .collect();

        // All tries may miss a sliver; then any point of the surface will do.
        if cells.iter().all(|cell| matches!(cell, Cell::Empty)) {
            let seed = sampling::hash(seed, u64::from(grid.first));
            let point = facet.point_at(sampling::unit(seed), sampling::unit(sampling::hash(seed, streams::SECOND)));
            cells[0] = Cell::Position(Place { point, surface: *surface, seed });
        }
        cells
    };
    grids.par_iter().with_min_len(64).flat_map_iter(of_grid).collect()
}
