//! The two systems of inequalities: for every leaf the least and the most radiosity that it can have.
//!
//! At any point x of a leaf `B(x) = E + rho sum_j F_j(x) B_j`, with B_j a mean over the part of source j that x sees. If each `F_j`
//! lies between l_j and u_j, and all of them add up to at most 1, then
//!
//! ```text
//! B(x) <= E + rho max { sum F_j U_j : l_j <= F_j <= u_j, sum F_j <= 1 }       U_j >= the radiosity anywhere on j
//! B(x) >= E + rho min { sum F_j L_j : l_j <= F_j <= u_j, sum F_j = 1 }        where x sees fronts alone, else sum l_j L_j
//! ```
//!
//! with L_j no more than the radiosity anywhere on j. Each right side is a fractional knapsack (`knapsack`); how the systems are solved is
//! told in `iteration`. (Lischinski 1994, equation 5.3, without the l_j in the upper system.)
//!
//! A leaf gathers over its own entries and those of all its ancestors. A source that is not a leaf stands for its brightest leaf in U and
//! for its dimmest in L.

use std::ops::Range;

use super::groups::Plans;

/// What a node may gather from one source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    pub source: u32,
    /// Between these lies the form factor from every point of the node.
    pub lower: f64,
    pub upper: f64,
}

/// A leaf: what its radiosity follows from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leaf<'a> {
    pub node: u32,
    /// W/m^2, by channel.
    pub exitance: &'a [f64],
    /// By channel.
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
    /// Where groups of sources are known: how the entries of a leaf are put together. Then all entries are those of leaves.
    pub plans: Option<Plans>,
}

/// Lower and upper radiosities by node and channel, in W/m^2.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Iterate {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl System<'_> {
    /// Visits the entries of a node, then those of all its ancestors, as ranges of indices.
    pub fn for_each_list(&self, node: u32, mut visit: impl FnMut(Range<usize>)) {
        let mut node = node as usize;
        loop {
            visit(self.entries_of(node as u32));
            let parent = self.parents[node] as usize;
            if parent == node {
                return;
            }
            node = parent;
        }
    }

    /// The indices of a node's own entries.
    pub fn entries_of(&self, node: u32) -> Range<usize> {
        self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize
    }

    /// The radiosity of an entry's source, `values` being by node and channel.
    pub fn radiosity(&self, values: &[f64], entry: u32, channel: usize) -> f64 {
        values[self.entries[entry as usize].source as usize * self.channels + channel]
    }

    /// Gives inner nodes the extremes of their leaves.
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
