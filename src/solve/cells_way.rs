//! The solver over cells: cell radiosities by random paths, and a final gather at points. From links it takes one coarse pass, which tells
//! where it is bright: where rays are aimed and the error is looked for, and what the elements have.

use std::sync::Arc;
use std::time::Instant;

use super::finish::{Outcome, finish};
use super::history::JudgedPart;
use super::judge::{Judge, Judged, add_time, cell_seed, note_error};
use super::linked::Linked;
use super::next_step::{Instead, next_step};
use super::options::Strategy;
use super::plan::Plan;
use super::report::{SolveReport, StoppedBy};
use super::solution::Solution;
use super::step::NextStep;
use super::strategies::{self, ErrorSearch};
use super::transport::Transport;
use super::way::Way;
use crate::cells::{CellRadiosities, SolvedCells};
use crate::error::{ErrorEstimate, REPLICATES, ReplicateGather, ResidualGather};
use crate::links::RefineEnd;
use crate::paths::LightPaths;
use crate::progress::Stage;
use crate::values::{FinalGather, Gather, Over, RayBudget};

/// The state of a solve over cells.
pub(super) struct CellsWay<'a> {
    linked: Linked<'a>,
    plan: Plan,
    /// Of the values.
    cells: Option<Arc<SolvedCells<'a, 1>>>,
    /// The values that were judged last, and their cells, while others are made or judged more closely.
    judged: Option<(Judged, Option<Arc<SolvedCells<'a, 1>>>)>,
    judge: Judge<'a>,
    search: ErrorSearch,
}

impl<'a> CellsWay<'a> {
    pub fn new(mut linked: Linked<'a>, plan: Plan, search: ErrorSearch) -> Self {
        linked.reserve_cells(&plan);
        let judge = Judge::new(linked.job.options.norm.into());
        Self { linked, plan, cells: None, judged: None, judge, search }
    }

    /// In place of values over links that were judged.
    pub fn instead_of(self, judged: Option<Judged>) -> Self {
        Self { judged: judged.map(|judged| (judged, None)), ..self }
    }
}

impl<'a> Way<'a> for CellsWay<'a> {
    fn advance(&mut self) -> RefineEnd {
        if self.linked.job.options.strategy != Strategy::Default {
            return strategies::advance(&mut self.linked, &self.plan, &mut self.search);
        }
        if self.linked.links.is_empty() { self.linked.refine_coarsely(&self.plan) } else { RefineEnd::Content }
    }

    fn find_cells(&mut self) {
        let Self { linked, plan, cells, judge, .. } = self;
        let job = linked.job;
        if job.is_late() {
            return;
        }
        let start = Instant::now();
        let resolution = plan.resolution();
        let own = cells.clone().filter(|own| own.resolution == resolution).or_else(|| {
            let paths = Arc::new(LightPaths::new(job.scene, job.rays, &linked.brightness(), resolution.size, &job.stop()));
            let stop = linked.stop_telling(Stage::Cells, CellRadiosities::questions(paths.grids.cells()));
            SolvedCells::solve(paths, resolution, [cell_seed(job.options.seed, 0)], &stop).map(Arc::new)
        });
        // Replicates have cells of the same size; those of values are not taken without them, unless there are no others.
        if let Some(own) = own {
            let stop = linked.stop_telling(Stage::Cells, REPLICATES * CellRadiosities::questions(own.paths.grids.cells()));
            let are_judged = judge.find_cells(plan.replicate_resolution(), job.options.seed, || own.paths.clone(), &stop);
            if are_judged || cells.is_none() {
                *cells = Some(own);
            }
        }
        add_time(&mut linked.report.time_s.resolve, start);
    }

    fn estimate_error(&mut self) -> Option<ErrorEstimate> {
        let Self { linked, plan, cells, judge, judged, .. } = self;
        let start = Instant::now();
        linked.progress(Stage::Error);
        let own = cells.as_ref()?;
        judge.estimate_error(
            linked,
            plan,
            |cells, number, vertex_rays| {
                let (paths, onward) = (&*cells.paths, &cells.radiosities[number]);
                ReplicateGather::Residual(ResidualGather { paths, of_values: &own.radiosities[0], onward, vertex_rays })
            },
            |rays, vertex_rays| user_gather(linked, own, [rays, vertex_rays]),
        );
        note_error(linked, JudgedPart::OverCells, judge.error.as_ref(), plan.point_rays());
        if judge.error.is_some() {
            *judged = None;
        }
        add_time(&mut linked.report.time_s.error, start);
        judge.error
    }

    fn plan_next(&mut self, error: &ErrorEstimate) -> NextStep {
        let Self { linked, plan, cells, judge, judged, .. } = self;
        let (Some(own), stop) = (cells, linked.job.stop()) else { return NextStep::Exhausted };
        let noise = plan.begin_step(error, |rays: [u32; 2]| judge.sampled_value_noise(&user_gather(linked, own, rays), &stop));
        let step = next_step(plan, error, noise, &Instead { refine: f64::INFINITY, take_cells: f64::INFINITY });
        let rays = plan.rays();
        *judged = match step {
            NextStep::GoodEnough | NextStep::Exhausted => None,
            _ => judge.judged(rays[0], &user_gather(linked, own, rays), &stop).map(|judged| (judged, Some(own.clone()))),
        };
        plan.apply(step);
        if step.changes_values() {
            judge.forget_values();
        }
        step
    }

    fn has_room(&mut self) -> bool {
        self.linked.has_room_for_cells(&self.plan)
    }

    fn into_cells(self: Box<Self>) -> Box<dyn Way<'a> + 'a> {
        self
    }

    fn finish(self: Box<Self>, stopped_by: StoppedBy) -> (Solution, SolveReport) {
        let Self { mut linked, plan, cells, mut judge, judged, .. } = *self;
        let is_last = judged.is_none();
        let (error, point_rays, known, cells) = match judged {
            Some((Judged { error, point_rays, known }, cells)) => (Some(error), point_rays, known, cells),
            None => {
                let (rays, stop) = (plan.rays(), linked.job.stop());
                let known = cells.as_ref().and_then(|own| judge.known_errors(&user_gather(&linked, own, rays), &stop));
                (judge.error, plan.point_rays(), known, cells)
            }
        };
        let is_final = is_last && cells.is_some() && judge.error.is_some();
        let (transport, stopped_by) = kept_transport(&mut linked, &plan, is_final.then_some(&judge), point_rays, stopped_by);
        drop(judge);
        let resolution = cells.as_ref().map_or(plan.resolution(), |own| own.resolution);
        let radiosities = cells.map(|own| match Arc::try_unwrap(own) {
            Ok(SolvedCells { radiosities: [radiosities], .. }) => radiosities,
            Err(shared) => shared.radiosities[0].clone(),
        });
        let [_, vertex_rays] = plan.rays();
        finish(linked, Outcome { known, error, stopped_by, point_rays, vertex_rays, resolution, radiosities, transport })
    }
}

/// The transport of the values that were judged last, if it is to be kept, and what ended the solve: a limit may leave no room for it.
fn kept_transport(
    linked: &mut Linked<'_>,
    plan: &Plan,
    judge: Option<&Judge<'_>>,
    point_rays: u32,
    stopped_by: StoppedBy,
) -> (Option<Transport>, StoppedBy) {
    let Some(judge) = judge.filter(|_| linked.job.options.keep_transport) else { return (None, stopped_by) };
    if !Transport::has_room(linked, plan, judge) {
        return (None, StoppedBy::Memory);
    }
    let start = Instant::now();
    let transport = Transport::record(linked, plan, judge, point_rays);
    add_time(&mut linked.report.time_s.transport, start);
    let ended = match transport {
        Some(_) => stopped_by,
        None if linked.job.is_cancelled() => StoppedBy::Cancelled,
        None => StoppedBy::Time,
    };
    (transport, ended)
}

/// Gathers the values that a user would get now, by so many rays from a point, and from where paths go on.
fn user_gather<'b>(linked: &'b Linked<'_>, cells: &'b SolvedCells<'_, 1>, [rays, vertex_rays]: [u32; 2]) -> Gather<'b> {
    let over = Over::Cells(FinalGather { paths: &cells.paths, radiosities: &cells.radiosities[0], bounces: 0, vertex_rays });
    let budget = RayBudget::of_values(rays, linked.job.options.seed);
    Gather { scene: linked.job.scene, hierarchy: &linked.hierarchy, over, budget }
}
