//! Error-driven refinement: solve, ask which links the error comes from, split these, again (Lischinski 1994, section 5.3).
//!
//! Form factors of links lie between bounds; from these follow lower and upper radiosities, and what each link adds to the gap between
//! them, weighted by what the answer is wanted for ([`Interest`](crate::solve::Interest)). With
//! [`Bounds::Guaranteed`] form factors are bounded by proof, so that the gap is proved, too; else by what the centre and the
//! vertices of each receiver see, which is less work and an estimate.

use std::collections::HashMap;
use std::time::Instant;

use crate::bounds::{BoundsInput, Certainty, FormFactorRule, KnownPairs, LinkGap, LinkGaps, link_gaps};
use crate::hierarchy::NodeId;
use crate::links::oracle::{Decision, ErrorDriven, LinkError, Uniform};
use crate::links::{Pair, RefineEnd};
use crate::progress::Stage;
use crate::scene::SurfaceId;
use crate::solve::interest::InitialImportance;
use crate::solve::job::Job;
use crate::solve::linked::Linked;
use crate::solve::options::Bounds;
use crate::solve::plan::Plan;
use crate::solve::report::LinkErrorReport;

/// What a link may add to the error is told for this part of the area of all surfaces, as in the default oracle.
const REFERENCE_AREA: f64 = 1e-3;

/// Times that links are split for one tolerance: each halves the sides of what is split.
const MOST_SPLITS: u32 = 40;

/// Splits of fewer links than this part of all are left to the next tolerance: a round costs the same for one of them.
const WORTH_A_ROUND: f64 = 0.01;

/// What error-driven refinement keeps from round to round.
pub(in crate::solve) struct ErrorSearch {
    initial: InitialImportance,
    known: KnownPairs,
}

impl ErrorSearch {
    pub fn new(initial: InitialImportance) -> Self {
        Self { initial, known: KnownPairs::default() }
    }

    /// Splits links until none adds more to the error than the tolerances of the round, one after the other.
    pub(super) fn refine_by_error(&mut self, linked: &mut Linked<'_>, plan: &Plan) -> RefineEnd {
        // Every pair that can exchange light has a link, and every link its light.
        let as_they_stand = Uniform { element_area: f64::INFINITY };
        let mut ended = linked.refine_and_sweep(&as_they_stand, &HashMap::new());
        let tolerances = plan.tolerances();
        let finest = tolerances.last().copied().unwrap_or(1.0);
        let area = REFERENCE_AREA * linked.hierarchy.area(NodeId::ROOT);
        for tolerance in tolerances {
            let tolerance = plan.irradiance_tolerance() * area * tolerance / finest;
            let oracle = ErrorDriven { tolerance, min_area: plan.min_area() };
            for _ in 0..MOST_SPLITS {
                let Some(gaps) = self.link_gaps(linked) else { return RefineEnd::Stopped };
                if ended != RefineEnd::Content {
                    return ended;
                }
                let splits = splits(linked, &gaps, &oracle);
                if (splits.len() as f64) < WORTH_A_ROUND * gaps.links.len() as f64 {
                    break;
                }
                ended = linked.refine_and_sweep(&as_they_stand, &splits);
            }
        }
        ended
    }

    /// What all links leave open, and its report; `None` if the solve is to end before that is known.
    fn link_gaps(&mut self, linked: &mut Linked<'_>) -> Option<LinkGaps> {
        let start = Instant::now();
        linked.progress(Stage::Error);
        let (rule, certainty) = match linked.job.options.bounds {
            Bounds::Guaranteed => (FormFactorRule::QuasiConcave, Certainty::Guaranteed),
            _ => (FormFactorRule::CentreAndVertices, Certainty::Estimate),
        };
        let Linked { job, hierarchy, links, radiosity, exposure, .. } = &*linked;
        let initial = self.initial.of_leaves(hierarchy, exposure, job.scene.channels());
        let stop = linked.ends_links();
        let input = BoundsInput {
            scene: job.scene,
            hierarchy,
            links,
            radiosity: radiosity.values(),
            rule,
            work: Some(0),
            error: job.options.error,
            stop: &stop,
        };
        let gaps = link_gaps(&input, &mut self.known, &initial, &job.stop())?;
        let splits = linked.report.link_error.map_or(0, |report| report.splits + 1);
        linked.report.link_error = Some(LinkErrorReport {
            certainty,
            gap: gaps.gap,
            estimated_error: 0.25 * gaps.gap,
            reflected: reflected_of(linked, &initial),
            unlinked_share: gaps.unlinked / gaps.gap.max(f64::MIN_POSITIVE),
            splits,
        });
        linked.report.time_s.bounds += start.elapsed().as_secs_f64();
        Some(gaps)
    }
}

/// `<R, B - E>`.
fn reflected_of(linked: &Linked<'_>, initial: &[f64]) -> f64 {
    let Linked { job: Job { scene, .. }, hierarchy, radiosity, .. } = linked;
    let channels = scene.channels();
    let of_leaf = |leaf: NodeId| {
        let exitance = &scene.material_of(SurfaceId(hierarchy.node(leaf).surface)).exitance;
        let reflected = radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e);
        initial[leaf.index() * channels..].iter().zip(reflected).map(|(r, b)| r * b).sum::<f64>()
    };
    hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).map(of_leaf).sum()
}

/// The links with which the oracle is not content; a link counts by the mean over its channels.
fn splits(linked: &Linked<'_>, gaps: &LinkGaps, oracle: &ErrorDriven) -> HashMap<Pair, Decision> {
    let decide = |gap: &LinkGap| {
        let error = LinkError {
            share: gap.share / linked.job.scene.channels() as f64,
            by_form_factor: gap.by_form_factor,
            by_source: gap.by_source,
            receiver_area: linked.hierarchy.area(gap.receiver),
            source_area: linked.hierarchy.area(gap.source),
        };
        let decision = oracle.decide(&error);
        (decision != Decision::Link).then_some((Pair { receiver: gap.receiver, source: gap.source }, decision))
    };
    gaps.links.iter().filter_map(decide).collect()
}
