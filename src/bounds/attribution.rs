//! Where the gap between the bounds comes from: how much each entry adds to `<R, U - L>`.
//!
//! The knapsacks give every leaf a row of form factors `F_` for the lower radiosities and a row `F*` for the upper ones, so that
//! `L = E + rho F_ L` and `U = E + rho F* U`. With the lower importance Z, which solves `Z = R + (rho F_)' Z`,
//!
//! ```text
//! <R, U - L> = <Z, (I - rho F_)(U - L)> = sum over leaves i and their entries j of  Z_i rho_i (F*_ij - F_ij) U_j
//! ```
//!
//! (Lischinski 1994, equation 5.10. The difference must be that of the rows, not that of the bounds of the entries, with which the parts
//! do not add up.) A source that is not a leaf stands for its brightest leaf in U and for its dimmest in L. So its part is
//! `Z rho (F* U_brightest - F_ U_dimmest)`, in which the variation of its radiosity counts, too. Where a row must add up to 1, the dimmest
//! entries may get more in `F_` than in `F*`; these take away from the gap.

use rayon::prelude::*;

use super::knapsack::Knapsack;
use super::system::{Iterate, Leaf, System};
use crate::progress::Stop;

/// The iteration of importance ends once a sweep adds less than this part of all importance.
const SWEEP_TOLERANCE: f64 = 1e-12;

/// More sweeps than a reflectance of 0.99 takes to come within the tolerance.
const MOST_SWEEPS: u32 = 3000;

/// Leaves whose rows one task computes.
const LEAVES_A_TASK: usize = 16;

/// The form factors of an entry in the two rows of a leaf, the lower one first.
struct Pair {
    entry: u32,
    form_factor: [f64; 2],
}

/// A leaf with its rows for one channel.
struct Row {
    node: usize,
    reflectance: f64,
    pairs: Vec<Pair>,
}

/// Why an entry leaves something open.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Share {
    /// Because its form factor is not known: `Z rho (F* - F_) U_brightest`. Negative where another entry gets more in the lower row.
    pub by_form_factor: f64,
    /// Because the radiosity varies over its source: `Z rho F_ (U_brightest - U_dimmest)`.
    pub by_source: f64,
}

impl Share {
    /// All that it adds.
    pub fn total(&self) -> f64 {
        self.by_form_factor + self.by_source
    }
}

/// What each entry adds to `<R, U - L>`, all channels together; once stopped, as far as that is known. `initial` is R, by node and channel; only
/// that of leaves counts.
pub(super) fn attribute(system: &System<'_>, iterate: &Iterate, initial: &[f64], stop: Stop<'_>) -> Vec<Share> {
    let channels = system.channels;
    let mut found = vec![Share::default(); system.entries.len()];
    for channel in 0..channels {
        let rows = rows(system, iterate, channel, stop);
        if stop() {
            break;
        }
        let dimmest = dimmest_leaves(system, iterate, channel);
        let source = |pair: &Pair| system.entries[pair.entry as usize].source as usize;

        // The lower importance: R, and what each bounce adds to it.
        let mut importance = vec![0.0; system.parents.len()];
        system.leaves.iter().for_each(|leaf| {
            importance[leaf.node as usize] = initial[leaf.node as usize * channels + channel];
        });
        let mut term = importance.clone();
        for _ in (0..MOST_SWEEPS).take_while(|_| !stop()) {
            let mut next = vec![0.0; term.len()];
            for row in rows.iter().filter(|row| term[row.node] > 0.0) {
                let worth = row.reflectance * term[row.node];
                row.pairs.iter().for_each(|pair| next[dimmest[source(pair)] as usize] += worth * pair.form_factor[0]);
            }
            term = next;
            importance.iter_mut().zip(&term).for_each(|(z, term)| *z += term);
            if term.iter().sum::<f64>() <= SWEEP_TOLERANCE * importance.iter().sum::<f64>() {
                break;
            }
        }

        // What each entry leaves open.
        let upper = |node: usize| iterate.upper[node * channels + channel];
        for row in &rows {
            let worth = row.reflectance * importance[row.node];
            for pair in &row.pairs {
                let [least, most] = pair.form_factor;
                let source = source(pair);
                let (bright, dim) = (upper(source), upper(dimmest[source] as usize));
                let found = &mut found[pair.entry as usize];
                found.by_form_factor += worth * (most - least) * bright;
                found.by_source += worth * least * (bright - dim);
            }
        }
    }
    found
}

/// The rows of all leaves that reflect; once stopped, of no more.
fn rows(system: &System<'_>, iterate: &Iterate, channel: usize, stop: Stop<'_>) -> Vec<Row> {
    if stop() {
        return Vec::new();
    }
    let mut knapsack = Knapsack::new(system, channel);
    knapsack.sort(iterate);
    let reflecting: Vec<_> = system.leaves.iter().filter(|leaf| leaf.reflectance[channel] > 0.0).collect();
    let row = |leaf: &&Leaf<'_>| {
        // All get their lower bounds, and some of them more.
        let mut entries = Vec::new();
        system.for_each_list(leaf.node, |list| entries.extend(list.map(|entry| entry as u32)));
        entries.sort_unstable();
        let least = |&entry: &u32| Pair { entry, form_factor: [system.entries[entry as usize].lower; 2] };
        let mut pairs: Vec<Pair> = entries.iter().map(least).collect();
        knapsack.irradiance(leaf.node, leaf.enclosed, iterate, |side, entry, more| {
            if let Ok(place) = entries.binary_search(&entry) {
                pairs[place].form_factor[side as usize] += more;
            }
        });
        Row { node: leaf.node as usize, reflectance: leaf.reflectance[channel], pairs }
    };
    reflecting.par_iter().with_min_len(LEAVES_A_TASK).filter(|_| !stop()).map(row).collect()
}

/// The leaf of every node with the least lower radiosity.
fn dimmest_leaves(system: &System<'_>, iterate: &Iterate, channel: usize) -> Vec<u32> {
    let lower = |node: u32| iterate.lower[node as usize * system.channels + channel];
    let mut dimmest = vec![u32::MAX; system.parents.len()];
    system.leaves.iter().for_each(|leaf| dimmest[leaf.node as usize] = leaf.node);
    for node in (0..dimmest.len()).rev() {
        let (own, parent) = (dimmest[node], system.parents[node] as usize);
        if parent != node && (dimmest[parent] == u32::MAX || lower(own) < lower(dimmest[parent])) {
            dimmest[parent] = own;
        }
    }
    dimmest
}
