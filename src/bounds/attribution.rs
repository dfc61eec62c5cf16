//! Where the gap between the bounds comes from: how much each entry adds to `<R, U - L>`.
//!
//! Pouring gives every leaf a row of form factors `F_` for the lower radiosities and a row `F*` for the upper ones, so that
//! `L = E + rho F_ L` and `U = E + rho F* U`. With Z, the lower importance, which solves `Z = R + (rho F_)' Z`,
//!
//! ```text
//! <R, U - L> = <Z, (I - rho F_)(U - L)> = sum over leaves i and their entries j of  Z_i rho_i (F*_ij - F_ij) U_j
//! ```
//!
//! (Lischinski 1994, equation 5.10, in which the difference must be that of the rows which are poured, not that of the entries: with
//! the entries it does not add up.) An inner source stands for its brightest leaf in U and for its dimmest in L, so its part is
//! `Z rho (F* U_brightest - F_ U_dimmest)`: what its radiosity varies counts, too. Where rows add up to 1 in closed surroundings, what
//! is poured on the dimmest may be more than they get in `F*`; such an entry takes away from the gap.

use rayon::prelude::*;

use super::pouring::Pouring;
use super::system::{Iterate, System};

/// The change of a sweep that ends the iteration of importance, as a part of all of it.
const SWEEP_TOLERANCE: f64 = 1e-12;

/// Sweeps for that at a reflectance of 0.99 are fewer.
const MOST_SWEEPS: u32 = 3000;

/// The form factors that an entry gets in the two rows of a leaf.
struct Share {
    entry: u32,
    form_factor: [f64; 2],
}

/// A leaf with its rows for one channel.
struct Row {
    node: usize,
    reflectance: f64,
    shares: Vec<Share>,
}

/// What each entry adds to `<R, U - L>`, all channels together; `initial` is R, by node and channel, of which that of leaves counts.
pub(super) fn attribute(system: &System<'_>, iterate: &Iterate, initial: &[f64]) -> Vec<f64> {
    let channels = system.channels;
    let mut found = vec![0.0; system.entries.len()];
    for channel in 0..channels {
        let rows = rows(system, iterate, channel);
        let dimmest = dimmest_leaves(system, iterate, channel);
        let source = |share: &Share| system.entries[share.entry as usize].source as usize;

        // The lower importance: R, and what arrives from it after each bounce.
        let mut importance = vec![0.0; system.parents.len()];
        system.leaves.iter().for_each(|leaf| {
            importance[leaf.node as usize] = initial[leaf.node as usize * channels + channel];
        });
        let mut term = importance.clone();
        for _ in 0..MOST_SWEEPS {
            let mut next = vec![0.0; term.len()];
            for row in rows.iter().filter(|row| term[row.node] > 0.0) {
                let worth = row.reflectance * term[row.node];
                row.shares.iter().for_each(|share| next[dimmest[source(share)] as usize] += worth * share.form_factor[0]);
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
            for share in &row.shares {
                let [least, most] = share.form_factor;
                let source = source(share);
                found[share.entry as usize] += worth * (most * upper(source) - least * upper(dimmest[source] as usize));
            }
        }
    }
    found
}

/// The rows of all leaves that reflect.
fn rows(system: &System<'_>, iterate: &Iterate, channel: usize) -> Vec<Row> {
    let mut pouring = Pouring::new(system, channel);
    pouring.look_at(iterate);
    let reflecting: Vec<_> = system.leaves.iter().filter(|leaf| leaf.reflectance[channel] > 0.0).collect();
    let row = |leaf: &&super::system::Leaf<'_>| {
        // All get the least, and some of them more.
        let mut entries = Vec::new();
        system.for_each_list(leaf.node, |list| entries.extend(list.map(|entry| entry as u32)));
        entries.sort_unstable();
        let least = |&entry: &u32| Share { entry, form_factor: [system.entries[entry as usize].lower; 2] };
        let mut shares: Vec<Share> = entries.iter().map(least).collect();
        pouring.pour(leaf.node, leaf.enclosed, iterate, |side, entry, more| {
            if let Ok(place) = entries.binary_search(&entry) {
                shares[place].form_factor[side as usize] += more;
            }
        });
        Row { node: leaf.node as usize, reflectance: leaf.reflectance[channel], shares }
    };
    reflecting.par_iter().with_min_len(16).map(row).collect()
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
