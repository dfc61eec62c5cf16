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
//! Each is a linear program that is solved by pouring: everyone gets the least, and what is left of 1 goes to the brightest (the
//! dimmest) up to their most. Both right sides grow with U and L. So from `U = E_max / (1 - rho_max)`, which is true, every sweep
//! gives something true and no larger, and from `L = E` something true and no smaller: one may stop at any time. (Lischinski 1994,
//! equation 5.3, starts the upper system from E, where only the limit is a bound, and pours without the l_j.)
//!
//! A leaf gathers over its own entries and those of all its ancestors; an inner source stands for its brightest (its dimmest) leaf.

use rayon::prelude::*;

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
fn rounding(terms: usize) -> f64 {
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

    /// Sweeps until the gap is `tolerance` of itself near what it can become, or so often; returns the bounds and the number of
    /// sweeps.
    pub fn solve(&self, tolerance: f64, most_sweeps: u32) -> (Iterate, u32) {
        let mut iterate = self.trivial();
        for sweep in 1..=most_sweeps {
            let change = self.sweep(&mut iterate);
            let gap = iterate.upper.iter().zip(&iterate.lower).map(|(upper, lower)| upper - lower).fold(0.0, f64::max);
            if change <= tolerance * gap {
                return (iterate, sweep);
            }
        }
        (iterate, most_sweeps)
    }

    /// Takes every leaf's bounds anew from those of all others; returns the largest change. Bounds never get wider.
    pub fn sweep(&self, iterate: &mut Iterate) -> f64 {
        let channels = self.channels;
        let mut found = vec![[0.0; 2]; channels * self.leaves.len()];
        found.par_chunks_mut(channels).zip(&self.leaves).for_each_init(Vec::new, |entries, (found, leaf)| {
            entries.clear();
            self.for_each_entry(leaf.node, |index| entries.push(index));
            for (channel, found) in found.iter_mut().enumerate() {
                let rho = leaf.reflectance[channel];
                let reflected = if rho > 0.0 {
                    self.pour(entries, leaf.enclosed, channel, iterate, |_, _, _| {}).map(|h| rho * h)
                } else {
                    [0.0; 2]
                };
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

    /// Visits the entries, by index, of a node and all its ancestors.
    pub fn for_each_entry(&self, node: u32, mut visit: impl FnMut(u32)) {
        let mut node = node;
        loop {
            (self.starts[node as usize]..self.starts[node as usize + 1]).for_each(&mut visit);
            let parent = self.parents[node as usize];
            if parent == node {
                return;
            }
            node = parent;
        }
    }

    /// The least and the most irradiance over these entries, given by index. Visits the form factor that each gets, side (0 for the
    /// least, 1 for the most) by side.
    pub fn pour(
        &self,
        entries: &mut [u32],
        enclosed: bool,
        channel: usize,
        iterate: &Iterate,
        mut visit: impl FnMut(usize, u32, f64),
    ) -> [f64; 2] {
        let of = |values: &[f64], index: u32| values[self.entry(index).source as usize * self.channels + channel];
        let widened = rounding(entries.len());
        let left = (1.0 - entries.iter().map(|&index| self.entry(index).lower).sum::<f64>()).max(0.0) + widened;
        let mut poured = |side: usize, entries: &[u32], values: &[f64], left: f64| {
            let (mut sum, mut left) = (0.0, left);
            for &index in entries {
                let entry = self.entry(index);
                let more = (entry.upper - entry.lower).min(left);
                left -= more;
                sum += (entry.lower + more) * of(values, index);
                visit(side, index, entry.lower + more);
            }
            sum
        };
        let in_order = |a: &u32, b: &u32| {
            let (a, b) = (self.entry(*a), self.entry(*b));
            a.source.cmp(&b.source).then(a.lower.total_cmp(&b.lower))
        };

        // The most: what is left goes to the brightest. If it is enough for all, their order does not matter.
        if entries.iter().map(|&index| self.entry(index).upper - self.entry(index).lower).sum::<f64>() > left {
            let brightest_first = |a: &u32, b: &u32| of(&iterate.upper, *b).total_cmp(&of(&iterate.upper, *a));
            entries.sort_unstable_by(|a, b| brightest_first(a, b).then(in_order(a, b)));
        }
        let most = poured(1, entries, &iterate.upper, left) * (1.0 + widened);

        // The least: what is left is lost, or goes to the dimmest.
        let least = if enclosed {
            let dimmest_first = |a: &u32, b: &u32| of(&iterate.lower, *a).total_cmp(&of(&iterate.lower, *b));
            entries.sort_unstable_by(|a, b| dimmest_first(a, b).then(in_order(a, b)));
            poured(0, entries, &iterate.lower, (left - 2.0 * widened).max(0.0))
        } else {
            poured(0, entries, &iterate.lower, 0.0)
        };
        [least * (1.0 - widened), most]
    }

    fn entry(&self, index: u32) -> &Entry {
        &self.entries[index as usize]
    }

    /// Inner nodes take the extremes of their leaves.
    fn pull(&self, iterate: &mut Iterate) {
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
