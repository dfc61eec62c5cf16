//! The two systems of inequalities: for every leaf the least and the most that it can reflect.
//!
//! At any point x of a leaf `B(x) = E + rho sum_j F_j(x) B_j`, with B_j a mean of what x sees of source j. With `F_j` between its
//! bounds and all of them together at most 1,
//!
//! ```text
//! B(x) <= E + rho max { sum F_j U_j : l_j <= F_j <= u_j, sum F_j <= 1 }       U_j >= the radiosity anywhere on j
//! B(x) >= E + rho min { sum F_j L_j : l_j <= F_j <= u_j, sum F_j = 1 }        where x sees fronts alone, else sum l_j L_j
//! ```
//!
//! Each is a linear program that is solved by pouring (`pouring`). Both right sides grow with U and L. So from `U = E_max / (1 - rho_max)`, which is true, every sweep
//! gives something true and no larger, and from `L = E` something true and no smaller: one may stop at any time. (Lischinski 1994,
//! equation 5.3, starts the upper system from E, where only the limit is a bound, and pours without the l_j.)
//!
//! A leaf gathers over its own entries and those of all its ancestors; an inner source stands for its brightest (its dimmest) leaf.

use std::ops::Range;

use rayon::prelude::*;

use super::pouring::Pouring;

/// What a node may gather from one source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    pub source: u32,
    pub lower: f64,
    pub upper: f64,
}

/// A leaf: where values are known by what it emits and reflects.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leaf<'a> {
    pub node: u32,
    /// W/m^2, by channel.
    pub exitance: &'a [f64],
    pub reflectance: &'a [f64],
    /// Whether all its points see fronts alone, in all directions.
    pub enclosed: bool,
}

/// Nodes, what they may gather, and the leaves among them.
pub(super) struct System<'a> {
    pub channels: usize,
    /// The parent of each node; a node without one is its own. Parents come before children.
    pub parents: Vec<u32>,
    /// Where the entries of each node start; one more than there are nodes.
    pub starts: Vec<u32>,
    pub entries: Vec<Entry>,
    pub leaves: Vec<Leaf<'a>>,
}

/// Lower and upper radiosities by node and channel, in W/m^2.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Iterate {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

/// Widens what a sum of this many terms gives, by all its roundings and one more for each step.
pub(super) fn rounding(terms: usize) -> f64 {
    f64::EPSILON * (terms as f64 + 8.0)
}

impl System<'_> {
    /// Bounds that hold whatever the form factors are: no surface emits less than E, and none can be brighter than the brightest
    /// would be with the highest reflectance all around.
    pub fn trivial(&self) -> Iterate {
        let count = self.channels * self.parents.len();
        let mut iterate = Iterate { lower: vec![0.0; count], upper: vec![0.0; count] };
        for channel in 0..self.channels {
            let most = |value: &dyn Fn(&Leaf<'_>) -> f64| self.leaves.iter().map(value).fold(0.0, f64::max);
            let (exitance, reflectance) = (most(&|leaf| leaf.exitance[channel]), most(&|leaf| leaf.reflectance[channel]));
            for leaf in &self.leaves {
                let at = leaf.node as usize * self.channels + channel;
                iterate.lower[at] = leaf.exitance[channel];
                let seen = exitance / (1.0 - reflectance);
                iterate.upper[at] = (leaf.exitance[channel] + leaf.reflectance[channel] * seen) * (1.0 + rounding(0));
            }
        }
        self.pull(&mut iterate);
        iterate
    }

    /// Sweeps until the gap is `tolerance` of itself near what it can become, so often, or until `stop`; returns the bounds and the number of
    /// sweeps.
    pub fn solve(&self, tolerance: f64, most_sweeps: u32, stop: &dyn Fn() -> bool) -> (Iterate, u32) {
        let (mut iterate, mut pourings) = (self.trivial(), self.pourings());
        for sweep in 1..=most_sweeps {
            let change = self.sweep(&mut iterate, &mut pourings);
            let gap = iterate.upper.iter().zip(&iterate.lower).map(|(upper, lower)| upper - lower).fold(0.0, f64::max);
            if change <= tolerance * gap || stop() {
                return (iterate, sweep);
            }
        }
        (iterate, most_sweeps)
    }

    /// Takes every leaf's bounds anew from those of all others; returns the largest change. Bounds never get wider.
    pub fn sweep(&self, iterate: &mut Iterate, pourings: &mut [Pouring<'_, '_>]) -> f64 {
        pourings.iter_mut().for_each(|pouring| pouring.look_at(iterate));
        let channels = self.channels;
        let mut found = vec![[0.0; 2]; channels * self.leaves.len()];
        found.par_chunks_mut(channels).with_min_len(64).zip(&self.leaves).for_each(|(found, leaf)| {
            for (channel, found) in found.iter_mut().enumerate() {
                let rho = leaf.reflectance[channel];
                let pour = || pourings[channel].pour(leaf.node, leaf.enclosed, iterate, |_, _, _| {});
                let reflected = if rho > 0.0 { pour().map(|h| rho * h) } else { [0.0; 2] };
                *found = reflected.map(|reflected| leaf.exitance[channel] + reflected);
            }
        });
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

    /// What is poured in a sweep, channel by channel.
    pub fn pourings(&self) -> Vec<Pouring<'_, '_>> {
        (0..self.channels).map(|channel| Pouring::new(self, channel)).collect()
    }

    /// Visits the entries of a node, then those of all its ancestors, as ranges of indices.
    pub fn for_each_list(&self, node: u32, mut visit: impl FnMut(Range<usize>)) {
        let mut node = node as usize;
        loop {
            visit(self.starts[node] as usize..self.starts[node + 1] as usize);
            let parent = self.parents[node] as usize;
            if parent == node {
                return;
            }
            node = parent;
        }
    }

    /// Of an entry's source.
    pub fn radiosity(&self, values: &[f64], entry: u32, channel: usize) -> f64 {
        values[self.entries[entry as usize].source as usize * self.channels + channel]
    }

    /// Inner nodes take the extremes of their leaves.
    pub fn pull(&self, iterate: &mut Iterate) {
        let channels = self.channels;
        let mut is_leaf = vec![false; self.parents.len()];
        self.leaves.iter().for_each(|leaf| is_leaf[leaf.node as usize] = true);
        for node in (0..self.parents.len()).filter(|&node| !is_leaf[node]) {
            iterate.lower[node * channels..][..channels].fill(f64::INFINITY);
            iterate.upper[node * channels..][..channels].fill(0.0);
        }
        for node in (0..self.parents.len()).rev() {
            let parent = self.parents[node] as usize;
            for channel in (0..channels).filter(|_| parent != node) {
                let (at, above) = (node * channels + channel, parent * channels + channel);
                iterate.lower[above] = iterate.lower[above].min(iterate.lower[at]);
                iterate.upper[above] = iterate.upper[above].max(iterate.upper[at]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
