//! Cell radiosities: one for every cell of the grids, found by light paths alone (stochastic Jacobi radiosity with kept paths).
//!
//! From a random position in each cell a few paths are followed to the cells where they end. The radiosities there are not known
//! yet, so the paths are kept: they are the rows of a linear system, which is iterated:
//!
//! ```text
//! B_i = E_i + rho_i (direct_i + mean over paths p of (constant_p + weight_p B_end(p)))
//! ```
//!
//! Each row is an unbiased estimate of the integral in the radiosity equation. The solution is noisy in a single cell; a final
//! gather averages over many. It has a bias only from paths that come back to their own cell, and few do.
//!
//! Direct light may vary much over a cell. So next-event estimation starts not from the position but from a few view points
//! (`view_points.rs`), the places where others see the cell. Emission that next-event estimation brings to others is left out of
//! `B_i`.

use serde::{Deserialize, Serialize};

use super::equations::Equations;
use super::positions::{Cell, sampled_positions};
use super::representatives::representatives;
use crate::paths::{LightPaths, Resolution};
use crate::scene::DistinctChannels;

/// The radiosity of every cell by channel, in W/m^2, without the emission that next-event estimation brings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CellRadiosities {
    channels: usize,
    /// By cell, as found at its position.
    values: Vec<f32>,
    /// By cell, the cell whose value is used for it: as seen from outside of solids, and from inside. The two see different parts
    /// of a cell, and its position lies in one of them.
    representative: [Vec<u32>; 2],
}

impl CellRadiosities {
    /// Solves for the radiosities of all cells.
    pub fn solve(paths: &LightPaths<'_>, resolution: &Resolution, seed: u64) -> Self {
        // The equations: positions, and paths from there.
        let cells = sampled_positions(paths, seed);
        let mut equations = Equations::of_paths(paths, &cells, resolution.rays, seed);

        // Cells without a position where they are seen take part by another cell.
        let mut representative = [false, true].map(|inside| representatives(paths, &cells, &equations, inside));
        equations.redirect(&representative);

        let channels = paths.scene.channels();
        let mut values: Vec<f32> = equations.iterate().into_iter().map(|value| value as f32).collect();

        // Cells without any position get a copy of the value that is used for them.
        for (cell, _) in cells.iter().enumerate().filter(|(_, cell)| matches!(cell, Cell::Empty)) {
            let from = representative[0][cell] as usize * channels;
            values.copy_within(from..from + channels, cell * channels);
            representative[0][cell] = cell as u32;
        }
        Self { channels, values, representative }
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(&self, channels: &DistinctChannels) -> Self {
        Self { channels: channels.count(), values: channels.expand(&self.values), representative: self.representative.clone() }
    }

    /// The radiosity of a cell as seen from outside of solids, by channel.
    pub fn of(&self, cell: u32) -> &[f32] {
        self.seen_from(false, cell)
    }

    /// The radiosity of a cell as seen from inside a solid, or from outside, by channel.
    pub fn seen_from(&self, inside: bool, cell: u32) -> &[f32] {
        let cell = self.representative[usize::from(inside)][cell as usize];
        &self.values[cell as usize * self.channels..][..self.channels]
    }

    /// Whether it fits a number of cells and channels, and all values are finite; in the dark noise may take them below 0.
    pub fn is_valid(&self, cells: usize, channels: usize) -> bool {
        let stands_in = |cells_of: &Vec<u32>| cells_of.len() == cells && cells_of.iter().all(|&cell| (cell as usize) < cells);
        let fits = self.channels == channels && self.values.len() == cells * channels;
        fits && self.values.iter().all(|value| value.is_finite()) && self.representative.iter().all(stands_in)
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        Self::bytes_of(self.representative[0].len(), self.channels)
    }

    /// Bytes that so many cells take.
    pub fn bytes_of(cells: usize, channels: usize) -> u64 {
        (cells * (channels * size_of::<f32>() + 2 * size_of::<u32>())) as u64
    }
}
