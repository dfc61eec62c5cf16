//! Pairs by what they may carry at most: the one that may carry most is split next.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::bounds::form_factors::{FormFactorRule, PairBounds};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::Pair;
use crate::scene::{Scene, SurfaceId};

/// The light that pairs may carry.
#[derive(Clone, Copy)]
pub(crate) struct Light<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    /// `scene.channels()` radiosities per node in W/m^2.
    pub radiosity: &'a [f64],
}

/// Pairs that wait to be split.
pub(super) struct WorstFirst<'a> {
    light: Light<'a>,
    nodes: Nodes,
    pair_bounds: PairBounds<'a>,
    waiting: BinaryHeap<Waiting>,
}

/// A pair with what it may carry, and what that may become by interreflection.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    /// What all surfaces together reflect because of it, at most: in W, all channels added.
    pub power: f64,
    pub pair: Pair,
    /// No point of the receiver has a larger form factor.
    pub upper: f64,
}

/// What became of the pair that may carry most.
pub(super) enum Worst {
    /// Pairs with the children of one of its nodes wait in its place.
    Split,
    /// A leaf that gathers from a polygon: it waits no longer.
    Polygons(Waiting),
}

impl<'a> WorstFirst<'a> {
    /// All pairs by which anything can be reflected, bounded cheaply.
    pub fn new(light: Light<'a>, pairs: impl ParallelIterator<Item = Pair>) -> Self {
        let pair_bounds = PairBounds::new(light.scene, light.hierarchy, FormFactorRule::QuasiConcave);
        let mut found = Self { light, nodes: Nodes::new(light), pair_bounds, waiting: BinaryHeap::new() };
        found.waiting = pairs.filter_map(|pair| found.cheaply(pair, 1.0)).collect::<Vec<_>>().into();
        found
    }

    /// Splits the pair that may carry most: the larger of its clusters, or else its receiver. `None` once no pair carries anything.
    pub fn split_worst(&mut self) -> Option<Worst> {
        let worst = *self.waiting.peek().filter(|worst| worst.power > 0.0)?;
        self.waiting.pop();
        let Waiting { pair, upper, .. } = worst;
        let hierarchy = self.light.hierarchy;
        let (receiver_is_cluster, source_is_cluster) = (hierarchy.is_cluster(pair.receiver), hierarchy.is_cluster(pair.source));
        let receiver_is_larger = hierarchy.area(pair.receiver) >= hierarchy.area(pair.source);
        let parts: Vec<Waiting> = if source_is_cluster && !(receiver_is_cluster && receiver_is_larger) {
            hierarchy.children(pair.source).filter_map(|source| self.cheaply(Pair { source, ..pair }, upper)).collect()
        } else if !hierarchy.is_leaf(pair.receiver) {
            hierarchy.children(pair.receiver).filter_map(|receiver| self.cheaply(Pair { receiver, ..pair }, upper)).collect()
        } else {
            return Some(Worst::Polygons(worst));
        };
        self.waiting.extend(parts);
        Some(Worst::Split)
    }

    /// What a pair of polygons may carry by the theorem for these, as [`Waiting::power`].
    pub fn power_of_polygons(&self, pair: Pair) -> f64 {
        let [upper, from_source] =
            [(pair.receiver, pair.source), (pair.source, pair.receiver)].map(|(r, s)| self.pair_bounds.upper_unlinked(r, s));
        self.power(pair, upper, from_source)
    }

    /// The pairs that still wait.
    pub fn into_rest(self) -> impl Iterator<Item = Waiting> {
        self.waiting.into_iter()
    }

    /// A pair with what it may carry, by what is known cheaply and by the bound of the pair it is a part of; `None` if nothing can be
    /// reflected because of it.
    fn cheaply(&self, pair: Pair, upper_around: f64) -> Option<Waiting> {
        let upper = self.pair_bounds.upper_quickly(pair.receiver, pair.source).min(upper_around);
        let reflects = || self.nodes.of(&self.nodes.gain, pair.receiver).any(|gain| gain > 0.0);
        (upper > 0.0 && reflects()).then(|| {
            let from_source = self.pair_bounds.upper_of_boxes(pair.source, pair.receiver);
            Waiting { power: self.power(pair, upper, from_source), pair, upper }
        })
    }

    /// What a pair may carry, as [`Waiting::power`]: `A_r F_rs` times the highest radiosity of the source, and no more than F_sr times the
    /// power of the source, by upper bounds of F_rs and F_sr; times the gain of the receiver.
    fn power(&self, pair: Pair, upper: f64, upper_from_source: f64) -> f64 {
        let Pair { receiver, source } = pair;
        let (hierarchy, channels) = (self.light.hierarchy, self.nodes.channels);
        let lit = self.nodes.of(&self.nodes.gain, receiver).zip(self.nodes.of(&self.nodes.brightest, source));
        let from_receiver = hierarchy.area(receiver) * upper.min(1.0);
        let from_source = hierarchy.area(source) * upper_from_source.min(1.0);
        let radiosity = &self.light.radiosity[source.index() * channels..][..channels];
        lit.zip(radiosity).map(|((gain, brightest), b)| gain * (from_receiver * brightest).min(from_source * b)).sum()
    }
}

/// What is known of nodes, by channel.
struct Nodes {
    channels: usize,
    /// The highest reflectance of a node's surfaces, divided by `1 - rho_max` of the scene: what is reflected there once, and what
    /// that becomes by interreflection at most.
    gain: Vec<f64>,
    /// The highest radiosity of a node's leaves, in W/m^2.
    brightest: Vec<f64>,
}

impl Nodes {
    fn new(light: Light<'_>) -> Self {
        let Light { scene, hierarchy, radiosity } = light;
        let channels = scene.channels();
        let highest = |channel: usize| scene.materials().iter().map(|material| material.reflectance[channel]).fold(0.0, f64::max);
        let interreflection: Vec<f64> = (0..channels).map(|channel| 1.0 / (1.0 - highest(channel))).collect();

        // Leaves have their own; nodes above, the highest of their children.
        let mut nodes = Self { channels, gain: vec![0.0; radiosity.len()], brightest: vec![0.0; radiosity.len()] };
        for node in hierarchy.ids().rev() {
            if hierarchy.is_leaf(node) {
                let reflectance = &scene.material_of(SurfaceId(hierarchy.node(node).surface)).reflectance;
                for (channel, rho) in reflectance.iter().enumerate() {
                    let at = node.index() * channels + channel;
                    nodes.gain[at] = rho * interreflection[channel];
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

    fn of<'b>(&self, values: &'b [f64], node: NodeId) -> impl Iterator<Item = f64> + Clone + use<'b> {
        values[node.index() * self.channels..][..self.channels].iter().copied()
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
