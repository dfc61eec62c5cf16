//! The end of a solve: what is kept, and what is told.

use std::sync::Arc;

use super::grouped_light::GroupedLight;
use super::linked::Linked;
use super::report::{Counts, Energy, ErrorFigure, ErrorReport, Powers, SkippedWork, SolveReport, StoppedBy};
use super::solution::Solution;
use super::transport::Transport;
use crate::bounds::{Light, bound_held_back};
use crate::cells::CellRadiosities;
use crate::error::{self, CONFIDENCE, ErrorEstimate, KnownErrors};
use crate::links::Pair;
use crate::paths::Resolution;
use crate::scene::SurfaceId;

/// What a solver found beside links.
pub(super) struct Outcome {
    pub error: Option<ErrorEstimate>,
    pub stopped_by: StoppedBy,
    pub point_rays: u32,
    pub vertex_rays: u32,
    pub resolution: Resolution,
    /// Where values end in cells.
    pub radiosities: Option<CellRadiosities>,
    pub known: Option<KnownErrors>,
    pub transport: Option<Transport>,
}

/// The solution and its report.
pub(super) fn finish(linked: Linked<'_>, outcome: Outcome) -> (Solution, SolveReport) {
    let energy = energy(&linked);
    let skipped = linked.skipped();
    let scene = linked.job.scene.clone();
    let Outcome { error, stopped_by, point_rays, vertex_rays, resolution, radiosities, known, transport } = outcome;
    let spots = linked.brightness().spots;
    let mut report = SolveReport { energy, stopped_by, converged: stopped_by == StoppedBy::Error, ..linked.report };

    let reflected = energy.sent - (energy.emitted - energy.of_lights);
    report.error = ErrorReport {
        requested: linked.job.options.error,
        skipped: if reflected > 0.0 { energy.held_back / reflected } else { 0.0 },
        ..error_report(error.as_ref())
    };
    report.counts = Counts {
        surfaces: scene.surfaces().len() as u64,
        clusters: linked.hierarchy.cluster_count() as u64,
        elements: (linked.hierarchy.len() - linked.hierarchy.cluster_count()) as u64,
        links: linked.links.len() as u64,
        dormant: linked.links.dormant().len() as u64,
        ..report.counts
    };
    report.count_rays(linked.job.rays);
    report.skipped.extend(skipped);
    let segments = linked.job.rays.segments();
    let per_ray = segments.seconds() / segments.count().max(1) as f64;
    let price = |work: &mut SkippedWork| work.estimate_saved_s = per_ray * work.estimate_saved_rays as f64;
    report.skipped.iter_mut().for_each(price);

    let error_bars = known.as_ref().map(|known| known.error_bars);
    let surfaces = (0..scene.surfaces().len() as u32).map(SurfaceId);
    let reflected = || surfaces.map(|surface| linked.radiosity.reflected(&scene, &linked.hierarchy, surface)).collect();
    let groups = known.and_then(|known| known.groups).map(|errors| GroupedLight::judged(errors, reflected()));
    let solution = Solution {
        scene,
        options: linked.job.options.clone(),
        hierarchy: linked.hierarchy.without_cuts(),
        links: linked.links,
        exposure: linked.exposure,
        lights: linked.lights,
        radiosity: linked.radiosity,
        point_rays,
        vertex_rays,
        resolution,
        spots,
        cell_radiosities: radiosities,
        error_bars,
        bounds: None,
        mesh: None,
        groups,
        transport: transport.map(Arc::new),
    };
    report.transport = solution.transport();
    report.memory_bytes = solution.memory_bytes();
    (solution, report)
}

/// What is told of an error as far as an estimate tells; `None` where there was none.
pub(super) fn error_report(error: Option<&ErrorEstimate>) -> ErrorReport {
    let figure = |of: error::ErrorFigure| ErrorFigure { estimate: of.claimed, measured: of.measured };
    ErrorReport {
        requested: 0.0,
        estimate: error.map_or(f64::INFINITY, ErrorEstimate::claimed_of_all),
        confidence: CONFIDENCE,
        measured: error.filter(|error| !error.is_elsewhere).map_or(f64::INFINITY, |error| error.measured),
        energy: error.map_or_else(ErrorFigure::default, |error| figure(error.energy)),
        local: error.map_or_else(ErrorFigure::default, |error| figure(error.local)),
        lit: error.map_or(0.0, |error| error.lit),
        where_found: error.filter(|error| error.is_elsewhere).map(|error| figure(error.told())),
        skipped: 0.0,
    }
}

/// Where the power goes, and what pairs without a link hold back of it.
fn energy(linked: &Linked<'_>) -> Energy {
    let Linked { job, hierarchy, links, exposure, lights, closure, radiosity, report, .. } = linked;
    let scene = job.scene;
    let powers = Powers { scene, hierarchy, links, exposure, closure: closure.as_ref(), lights, radiosity };
    let light = Light { scene, hierarchy, radiosity: radiosity.values() };
    let held_back = |pairs: &[Pair]| bound_held_back(light, pairs, &job.stop());
    Energy {
        residual: report.energy.residual,
        held_back: report.energy_balance.map_or_else(|| held_back(links.dormant()), |balance| balance.held_back),
        held_back_unseen: held_back(links.unseen()),
        ..powers.energy()
    }
}
