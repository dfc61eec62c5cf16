//! Solving both systems: sweeps over all leaves, from bounds that are true to bounds that are closer.
//!
//! Both right sides grow with U and L (see `system`). So from `U = E_max / (1 - rho_max)`, which is true, every sweep gives an upper bound
//! that is true and no larger, and from `L = E` a lower bound that is true and no smaller: one may stop at any time. (Lischinski 1994,
//! equation 5.3, starts the upper system from E, where only the limit is a bound.)

use rayon::prelude::*;

use super::knapsack::Knapsack;
use super::rounding::rounding;
use super::system::{Iterate, Leaf, System};
use crate::progress::Stop;

/// Sweeps end when they change bounds by less than this part of the widest gap.
pub(super) const SWEEP_TOLERANCE: f64 = 1e-3;

/// Enough for a reflectance of 0.99 to come within the tolerance.
pub(super) const MOST_SWEEPS: u32 = 1000;

/// Leaves whose knapsacks one task fills.
const LEAVES_A_TASK: usize = 64;

/// The first sweep over fewer entries is done in any case: a tenth of a second, and bounds are worth much more after it.
const MOMENT: usize = 1 << 20;

impl System<'_> {
    /// Bounds that hold whatever the form factors are: no leaf sends less than E, and none receives more than `E_max / (1 - rho_max)`,
    /// the radiosity of a closed room that emits and reflects everywhere as much as any surface does anywhere.
    pub fn trivial(&self) -> Iterate {
        let count = self.channels * self.parents.len();
        let mut iterate = Iterate { lower: vec![0.0; count], upper: vec![0.0; count] };
        for channel in 0..self.channels {
            let most = |value: &dyn Fn(&Leaf<'_>) -> f64| self.leaves.iter().map(value).fold(0.0, f64::max);
            let (exitance, reflectance) = (most(&|leaf| leaf.exitance[channel]), most(&|leaf| leaf.reflectance[channel]));
            let irradiance = exitance / (1.0 - reflectance);
            for leaf in &self.leaves {
                let at = leaf.node as usize * self.channels + channel;
                iterate.lower[at] = leaf.exitance[channel];
                iterate.upper[at] = (leaf.exitance[channel] + leaf.reflectance[channel] * irradiance) * (1.0 + rounding(0));
            }
        }
        self.pull(&mut iterate);
        iterate
    }

    /// Sweeps until a sweep changes bounds by no more than `tolerance` times the widest gap, `most_sweeps` times, or until `stop`; returns
    /// the bounds and the number of sweeps.
    pub fn solve(&self, tolerance: f64, most_sweeps: u32, stop: Stop<'_>) -> (Iterate, u32) {
        self.solve_from(self.trivial(), tolerance, most_sweeps, stop)
    }

    /// The same, from bounds that are known already.
    pub fn solve_from(&self, mut iterate: Iterate, tolerance: f64, most_sweeps: u32, stop: Stop<'_>) -> (Iterate, u32) {
        let is_short = self.entries.len() < MOMENT;
        if !is_short && stop() {
            return (iterate, 0);
        }
        let mut knapsacks = Knapsack::of_channels(self);
        for sweep in 1..=most_sweeps {
            let stop_within: Stop<'_> = if is_short { &|| false } else { stop };
            let change = self.sweep(&mut iterate, &mut knapsacks, stop_within);
            let gap = iterate.upper.iter().zip(&iterate.lower).map(|(upper, lower)| upper - lower).fold(0.0, f64::max);
            if change <= tolerance * gap || stop() {
                return (iterate, sweep);
            }
        }
        (iterate, most_sweeps)
    }

    /// Computes every leaf's bounds from those of all others, once stopped of no more; returns the largest change. Bounds never get wider.
    pub fn sweep(&self, iterate: &mut Iterate, knapsacks: &mut [Knapsack<'_, '_>], stop: Stop<'_>) -> f64 {
        for knapsack in &mut *knapsacks {
            if stop() {
                return 0.0;
            }
            knapsack.sort(iterate);
        }

        // What each leaf reflects, in parallel.
        let channels = self.channels;
        let places = |leaf: &Leaf<'_>| leaf.node as usize * channels..(leaf.node as usize + 1) * channels;
        let known = |at: usize| [iterate.lower[at], iterate.upper[at]];
        let mut found: Vec<[f64; 2]> = self.leaves.iter().flat_map(places).map(known).collect();
        found.par_chunks_mut(channels).with_min_len(LEAVES_A_TASK).zip(&self.leaves).for_each(|(found, leaf)| {
            if stop() {
                return;
            }
            for (channel, found) in found.iter_mut().enumerate() {
                let rho = leaf.reflectance[channel];
                let irradiance = || knapsacks[channel].irradiance(leaf.node, leaf.enclosed, iterate, |_, _, _| {});
                let reflected = if rho > 0.0 { irradiance().map(|h| rho * h) } else { [0.0; 2] };
                *found = reflected.map(|reflected| leaf.exitance[channel] + reflected);
            }
        });

        // Keep the closer one of the old bounds and the new ones.
        let mut change = 0.0_f64;
        for (found, leaf) in found.chunks(channels).zip(&self.leaves) {
            for (channel, &[lower, upper]) in found.iter().enumerate() {
                let at = leaf.node as usize * channels + channel;
                change = change.max(lower - iterate.lower[at]).max(iterate.upper[at] - upper);
                iterate.lower[at] = iterate.lower[at].max(lower);
                iterate.upper[at] = iterate.upper[at].min(upper).max(iterate.lower[at]);
            }
        }
        self.pull(iterate);
        change
    }
}
