//! Error-driven refinement: solve, ask which links the error comes from, split these, again (Lischinski 1994, section 5.3).
//!
//! Form factors of links lie between bounds; from these follow lower and upper radiosities, and what each link adds to the gap between
//! them, weighted by what the answer is wanted for ([`Interest`](super::Interest)). With
//! [`Bounds::Guaranteed`] form factors are bounded by proof, so that the gap is proved, too; else by what the centre and the
//! vertices of each receiver see, which is less work and an estimate.

use std::collections::HashMap;
use std::time::Instant;

use serde::Serialize;

use super::interest::InitialImportance;
use super::plan::Plan;
use super::{Bounds, RunOptions, Solver};
use crate::bounds::{BoundsInput, Certainty, FormFactorRule, KnownPairs, LinkGap, LinkGaps, link_gaps};
use crate::hierarchy::NodeId;
use crate::links::oracle::{Decision, ErrorDriven, LinkError, Uniform};
use crate::links::{Pair, RefineEnd};
use crate::progress::Stage;
use crate::scene::SurfaceId;

/// What a link may add to the error is told for this part of the area of all surfaces, as in the default oracle.
const REFERENCE_AREA: f64 = 1e-3;

/// Times that links are split for one tolerance: each halves the sides of what is split.
const MOST_SPLITS: u32 = 40;

/// Splits of fewer links than this part of all are left to the next tolerance: a round costs the same for one of them.
const WORTH_A_ROUND: f64 = 0.01;

/// How wrong radiosities may be by the links of error-driven refinement, in W, channels added, weighted by importance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LinkErrorReport {
    /// How far that can be trusted.
    pub certainty: Certainty,
    /// `<R, upper - lower>`: what all links, and pairs without one, leave open.
    pub gap: f64,
    /// The L1 error that is to be expected if radiosities are spread evenly between their bounds: a quarter of the gap (Lischinski
    /// 1994, equation 5.7).
    pub estimated_error: f64,
    /// `<R, B - E>`: what is reflected of it.
    pub reflected: f64,
    /// The part of the gap, 0 to 1, of pairs without a link.
    pub unlinked_share: f64,
    /// How often links were split.
    pub splits: u64,
}

/// What error-driven refinement keeps from round to round.
pub(super) struct ErrorSearch {
    initial: InitialImportance,
    known: KnownPairs,
}

impl ErrorSearch {
    pub fn new(initial: InitialImportance) -> Self {
        Self { initial, known: KnownPairs::default() }
    }
}

impl Solver<'_> {
    /// Splits links until none adds more to the error than the tolerances of the round, one after the other.
    pub(super) fn refine_by_error(&mut self, plan: &Plan, run: &RunOptions, deadline: Option<Instant>) -> RefineEnd {
        // Every pair that can exchange light has a link, and every link its light.
        let mut ended = self.split_and_sweep(&HashMap::new(), plan, run, deadline);
        let tolerances = plan.tolerances();
        let finest = tolerances.last().copied().unwrap_or(1.0);
        let area = REFERENCE_AREA * self.hierarchy.area(NodeId::ROOT);
        for tolerance in tolerances {
            let oracle =
                ErrorDriven { tolerance: plan.irradiance_tolerance() * area * tolerance / finest, min_area: plan.min_area() };
            for _ in 0..MOST_SPLITS {
                let gaps = self.link_gaps(deadline);
                let splits = self.splits(&gaps, &oracle);
                if ended != RefineEnd::Content || (splits.len() as f64) < WORTH_A_ROUND * gaps.links.len() as f64 {
                    break;
                }
                ended = self.split_and_sweep(&splits, plan, run, deadline);
            }
        }
        ended
    }

    /// Splits links, links what that makes as it stands, and lets light travel until all that it reaches is linked.
    fn split_and_sweep(
        &mut self,
        splits: &HashMap<Pair, Decision>,
        plan: &Plan,
        run: &RunOptions,
        deadline: Option<Instant>,
    ) -> RefineEnd {
        let as_they_stand = Uniform { element_area: f64::INFINITY };
        let mut ended = self.refine_with(&as_they_stand, splits, plan, run, deadline);
        self.sweep(deadline);
        while ended == RefineEnd::Content && self.dormant_pair_is_lit(plan) {
            ended = self.refine_with(&as_they_stand, &HashMap::new(), plan, run, deadline);
            self.sweep(deadline);
        }
        ended
    }

    /// What all links leave open, and its report.
    fn link_gaps(&mut self, deadline: Option<Instant>) -> LinkGaps {
        let start = Instant::now();
        self.progress(Stage::Error);
        let (rule, certainty) = match self.options.bounds {
            Bounds::Guaranteed => (FormFactorRule::QuasiConcave, Certainty::Guaranteed),
            _ => (FormFactorRule::CentreAndVertices, Certainty::Estimate),
        };
        let initial = self.error_search.initial.of_leaves(&self.hierarchy, &self.exposure, self.scene.channels());
        let radiosity = self.radiosity.values();
        let stop = self.is_late(deadline);
        let input = BoundsInput {
            scene: self.scene,
            hierarchy: &self.hierarchy,
            links: &self.links,
            radiosity,
            rule,
            work: 0,
            stop: &stop,
        };
        let gaps = link_gaps(&input, &mut self.error_search.known, &initial);
        let splits = self.report.link_error.map_or(0, |report| report.splits + 1);
        self.report.link_error = Some(LinkErrorReport {
            certainty,
            gap: gaps.gap,
            estimated_error: 0.25 * gaps.gap,
            reflected: self.reflected_of(&initial),
            unlinked_share: gaps.unlinked / gaps.gap.max(f64::MIN_POSITIVE),
            splits,
        });
        self.report.time_s.bounds += start.elapsed().as_secs_f64();
        gaps
    }

    /// `<R, B - E>`.
    fn reflected_of(&self, initial: &[f64]) -> f64 {
        let channels = self.scene.channels();
        let of_leaf = |leaf: NodeId| {
            let exitance = &self.scene.material_of(SurfaceId(self.hierarchy.node(leaf).surface)).exitance;
            let reflected = self.radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e);
            initial[leaf.index() * channels..].iter().zip(reflected).map(|(r, b)| r * b).sum::<f64>()
        };
        self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node)).map(of_leaf).sum()
    }

    /// The links with which the oracle is not content; a link counts by the mean over its channels.
    fn splits(&self, gaps: &LinkGaps, oracle: &ErrorDriven) -> HashMap<Pair, Decision> {
        let decide = |gap: &LinkGap| {
            let error = LinkError {
                share: gap.share / self.scene.channels() as f64,
                by_form_factor: gap.by_form_factor,
                by_source: gap.by_source,
                receiver_area: self.hierarchy.area(gap.receiver),
                source_area: self.hierarchy.area(gap.source),
            };
            let decision = oracle.decide(&error);
            (decision != Decision::Link).then_some((Pair { receiver: gap.receiver, source: gap.source }, decision))
        };
        gaps.links.iter().filter_map(decide).collect()
    }
}
