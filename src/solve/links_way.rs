//! The solver over links: hierarchical radiosity. Values gather over the links above a point; from cells it takes what its error is judged by.

use std::sync::Arc;
use std::time::Instant;

use super::cells_way::CellsWay;
use super::finish::{Outcome, finish};
use super::history::JudgedPart;
use super::judge::{Judge, Judged, add_time, note_error};
use super::linked::Linked;
use super::next_step::{Instead, next_step, refinement};
use super::plan::Plan;
use super::report::{SolveReport, StoppedBy};
use super::solution::Solution;
use super::step::NextStep;
use super::strategies::{self, ErrorSearch};
use super::way::Way;
use crate::cells::CellRadiosities;
use crate::error::{ErrorEstimate, REPLICATES, ReplicateGather};
use crate::links::RefineEnd;
use crate::paths::{LightPaths, cell_count};
use crate::progress::Stage;
use crate::values::{FinalGather, Gather, RayBudget};

/// The state of a solve over links.
pub(super) struct LinksWay<'a> {
    linked: Linked<'a>,
    plan: Plan,
    judge: Judge<'a>,
    search: ErrorSearch,
    /// The values over these links that were judged last, while they take other rays or are judged more closely.
    judged: Option<Judged>,
    /// What cells would take, where they may be taken instead.
    over_cells: Option<Plan>,
}

impl<'a> LinksWay<'a> {
    pub fn new(mut linked: Linked<'a>, plan: Plan, search: ErrorSearch) -> Self {
        linked.reserve_cells(&plan);
        Self { plan, judge: Judge::new(linked.job.options.norm.into()), linked, search, judged: None, over_cells: None }
    }

    /// Cells are taken where they are predicted to take less.
    pub fn or_over(self, cells: Plan) -> Self {
        Self { over_cells: Some(cells), ..self }
    }

    /// What may be done beside finding and knowing values better over the same links.
    fn instead(&self, error: &ErrorEstimate) -> Instead {
        let Self { linked, plan, over_cells, .. } = self;
        let refined = || plan.work_of_refining(linked.links.len(), linked.cast_by_leaves, refinement(plan, error));
        Instead {
            refine: if plan.may_refine() { refined() } else { f64::INFINITY },
            take_cells: over_cells.as_ref().map_or(f64::INFINITY, |cells| cells.work() - plan.work_of_values()),
        }
    }
}

impl<'a> Way<'a> for LinksWay<'a> {
    fn advance(&mut self) -> RefineEnd {
        self.judged = None;
        strategies::advance(&mut self.linked, &self.plan, &mut self.search)
    }

    fn find_cells(&mut self) {
        let Self { linked, plan, judge, .. } = self;
        let job = linked.job;
        if job.is_late() {
            return;
        }
        let start = Instant::now();
        let resolution = plan.replicate_resolution();
        let brightness = linked.brightness();
        let cells = cell_count(job.scene, &brightness, resolution.size).unwrap_or(0);
        let stop = linked.stop_telling(Stage::Cells, REPLICATES * CellRadiosities::questions(cells));
        let paths = || Arc::new(LightPaths::new(job.scene, job.rays, &brightness, resolution.size, &job.stop()));
        judge.find_cells(resolution, job.options.seed, paths, &stop);
        add_time(&mut linked.report.time_s.resolve, start);
    }

    fn estimate_error(&mut self) -> Option<ErrorEstimate> {
        let Self { linked, plan, judge, judged, .. } = self;
        let start = Instant::now();
        linked.progress(Stage::Error);
        let bounces = plan.replicate_bounces();
        judge.estimate_error(
            linked,
            plan,
            |cells, number, vertex_rays| {
                let (paths, radiosities) = (&*cells.paths, &cells.radiosities[number]);
                ReplicateGather::Truth(FinalGather { paths, radiosities, bounces, vertex_rays })
            },
            |rays, _| user_gather(linked, rays),
        );
        note_error(linked, JudgedPart::OverLinks, judge.error.as_ref(), plan.point_rays());
        if judge.error.is_some() {
            *judged = None;
        }
        add_time(&mut linked.report.time_s.error, start);
        judge.error
    }

    fn plan_next(&mut self, error: &ErrorEstimate) -> NextStep {
        let Self { linked, plan, judge, .. } = self;
        let start = Instant::now();
        let stop = linked.job.stop();
        let noise = plan.begin_step(error, |[rays, _]| judge.sampled_value_noise(&user_gather(linked, rays), &stop));
        let step = next_step(&self.plan, error, noise, &self.instead(error));
        let Self { linked, plan, judge, judged, .. } = self;
        *judged = match step {
            NextStep::GoodEnough | NextStep::Exhausted => None,
            // What error bars hang on takes rays: these are spent where the time may end.
            _ if linked.job.run.time_s.is_none() => None,
            _ => judge.judged(plan.point_rays(), &user_gather(linked, plan.point_rays()), &stop),
        };
        plan.apply(step);
        if step.changes_values() {
            judge.forget_values();
        }
        add_time(&mut linked.report.time_s.error, start);
        step
    }

    fn has_room(&mut self) -> bool {
        self.linked.has_room_for_cells(&self.plan)
    }

    fn into_cells(self: Box<Self>) -> Box<dyn Way<'a> + 'a> {
        let Self { linked, plan, search, judged, over_cells, .. } = *self;
        Box::new(CellsWay::new(linked, over_cells.unwrap_or(plan), search).instead_of(judged))
    }

    fn finish(self: Box<Self>, stopped_by: StoppedBy) -> (Solution, SolveReport) {
        let Self { linked, plan, mut judge, judged, .. } = *self;
        let (error, point_rays, known) = match judged {
            Some(Judged { error, point_rays, known }) => (Some(error), point_rays, known),
            None => {
                let (rays, stop) = (plan.point_rays(), linked.job.stop());
                let known = judge.error.and_then(|_| judge.known_errors(&user_gather(&linked, rays), &stop));
                (judge.error, rays, known)
            }
        };
        finish(
            linked,
            Outcome {
                known,
                error,
                stopped_by,
                point_rays,
                vertex_rays: plan.rays()[1],
                resolution: plan.resolution(),
                radiosities: None,
                transport: None,
            },
        )
    }
}

/// Gathers the values that a user would get now.
fn user_gather<'b>(linked: &'b Linked<'_>, rays: u32) -> Gather<'b> {
    linked.gather(RayBudget::of_values(rays, linked.job.options.seed))
}
