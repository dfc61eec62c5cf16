//! The form factors with which a leaf receives the least, or the most, that their bounds allow: a fractional knapsack.
//!
//! Every entry gets its lower bound. What is then left of 1 goes to the brightest source up to its upper bound, then to the next, until
//! nothing is left (for the least to the dimmest first): the greedy solution is that of the linear program (Dantzig 1957).
//!
//! A leaf gathers over its own entries and those of all its ancestors, which it shares with other leaves. So the entries of each node are
//! sorted once a sweep, and a leaf merges these lists, only as far as what is left reaches.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use super::groups::{self, Plans, Side};
use super::rounding::rounding;
use super::system::{Entry, Iterate, System};

/// Nodes whose entries one task sorts.
const NODES_A_TASK: usize = 64;

/// The entries of a system in the order in which they are filled, for one channel.
pub(super) struct Knapsack<'s, 'a> {
    system: &'s System<'a>,
    channel: usize,
    /// Indices of entries, those of a node together: the dimmest first by lower radiosities, the brightest first by upper ones.
    dimmest: Vec<u32>,
    brightest: Vec<u32>,
    /// By node, over its entries and those of all its ancestors, if each gets its lower bound.
    sums: Vec<Sums>,
}

/// Sums over entries that get their lower bounds.
#[derive(Clone, Copy, Default)]
struct Sums {
    terms: usize,
    form_factor: f64,
    /// By lower radiosities, and by upper ones.
    irradiance: [f64; 2],
}

/// The entries of one node that a leaf has not filled yet: the next, and the indices of those after it.
struct Unfilled {
    entry: u32,
    radiosity: f64,
    rest: Range<usize>,
}

impl<'s, 'a> Knapsack<'s, 'a> {
    /// In no order yet: see [`Knapsack::sort`].
    pub fn new(system: &'s System<'a>, channel: usize) -> Self {
        let all = || (0..system.entries.len() as u32).collect();
        Self { system, channel, dimmest: all(), brightest: all(), sums: Vec::new() }
    }

    /// One for each channel, in no order yet.
    pub fn of_channels(system: &'s System<'a>) -> Vec<Self> {
        (0..system.channels).map(|channel| Self::new(system, channel)).collect()
    }

    /// Sorts the entries by the radiosities of an iterate, and adds up what they bring at their lower bounds.
    pub fn sort(&mut self, iterate: &Iterate) {
        let (system, channel) = (self.system, self.channel);
        if system.plans.is_some() {
            return;
        }
        let radiosity = |values: &[f64], entry: u32| system.radiosity(values, entry, channel);
        let by_source = |a: u32, b: u32| {
            let (a, b) = (&system.entries[a as usize], &system.entries[b as usize]);
            a.source.cmp(&b.source).then(a.lower.total_cmp(&b.lower))
        };
        sort_within(&mut self.brightest, &system.starts, |&a, &b| {
            radiosity(&iterate.upper, b).total_cmp(&radiosity(&iterate.upper, a)).then(by_source(a, b))
        });
        if system.leaves.iter().any(|leaf| leaf.enclosed) {
            sort_within(&mut self.dimmest, &system.starts, |&a, &b| {
                radiosity(&iterate.lower, a).total_cmp(&radiosity(&iterate.lower, b)).then(by_source(a, b))
            });
        }

        // The sums over each node's own entries, then with those of all its ancestors.
        let own = |node: usize| {
            let mut sums = Sums { terms: 1, ..Sums::default() };
            for entry in system.starts[node]..system.starts[node + 1] {
                let lower = system.entries[entry as usize].lower;
                let irradiance = [&iterate.lower, &iterate.upper].map(|values| lower * radiosity(values, entry));
                sums = sums.plus(&Sums { terms: 1, form_factor: lower, irradiance });
            }
            sums
        };
        (0..system.parents.len()).into_par_iter().with_min_len(NODES_A_TASK).map(own).collect_into_vec(&mut self.sums);
        for (node, &parent) in system.parents.iter().enumerate() {
            if parent as usize != node {
                self.sums[node] = self.sums[node].plus(&self.sums[parent as usize]);
            }
        }
    }

    /// The least and the most irradiance of a leaf, by the iterate of the last [`Knapsack::sort`]. Calls `visit(side, entry, more)` for
    /// each entry that gets `more` than its lower bound; for the least only where the leaf is enclosed, since elsewhere what is left may
    /// go to no surface at all.
    pub fn irradiance(&self, leaf: u32, enclosed: bool, iterate: &Iterate, mut visit: impl FnMut(Side, u32, f64)) -> [f64; 2] {
        if let Some(plans) = &self.system.plans {
            return self.planned_irradiance(plans, (leaf, enclosed), iterate, visit);
        }
        let Sums { terms, form_factor, irradiance: [mut least, mut most] } = self.sums[leaf as usize];
        let widened = rounding(terms);
        let left = (1.0 - form_factor).max(0.0) + widened;
        most += self.fill(leaf, left, Side::Most, &iterate.upper, &mut visit);
        if enclosed {
            least += self.fill(leaf, (left - 2.0 * widened).max(0.0), Side::Least, &iterate.lower, &mut visit);
        }
        [least * (1.0 - widened), most * (1.0 + widened)]
    }

    /// The same, where groups of sources are known.
    fn planned_irradiance(
        &self,
        plans: &Plans,
        (leaf, enclosed): (u32, bool),
        iterate: &Iterate,
        mut visit: impl FnMut(Side, u32, f64),
    ) -> [f64; 2] {
        [(Side::Least, &iterate.lower), (Side::Most, &iterate.upper)].map(|(side, values)| {
            let range = |entry: u32| {
                let Entry { lower, upper, .. } = self.system.entries[entry as usize];
                groups::Range { lower, upper, radiosity: self.system.radiosity(values, entry, self.channel) }
            };
            plans.irradiance(leaf, side, enclosed, range, |entry, more| visit(side, entry, more))
        })
    }

    /// Gives what is left to the entries of a leaf and of all its ancestors; returns the irradiance that it brings.
    fn fill(&self, leaf: u32, left: f64, side: Side, values: &[f64], visit: &mut impl FnMut(Side, u32, f64)) -> f64 {
        let (system, order) = (self.system, if side == Side::Most { &self.brightest } else { &self.dimmest });
        let next = |mut rest: Range<usize>| {
            let entry = order[rest.next()?];
            Some(Unfilled { entry, radiosity: system.radiosity(values, entry, self.channel), rest })
        };
        let mut lists: Vec<Unfilled> = Vec::new();
        system.for_each_list(leaf, |list| lists.extend(next(list)));

        let (mut sum, mut left) = (0.0, left);
        while left > 0.0 {
            let first = lists.iter().enumerate().min_by(|(_, a), (_, b)| match side {
                Side::Most => b.radiosity.total_cmp(&a.radiosity),
                Side::Least => a.radiosity.total_cmp(&b.radiosity),
            });
            let Some((at, &Unfilled { entry, radiosity, ref rest })) = first else { break };
            let room = system.entries[entry as usize].upper - system.entries[entry as usize].lower;
            let more = room.min(left);
            left -= more;
            sum += more * radiosity;
            visit(side, entry, more);
            match next(rest.clone()) {
                Some(after) => lists[at] = after,
                None => drop(lists.remove(at)),
            }
        }
        sum
    }
}

impl Sums {
    fn plus(&self, other: &Self) -> Self {
        Self {
            terms: self.terms + other.terms,
            form_factor: self.form_factor + other.form_factor,
            irradiance: [0, 1].map(|side| self.irradiance[side] + other.irradiance[side]),
        }
    }
}

/// Sorts the entries of each node by themselves.
fn sort_within(entries: &mut [u32], starts: &[u32], order: impl Fn(&u32, &u32) -> Ordering + Sync) {
    let (mut nodes, mut rest) = (Vec::with_capacity(starts.len()), entries);
    for bounds in starts.windows(2) {
        let (own, others) = rest.split_at_mut((bounds[1] - bounds[0]) as usize);
        nodes.push(own);
        rest = others;
    }
    nodes.into_par_iter().with_min_len(NODES_A_TASK).for_each(|own| own.sort_by(&order));
}
