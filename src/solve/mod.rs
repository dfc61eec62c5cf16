//! The main algorithm on one screen: refine, gather, push-pull, good enough?

mod bounces;
mod error_driven;
mod error_estimate;
mod interest;
mod linked_once;
mod options;
mod plan;
mod report;
mod solution;

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::{Duration, Instant};

use rayon::prelude::*;

pub use crate::links::Skips;
pub use error_driven::LinkErrorReport;
pub(crate) use interest::InitialImportance;
pub use interest::{Interest, InterestError};
pub use options::{Bounds, Gather, OptionsError, RunOptions, SolveOptions, Strategy, Sweep};
pub use report::{Counts, Energy, EnergyBalance, ErrorReport, IterationReport, SkippedWork, SolveReport, StageTimes, StoppedBy};
pub use solution::Solution;

use error_driven::ErrorSearch;
use error_estimate::{ErrorEstimate, ErrorSamples, LookGather, Looking};
use plan::{Plan, Verdict};
use report::Powers;

use crate::bounds::{Light, bound_held_back};
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::oracle::{Decision, RefinementOracle};
use crate::links::{LinkSet, Pair, RefineContext, RefineEnd, RefineLimits, Refinement};
use crate::progress::{Observer, Progress, Stage};
use crate::reconstruct::{
    Effort, ExcessGather, HemisphereGather, Lattice, LightPaths, LinkGather, Reconstruction, Reflector, Resolution, Resolved,
    Scratch, Way, reflectors,
};
use crate::scene::{DistinctChannels, Scene, SurfaceId};
use crate::sweep::{self, ByPlane, Closure, Exposure, Radiosity, Reflections, sampled_exposed_point, sweep_in_place};
use crate::transmittance::Rays;

/// No solve sweeps more often in a row: at reflectance 0.999 the change has fallen by e^-20 by then.
const MAX_SWEEPS: u32 = 20_000;

/// Solves `scene` in the current rayon pool; `importance` is looked at by error-driven refinement alone.
///
/// Channels that repeat others, or in which no light is on, are read off the others.
pub(crate) fn solve(
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    importance: InitialImportance,
    rays: &Rays<'_>,
    observer: &dyn Observer,
) -> (Solution, SolveReport) {
    let merges = options.skips.channels && options.strategy == Strategy::Default;
    let Some(channels) = DistinctChannels::of(&scene).filter(|_| merges) else {
        return solve_all_channels(&scene, scene.channels(), options, run, importance, rays, observer);
    };
    let (solution, mut report) = solve_all_channels(&channels.scene, scene.channels(), options, run, importance, rays, observer);
    let (radiosity, resolved) =
        (solution.radiosity.spread(&channels), solution.resolved.map(|resolved| resolved.spread(&channels)));
    let solution = Solution { scene, radiosity, resolved, ..solution };
    report.energy = report.energy.times(channels.copies as f64);
    report.memory_bytes = solution.memory_bytes();
    report.skipped.push(SkippedWork {
        what: "channels that repeat others, or in which no light is on".to_owned(),
        count: channels.spared() as u64,
        ..SkippedWork::default()
    });
    (solution, report)
}

/// Solves the scene as it is; the solution will have `kept_channels` channels.
fn solve_all_channels(
    scene: &Scene,
    kept_channels: usize,
    options: &SolveOptions,
    run: &RunOptions,
    importance: InitialImportance,
    rays: &Rays<'_>,
    observer: &dyn Observer,
) -> (Solution, SolveReport) {
    let start = Instant::now();
    let mut solver = Solver::new(scene, kept_channels, options, importance, rays, observer);
    let deadline = run.time_s.and_then(|seconds| start.checked_add(Duration::from_secs_f64(seconds)));
    let mut plan = Plan::new(scene, options);

    // Rounds: refine step by step, each step with the brightness that the one before has found; then look how good it is.
    let stopped_by = 'rounds: loop {
        let ended = if options.strategy.links_once() {
            solver.link_once(&plan, run, deadline)
        } else if options.strategy.links_surfaces() {
            solver.bounce(&plan, run, deadline)
        } else {
            let ended = match options.strategy {
                Strategy::ErrorDriven => solver.refine_by_error(&plan, run, deadline),
                _ => solver.refine_in_steps(&plan, run, deadline),
            };
            solver.regather_leaves(&plan, deadline);
            ended
        };
        loop {
            solver.resolve(&plan);
            solver.estimate_error(&mut plan);
            if let Some(limit) = solver.limit(ended, deadline) {
                break 'rounds limit;
            }
            let (error, point_rays) = (solver.error, plan.point_rays());
            let gather_noise = || solver.sampled_gather_noise(point_rays);
            let judge = |error: ErrorEstimate| plan.judge(&error, || error.gather_noise.unwrap_or_else(gather_noise));
            match error.map_or(Verdict::Exhausted, judge) {
                Verdict::GoodEnough => break 'rounds StoppedBy::Error,
                Verdict::Exhausted => break 'rounds StoppedBy::Exhausted,
                Verdict::LookCloser => {}
                Verdict::Resolve if !solver.cells_fit(&plan, run) => break 'rounds StoppedBy::Memory,
                Verdict::MoreRays | Verdict::Resolve => solver.error_samples.forget_values(),
                Verdict::Refine => {
                    solver.error_samples.forget_values();
                    break;
                }
            }
        }
    };
    solver.finish(scene.clone(), &plan, stopped_by)
}

/// Radiosities that are resolved finer than elements, `N` times from paths of their own.
struct ResolvedLight<'a, const N: usize> {
    resolution: Resolution,
    paths: Arc<LightPaths<'a>>,
    resolved: [Resolved; N],
}

/// The state of a solve between stages.
struct Solver<'a> {
    scene: &'a Scene,
    /// How many channels the solution will have.
    kept_channels: usize,
    options: &'a SolveOptions,
    rays: &'a Rays<'a>,
    observer: &'a dyn Observer,
    hierarchy: Hierarchy,
    refinement: Refinement,
    links: LinkSet,
    exposure: Exposure,
    radiosity: Radiosity,
    /// Where clusters gather and emit.
    closure: Option<Closure>,
    /// Mean reflectance of the clusters, by channel.
    cluster_reflectance: Vec<f64>,
    /// What the paths of values find where they end; `None` before it is looked for, and where values do without paths.
    for_values: Option<ResolvedLight<'a, 1>>,
    /// The same for the two looks of the error estimate.
    for_looks: Option<ResolvedLight<'a, 2>>,
    /// Of the values as they stand; `None` before the first estimate, and where the last one was cut short.
    error: Option<ErrorEstimate>,
    error_samples: ErrorSamples,
    error_search: ErrorSearch,
    report: SolveReport,
}

impl<'a> Solver<'a> {
    fn new(
        scene: &'a Scene,
        kept_channels: usize,
        options: &'a SolveOptions,
        importance: InitialImportance,
        rays: &'a Rays<'a>,
        observer: &'a dyn Observer,
    ) -> Self {
        let start = Instant::now();
        let hierarchy = Hierarchy::new(scene);
        let mut exposure = Exposure::default();
        exposure.grow(scene, &hierarchy, rays, options.seed);
        let radiosity = Radiosity::emitted(scene, &hierarchy, &exposure);
        let mut report = SolveReport { backend: rays.description(), ..SolveReport::default() };
        report.time_s.build = start.elapsed().as_secs_f64();
        let (refinement, links) = (Refinement::new(), LinkSet::default());
        let cluster_reflectance = sweep::cluster_reflectance(scene, &hierarchy);
        Self {
            scene,
            kept_channels,
            options,
            rays,
            observer,
            hierarchy,
            refinement,
            links,
            exposure,
            radiosity,
            closure: None,
            cluster_reflectance,
            for_values: None,
            for_looks: None,
            error: None,
            error_samples: ErrorSamples::default(),
            error_search: ErrorSearch::new(importance),
            report,
        }
    }

    fn progress(&self, stage: Stage) {
        let elements = (self.hierarchy.len() - self.hierarchy.cluster_count()) as u64;
        let error = self.error.map(|error| error.claimed);
        let round = self.report.counts.rounds as u32;
        self.observer.progress(&Progress { stage, round, fraction: None, links: self.refinement.links(), elements, error });
    }

    /// Refines to the tolerances of a round, one after the other.
    fn refine_in_steps(&mut self, plan: &Plan, run: &RunOptions, deadline: Option<Instant>) -> RefineEnd {
        for tolerance in plan.tolerances() {
            // Pairs that slept because their source was dark wake once light has come there.
            loop {
                let ended = self.refine_with(&*plan.oracle(tolerance), &HashMap::new(), plan, run, deadline);
                self.sweep(deadline);
                if ended != RefineEnd::Content {
                    return ended;
                }
                if !self.dormant_pair_is_lit(plan) {
                    break;
                }
            }
        }
        RefineEnd::Content
    }

    /// The limit that ends the solve now, if there is one and the error is still too large.
    fn limit(&self, ended: RefineEnd, deadline: Option<Instant>) -> Option<StoppedBy> {
        if self.observer.cancelled() {
            return Some(StoppedBy::Cancelled);
        }
        if self.error.is_some_and(|error| error.claimed <= self.options.error) {
            return None;
        }
        match ended {
            RefineEnd::MaxLinks => Some(StoppedBy::MaxLinks),
            RefineEnd::Memory => Some(StoppedBy::Memory),
            RefineEnd::Stopped => Some(StoppedBy::Time),
            RefineEnd::Content => deadline.filter(|&deadline| Instant::now() >= deadline).map(|_| StoppedBy::Time),
        }
    }

    /// Whether work is cancelled or over its time by now.
    fn is_late(&self, deadline: Option<Instant>) -> impl Fn() -> bool + Sync + use<'a> {
        let observer = self.observer;
        move || observer.cancelled() || deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Tells how far a refinement is, and whether to end it now: on cancellation, or after the deadline.
    fn refinement_stop(&self, deadline: Option<Instant>) -> impl Fn(u64, u64) -> bool + Sync + use<'a> {
        let (observer, round, late) = (self.observer, self.report.counts.rounds as u32, self.is_late(deadline));
        move |links, elements| {
            observer.progress(&Progress { stage: Stage::Refine, round, fraction: None, links, elements, error: None });
            late()
        }
    }

    /// Where refinement ends, content or not: what cells take is not left to links.
    fn refine_limits<'s>(&self, plan: &Plan, run: &RunOptions, stop: &'s (dyn Fn(u64, u64) -> bool + Sync)) -> RefineLimits<'s> {
        let left = |bytes: u64| bytes.saturating_sub(self.cell_bytes(plan));
        RefineLimits {
            max_links: self.options.max_links.unwrap_or(u64::from(u32::MAX)),
            max_bytes: run.memory_bytes.map_or(u64::MAX, left),
            channels: self.kept_channels,
            stop,
        }
    }

    /// What the solution keeps of radiosities that are resolved as finely as planned.
    fn cell_bytes(&self, plan: &Plan) -> u64 {
        match plan.gather() {
            Gather::Hemisphere => {
                let cells = Lattice::new(self.scene, &self.reflectors(), plan.resolution().side).count();
                cells.map_or(u64::MAX, |cells| Resolved::bytes_of(cells, self.kept_channels))
            }
            _ => 0,
        }
    }

    fn reflectors(&self) -> Vec<Reflector> {
        reflectors(self.scene, &self.hierarchy, &self.radiosity)
    }

    /// Whether the memory allows radiosities that are resolved as finely as planned, beside what there is.
    fn cells_fit(&self, plan: &Plan, run: &RunOptions) -> bool {
        let radiosities = self.hierarchy.len() * self.kept_channels * size_of::<f64>();
        let nodes = self.hierarchy.memory_bytes() + radiosities as u64;
        let links = self.links.memory_bytes();
        run.memory_bytes.is_none_or(|most| (nodes + links).saturating_add(self.cell_bytes(plan)) <= most)
    }

    /// Whether clusters gather and emit: by plan, or where few surfaces are no reason to do without.
    fn links_clusters(&self, plan: &Plan) -> bool {
        plan.clusters() || (self.options.strategy == Strategy::Default && !self.options.skips.clusters)
    }

    /// Splits the links that `splits` names, and refines until the oracle is content.
    fn refine_with(
        &mut self,
        oracle: &dyn RefinementOracle,
        splits: &HashMap<Pair, Decision>,
        plan: &Plan,
        run: &RunOptions,
        deadline: Option<Instant>,
    ) -> RefineEnd {
        let start = Instant::now();
        self.report.counts.rounds += 1;
        self.progress(Stage::Refine);
        let context = RefineContext {
            scene: self.scene,
            rays: self.rays,
            oracle,
            radiosity: self.radiosity.values(),
            clusters: self.links_clusters(plan),
            cluster_reflectance: &self.cluster_reflectance,
            form_factor_accuracy: self.options.form_factor_accuracy,
            rays_per_link: self.options.rays_per_link,
            rays_per_light_link: self.options.rays_per_light_link,
            skips: self.options.skips,
            seed: self.options.seed,
            form_factor_nanoseconds: AtomicU64::new(0),
        };
        let stop = self.refinement_stop(deadline);
        let limits = self.refine_limits(plan, run, &stop);
        let end = self.refinement.refine(&mut self.hierarchy, splits, &context, &limits);
        self.report.time_s.form_factor += context.form_factor_nanoseconds.into_inner() as f64 * 1e-9;
        self.links = self.refinement.link_set(&self.hierarchy);
        self.exposure.grow(self.scene, &self.hierarchy, self.rays, self.options.seed);
        self.radiosity.grow(&self.hierarchy);
        let clusters = self.links_clusters(plan);
        self.closure = Closure::needed(self.scene, &self.hierarchy, &self.links, &self.exposure, clusters);
        self.report.time_s.refine += start.elapsed().as_secs_f64();
        end
    }

    /// Whether a pair that sleeps because its source was dark must be looked at again. Where clusters are linked, one with itself sleeps
    /// because it carries little.
    fn dormant_pair_is_lit(&self, plan: &Plan) -> bool {
        let sleeps_in_the_dark = |pair: &&Pair| pair.receiver != pair.source || !self.links_clusters(plan);
        let in_the_dark = self.links.dormant().iter().filter(sleeps_in_the_dark);
        in_the_dark.map(|pair| pair.source).any(|source| self.radiosity.of(source).iter().any(|&b| b > 0.0))
    }

    /// Gathers over the links and push-pulls until what is still to come is below the tolerance.
    fn sweep(&mut self, deadline: Option<Instant>) {
        self.progress(Stage::Gather);
        let mut previous = f64::INFINITY;
        for _ in 0..MAX_SWEEPS {
            let start = Instant::now();
            let closure = self.closure.as_ref();
            let change = match self.options.sweep {
                Sweep::Jacobi => {
                    let irradiance = sweep::gather(&self.hierarchy, &self.links, &self.exposure, &self.radiosity);
                    let gathered = Instant::now();
                    let change =
                        sweep::push_pull(self.scene, &self.hierarchy, &self.exposure, closure, irradiance, &mut self.radiosity);
                    self.report.time_s.push_pull += gathered.elapsed().as_secs_f64();
                    self.report.time_s.gather += (gathered - start).as_secs_f64();
                    change
                }
                Sweep::InPlace => {
                    let change =
                        sweep_in_place(self.scene, &self.hierarchy, &self.links, &self.exposure, closure, &mut self.radiosity);
                    self.report.time_s.gather += start.elapsed().as_secs_f64();
                    change
                }
            };
            self.report.counts.iterations += 1;
            self.report.energy.residual = change.largest;

            let to_come = change.estimate_to_come(previous);
            previous = change.largest;
            let late = self.is_late(deadline);
            if to_come <= self.options.sweep_tolerance * change.brightest || !change.largest.is_finite() || late() {
                break;
            }
        }
    }

    /// Takes the radiosity of every leaf anew, by the gather at its centre, or where it is exposed, and follows what that changes.
    fn regather_leaves(&mut self, plan: &Plan, deadline: Option<Instant>) {
        let late = self.is_late(deadline);
        if plan.leaf_rays() == 0 || plan.gather() == Gather::Hemisphere || late() {
            return;
        }
        let start = Instant::now();
        let effort = Effort { rays: plan.leaf_rays(), least_chance: 1.0, seed: self.options.seed };
        let reconstruction = self.reconstruction(None, effort);
        let channels = self.scene.channels();
        let leaves: Vec<NodeId> = self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node)).collect();
        let mut values = vec![0.0; leaves.len() * channels];
        let by_plane = ByPlane::new(self.scene);
        values.par_chunks_mut(channels).zip(&leaves).for_each_init(Scratch::default, |scratch, (value, &leaf)| {
            let surface = SurfaceId(self.hierarchy.node(leaf).surface);
            match sampled_exposed_point(&self.hierarchy, &by_plane, &self.exposure, self.rays, leaf, self.options.seed) {
                Some(point) => reconstruction.radiosities_at([(point, surface)].into_iter(), effort, scratch, value),
                None => value.copy_from_slice(self.radiosity.of(leaf)),
            }
        });
        let mut change = self.radiosity.clone();
        for (value, &leaf) in values.chunks(channels).zip(&leaves) {
            change.of_mut(leaf).iter_mut().zip(value).for_each(|(old, new)| *old = new - *old);
            self.radiosity.of_mut(leaf).copy_from_slice(value);
        }
        let Self { scene, hierarchy, links, exposure, closure, radiosity, .. } = self;
        Reflections { scene, hierarchy, links, exposure, closure: closure.as_ref() }.add(change, radiosity, &late);
        self.radiosity.pull(&self.hierarchy, &self.exposure);
        self.report.time_s.gather += start.elapsed().as_secs_f64();
    }

    /// Resolves radiosities as finely as planned, for looks and, if they need them, for values.
    fn resolve(&mut self, plan: &Plan) {
        if self.observer.cancelled() {
            return;
        }
        let start = Instant::now();
        if plan.gather() == Gather::Hemisphere && self.for_values.as_ref().is_none_or(|own| own.resolution != plan.resolution()) {
            self.for_values = Some(self.resolved(plan.resolution(), [0]));
        }
        if self.for_looks.as_ref().is_none_or(|own| own.resolution != plan.look_resolution()) {
            self.for_looks = Some(self.resolved(plan.look_resolution(), [1, 2]));
            self.error_samples = ErrorSamples::default();
        }
        self.report.time_s.resolve += start.elapsed().as_secs_f64();
    }

    /// Radiosities resolved once for each of `parts`, which pick the random numbers.
    fn resolved<const N: usize>(&self, resolution: Resolution, parts: [u64; N]) -> ResolvedLight<'a, N> {
        // Those of looks have the same cells as those of values.
        let of_values = self.for_values.as_ref().filter(|own| own.resolution.side == resolution.side);
        let paths = of_values.map_or_else(|| Arc::new(self.light_paths(resolution.side)), |of_values| of_values.paths.clone());
        let seed = |part| sampling::hash(self.options.seed, 0x5e50_17ed_u64 + part);
        let resolved = parts.map(|part| Resolved::solve(&paths, &resolution, seed(part)));
        ResolvedLight { resolution, paths, resolved }
    }

    fn light_paths(&self, side: f64) -> LightPaths<'a> {
        LightPaths::new(self.scene, self.rays, &self.hierarchy, &self.radiosity, side)
    }

    /// Estimates the error of the values that a user would get now.
    fn estimate_error(&mut self, plan: &mut Plan) {
        self.error = None;
        let Some(for_looks) = self.for_looks.as_ref().filter(|_| !self.observer.cancelled()) else { return };
        let start = Instant::now();
        self.progress(Stage::Error);
        let cancelled = || self.observer.cancelled();
        let ResolvedLight { paths, resolved, .. } = for_looks;
        let gathers = resolved.each_ref().map(|resolved| match &self.for_values {
            Some(own) => LookGather::Excess(ExcessGather { paths, believed: &own.resolved[0], onward: resolved }),
            None => LookGather::Truth(HemisphereGather { paths, resolved, bounces: plan.look_bounces() }),
        });
        let looking = Looking {
            scene: self.scene,
            hierarchy: &self.hierarchy,
            radiosity: &self.radiosity,
            gathers,
            seed: sampling::hash(self.options.seed, u64::MAX),
        };
        let mut samples = std::mem::take(&mut self.error_samples);
        let is_first = samples.is_empty();
        let is_spread = samples.spread(plan.error_points(), plan.look_pilot_rays(), &looking, &cancelled);
        if is_spread && is_first && self.for_values.is_some() {
            let reconstruction = self.reconstruction_for_users(plan.pilot_rays());
            samples.pilot(&reconstruction, &cancelled).iter().for_each(|pilot| plan.fit_rays(pilot));
        }
        if is_spread && samples.look(plan.look_rays(), &looking, &cancelled) {
            self.error = samples.estimate(&self.reconstruction_for_users(plan.point_rays()), &cancelled);
        }
        self.error_samples = samples;
        self.report.time_s.error += start.elapsed().as_secs_f64();
    }

    /// The part of the error estimated last that is noise of values of so many rays.
    fn sampled_gather_noise(&mut self, point_rays: u32) -> f64 {
        let start = Instant::now();
        let reconstruction = self.reconstruction_for_users(point_rays);
        let noise = self.error_samples.sampled_gather_noise(&reconstruction, &|| self.observer.cancelled());
        self.report.time_s.error += start.elapsed().as_secs_f64();
        noise
    }

    /// Takes the values that a user would get now.
    fn reconstruction_for_users(&self, point_rays: u32) -> Reconstruction<'_> {
        let effort = Effort::of_values(point_rays, self.options.seed);
        let hemisphere =
            self.for_values.as_ref().map(|own| HemisphereGather { paths: &own.paths, resolved: &own.resolved[0], bounces: 0 });
        self.reconstruction(hemisphere, effort)
    }

    /// Takes values at points over the hemisphere, or else over links.
    fn reconstruction<'b>(&'b self, hemisphere: Option<HemisphereGather<'b>>, effort: Effort) -> Reconstruction<'b> {
        let Self { scene, hierarchy, links, radiosity, exposure, rays, .. } = self;
        let over_links = || Way::Links(LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays));
        Reconstruction { scene, hierarchy, way: hemisphere.map_or_else(over_links, Way::Hemisphere), effort }
    }

    /// What refinement left out.
    fn skipped(&self, plan: &Plan) -> Vec<SkippedWork> {
        let work = |what: &str, count, estimate_saved_rays| SkippedWork {
            what: what.to_owned(),
            count,
            estimate_saved_rays,
            ..SkippedWork::default()
        };
        let Refinement { behind, black, .. } = self.refinement;
        let asleep =
            |is_counted: &dyn Fn(&Pair) -> bool| self.links.dormant().iter().filter(|pair| is_counted(pair)).count() as u64;
        let (dark, within) = (asleep(&|pair| pair.receiver != pair.source), asleep(&|pair| pair.receiver == pair.source));
        let rays = 2 * u64::from(self.options.rays_per_link);
        let unused = if self.links_clusters(plan) { 0 } else { self.hierarchy.cluster_count() as u64 };
        let is_dark = |surface: &u32| self.radiosity.of(self.hierarchy.node_of(SurfaceId(*surface))).iter().all(|&b| b == 0.0);
        let sealed = (0..self.scene.surfaces().len() as u32).filter(is_dark).count() as u64;
        let spared = self.rays.spared();
        let (everywhere, between) = if self.rays.is_clear_everywhere() { (spared, 0) } else { (0, spared) };
        vec![
            work("pairs behind one another", behind.pairs, behind.rays),
            work("pairs with a black receiver", black.pairs, black.rays),
            work("dormant pairs with a dark source, or for which there was no room", dark, rays * dark),
            work("dormant pairs of a cluster with itself", within, rays * within),
            work("surfaces that no light reaches", sealed, 0),
            work("clusters that are not linked", unused, 0),
            work("segments in a scene where nothing occludes", everywhere, everywhere),
            work("segments between planes with nothing in between", between, between),
        ]
    }

    fn finish(self, scene: Scene, plan: &Plan, stopped_by: StoppedBy) -> (Solution, SolveReport) {
        let skipped = self.skipped(plan);
        let mut report = self.report;
        let powers = Powers {
            scene: &scene,
            hierarchy: &self.hierarchy,
            links: &self.links,
            exposure: &self.exposure,
            closure: self.closure.as_ref(),
            radiosity: &self.radiosity,
        };
        let held_back = |pairs: &[Pair]| {
            let radiosity = self.radiosity.values();
            bound_held_back(Light { scene: &scene, hierarchy: &self.hierarchy, radiosity }, pairs)
        };
        report.energy = Energy {
            residual: report.energy.residual,
            held_back: report.energy_balance.map_or_else(|| held_back(self.links.dormant()), |balance| balance.held_back),
            held_back_unseen: held_back(self.links.unseen()),
            ..powers.energy()
        };
        let reflected = report.energy.sent - report.energy.emitted;
        report.error = ErrorReport {
            requested: self.options.error,
            estimate: self.error.map_or(f64::INFINITY, |error| error.claimed),
            confidence: error_estimate::CONFIDENCE,
            measured: self.error.map_or(f64::INFINITY, |error| error.measured),
            skipped: if reflected > 0.0 { report.energy.held_back / reflected } else { 0.0 },
        };
        report.stopped_by = stopped_by;
        report.converged = stopped_by == StoppedBy::Error;
        let (segments, first_hits) = (self.rays.segments(), self.rays.first_hit_rays());
        report.time_s.visibility = segments.seconds() + first_hits.seconds();
        report.time_s.first_hits = first_hits.seconds();
        report.counts = Counts {
            surfaces: scene.surfaces().len() as u64,
            clusters: self.hierarchy.cluster_count() as u64,
            elements: (self.hierarchy.len() - self.hierarchy.cluster_count()) as u64,
            links: self.links.len() as u64,
            dormant: self.links.dormant().len() as u64,
            rays: segments.count() + first_hits.count(),
            first_hit_rays: first_hits.count(),
            ..report.counts
        };
        report.skipped.extend(skipped);
        let per_ray = segments.seconds() / segments.count().max(1) as f64;
        for skipped in &mut report.skipped {
            skipped.estimate_saved_s = per_ray * skipped.estimate_saved_rays as f64;
        }
        let solution = Solution {
            scene,
            options: self.options.clone(),
            hierarchy: self.hierarchy,
            links: self.links,
            exposure: self.exposure,
            radiosity: self.radiosity,
            point_rays: plan.point_rays(),
            resolution: self.for_values.as_ref().map_or(plan.resolution(), |own| own.resolution),
            resolved: self.for_values.map(|own| own.resolved).map(|[resolved]| resolved),
        };
        report.memory_bytes = solution.memory_bytes();
        (solution, report)
    }
}
