//! The error estimate of a solve, from step to step.

use std::sync::Arc;
use std::time::Instant;

use super::history::{JudgedPart, Judgement};
use super::linked::Linked;
use super::plan::Plan;
use crate::cells::SolvedCells;
use crate::error::{
    ErrorEstimate, ErrorNorm, ErrorSamples, KnownErrors, Pilot, REPLICATES, ReplicateGather, Replication, SampleRecorder,
    StoredSamples,
};
use crate::geometry::{sampling, streams};
use crate::paths::{LightPaths, ProductNumbers, Resolution};
use crate::progress::{Stage, Stop};
use crate::transmittance::Rays;
use crate::values::{Gather, Over};

/// Values that were judged, to go back to where the time ends before better ones are judged as well.
#[derive(Clone)]
pub(super) struct Judged {
    pub error: ErrorEstimate,
    pub point_rays: u32,
    pub known: Option<KnownErrors>,
}

/// Where emitters are looked for exactly from where paths go on, that may cost as much as so many rays to them. Deep between plates, exact parts take as long as
/// some twenty rays.
const VERTEX_RAYS: u32 = 32;

/// That is done if it makes values so many times cheaper: what they take is foreseen to some 50%.
const GAIN: f64 = 1.5;

/// What a first hit of a path costs in rays to emitters, with all that is done about it, by the profiler.
const WORK_OF_FIRST_HIT: f64 = 6.0;

/// Samples of the error, the cells in which the paths of their replicates end, and what was estimated last.
pub(super) struct Judge<'a> {
    cells: Option<SolvedCells<'a, REPLICATES>>,
    samples: ErrorSamples,
    /// Of the values as they stand; `None` before the first estimate, and where the last one was cut short.
    pub error: Option<ErrorEstimate>,
}

impl<'a> Judge<'a> {
    pub fn new(norm: ErrorNorm) -> Self {
        Self { cells: None, samples: ErrorSamples::new(norm), error: None }
    }

    /// Values have changed.
    pub fn forget_values(&mut self) {
        self.samples.forget_values();
    }

    /// Finds the cell radiosities of the replicates, if they are not known so finely; `paths` end in cells of that size. `false` if stopped
    /// before: then those that were known stay.
    pub fn find_cells(
        &mut self,
        resolution: Resolution,
        seed: u64,
        paths: impl FnOnce() -> Arc<LightPaths<'a>>,
        stop: Stop<'_>,
    ) -> bool {
        if self.cells.as_ref().is_none_or(|own| own.resolution != resolution) {
            let seeds = std::array::from_fn(|number| cell_seed(seed, 1 + number as u64));
            let Some(cells) = SolvedCells::solve(paths(), resolution, seeds, stop) else { return false };
            self.cells = Some(cells);
            self.samples.clear();
        }
        true
    }

    /// Estimates the error of the values that `gather` gives for so many rays. What replicates find, `replicate` tells by number, their paths
    /// and cells. Before the first replicates are taken a pilot may fit their rays, and those of values.
    pub fn estimate_error<'b>(
        &'b mut self,
        linked: &'b Linked<'a>,
        plan: &mut Plan,
        replicate: impl Fn(&'b SolvedCells<'a, REPLICATES>, usize, u32) -> ReplicateGather<'b>,
        gather: impl Fn(u32, u32) -> Gather<'b>,
    ) {
        let Self { cells, samples, error } = self;
        *error = None;
        let job = linked.job;
        let Some(cells) = cells.as_ref().filter(|_| !job.is_late()) else { return };
        let stop = linked.stop_telling(Stage::Error, 3 * plan.error_points());
        let replication = |plan: &Plan| Replication {
            scene: job.scene,
            hierarchy: &linked.hierarchy,
            radiosity: &linked.radiosity,
            gathers: std::array::from_fn(|number| replicate(cells, number, plan.rays()[1])),
            seed: sampling::hash(job.options.seed, streams::ERROR),
            most_paths: plan.most_paths_for_error(),
        };
        let mut with = replication(plan);
        let mut is_spread = samples.add_points(plan.error_points(), plan.replicate_pilot_rays(), &with, &stop);
        if is_spread && (plan.wants_pilot() || (plan.is_first() && job.leaves_time_to_values())) {
            let (start, tried) = (Instant::now(), plan.pilot_rays());
            let mut pilot: Option<Pilot> = samples.pilot(&gather(tried, 1), &stop);
            if let Some(plain) = pilot.as_ref().filter(|_| plan.wants_pilot()) {
                let exact = gather(tried, VERTEX_RAYS);
                if seeing_exactly_pays(samples, plan, plain, &exact, job.rays, &stop) {
                    // Replicates are noisy elsewhere then.
                    plan.see_exactly(VERTEX_RAYS);
                    with = replication(plan);
                    samples.clear();
                    is_spread = samples.add_points(plan.error_points(), plan.replicate_pilot_rays(), &with, &stop);
                    pilot = samples.pilot(&gather(plan.pilot_rays(), VERTEX_RAYS), &stop);
                }
                pilot.iter().for_each(|pilot| plan.fit_rays(pilot));
            }
            let most = job.most_rays_in_time(start.elapsed().as_secs_f64() / (f64::from(tried) * plan.error_points() as f64));
            most.into_iter().for_each(|most| plan.limit_point_rays(most));
        }
        if is_spread && samples.take_replicates(plan.replicate_rays(), &with, &stop) {
            let [rays, vertex_rays] = plan.rays();
            *error = samples.estimate(&gather(rays, vertex_rays), &with, &stop);
            job.leave_time_for_values(samples.seconds_of_value);
        }

        // Light that no point has found is somewhere all the same.
        let is_reflected = linked.landings.iter().any(|landing| landing.power > 0.0);
        if is_reflected && let Some(found) = error.as_mut().filter(|found| found.lit == 0.0) {
            *found = ErrorEstimate::UNKNOWN;
        }
    }

    /// How many rays all replicates have taken.
    pub fn replicate_rays(&self) -> u64 {
        self.samples.rays()
    }

    /// Records what the rays of values and replicates bring at all points; `None` if stopped before.
    pub fn record(&self, recorder: &SampleRecorder<'_>, numbers: &mut ProductNumbers, stop: Stop<'_>) -> Option<StoredSamples> {
        recorder.record(&self.samples, numbers, stop)
    }

    /// What is known of the values that `gather` gives beside their error; `None` where that was not estimated, or if stopped.
    pub fn known_errors(&mut self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<KnownErrors> {
        self.error?;
        self.samples.known_errors(gather, stop)
    }

    /// The values that `gather` gives as they were judged last, if they were.
    pub fn judged(&mut self, point_rays: u32, gather: &Gather<'_>, stop: Stop<'_>) -> Option<Judged> {
        let error = self.error?;
        Some(Judged { error, point_rays, known: self.samples.known_errors(gather, stop) })
    }

    /// The part of the error estimated last that is noise of the values that `gather` gives.
    pub fn sampled_value_noise(&self, gather: &Gather<'_>, stop: Stop<'_>) -> f64 {
        self.samples.sampled_value_noise(gather, stop)
    }
}

/// Whether values take less if paths look for emitters exactly: by what next-event rays would add to their noise, and the work of both ways.
fn seeing_exactly_pays(
    samples: &ErrorSamples,
    plan: &Plan,
    pilot: &Pilot,
    exact: &Gather<'_>,
    rays: &Rays<'_>,
    stop: Stop<'_>,
) -> bool {
    let Over::Cells(gather) = &exact.over else { return false };
    if !plan.may_see_exactly(pilot) || !gather.paths.may_see_exactly(VERTEX_RAYS) {
        return false;
    }
    let counts = || {
        let [segments, first_hits] = rays.cast_by_all();
        [segments as f64, first_hits as f64, rays.exact_parts_by_all()]
    };
    let before = counts();
    let Some(noise_sq) = samples.next_event_noise(pilot, gather, exact.budget.rays, stop) else { return false };
    let after = counts();
    let Some(pilot_exact) = samples.pilot(exact, stop) else { return false };

    // From each place but the last of a path a ray goes on, and one to an emitter.
    let [segments, first_hits, exact_parts] = std::array::from_fn(|number| after[number] - before[number]);
    let work_exact = WORK_OF_FIRST_HIT * first_hits + segments + exact_parts;
    let work = (WORK_OF_FIRST_HIT + 1.0) * first_hits;
    let (paths, paths_exact) = (plan.rays_for(pilot, noise_sq), plan.rays_for(&pilot_exact, 0.0));
    paths * work > GAIN * paths_exact * work_exact
}

/// Notes an error of values that take so many rays each, where it was estimated.
pub(super) fn note_error(linked: &mut Linked<'_>, of: JudgedPart, error: Option<&ErrorEstimate>, point_rays: u32) {
    let Some(error) = error else { return };
    linked.claimed = Some(error.claimed_of_all());
    let rays = linked.job.rays;
    linked.report.history.push(Judgement {
        time_s: linked.job.seconds(),
        of,
        claimed: error.claimed_of_all(),
        measured: if error.is_elsewhere { f64::INFINITY } else { error.measured },
        rays_per_point: Some(point_rays),
        rays: rays.cast_by_all().iter().sum(),
    });
}

/// The seed of cell radiosities: number 0 of values, the next ones of replicates.
pub(super) fn cell_seed(seed: u64, number: u64) -> u64 {
    sampling::hash(seed, streams::CELL_RADIOSITIES + number)
}

/// The seed of the particles that tell where light goes.
pub(super) fn particle_seed(seed: u64) -> u64 {
    sampling::hash(seed, streams::PARTICLES)
}

/// Adds the seconds since `start` to a time of the report.
pub(super) fn add_time(total: &mut f64, start: Instant) {
    *total += start.elapsed().as_secs_f64();
}
