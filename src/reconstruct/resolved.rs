//! Radiosities resolved at positions: one in every cell of the lattice, found by light paths alone.
//!
//! From a random position in each cell a few paths are followed to the cells where they end. What they find there is not known yet;
//! so the paths are kept, and the positions take their radiosities from one another until nothing changes:
//!
//! ```text
//! B_i = E_i + rho_i (direct_i + mean over paths p of (constant_p + weight_p B_end(p)))
//! ```
//!
//! That is the radiosity equation with random rows instead of integrals, each unbiased. Its solution is noisy at a single position,
//! which gathers over many positions average out; biased is it only where a path comes back to its own position, which few do.
//!
//! What lamps bring varies over a cell, much where they are near. So rays to them do not start from the position, but from a few spots (`spots.rs`)
//! where others see the cell. (In two white rooms with a lamp beside a wall, resolved at 3200 positions, values had been 1.1 +- 0.2% too
//! dark and scattered by 3.2% from seed to seed; from spots they are right to 0.2% and scatter by 1.7%. In an office at 2% the square of
//! what values are off by for believing cells fell to a half.)
//!
//! The light that lamp rays bring is left out of what a cell sends.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::equations::{Cell, Equations};
use super::lattice::Grid;
use super::light_paths::{LightPaths, Place};
use crate::geometry::sampling;
use crate::scene::{DistinctChannels, Scene};

/// How finely radiosities are resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Resolution {
    /// The size of a cell, in metres.
    pub side: f64,
    /// Paths from each position, and as many rays to lamps.
    pub rays: u32,
}

impl Resolution {
    /// About `positions` cells over the surfaces of a scene.
    pub fn of_positions(scene: &Scene, positions: usize, rays: u32) -> Self {
        let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
        Self { side: (area / positions.max(1) as f64).sqrt(), rays }
    }

    /// Whether the numbers are in range.
    pub fn is_valid(&self) -> bool {
        self.side.is_finite() && self.side > 0.0 && self.rays > 0
    }
}

/// What every cell sends, by channel: its radiosity in W/m^2, less what lamp rays bring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Resolved {
    channels: usize,
    /// By cell, as found at its position.
    values: Vec<f32>,
    /// By cell, the one that stands for it where it is seen: by those who are not covered, then by those who are. They see different parts
    /// of a cell, and its position lies in one of them.
    stand_in: [Vec<u32>; 2],
}

/// Points tried in a cell until one lies on the surface.
const TRIES: u64 = 8;

impl Resolved {
    /// Solves for what every cell sends.
    pub fn solve(paths: &LightPaths<'_>, resolution: &Resolution, seed: u64) -> Self {
        let cells = spread_positions(paths, seed);
        let mut equations = Equations::of_paths(paths, &cells, resolution, seed);
        let mut stand_in = [false, true].map(|covered| stand_ins(paths, &cells, &equations, covered));

        equations.redirect(&stand_in);
        let channels = paths.scene.channels();
        let mut values: Vec<f32> = equations.solve().into_iter().map(|value| value as f32).collect();

        // Cells without a position have no value of their own.
        for (cell, _) in cells.iter().enumerate().filter(|(_, cell)| matches!(cell, Cell::Empty)) {
            let from = stand_in[0][cell] as usize * channels;
            values.copy_within(from..from + channels, cell * channels);
            stand_in[0][cell] = cell as u32;
        }
        Self { channels, values, stand_in }
    }

    /// The same for all channels, from those that were solved.
    pub fn spread(&self, channels: &DistinctChannels) -> Self {
        Self { channels: channels.count(), values: channels.spread(&self.values), stand_in: self.stand_in.clone() }
    }

    /// What a cell sends, by channel, where it is not covered.
    pub fn of(&self, cell: u32) -> &[f32] {
        self.seen_from(false, cell)
    }

    /// What a cell sends to a place, by channel: who is covered sees the covered parts of cells, all others what is not.
    pub fn seen_from(&self, covered: bool, cell: u32) -> &[f32] {
        let cell = self.stand_in[usize::from(covered)][cell as usize];
        &self.values[cell as usize * self.channels..][..self.channels]
    }

    /// Whether it fits a number of cells and channels, and holds only numbers; in the dark noise may take them below 0.
    pub fn is_valid(&self, cells: usize, channels: usize) -> bool {
        let stands_in = |cells_of: &Vec<u32>| cells_of.len() == cells && cells_of.iter().all(|&cell| (cell as usize) < cells);
        let fits = self.channels == channels && self.values.len() == cells * channels;
        fits && self.values.iter().all(|value| value.is_finite()) && self.stand_in.iter().all(stands_in)
    }

    /// Bytes that the values take.
    pub fn memory_bytes(&self) -> u64 {
        Self::bytes_of(self.stand_in[0].len(), self.channels)
    }

    /// Bytes that the values of so many cells take.
    pub fn bytes_of(cells: usize, channels: usize) -> u64 {
        (cells * (channels * size_of::<f32>() + 2 * size_of::<u32>())) as u64
    }
}

/// A random position in every cell that meets its surface.
fn spread_positions(paths: &LightPaths<'_>, seed: u64) -> Vec<Cell> {
    let grids: Vec<_> = paths.lattice.grids().collect();
    let of_grid = |(surface, grid): &(_, &Grid)| -> Vec<Cell> {
        let facet = paths.scene.surface(*surface).polygon.facet();
        let mut cells: Vec<Cell> = (0..grid.len())
            .map(|index| {
                let seed = sampling::hash(seed, u64::from(grid.first) + index as u64);
                let tries = (0..TRIES).map(|attempt| sampling::hash(seed, attempt));
                let mut points =
                    tries.map(|draw| grid.point_in(index, sampling::unit(draw), sampling::unit(sampling::hash(draw, 1))));
                let inside = points.find(|&point| facet.contains(point));
                inside.map_or(Cell::Empty, |point| Cell::Position(Place { point, surface: *surface, seed }))
            })
            .collect();

        // A sliver may slip through; then any point of the surface will do.
        if cells.iter().all(|cell| matches!(cell, Cell::Empty)) {
            let seed = sampling::hash(seed, u64::from(grid.first));
            let point = facet.point_at(sampling::unit(seed), sampling::unit(sampling::hash(seed, 1)));
            cells[0] = Cell::Position(Place { point, surface: *surface, seed });
        }
        cells
    };
    grids.par_iter().with_min_len(64).flat_map_iter(of_grid).collect()
}

/// For every cell the nearest one of its surface with a position that is covered as told: itself, for most. A cell that has none beside it
/// may well be seen as a whole by those who are covered, in part.
fn stand_ins(paths: &LightPaths<'_>, cells: &[Cell], equations: &Equations, covered: bool) -> Vec<u32> {
    let mut stand_in: Vec<u32> = (0..cells.len() as u32).collect();
    let most_steps = if covered { 1 } else { usize::MAX };
    for (_, grid) in paths.lattice.grids() {
        let first = grid.first as usize;
        let serves = |cell: usize| matches!(cells[cell], Cell::Position(_)) && equations.is_covered(cell) == covered;
        let mut open: Vec<usize> = (first..first + grid.len()).filter(|&cell| !serves(cell)).collect();
        if open.is_empty() || open.len() == grid.len() {
            // Nothing to do; or no path from such a place ends here but by rounding.
            let any = (first..first + grid.len()).find(|&cell| matches!(cells[cell], Cell::Position(_))).unwrap_or(first);
            open.into_iter().filter(|&cell| matches!(cells[cell], Cell::Empty)).for_each(|cell| stand_in[cell] = any as u32);
            continue;
        }

        // The known spreads from cell to cell, a step in every round.
        let columns = grid.columns as usize;
        let mut is_open = vec![false; grid.len()];
        open.iter().for_each(|cell| is_open[cell - first] = true);
        let mut steps = 0;
        while !open.is_empty() && steps < most_steps {
            steps += 1;
            let found: Vec<(usize, u32)> = open
                .iter()
                .filter_map(|&cell| {
                    let (index, column) = (cell - first, (cell - first) % columns);
                    let left = (column > 0).then(|| index - 1);
                    let right = (column + 1 < columns).then_some(index + 1);
                    let (below, above) = (index.checked_sub(columns), (index + columns < grid.len()).then_some(index + columns));
                    let neighbours = [left, right, below, above].into_iter().flatten();
                    neighbours.into_iter().find(|&near| !is_open[near]).map(|near| (cell, stand_in[first + near]))
                })
                .collect();
            for &(cell, by) in &found {
                stand_in[cell] = by;
                is_open[cell - first] = false;
            }
            open.retain(|cell| is_open[cell - first]);
        }
    }
    stand_in
}
