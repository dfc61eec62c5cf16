//! What pairs without a link hold back at most.
//!
//! With the links as they are, B solves `B = E + rho K B`. Let K' be what pairs without a link would add. Then the whole answer
//! exceeds B by `e = (I - rho (K + K'))^-1 rho K' B`, and as no scene reflects more than it receives (the form factors of any point add
//! up to 1 at most),
//!
//! ```text
//! Integral of e <= 1 / (1 - rho_max) Integral of rho K' B
//! Integral over r of K' B from s <= min(A_r F_rs max B_s, F_sr Integral of B_s)      F the largest from any point, nothing in between
//! ```
//!
//! Of two clusters F is bounded by boxes and by cones of normals. What may carry most is taken apart, and bounded by the theorem for
//! polygons, until so much work is done.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::pair::PairBounds;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::Pair;
use crate::scene::{Scene, SurfaceId};

/// So much is done to tell closely: a pair that is taken apart is one, polygons that are bounded are [`OF_POLYGONS`].
const MOST_WORK: usize = 1 << 15;
const OF_POLYGONS: usize = 1024;

/// What the light is that may be held back.
pub(crate) struct HeldBackInput<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    /// `scene.channels()` radiosities per node in W/m^2: what the links carry.
    pub radiosity: &'a [f64],
}

/// The most that all surfaces together radiate less because of `pairs` without a link, in W, all channels added: proved for the light
/// of `radiosity`, up to what sweeps would still change.
pub(crate) fn bound_held_back(input: &HeldBackInput<'_>, pairs: &[Pair]) -> f64 {
    let nodes = Nodes::new(input);
    let pair_bounds = PairBounds::new(input.scene, input.hierarchy, super::FormFactorRule::QuasiConcave);
    let cheaply = |pair: Pair| Waiting { power: nodes.power(input, pair, |r, s| pair_bounds.upper_of_boxes(r, s)), pair };

    // All pairs cheaply; the largest are looked at again. A pair with a cluster is taken apart, polygons are bounded as well as can be.
    let all: Vec<Waiting> = pairs.par_iter().with_min_len(256).map(|&pair| cheaply(pair)).collect();
    let mut heap: BinaryHeap<Waiting> = all.into_iter().filter(|waiting| waiting.power > 0.0).collect();
    let mut settled = 0.0;
    let mut work = 0;
    while work < MOST_WORK {
        let Some(Waiting { pair, .. }) = heap.pop() else { break };
        let hierarchy = input.hierarchy;
        let receiver_first = hierarchy.area(pair.receiver) >= hierarchy.area(pair.source);
        match (hierarchy.is_cluster(pair.receiver), hierarchy.is_cluster(pair.source)) {
            (true, source) if receiver_first || !source => {
                heap.extend(hierarchy.children(pair.receiver).map(|receiver| cheaply(Pair { receiver, ..pair })));
            }
            (_, true) => heap.extend(hierarchy.children(pair.source).map(|source| cheaply(Pair { source, ..pair }))),
            (_, false) => {
                work += OF_POLYGONS;
                settled += nodes.power(input, pair, |r, s| pair_bounds.upper_unlinked(r, s));
            }
        }
        work += 1;
    }
    let rounding = 1.0 + f64::EPSILON * (pairs.len() + MOST_WORK) as f64;
    (settled + heap.into_iter().map(|waiting| waiting.power).sum::<f64>()) * rounding
}

/// A pair with what it may hold back, in W.
struct Waiting {
    power: f64,
    pair: Pair,
}

/// What is known of nodes, by channel.
struct Nodes {
    /// The highest reflectance of a node's surfaces, over `1 - rho_max` of the scene.
    gain: Vec<f64>,
    /// The highest radiosity of a node's leaves, in W/m^2.
    brightest: Vec<f64>,
}

impl Nodes {
    fn new(input: &HeldBackInput<'_>) -> Self {
        let HeldBackInput { scene, hierarchy, radiosity } = *input;
        let channels = scene.channels();
        let highest = |channel: usize| scene.materials().iter().map(|material| material.reflectance[channel]).fold(0.0, f64::max);
        let once: Vec<f64> = (0..channels).map(|channel| 1.0 / (1.0 - highest(channel))).collect();

        // Leaves have their own; above, the highest of the children.
        let mut nodes = Self { gain: vec![0.0; radiosity.len()], brightest: vec![0.0; radiosity.len()] };
        for node in hierarchy.ids().rev() {
            if hierarchy.is_leaf(node) {
                let reflectance = &scene.material_of(SurfaceId(hierarchy.node(node).surface)).reflectance;
                for (channel, rho) in reflectance.iter().enumerate() {
                    let at = node.index() * channels + channel;
                    nodes.gain[at] = rho * once[channel];
                    nodes.brightest[at] = radiosity[at];
                }
            }
            let Some(parent) = hierarchy.parent(node) else { continue };
            for channel in 0..channels {
                let (own, above) = (node.index() * channels + channel, parent.index() * channels + channel);
                nodes.gain[above] = nodes.gain[above].max(nodes.gain[own]);
                nodes.brightest[above] = nodes.brightest[above].max(nodes.brightest[own]);
            }
        }
        nodes
    }

    /// What a pair may hold back with its interreflection, in W, all channels added; `upper(r, s)` bounds F_rs.
    fn power(&self, input: &HeldBackInput<'_>, pair: Pair, upper: impl Fn(NodeId, NodeId) -> f64) -> f64 {
        let Pair { receiver, source } = pair;
        let channels = input.scene.channels();
        let of = |values: &[f64], node: NodeId, channel: usize| values[node.index() * channels + channel];
        if (0..channels).all(|channel| of(&self.gain, receiver, channel) * of(&self.brightest, source, channel) == 0.0) {
            return 0.0;
        }
        let from_receiver = input.hierarchy.area(receiver) * upper(receiver, source).min(1.0);
        let from_source = input.hierarchy.area(source) * upper(source, receiver).min(1.0);
        let arriving = |channel: usize| {
            let of_source = from_source * of(input.radiosity, source, channel);
            (from_receiver * of(&self.brightest, source, channel)).min(of_source)
        };
        (0..channels).map(|channel| of(&self.gain, receiver, channel) * arriving(channel)).sum()
    }
}

impl Ord for Waiting {
    /// By power; of equal ones by pair, so that order depends on nothing else.
    fn cmp(&self, other: &Self) -> Ordering {
        let pair = |waiting: &Self| (waiting.pair.receiver, waiting.pair.source);
        self.power.total_cmp(&other.power).then_with(|| pair(self).cmp(&pair(other)))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}
