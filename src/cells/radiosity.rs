//! Cell radiosities: one for every cell of the grids, found by light paths alone (stochastic Jacobi radiosity with kept paths).
//!
//! From random points of each cell a few paths are followed to the cells where they end. The radiosities there are not known
//! yet, so the paths are kept: they are the rows of a linear system, which is iterated:
//!
//! ```text
//! B_i = E_i + rho_i (direct_i + mean over paths p of (constant_p + weight_p B_end(p)))
//! ```
//!
//! Each row is an unbiased estimate of the integral in the radiosity equation. The solution is noisy in a single cell; a final
//! gather averages over many. It has a bias only from paths that come back to their own cell, and few do.
//!
//! Direct light may vary much over a cell. So next-event estimation starts not from these points but from a few view points
//! (`view_points.rs`), the places where others see the cell. Emission that next-event estimation brings to others is left out of
//! `B_i`.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::assemble::bytes_to_assemble;
use super::equations::{BATCH, Equations};
use super::positions::sampled_positions;
use crate::paths::{LightPaths, Resolution};
use crate::progress::Stop;
use crate::scene::DistinctChannels;

/// The radiosity of every cell by channel, in W/m^2, without the emission that next-event estimation brings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CellRadiosities {
    channels: usize,
    /// By cell, the mean over where it has a value; 0 where it has none, and no path ends.
    values: Vec<f32>,
}

impl CellRadiosities {
    /// Solves for the radiosities of all cells; `None` if stopped before.
    pub fn solve(paths: &LightPaths<'_>, resolution: &Resolution, seed: u64, stop: Stop<'_>) -> Option<Self> {
        let positions = sampled_positions(paths, seed, stop);
        if stop() {
            return None;
        }
        let equations = Equations::of_paths(paths, &positions, resolution.rays, seed, stop)?;
        drop(positions);
        Some(Self::of_values(paths.scene.channels(), &equations.iterate(stop)?))
    }

    /// These radiosities, by cell and channel.
    pub(super) fn of_values(channels: usize, values: &[f64]) -> Self {
        Self { channels, values: values.iter().map(|&value| value as f32).collect() }
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(&self, channels: &DistinctChannels) -> Self {
        Self { channels: channels.count_of(self.channels), values: channels.expand(&self.values) }
    }

    /// The same in some of the channels.
    pub fn of_channels(&self, channels: Range<usize>) -> Self {
        let values = self.values.chunks(self.channels).flat_map(|of_cell| &of_cell[channels.clone()]).copied().collect();
        Self { channels: channels.len(), values }
    }

    /// With other values in so many channels, by cell and channel, of what all of these become together.
    pub fn mapped(&self, channels: usize, map: impl Fn(&[f32]) -> Vec<f32>) -> Self {
        Self { channels, values: map(&self.values) }
    }

    /// The radiosity of a cell by channel.
    pub fn of(&self, cell: u32) -> &[f32] {
        &self.values[cell as usize * self.channels..][..self.channels]
    }

    /// By cell and channel.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Whether it fits a number of cells and channels, and all values are finite; in the dark noise may take them below 0.
    pub fn is_valid(&self, cells: usize, channels: usize) -> bool {
        let fits = self.channels == channels && self.values.len() == cells * channels;
        fits && self.values.iter().all(|value| value.is_finite())
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        (self.values.len() * size_of::<f32>()) as u64
    }

    /// How often solving for so many cells asks whether to stop, sweeps left out.
    pub fn questions(cells: usize) -> usize {
        2 * cells.div_ceil(BATCH)
    }

    /// Bytes that it takes to solve for so many cells with so many paths from each, beside the result.
    pub fn bytes_to_solve(cells: usize, rays: u32, channels: usize) -> u64 {
        bytes_to_assemble(cells, rays as usize, channels)
    }

    /// Bytes that so many cells take.
    pub fn bytes_of(cells: usize, channels: usize) -> u64 {
        (cells * channels * size_of::<f32>()) as u64
    }
}
