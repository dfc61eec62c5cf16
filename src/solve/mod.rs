//! The main algorithm: find radiosities, estimate how wrong the values are, decide what to do about it, until it is enough.
//!
//! Two solvers take part in it, behind one trait (`way`): over links (`links_way`) and over cells (`cells_way`); `choice` tells which. How fine
//! they work follows from the requested error by one law (`effort`, `plan`); what to do when it is not reached is decided in `next_step`.

mod beginning;
mod cells_way;
mod channels;
mod choice;
mod cuts;
mod effort;
mod finish;
mod first_error;
mod flux;
mod grouped_light;
mod groups_apart;
mod history;
mod interest;
mod job;
mod judge;
mod linked;
mod links_way;
mod lit_mesh;
mod memory;
mod mesh_lines;
mod multiresolution96;
mod next_step;
mod options;
mod other_materials;
mod plan;
mod relight;
mod report;
mod scale;
mod shares;
mod skipped;
mod solution;
mod stage_times;
mod step;
mod strategies;
mod transport;
mod way;
mod work;
mod worthwhile_cells;

pub use crate::links::Skips;
pub(crate) use beginning::Beginning;
pub use flux::Flux;
pub use history::{JudgedPart, Judgement};
pub(crate) use interest::InitialImportance;
pub use interest::InterestError;
pub(crate) use memory::least_bytes;
pub use options::{
    Bounds, CellOptions, ChangShih98Options, Holzschuch94Options, Interest, LinkOptions, Multiresolution96Options, Norm,
    OptionEntry, OptionGroup, OptionType, OptionsError, RunOptions, SolveOptions, Solver, Strategy, Subdivision, Sweep,
    UniformOptions,
};
pub use other_materials::OtherMaterialsError;
pub use report::{
    Counts, Energy, EnergyBalance, ErrorFigure, ErrorReport, IterationReport, LightGroupReport, LightGroupsReport, LinkErrorReport,
    LitMeshReport, SkippedWork, SolveReport, StoppedBy, TransportReport,
};
pub use solution::Solution;
pub(crate) use solution::StoredSolution;
pub use stage_times::StageTimes;

use std::time::Instant;

use channels::SolvedChannels;
use choice::choose;
use job::{Job, TimeOfValues};
use shares::Shares;
use step::NextStep;

use crate::progress::Observer;
use crate::scene::Scene;
use crate::transmittance::Rays;

/// Solves `scene` in the current rayon pool.
pub(crate) fn solve(
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    beginning: Beginning,
    rays: &Rays<'_>,
    observer: &dyn Observer,
) -> (Solution, SolveReport) {
    let channels = SolvedChannels::of(scene, options);
    let of_values = TimeOfValues::default();
    let job = |scene| Job::new(scene, channels.kept(), options, (run, &of_values), rays, observer);
    let found = solve_to_the_end(&job(&channels.scene()), beginning);
    channels.expand(found)
}

/// Solves the scene of a job as it is: values at points, and the lit mesh if it is wanted.
fn solve_to_the_end(job: &Job<'_>, beginning: Beginning) -> (Solution, SolveReport) {
    if !job.options.lit_mesh {
        return solve_all_channels(job, beginning);
    }
    let error = Shares::of(job.scene, job.options.error).error_of_values();
    let options = SolveOptions { error, ..job.options.clone() };
    let (mut solution, mut report) = solve_all_channels(&job.of_values(&options), beginning);
    lit_mesh::add(job, &mut solution, &mut report);
    (solution, report)
}

/// Solves the scene of a job as it is, step by step: radiosities as finely as planned, the error that is left, and what to do about it.
fn solve_all_channels(job: &Job<'_>, beginning: Beginning) -> (Solution, SolveReport) {
    let mut way = choose(job, beginning);
    let stopped_by = 'solve: loop {
        let round = Instant::now();
        let ended = way.advance();
        loop {
            let cells = Instant::now();
            if !way.has_room() {
                break 'solve StoppedBy::Memory;
            }
            way.find_cells();
            let error = way.estimate_error();
            if let Some(limit) = job.limit(error, ended) {
                break 'solve limit;
            }

            // What comes next takes longer than what it takes the place of: it is not begun if that would not end in time.
            match error.map_or(NextStep::Exhausted, |error| way.plan_next(&error)) {
                NextStep::GoodEnough => break 'solve StoppedBy::Error,
                NextStep::Exhausted => break 'solve StoppedBy::Exhausted,
                NextStep::FindCells(_) | NextStep::PassUnresolved if job.has_no_time_for(cells.elapsed()) => {
                    break 'solve StoppedBy::Time;
                }
                NextStep::Refine(_) if job.has_no_time_for(round.elapsed()) => break 'solve StoppedBy::Time,
                NextStep::MoreRays(factor) if job.has_no_time_for(job.time_of_values().mul_f64(factor - 1.0)) => {
                    break 'solve StoppedBy::Time;
                }
                NextStep::MoreReplicateRays
                | NextStep::MorePoints
                | NextStep::MoreRays(_)
                | NextStep::FindCells(_)
                | NextStep::PassUnresolved => {}
                NextStep::Refine(_) => break,
                NextStep::TakeCells => {
                    way = way.into_cells();
                    break;
                }
            }
        }
    };
    way.finish(stopped_by)
}
