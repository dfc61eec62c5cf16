//! What is split next: what narrows the bounds most for the work that it takes.

use crate::bounds::attribution::{Share, attribute};
use crate::bounds::system::{Iterate, Leaf, System};
use crate::hierarchy::NodeId;

use super::refinement::{Choice, Refinement, WORK_OF_POLYGONS};

/// In one round no more work is done than this part of the work so far: the better the bounds, the better the choice.
const GROWTH: f64 = 0.6;

/// In a round at least so much work may be done, or the first rounds would split single surfaces.
const LEAST_ROUND: u64 = 1 << 10;

/// A split is expected to take this part of what is left open away: form factors vary by half as much over halves.
const GAINED: f64 = 0.5;

/// What leaves less open than this part of all is not worth its work.
const NEGLIGIBLE: f64 = 1e-7;

/// A split that may be made.
enum Split {
    Receiver(NodeId),
    Source(NodeId, NodeId),
}

/// Chooses splits, none if the mean relative width is no more than `enough`.
pub(super) fn choose(system: &System<'_>, iterate: &Iterate, refinement: &Refinement<'_>, enough: f64, most_work: u64) -> Choice {
    let weights = Weights::new(system, iterate, refinement);
    if weights.mean_width(system, iterate, refinement) <= enough {
        return Choice::default();
    }
    let shares = attribute(system, iterate, &weights.initial(system, refinement), &|| false);
    let total: f64 = system.leaves.iter().map(|leaf| open_of(system, &shares, leaf).abs()).sum();

    // What splitting each receiver, and each source, would bring.
    let hierarchy = refinement.hierarchy();
    let mut splits: Vec<(f64, u64, Split)> = Vec::new();
    for leaf in &system.leaves {
        let receiver = NodeId(leaf.node);
        let entries = system.entries_of(leaf.node);
        for at in entries.clone() {
            let source = NodeId(system.entries[at].source);
            let children = hierarchy.children(source).len() as u64;
            if children > 0 {
                splits.push((GAINED * shares[at].by_source, children, Split::Source(receiver, source)));
            }
        }
        let by_receiver: f64 = shares[entries.clone()].iter().map(|share| share.by_form_factor).sum();
        let pieces = hierarchy.facet(receiver).vertices.len().max(4) as u64;
        splits.push((GAINED * by_receiver, pieces * refinement.sources_of(receiver) as u64, Split::Receiver(receiver)));
    }

    // The best first, as far as the work of a round goes.
    splits.retain(|&(gained, cost, _)| cost > 0 && gained > NEGLIGIBLE * total);
    splits.sort_by(|a, b| (b.0 / b.1 as f64).total_cmp(&(a.0 / a.1 as f64)));
    let left = most_work.saturating_sub(refinement.work());
    let budget = LEAST_ROUND.max((GROWTH * refinement.work() as f64) as u64).min(left);
    let (mut choice, mut work) = (Choice::default(), 0);
    for (_, cost, split) in splits {
        if work >= budget {
            break;
        }
        work += WORK_OF_POLYGONS * cost;
        match split {
            Split::Receiver(receiver) => choice.receivers.push(receiver),
            Split::Source(receiver, source) => choice.opened.push((receiver, source)),
        }
    }
    choice
}

/// By what the width of each leaf is divided, by leaf in the order of the system: its own reflected radiosity, or the mean of all that
/// reflect where that is more; channels added. Infinite for leaves that do not reflect.
struct Weights {
    scale: Vec<f64>,
    area: f64,
}

impl Weights {
    fn new(system: &System<'_>, iterate: &Iterate, refinement: &Refinement<'_>) -> Self {
        let hierarchy = refinement.hierarchy();
        let reflected = |leaf: &Leaf<'_>| -> f64 {
            let at = leaf.node as usize * system.channels;
            (0..system.channels)
                .map(|channel| 0.5 * (iterate.lower[at + channel] + iterate.upper[at + channel]) - leaf.exitance[channel])
                .sum()
        };
        let (mut area, mut sum) = (0.0, 0.0);
        for leaf in system.leaves.iter().filter(|leaf| refinement.reflects(NodeId(leaf.node))) {
            area += hierarchy.area(NodeId(leaf.node));
            sum += hierarchy.area(NodeId(leaf.node)) * reflected(leaf);
        }
        let mean = sum / area;
        let scale = |leaf: &Leaf<'_>| {
            let own = reflected(leaf).max(mean);
            if refinement.reflects(NodeId(leaf.node)) && own > 0.0 { own } else { f64::INFINITY }
        };
        Self { scale: system.leaves.iter().map(scale).collect(), area }
    }

    /// The mean over the area that reflects of the width of leaves, relative to what they reflect.
    fn mean_width(&self, system: &System<'_>, iterate: &Iterate, refinement: &Refinement<'_>) -> f64 {
        let width = |leaf: &Leaf<'_>| -> f64 {
            let at = leaf.node as usize * system.channels;
            (at..at + system.channels).map(|at| iterate.upper[at] - iterate.lower[at]).sum()
        };
        let parts = system.leaves.iter().zip(&self.scale);
        let sum: f64 = parts.map(|(leaf, scale)| refinement.hierarchy().area(NodeId(leaf.node)) * width(leaf) / scale).sum();
        if self.area > 0.0 { sum / self.area } else { 0.0 }
    }

    /// The initial importance by which that is found, by node and channel: each leaf for itself, and as much for what points gather from
    /// it, whose bounds are apart by `rho sum_j F_j (U_j - L_j)`.
    fn initial(&self, system: &System<'_>, refinement: &Refinement<'_>) -> Vec<f64> {
        // What sources are worth to the points of the leaves that gather from them.
        let (hierarchy, channels) = (refinement.hierarchy(), system.channels);
        let mut importance = vec![0.0; system.parents.len() * channels];
        for (leaf, scale) in system.leaves.iter().zip(&self.scale) {
            let of_leaf = hierarchy.area(NodeId(leaf.node)) / scale;
            for entry in &system.entries[system.entries_of(leaf.node)] {
                let sent = &mut importance[entry.source as usize * channels..][..channels];
                sent.iter_mut().zip(leaf.reflectance).for_each(|(sent, rho)| *sent += of_leaf * rho * entry.upper);
            }
        }

        // Sources give it to their parts, by area.
        for node in hierarchy.ids().filter(|&node| !hierarchy.is_cluster(node)) {
            for child in hierarchy.children(node) {
                let share = hierarchy.area(child) / hierarchy.area(node);
                for channel in 0..channels {
                    importance[child.index() * channels + channel] += share * importance[node.index() * channels + channel];
                }
            }
        }
        for (leaf, scale) in system.leaves.iter().zip(&self.scale) {
            let own = &mut importance[leaf.node as usize * channels..][..channels];
            own.iter_mut().for_each(|importance| *importance += hierarchy.area(NodeId(leaf.node)) / scale);
        }
        importance
    }
}

/// What a leaf's entries leave open.
fn open_of(system: &System<'_>, shares: &[Share], leaf: &Leaf<'_>) -> f64 {
    shares[system.entries_of(leaf.node)].iter().map(Share::total).sum()
}
