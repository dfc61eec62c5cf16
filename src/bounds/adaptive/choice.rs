//! What is split next: what narrows the bounds most for the work that it takes.

use crate::bounds::attribution::attribute;
use crate::bounds::system::{Iterate, System};
use crate::hierarchy::NodeId;

use super::WORK_OF_POLYGONS;
use super::refinement::Refinement;

/// In one round no more work is done than this part of the work so far: the better the bounds, the better the choice.
const GROWTH: f64 = 0.6;

/// In a round at least so much work may be done, or the first rounds would split single surfaces.
const LEAST_ROUND: u64 = 1 << 10;

/// A split is expected to take this part of what is left open away: form factors vary by half as much over halves.
const GAINED: f64 = 0.5;

/// What leaves less open than this part of all is not worth its work.
const NEGLIGIBLE: f64 = 1e-7;

/// What is split.
#[derive(Default)]
pub(super) struct Choice {
    /// Elements that are split.
    pub receivers: Vec<NodeId>,
    /// Receivers with the source that is replaced by its children.
    pub opened: Vec<(NodeId, NodeId)>,
}

impl Choice {
    pub fn is_empty(&self) -> bool {
        self.receivers.is_empty() && self.opened.is_empty()
    }
}

/// A split that may be made.
enum Split {
    Receiver(NodeId),
    Source(NodeId, NodeId),
}

/// Chooses splits, none if the mean relative width is no more than `enough`.
pub(super) fn choose(
    system: &System<'_>,
    iterate: &Iterate,
    refinement: &Refinement<'_>,
    enough: f64,
    most_work: u64,
) -> Choice {
    let weights = Weights::new(system, iterate, refinement);
    if weights.mean_width(system, iterate, refinement) <= enough {
        return Choice::default();
    }
    let shares = attribute(system, iterate, &weights.initial(system, refinement));
    let total: f64 = shares.iter().map(|share| share.abs()).sum();

    // What splitting each receiver, and each source, would bring.
    let hierarchy = refinement.hierarchy();
    let dimmest = dimmest_upper(system, iterate);
    let mut splits: Vec<(f64, u64, Split)> = Vec::new();
    for leaf in &system.leaves {
        let entries = system.starts[leaf.node as usize] as usize..system.starts[leaf.node as usize + 1] as usize;
        let receiver = NodeId(leaf.node);
        let mut by_receiver = 0.0;
        for at in entries.clone() {
            let entry = &system.entries[at];
            let sum = |values: &[f64]| values[entry.source as usize * system.channels..][..system.channels].iter().sum::<f64>();
            let (brightest, dimmest) = (sum(&iterate.upper), sum(&dimmest));
            let (range, variation) = ((entry.upper - entry.lower) * brightest, entry.upper * (brightest - dimmest).max(0.0));
            if range + variation <= 0.0 || shares[at] <= 0.0 {
                continue;
            }
            by_receiver += shares[at] * range / (range + variation);
            let children = hierarchy.children(NodeId(entry.source)).len() as u64;
            if children > 0 && variation > 0.0 {
                let gained = GAINED * shares[at] * variation / (range + variation);
                splits.push((gained, children, Split::Source(receiver, NodeId(entry.source))));
            }
        }
        let pieces = hierarchy.facet(receiver).vertices.len().max(4) as u64;
        splits.push((GAINED * by_receiver, pieces * entries.len() as u64, Split::Receiver(receiver)));
    }

    if std::env::var("DBG").is_ok() {
        let mut counts = std::collections::BTreeMap::new();
        for leaf in &system.leaves {
            let s = hierarchy.node(NodeId(leaf.node)).surface;
            let e: &mut (usize, usize, f64, f64, f64) = counts.entry(s).or_default();
            e.0 += 1;
            let r = system.starts[leaf.node as usize] as usize..system.starts[leaf.node as usize + 1] as usize;
            e.1 += r.len();
            e.2 += hierarchy.area(NodeId(leaf.node)) * (iterate.upper[leaf.node as usize] - iterate.lower[leaf.node as usize]);
            for at in r {
                let entry = &system.entries[at];
                let sum = |values: &[f64]| values[entry.source as usize * system.channels..][..system.channels].iter().sum::<f64>();
                let (brightest, dimmest) = (sum(&iterate.upper), sum(&dimmest));
                let (range, variation) = ((entry.upper - entry.lower) * brightest, entry.upper * (brightest - dimmest).max(0.0));
                e.3 += shares[at] * range / (range + variation).max(1e-300);
                e.4 += shares[at] * variation / (range + variation).max(1e-300);
            }
        }
        eprintln!("work {} width {:.4} total {:.4} by surface (leaves, entries, W, range share, variation share) {:?}", refinement.work(), weights.mean_width(system, iterate, refinement), total, counts);
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
        let reflected = |leaf: &crate::bounds::system::Leaf<'_>| -> f64 {
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
        let scale = |leaf: &crate::bounds::system::Leaf<'_>| {
            let own = reflected(leaf).max(mean);
            if refinement.reflects(NodeId(leaf.node)) && own > 0.0 { own } else { f64::INFINITY }
        };
        Self { scale: system.leaves.iter().map(scale).collect(), area }
    }

    /// The mean over the area that reflects of the width of leaves, relative to what they reflect.
    fn mean_width(&self, system: &System<'_>, iterate: &Iterate, refinement: &Refinement<'_>) -> f64 {
        let width = |leaf: &crate::bounds::system::Leaf<'_>| -> f64 {
            let at = leaf.node as usize * system.channels;
            (at..at + system.channels).map(|at| iterate.upper[at] - iterate.lower[at]).sum()
        };
        let parts = system.leaves.iter().zip(&self.scale);
        let sum: f64 = parts.map(|(leaf, scale)| refinement.hierarchy().area(NodeId(leaf.node)) * width(leaf) / scale).sum();
        if self.area > 0.0 { sum / self.area } else { 0.0 }
    }

    /// The initial importance of which that is the product with the width, by node and channel.
    fn initial(&self, system: &System<'_>, refinement: &Refinement<'_>) -> Vec<f64> {
        let mut initial = vec![0.0; system.parents.len() * system.channels];
        let mut sent = initial.clone();
        for (leaf, scale) in system.leaves.iter().zip(&self.scale) {
            let of_leaf = refinement.hierarchy().area(NodeId(leaf.node)) / scale;
            let lambda: f64 = std::env::var("LAMBDA").map_or(1.0, |s| s.parse().unwrap());
            for channel in 0..system.channels {
                initial[leaf.node as usize * system.channels + channel] += lambda * of_leaf;
                for entry in &system.entries[system.starts[leaf.node as usize] as usize..system.starts[leaf.node as usize + 1] as usize] {
                    sent[entry.source as usize * system.channels + channel] += of_leaf * leaf.reflectance[channel] * entry.upper;
                }
            }
        }
        // Sources give to their parts by area.
        let hierarchy = refinement.hierarchy();
        for node in hierarchy.ids().filter(|&node| !hierarchy.is_cluster(node)) {
            for child in hierarchy.children(node) {
                for channel in 0..system.channels {
                    sent[child.index() * system.channels + channel] +=
                        sent[node.index() * system.channels + channel] * hierarchy.area(child) / hierarchy.area(node);
                }
            }
        }
        for leaf in &system.leaves {
            for at in leaf.node as usize * system.channels..(leaf.node as usize + 1) * system.channels {
                initial[at] += sent[at];
            }
        }
        initial
    }
}

/// The least upper radiosity of any leaf below each node, by channel.
fn dimmest_upper(system: &System<'_>, iterate: &Iterate) -> Vec<f64> {
    let mut found = vec![f64::INFINITY; iterate.upper.len()];
    let channels = system.channels;
    for leaf in &system.leaves {
        let at = leaf.node as usize * channels;
        found[at..at + channels].copy_from_slice(&iterate.upper[at..at + channels]);
    }
    for node in (0..system.parents.len()).rev() {
        let parent = system.parents[node] as usize;
        for channel in (0..channels).filter(|_| parent != node) {
            found[parent * channels + channel] = found[parent * channels + channel].min(found[node * channels + channel]);
        }
    }
    found
}
