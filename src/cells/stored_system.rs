//! The equations of cell radiosities that stored rows make with some materials, and their solution by Gauss-Seidel sweeps over blocks.
//!
//! Paths went on by the reflectances that were solved. With larger ones the weights of a row may sum to more than 1, and where such rows see each other
//! light grows from sweep to sweep. Then such rows are scaled down to [`MOST_TAKEN`], signs left out: sweeps converge, and what is left out
//! is in the error that independent replicates tell.

use rayon::prelude::*;

use super::equations::{BATCH, MOST_TAKEN};
use super::iteration::{Iterated, MAX_STEPS, iterated};
use crate::progress::Stop;

/// A sweep takes cells in so many blocks one after the other, and the values of blocks before are the new ones; inside a block they are the old ones, so
/// that its rows are found at the same time. Cells beside each other lie on one surface and do not see each other, so few blocks are nearly as
/// good as single cells.
const BLOCKS: usize = 16;

/// Light that does not stand still after so many sweeps grows, or nearly so: where it does not, some 20 to 40 are enough.
const ENOUGH_SWEEPS: u32 = 200;

/// Light grows if what a sweep changes does by this factor. Where it does not, changes fall from one sweep to the next, but for single rows: in a room of
/// bright paint some summed to 98.
const GROWN: f64 = 100.0;

/// Equations `B = constant + sum over terms of weight * B_source`, by [`BATCH`] of cells.
pub(super) struct StoredSystem {
    channels: usize,
    batches: Vec<StoredBatch>,
}

/// The equations of a batch of cells.
#[derive(Default)]
pub(super) struct StoredBatch {
    /// By row and channel.
    constant: Vec<f64>,
    /// By row: where its terms end.
    ends: Vec<usize>,
    /// By term.
    source: Vec<u32>,
    /// By term and channel; includes the reflectance.
    weight: Vec<f32>,
    /// Channels.
    channels: usize,
}

impl StoredBatch {
    /// The constant of the row at work, by channel.
    pub fn constant(&mut self) -> &mut [f64] {
        let first = self.constant.len() - self.channels;
        &mut self.constant[first..]
    }

    /// Adds a term to the row at work.
    pub fn push(&mut self, source: u32, weights: impl Iterator<Item = f32>) {
        self.source.push(source);
        self.weight.extend(weights);
    }

    /// How many terms there are.
    pub fn terms(&self) -> usize {
        self.source.len()
    }

    /// Scales the terms of the row at work from this one on down, those of reflectors, where with the others they sum to more than [`MOST_TAKEN`].
    pub fn limit_seen(&mut self, first: usize) {
        let (channels, row) = (self.channels, self.ends.last().copied().unwrap_or(0));
        let (ends, seen) = self.weight[row * channels..].split_at_mut((first - row) * channels);
        for channel in 0..channels {
            let sum = |weights: &[f32]| weights.iter().skip(channel).step_by(channels).sum::<f32>();
            let (room, taken) = ((MOST_TAKEN - sum(ends)).max(0.0), sum(seen));
            if taken > room {
                seen.iter_mut().skip(channel).step_by(channels).for_each(|weight| *weight *= room / taken);
            }
        }
    }

    /// Scales rows down to [`MOST_TAKEN`] whose weights sum to 1 or more, signs left out.
    fn limit_rows(&mut self) {
        let (channels, mut begin) = (self.channels, 0);
        for &end in &self.ends {
            let row = &mut self.weight[begin * channels..end * channels];
            for channel in 0..channels {
                let taken = row.iter().skip(channel).step_by(channels).map(|weight| weight.abs()).sum::<f32>();
                if taken >= 1.0 {
                    row.iter_mut().skip(channel).step_by(channels).for_each(|weight| *weight *= MOST_TAKEN / taken);
                }
            }
            begin = end;
        }
    }

    /// The right-hand sides of all rows, for these radiosities of all cells. `CHANNELS` is how many there are, or 0 where that is not known beforehand.
    fn gather<const CHANNELS: usize>(&self, values: &[f64], next: &mut [f64]) {
        let channels = if CHANNELS == 0 { self.channels } else { CHANNELS };
        next.copy_from_slice(&self.constant);
        let mut begin = 0;
        for (next, &end) in next.chunks_exact_mut(channels).zip(&self.ends) {
            let weights = self.weight[begin * channels..end * channels].chunks_exact(channels);
            for (&source, weights) in self.source[begin..end].iter().zip(weights) {
                let sent = &values[source as usize * channels..][..channels];
                next.iter_mut().zip(weights).zip(sent).for_each(|((next, &weight), sent)| *next += f64::from(weight) * sent);
            }
            begin = end;
        }
    }
}

impl StoredSystem {
    /// The system of so many rows, each of which `fill` fills in.
    pub fn filled(channels: usize, rows: usize, fill: impl Fn(usize, &mut StoredBatch) + Sync) -> Self {
        let batch = |number: usize| {
            let mut batch = StoredBatch { channels, ..StoredBatch::default() };
            for row in number * BATCH..rows.min((number + 1) * BATCH) {
                batch.constant.resize(batch.constant.len() + channels, 0.0);
                fill(row, &mut batch);
                batch.ends.push(batch.source.len());
            }
            batch
        };
        Self { channels, batches: (0..rows.div_ceil(BATCH)).into_par_iter().map(batch).collect() }
    }

    /// The radiosities of all cells, by cell and channel, with rows limited if light grows without; `None` if stopped before.
    pub fn solved(&mut self, stop: Stop<'_>) -> Option<Vec<f64>> {
        let found = self.iterated(ENOUGH_SWEEPS, GROWN, stop)?;
        if found.is_settled {
            return Some(found.values);
        }
        self.batches.par_iter_mut().for_each(StoredBatch::limit_rows);
        Some(self.iterated(MAX_STEPS, f64::INFINITY, stop)?.values)
    }

    /// What so many sweeps lead to, or as many as let changes grow by a factor.
    fn iterated(&self, sweeps: u32, growth: f64, stop: Stop<'_>) -> Option<Iterated> {
        let start = self.batches.iter().flat_map(|batch| &batch.constant).copied().collect();
        let mut of_block = vec![0.0; self.batches.len().div_ceil(BLOCKS) * BATCH * self.channels];
        let step = |values: &[f64], next: &mut [f64]| match self.channels {
            1 => self.sweep::<1>(values, next, &mut of_block),
            3 => self.sweep::<3>(values, next, &mut of_block),
            _ => self.sweep::<0>(values, next, &mut of_block),
        };
        iterated(start, ([self.channels; 2], sweeps, growth), step, stop)
    }

    /// One sweep: finds `next` from `values`; there is room in `found` for the values of a block.
    fn sweep<const CHANNELS: usize>(&self, values: &[f64], next: &mut [f64], found: &mut [f64]) {
        next.copy_from_slice(values);
        let of_block = self.batches.len().div_ceil(BLOCKS).max(1);
        let length = of_block * BATCH * self.channels;
        for (block, batches) in self.batches.chunks(of_block).enumerate() {
            let found = &mut found[..length.min(next.len() - block * length)];
            let rows = batches.par_iter().zip(found.par_chunks_mut(BATCH * self.channels)).with_min_len(4);
            rows.for_each(|(batch, found)| batch.gather::<CHANNELS>(next, found));
            next[block * length..][..found.len()].copy_from_slice(found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows in which cell `n` takes `weight` of the next one, and sends 1 itself.
    fn ring(cells: usize, channels: usize, weight: f32) -> StoredSystem {
        StoredSystem::filled(channels, cells, |row, system| {
            system.constant().fill(1.0);
            system.push(((row + 1) % cells) as u32, (0..channels).map(|_| weight));
        })
    }

    #[test]
    fn rings_send_what_their_reflectance_says() {
        for (channels, cells) in [(1, 2), (2, 700), (3, 5000)] {
            for weight in [0.0, 0.5, -0.5, 0.9].into_iter().chain((cells == 2).then_some(0.999)) {
                let values = ring(cells, channels, weight).solved(&|| false).unwrap();
                assert_eq!(values.len(), cells * channels);
                let expected = 1.0 / (1.0 - f64::from(weight));
                // What is to come is estimated, and below 1e-5 of the brightest.
                assert!(values.iter().all(|value| (value - expected).abs() <= 2e-5 * expected), "{channels} {cells} {weight}");
            }
        }
        assert!(ring(10, 1, 0.5).solved(&|| true).is_none());
    }

    #[test]
    fn what_reflectors_send_is_limited_beside_paths() {
        let system = StoredSystem::filled(2, 2, |_, system| {
            system.push(0, [0.75, 0.5].into_iter());
            let of_ends = system.terms();
            system.push(0, [0.5, 0.25].into_iter());
            system.push(1, [-0.02, 0.25].into_iter());
            system.limit_seen(of_ends);
        });
        // 0.99 less 0.75 is half of 0.48; 0.99 less 0.5 is 0.98 of 0.5.
        let row = [0.75, 0.5, 0.25, 0.245, -0.01, 0.245];
        let weights = system.batches[0].weight.chunks(6);
        assert!(weights.into_iter().all(|found| found.iter().zip(row).all(|(found, weight)| (found - weight).abs() < 1e-6)));
    }

    #[test]
    fn where_light_would_grow_rows_are_scaled_down() {
        for (weight, expected) in [(5.0, 100.0), (1.02, 100.0), (-5.0, 1.0 / 1.99)] {
            let values = ring(300, 3, weight).solved(&|| false).unwrap();
            assert!(values.iter().all(|value| (value / expected - 1.0).abs() < 1e-4), "{weight}");
        }
    }
}
