//! The equations of cell radiosities, one sparse random row for each cell, and how they are solved.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::iteration::{MAX_STEPS, iterated};
use crate::paths::NO_CELL;
use crate::progress::Stop;

/// The most that the weights in a row may sum to where terms of reflectors are in it: below 1, so that sweeps converge.
pub(super) const MOST_TAKEN: f32 = 0.99;

/// Cells whose rows are made and multiplied together.
pub(super) const BATCH: usize = 256;

/// One equation for each cell: `B = constant + sum over paths of weight * B_end + terms of reflectors`.
pub(super) struct Equations {
    pub channels: usize,
    /// The first so many of them tell when it is enough.
    pub deciding: usize,
    /// Paths from each cell.
    pub paths: usize,
    /// By cell and channel.
    pub constant: Vec<f64>,
    /// By cell and path, the cell where the path ends.
    pub end: Vec<u32>,
    /// By cell, path and channel; includes the reflectance and `1 / paths`.
    pub weight: Vec<f32>,
    /// What next-event rays to reflectors bring, by [`BATCH`] of cells.
    pub of_reflectors: Vec<ReflectorTerms>,
}

/// The terms of reflectors in the rows of a batch: seen from the view points of its cells, and from where their paths go on.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct ReflectorTerms {
    /// The index of the row in the batch, and the cell of the reflector.
    cells: Vec<(usize, u32)>,
    /// By entry of `cells` and channel; includes the reflectance and the number of rays.
    weight: Vec<f32>,
}

impl ReflectorTerms {
    /// Adds a term to row `by`: the radiosity of `cell` times `weights` and `reflectance`, by channel.
    pub fn add(&mut self, by: usize, cell: u32, weights: impl Iterator<Item = f64>, reflectance: &[f64]) {
        self.cells.push((by, cell));
        self.weight.extend(weights.zip(reflectance).map(|(weight, rho)| (rho * weight) as f32));
    }

    /// Scales terms down where the weights of a row sum to more than [`MOST_TAKEN`]: with noise they may reach 1, and light would
    /// grow from sweep to sweep. `end` and `weight` are those of the batch's paths, `count` from each cell.
    pub fn limit_row_sums(&mut self, end: &[u32], weight: &[f32], count: usize, channels: usize) {
        if self.cells.is_empty() {
            return;
        }
        let mut of_paths = vec![0.0_f32; end.len() / count * channels];
        let ending = end.iter().zip(weight.chunks(channels)).enumerate().filter(|(_, (end, _))| **end != NO_CELL);
        ending.for_each(|(path, (_, weights))| add_weights(&mut of_paths, path / count, weights));
        let mut seen = vec![0.0_f32; of_paths.len()];
        self.cells.iter().zip(self.weight.chunks(channels)).for_each(|(&(by, _), weights)| add_weights(&mut seen, by, weights));

        // The terms get what paths leave.
        for (&(by, _), weights) in self.cells.iter().zip(self.weight.chunks_mut(channels)) {
            for (channel, weight) in weights.iter_mut().enumerate() {
                let sum = by * channels + channel;
                let room = (MOST_TAKEN - of_paths[sum]).max(0.0);
                if seen[sum] > room {
                    *weight *= room / seen[sum];
                }
            }
        }
    }
}

/// Adds weights by channel to the sums of a row.
fn add_weights(sums: &mut [f32], row: usize, weights: &[f32]) {
    sums[row * weights.len()..][..weights.len()].iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight);
}

impl Equations {
    /// Rows in which no light comes from anywhere yet.
    pub fn empty(cells: usize, paths: usize, [channels, deciding]: [usize; 2]) -> Self {
        Self {
            channels,
            deciding,
            paths,
            constant: vec![0.0; cells * channels],
            end: vec![NO_CELL; cells * paths],
            weight: vec![0.0; cells * paths * channels],
            of_reflectors: Vec::new(),
        }
    }

    /// The radiosities of all cells; `None` if stopped before.
    ///
    /// Two Jacobi sweeps make one step: light between two facing surfaces changes the one and the other in turn.
    pub fn iterate(&self, stop: Stop<'_>) -> Option<Vec<f64>> {
        let mut between = vec![0.0; self.constant.len()];
        let step = |values: &[f64], next: &mut [f64]| {
            self.sweep(values, &mut between);
            self.sweep(&between, next);
        };
        let found = iterated(self.constant.clone(), ([self.channels, self.deciding], MAX_STEPS, f64::INFINITY), step, stop)?;
        Some(found.values)
    }

    /// One Jacobi sweep: `next` is the right-hand side of all equations for the radiosities `values`.
    fn sweep(&self, values: &[f64], next: &mut [f64]) {
        let (channels, paths) = (self.channels, self.paths);
        let add = |next: &mut [f64], cell: u32, weight: &[f32]| {
            let sent = &values[cell as usize * channels..][..channels];
            next.iter_mut().zip(weight).zip(sent).for_each(|((next, weight), sent)| *next += f64::from(*weight) * sent);
        };
        let batches = next.par_chunks_mut(BATCH * channels).zip(&self.of_reflectors).with_min_len(4).enumerate();
        batches.for_each(|(batch, (next, seen))| {
            for (cell, next) in (batch * BATCH..).zip(next.chunks_mut(channels)) {
                next.copy_from_slice(&self.constant[cell * channels..][..channels]);
                let ends = &self.end[cell * paths..][..paths];
                let weights = self.weight[cell * paths * channels..].chunks(channels);
                ends.iter().zip(weights).filter(|(end, _)| **end != NO_CELL).for_each(|(&end, weight)| add(next, end, weight));
            }
            for (&(by, cell), weight) in seen.cells.iter().zip(seen.weight.chunks(channels)) {
                add(&mut next[by * channels..][..channels], cell, weight);
            }
        });
    }
}
