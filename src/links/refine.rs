//! The refinement loop: pairs are worked in waves until every one is linked, dormant or proved invisible.
//!
//! A wave's pairs are decided in parallel; those that may be linked have their visibility asked in one batch per chunk, and are decided
//! once more with it; splits make the next wave. Order and random numbers come from ids, so threads cannot change a bit.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::exchange::{
    bound_form_factor, estimate_cluster_form_factor, is_dark, polygon_form_factor, quick_form_factor, separated,
};
use super::limits::{Holding, RefineEnd, RefineLimits};
use super::oracle::{Candidate, Decision, RefinementOracle};
use super::sample_pairs::{sampled_blocked_form_factor, sampled_pairs, sampled_transmittance};
use super::{Link, LinkSet, Pair, Skips, Spared};
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// What refinement looks at: everything but the hierarchy, which grows.
pub(crate) struct RefineContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub oracle: &'a dyn RefinementOracle,
    /// `scene.channels()` radiosities per node; nodes that are newer take their nearest older ancestor's.
    pub radiosity: &'a [f64],
    /// Whether clusters gather and emit; otherwise they are split down to their surfaces.
    pub clusters: bool,
    /// Mean reflectance of the clusters, `scene.channels()` each.
    pub cluster_reflectance: &'a [f64],
    /// Relative accuracy of form factors; 0 asks for exact ones.
    pub form_factor_accuracy: f64,
    /// Visibility rays for a link between reflecting surfaces.
    pub rays_per_link: u32,
    /// Visibility rays for a link from a lamp.
    pub rays_per_light_link: u32,
    /// What is left out.
    pub skips: Skips,
    pub seed: u64,
    /// Spent on form factors of links, added over threads.
    pub form_factor_nanoseconds: AtomicU64,
}

/// What is known of every pair so far.
#[derive(Clone, Debug)]
pub(crate) struct Refinement {
    linked: Vec<(NodeId, Link)>,
    dormant: Vec<Pair>,
    /// Pairs that were dropped, by reason.
    pub behind: Spared,
    pub black: Spared,
}

/// What becomes of a pair of a wave.
enum Outcome {
    /// One is behind the other: no light can pass.
    Behind,
    /// The receiver reflects nothing: gathering would be in vain.
    Black,
    /// The source is dark so far.
    Dormant,
    Linked(Link),
    Split(Decision),
    /// Waits for its visibility: so many segments of the chunk's batch decide, the next give the value. They are drawn apart, because
    /// what one half of an even spread misses the other half meets more often.
    Asked {
        form_factor: f64,
        deciding: u32,
        valued: u32,
    },
}

/// Nodes are near each other if their radii together exceed this part of their distance. Then the kernel may be huge at a single sample,
/// and the visibilities share the exact form factor: a small bias instead of a large noise.
const NEAR: f64 = 1.5;

/// Pairs of clusters that must be split, whatever may be linked, are followed while no more pairs than this wait: they may prove dark.
const FEW_WAITING: usize = 1 << 16;

/// Pairs of a wave that are decided, and ask for visibility, together: about a thousand segments.
const CHUNK: usize = 256;

impl Refinement {
    /// One dormant pair, (root, root), which covers everything.
    pub fn new() -> Self {
        let everything = Pair { receiver: NodeId::ROOT, source: NodeId::ROOT };
        Self { linked: Vec::new(), dormant: vec![everything], behind: Spared::default(), black: Spared::default() }
    }

    /// How many links there are.
    pub fn links(&self) -> u64 {
        self.linked.len() as u64
    }

    /// The links by receiver.
    pub fn link_set(&self, hierarchy: &Hierarchy) -> LinkSet {
        LinkSet::new(hierarchy.len(), &self.linked, self.dormant.clone())
    }

    /// Splits the links that `splits` names, decides every other pair anew, and refines those with which the oracle is not content.
    pub fn refine(
        &mut self,
        hierarchy: &mut Hierarchy,
        splits: &HashMap<Pair, Decision>,
        context: &RefineContext<'_>,
        limits: &RefineLimits<'_>,
    ) -> RefineEnd {
        // Links with which the oracle is not content any more are split; dormant pairs are asked again.
        let decide = |(receiver, link): &(NodeId, Link)| {
            let pair = Pair { receiver: *receiver, source: link.source };
            splits.get(&pair).copied().unwrap_or_else(|| {
                context.oracle.decide(&context.candidate(hierarchy, pair, link.form_factor, Some(f64::from(link.seen))))
            })
        };
        let decisions: Vec<Decision> = self.linked.par_iter().map(decide).collect();
        let mut wave = std::mem::take(&mut self.dormant);
        let mut end = RefineEnd::Content;
        let linked = std::mem::take(&mut self.linked);
        let mut left = linked.len();
        for (placed, decision) in linked.into_iter().zip(decisions) {
            left -= 1;
            let pair = Pair { receiver: placed.0, source: placed.1.source };
            match decision {
                Decision::Link => self.linked.push(placed),
                split => match self.exceeded_by_split(hierarchy, pair, split, left + wave.len(), limits) {
                    Some(limit) => {
                        end = limit;
                        self.linked.push(placed);
                    }
                    None => push_children(hierarchy, pair, split, &mut wave),
                },
            }
        }

        // Wave after wave: decide, ask, decide again, split.
        while !wave.is_empty() {
            if end == RefineEnd::Content && limits.says_stop(hierarchy, self.linked.len() + wave.len()) {
                end = RefineEnd::Stopped;
            }
            let may_split = end == RefineEnd::Content;
            let outcomes: Vec<Vec<Outcome>> =
                wave.par_chunks(CHUNK).map(|pairs| context.decide_chunk(hierarchy, pairs, may_split)).collect();
            let mut splits = Vec::new();
            for (pair, outcome) in wave.iter().zip(outcomes.into_iter().flatten()) {
                match outcome {
                    Outcome::Behind => self.behind.add(2 * context.rays_for(hierarchy, *pair)),
                    Outcome::Black => self.black.add(2 * context.rays_for(hierarchy, *pair)),
                    Outcome::Dormant => self.dormant.push(*pair),
                    Outcome::Linked(link) => end = self.link(hierarchy, pair.receiver, link, limits).unwrap_or(end),
                    Outcome::Split(decision) => splits.push((*pair, decision)),
                    Outcome::Asked { .. } => unreachable!("a chunk answers all it asks"),
                }
            }

            // What does not fit waits: pairs that prove dark make room. If none does, this is the end, and who cannot be linked sleeps.
            let (mut next, mut left, mut refused) = (Vec::new(), splits.len(), None);
            let all = splits.len();
            for (pair, decision) in splits {
                left -= 1;
                let is_structural = !context.clusters && (hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source));
                match self.exceeded_by_split(hierarchy, pair, decision, left + next.len(), limits) {
                    Some(limit) if !(is_structural && limit == RefineEnd::MaxLinks && left + next.len() <= FEW_WAITING) => {
                        refused = Some(limit);
                        if may_split { next.push(pair) } else { self.dormant.push(pair) }
                    }
                    _ => push_children(hierarchy, pair, decision, &mut next),
                }
            }
            if let Some(limit) = refused.filter(|_| may_split && next.len() == all) {
                end = limit;
            }
            wave = next;
        }
        end
    }

    /// Adds a link, or leaves the pair dormant if a limit says so, which is returned.
    fn link(&mut self, hierarchy: &Hierarchy, receiver: NodeId, link: Link, limits: &RefineLimits<'_>) -> Option<RefineEnd> {
        let exceeded = limits.exceeded(hierarchy, self.holding(1), 0);
        match exceeded {
            Some(_) => self.dormant.push(Pair { receiver, source: link.source }),
            None => self.linked.push((receiver, link)),
        }
        exceeded
    }

    /// The limit that would be exceeded if a pair were split, and all that came of it and `waiting` others were linked.
    fn exceeded_by_split(
        &self,
        hierarchy: &Hierarchy,
        pair: Pair,
        decision: Decision,
        waiting: usize,
        limits: &RefineLimits<'_>,
    ) -> Option<RefineEnd> {
        let (children, bytes) = limits.cost_of_split(hierarchy, split_end(pair, decision));
        limits.exceeded(hierarchy, self.holding(waiting + children), bytes)
    }

    /// What there is if all `waiting` pairs are linked.
    fn holding(&self, waiting: usize) -> Holding {
        Holding { links: self.linked.len() + waiting, unlinked: self.dormant.len() }
    }
}

/// The node of a pair that a decision splits.
fn split_end(pair: Pair, decision: Decision) -> NodeId {
    if decision == Decision::SplitReceiver { pair.receiver } else { pair.source }
}

/// Appends the pairs that take the place of `pair`, making elements where there are none yet.
fn push_children(hierarchy: &mut Hierarchy, pair: Pair, decision: Decision, pairs: &mut Vec<Pair>) {
    let split = split_end(pair, decision);
    if hierarchy.is_leaf(split) {
        hierarchy.split(split);
    }
    pairs.extend(hierarchy.children(split).map(|child| match decision {
        Decision::SplitReceiver => Pair { receiver: child, ..pair },
        _ => Pair { source: child, ..pair },
    }));
}

impl RefineContext<'_> {
    /// Decides the pairs of a chunk: first without visibility, then, for those that come through, with it.
    fn decide_chunk(&self, hierarchy: &Hierarchy, pairs: &[Pair], may_split: bool) -> Vec<Outcome> {
        // Decide by geometry and brightness, and collect the segments of those that would be linked.
        let (mut segments, mut kernels) = (Vec::new(), Vec::new());
        let mut outcomes: Vec<Outcome> =
            pairs.iter().map(|&pair| self.decide_unseen(hierarchy, pair, may_split, &mut segments, &mut kernels)).collect();
        let mut occluded = Vec::new();
        self.rays.occluded(&segments, &mut occluded);

        // Decide again, with the part that gets through.
        let mut first = 0;
        for (&pair, outcome) in pairs.iter().zip(&mut outcomes) {
            let Outcome::Asked { form_factor, deciding, valued } = *outcome else { continue };
            let deciding = first..first + deciding as usize;
            let valued = deciding.end..deciding.end + valued as usize;
            first = valued.end;
            let seen = sampled_transmittance(&kernels[deciding.clone()], &occluded[deciding]);
            let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
            let near = receiver.radius + source.radius > NEAR * receiver.centroid.distance(source.centroid);
            let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
            let transmittance = if near || clusters || form_factor <= 0.0 {
                sampled_transmittance(&kernels[valued.clone()], &occluded[valued])
            } else {
                1.0 - sampled_blocked_form_factor(source.area, &kernels[valued.clone()], &occluded[valued]) / form_factor
            };
            let decision = if may_split {
                self.oracle.decide(&self.candidate(hierarchy, pair, form_factor, Some(seen)))
            } else {
                Decision::Link
            };
            *outcome = match decision {
                Decision::Link => Outcome::Linked(Link {
                    form_factor,
                    source: pair.source,
                    transmittance: transmittance as f32,
                    seen: seen as f32,
                }),
                split => Outcome::Split(split),
            };
        }
        outcomes
    }

    /// Decides a pair without visibility; a pair that would be linked leaves its segments in the batch.
    fn decide_unseen(
        &self,
        hierarchy: &Hierarchy,
        pair: Pair,
        may_split: bool,
        segments: &mut Vec<Segment>,
        kernels: &mut Vec<f64>,
    ) -> Outcome {
        // What cannot pass, is not reflected or does not shine yet is not asked any further.
        let is_itself = pair.receiver == pair.source;
        if (self.skips.behind || (is_itself && !hierarchy.is_cluster(pair.source))) && is_dark(self.scene, hierarchy, pair) {
            return Outcome::Behind;
        }
        if self.skips.black && self.reflectance(hierarchy, pair.receiver).iter().all(|&rho| rho == 0.0) {
            return Outcome::Black;
        }
        if self.skips.dark && self.radiosity_of(hierarchy, pair.source).iter().all(|&b| b == 0.0) {
            return Outcome::Dormant;
        }

        // Is it little enough, by a cheap form factor? No cluster is linked with itself.
        let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
        if clusters && (!self.clusters || (is_itself && !self.skips.within)) {
            return Outcome::Split(larger(hierarchy, pair));
        }
        let separated = !clusters || separated(hierarchy, pair);
        if may_split {
            let cheap = match (clusters, separated) {
                (false, _) => quick_form_factor(&hierarchy.facet(pair.receiver), &hierarchy.facet(pair.source)),
                (true, true) => estimate_cluster_form_factor(hierarchy, pair),
                (true, false) => bound_form_factor(hierarchy, pair),
            };
            let decision = self.oracle.decide(&self.candidate(hierarchy, pair, cheap, None));
            if decision != Decision::Link {
                return Outcome::Split(decision);
            }
        }
        if is_itself {
            return Outcome::Dormant;
        }

        // It is: ask for visibility, and take the form factor with care. Of clusters that are near each other it is sampled.
        let count = self.rays_for(hierarchy, pair);
        let seed = sampling::hash(self.seed, u64::from(pair.receiver.0) << 32 | u64::from(pair.source.0));
        let mut sample = |seed| sampled_pairs(self.scene, hierarchy, pair, count, seed, segments, kernels);
        let (deciding, valued) = (sample(seed), sample(sampling::hash(seed, 1)));
        let start = Instant::now();
        let form_factor = match (clusters, separated) {
            (false, _) => {
                polygon_form_factor(&hierarchy.facet(pair.receiver), &hierarchy.facet(pair.source), self.form_factor_accuracy)
            }
            (true, true) => estimate_cluster_form_factor(hierarchy, pair),
            (true, false) => (0.5 * (deciding.1 + valued.1)).min(bound_form_factor(hierarchy, pair)),
        };
        self.form_factor_nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        Outcome::Asked { form_factor, deciding: deciding.0, valued: valued.0 }
    }

    /// Visibility rays for the value of a link of this pair; as many again decide whether it is one.
    fn rays_for(&self, hierarchy: &Hierarchy, pair: Pair) -> u32 {
        let is_lamp = hierarchy.surface_of(pair.source).is_some_and(|surface| self.scene.material_of(surface).emits());
        if is_lamp { self.rays_per_light_link } else { self.rays_per_link }
    }

    /// The numbers that an oracle sees.
    fn candidate(&self, hierarchy: &Hierarchy, pair: Pair, form_factor: f64, transmittance: Option<f64>) -> Candidate {
        let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
        let radiosity = self.radiosity_of(hierarchy, pair.source);
        let reflectance = self.reflectance(hierarchy, pair.receiver);
        let reflected_radiosity = reflectance.iter().zip(radiosity).map(|(rho, b)| rho * b).fold(0.0, f64::max);
        Candidate {
            form_factor,
            transmittance,
            reflected_radiosity,
            source_variation: self.variation(hierarchy, pair.source),
            receiver_area: receiver.area,
            receiver_radius: receiver.radius,
            source_area: source.area,
            source_radius: source.radius,
            distance: receiver.centroid.distance(source.centroid),
            clusters: hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source),
        }
    }

    /// The reflectance of a node by channel, of a cluster the mean over its area.
    fn reflectance(&self, hierarchy: &Hierarchy, node: NodeId) -> &[f64] {
        match hierarchy.surface_of(node) {
            Some(surface) => &self.scene.material_of(surface).reflectance,
            None => &self.cluster_reflectance[node.index() * self.scene.channels()..][..self.scene.channels()],
        }
    }

    /// The radiosity of a node, or of its nearest ancestor that is old enough to have one.
    fn radiosity_of(&self, hierarchy: &Hierarchy, node: NodeId) -> &[f64] {
        let channels = self.scene.channels();
        let known = self.radiosity.len() / channels;
        let mut node = node;
        while node.index() >= known {
            node = hierarchy.node(node).parent;
        }
        &self.radiosity[node.index() * channels..][..channels]
    }

    /// How much B varies over a node, relative to B: measured between its children, else guessed as half of what is reflected.
    fn variation(&self, hierarchy: &Hierarchy, node: NodeId) -> f64 {
        let brightest = |radiosity: &[f64]| radiosity.iter().copied().fold(0.0, f64::max);
        let mean = brightest(self.radiosity_of(hierarchy, node));
        if mean <= 0.0 {
            return 0.0;
        }
        let known = self.radiosity.len() / self.scene.channels();
        let measured = hierarchy.children(node).filter(|child| child.index() < known);
        match measured.map(|child| (brightest(self.radiosity_of(hierarchy, child)) - mean).abs()).reduce(f64::max) {
            Some(difference) => difference / mean,
            None => {
                let emitted =
                    hierarchy.surface_of(node).map_or(0.0, |surface| brightest(&self.scene.material_of(surface).exitance));
                UNKNOWN_VARIATION * (1.0 - emitted / mean).clamp(0.0, 1.0)
            }
        }
    }
}

/// The variation of reflected light over a surface that was not split yet.
const UNKNOWN_VARIATION: f64 = 0.5;

/// Splits the larger of two nodes where clusters neither gather nor emit: a cluster before a surface.
fn larger(hierarchy: &Hierarchy, pair: Pair) -> Decision {
    let source_first = !hierarchy.is_cluster(pair.receiver)
        || (hierarchy.is_cluster(pair.source) && hierarchy.area(pair.source) > hierarchy.area(pair.receiver));
    if source_first { Decision::SplitSource } else { Decision::SplitReceiver }
}
