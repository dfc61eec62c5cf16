//! What becomes of a pair: it is dropped by proof, sleeps, is split, or has its visibility asked and is linked.

use std::sync::atomic::Ordering;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::context::RefineContext;
use super::exchange::{
    bound_form_factor, estimate_cluster_form_factor, is_dark, polygon_form_factor, quick_form_factor, separated,
};
use super::link_set::{Link, Pair};
use super::oracle::Decision;
use super::sample_pairs::{SamplePairs, sampled_transmittance, sampled_visible_form_factor};
use crate::geometry::{sampling, streams};
use crate::hierarchy::Hierarchy;

/// What becomes of a pair of a wave.
#[derive(Serialize, Deserialize)]
pub(super) enum Outcome {
    /// One is behind the other: no light can pass.
    Behind,
    /// The receiver reflects nothing: gathering would be in vain.
    Black,
    /// The source is dark so far.
    Dormant,
    Linked(Link),
    Split(Decision),
}

/// What becomes of a pair by geometry and brightness alone.
enum Unseen {
    Settled(Outcome),
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

impl RefineContext<'_> {
    /// Decides the pairs of a chunk: first without visibility, then, for those that may be linked, with it.
    pub(super) fn decide_chunk(&self, hierarchy: &Hierarchy, pairs: &[Pair], may_split: bool) -> Vec<Outcome> {
        // Decide by geometry and brightness, and collect the segments of those that may be linked.
        let mut samples = SamplePairs::default();
        let decide = |&pair: &Pair| match self.decide_unseen(hierarchy, pair, may_split) {
            Some(outcome) => Unseen::Settled(outcome),
            None => self.ask(hierarchy, pair, &mut samples),
        };
        let unseen: Vec<Unseen> = pairs.iter().map(decide).collect();
        let passes = self.ask_rays(&samples);

        // Decide again, with the part that gets through.
        let mut answers = Answers { kernels: &samples.kernels, passes: &passes };
        let decide = |(&pair, unseen): (&Pair, Unseen)| match unseen {
            Unseen::Settled(outcome) => outcome,
            Unseen::Asked { form_factor, deciding, valued } => {
                let (deciding, valued) = (answers.take(deciding), answers.take(valued));
                let seen = sampled_transmittance(deciding.kernels, deciding.passes.iter().copied());
                let transmittance = sampled_link_transmittance(hierarchy, pair, form_factor, seen, valued) as f32;
                let candidate = || self.candidate(hierarchy, pair, form_factor, Some(seen));
                match if may_split { self.oracle.decide(&candidate()) } else { Decision::Link } {
                    Decision::Link => Outcome::Linked(Link { form_factor, source: pair.source, transmittance, seen: seen as f32 }),
                    split => Outcome::Split(split),
                }
            }
        };
        pairs.iter().zip(unseen).map(decide).collect()
    }

    /// Decides a pair without visibility; `None` if it may be linked.
    fn decide_unseen(&self, hierarchy: &Hierarchy, pair: Pair, may_split: bool) -> Option<Outcome> {
        // What cannot pass, is not reflected or does not shine yet is not asked any further.
        let is_itself = pair.receiver == pair.source;
        if (self.skips.behind || (is_itself && !hierarchy.is_cluster(pair.source))) && is_dark(self.scene, hierarchy, pair) {
            return Some(Outcome::Behind);
        }
        if self.skips.black && self.reflectance(hierarchy, pair.receiver).iter().all(|&rho| rho == 0.0) {
            return Some(Outcome::Black);
        }
        if self.skips.dark && self.radiosity_of(hierarchy, pair.source).iter().all(|&b| b == 0.0) {
            return Some(Outcome::Dormant);
        }

        // Is it little enough, by a cheap form factor? No cluster is linked with itself.
        let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
        if clusters && (!self.clusters || (is_itself && !self.skips.within)) {
            return Some(Outcome::Split(larger(hierarchy, pair)));
        }
        if may_split {
            let cheap = match (clusters, separated(hierarchy, pair)) {
                (false, _) => quick_form_factor(&hierarchy.facet(pair.receiver), &hierarchy.facet(pair.source)),
                (true, true) => estimate_cluster_form_factor(hierarchy, pair),
                (true, false) => bound_form_factor(hierarchy, pair),
            };
            let decision = self.oracle.decide(&self.candidate(hierarchy, pair, cheap, None));
            if decision != Decision::Link {
                return Some(Outcome::Split(decision));
            }
        }
        is_itself.then_some(Outcome::Dormant)
    }

    /// Takes the form factor of a pair with care, and leaves the segments by which to decide it in the batch. Of clusters that are near each
    /// other the form factor is sampled.
    fn ask(&self, hierarchy: &Hierarchy, pair: Pair, samples: &mut SamplePairs) -> Unseen {
        let count = self.rays_for(hierarchy, pair);
        let seed = pair.seed(self.seed);
        let mut sample = |seed| samples.add(self.scene, hierarchy, pair, count, seed);
        let (deciding, valued) = (sample(seed), sample(sampling::hash(seed, streams::LINK_VALUE)));
        self.ask_maps(hierarchy, pair, deciding.0 + valued.0, samples);
        let start = Instant::now();
        let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
        let form_factor = match (clusters, separated(hierarchy, pair)) {
            (false, _) => {
                polygon_form_factor(&hierarchy.facet(pair.receiver), &hierarchy.facet(pair.source), self.form_factor_accuracy)
            }
            (true, true) => estimate_cluster_form_factor(hierarchy, pair),
            (true, false) => (0.5 * (deciding.1 + valued.1)).min(bound_form_factor(hierarchy, pair)),
        };
        self.form_factor_nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        Unseen::Asked { form_factor, deciding: deciding.0, valued: valued.0 }
    }
}

/// Answers of a batch that were not read yet, in the order in which they were asked.
#[derive(Clone, Copy)]
struct Answers<'a> {
    kernels: &'a [f64],
    passes: &'a [f64],
}

impl<'a> Answers<'a> {
    /// The next answers.
    fn take(&mut self, count: u32) -> Answers<'a> {
        let (kernels, more_kernels) = self.kernels.split_at(count as usize);
        let (passes, more_passes) = self.passes.split_at(count as usize);
        *self = Self { kernels: more_kernels, passes: more_passes };
        Answers { kernels, passes }
    }
}

/// The part of a link's form factor that gets through, without bias but where the two are near each other; `seen` is what other samples
/// found of it.
fn sampled_link_transmittance(
    hierarchy: &Hierarchy,
    pair: Pair,
    form_factor: f64,
    seen: f64,
    Answers { kernels, passes }: Answers<'_>,
) -> f64 {
    let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
    let near = receiver.radius + source.radius > NEAR * receiver.centroid.distance(source.centroid);
    let clusters = hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
    if near || clusters || form_factor <= 0.0 {
        sampled_transmittance(kernels, passes.iter().copied())
    } else {
        sampled_visible_form_factor(form_factor, seen, source.area, kernels, passes) / form_factor
    }
}

/// Splits the larger of two nodes where clusters neither gather nor emit: a cluster before a surface.
fn larger(hierarchy: &Hierarchy, pair: Pair) -> Decision {
    let source_first = !hierarchy.is_cluster(pair.receiver)
        || (hierarchy.is_cluster(pair.source) && hierarchy.area(pair.source) > hierarchy.area(pair.receiver));
    if source_first { Decision::SplitSource } else { Decision::SplitReceiver }
}
