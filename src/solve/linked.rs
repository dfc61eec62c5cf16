//! The state over links: hierarchy, links, and the radiosities that sweeps find over them.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::cuts::cut_along_discontinuities;
use super::job::Job;
use super::memory::{CellDemand, Holdings, LINK_AT_WORK};
use super::options::{Subdivision, Sweep};
use super::plan::{COARSE_TOLERANCE, Plan};
use super::report::SolveReport;
use crate::direct::Lights;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::oracle::{Decision, RefinementOracle};
use crate::links::{Dropped, LinkSet, Pair, RefineContext, RefineEnd, RefineLimits, Refinement};
use crate::paths::{Brightness, Illumination, Landing, cell_count};
use crate::progress::{Progress, Stage, Stop};
use crate::scene::SurfaceId;
use crate::sweep::{
    self, ByPlane, Closure, Exposure, Irradiance, LightIrradiance, Radiosity, Reflection, Reflections, sampled_exposed_point,
    sweep_in_place,
};
use crate::transmittance::maps::Maps;
use crate::values::{Gather, Gathered, LinkGather, Over, RayBudget, Scratch};

/// No solve sweeps more often in a row: at reflectance 0.999 the change has fallen by e^-20 by then.
pub(super) const MAX_SWEEPS: u32 = 20_000;

/// Hierarchy, links and radiosities, and what was told of them so far.
pub(super) struct Linked<'a> {
    pub job: Job<'a>,
    /// Where particles from the emitters landed.
    pub landings: Arc<[Landing]>,
    pub hierarchy: Hierarchy,
    pub maps: Option<Maps<'a>>,
    pub links: LinkSet,
    pub dropped: Dropped,
    pub exposure: Exposure,
    /// What lights bring to leaves.
    pub lights: LightIrradiance,
    pub radiosity: Radiosity,
    /// What stands between points and sources.
    /// Where clusters gather and emit.
    pub closure: Option<Closure>,
    /// Whether clusters gather and emit.
    pub clusters: bool,
    /// Largest reflectance below each cluster, by channel.
    cluster_reflectance: Vec<f64>,
    /// Bytes that others take of the memory.
    pub reserved_bytes: u64,
    /// Until then links are made and leaves gathered anew, where there is a time limit: what is left of the time is for the error.
    links_until: Option<Instant>,
    /// Rays that leaves have cast when they were gathered anew last.
    pub cast_by_leaves: u64,
    /// The error that was claimed last.
    pub claimed: Option<f64>,
    pub report: SolveReport,
}

impl<'a> Linked<'a> {
    pub fn new(job: Job<'a>, illumination: &Illumination, mut hierarchy: Hierarchy, clusters: bool) -> Self {
        let start = Instant::now();
        let Job { scene, rays, options, .. } = job;
        if options.links.subdivision == Subdivision::Discontinuities {
            cut_along_discontinuities(&job, illumination, &mut hierarchy);
        }
        let mut exposure = Exposure::default();
        exposure.grow(scene, &hierarchy, rays, options.seed, &job.stop());
        let mut lights = LightIrradiance::default();
        lights.grow(Lights::new(scene, rays), &hierarchy, &exposure, options.seed, &job.stop());
        let radiosity = Radiosity::emitted(scene, &hierarchy, &exposure);
        let mut report = SolveReport { backend: rays.description(), ..SolveReport::default() };
        report.time_s.build = start.elapsed().as_secs_f64();
        let cluster_reflectance = sweep::cluster_reflectance(scene, &hierarchy);
        Self {
            links: LinkSet::unrefined(hierarchy.len()),
            job,
            landings: illumination.landings.clone(),
            maps: super::multiresolution96::maps(&job, &hierarchy),
            hierarchy,
            dropped: Dropped::default(),
            exposure,
            lights,
            radiosity,
            closure: None,
            clusters,
            cluster_reflectance,
            reserved_bytes: 0,
            links_until: job.half_time(),
            cast_by_leaves: 0,
            claimed: None,
            report,
        }
    }

    pub fn progress(&self, stage: Stage) {
        let elements = (self.hierarchy.len() - self.hierarchy.cluster_count()) as u64;
        let round = self.report.counts.rounds as u32;
        let (links, error) = (self.links.len() as u64, self.claimed);
        self.job.observer.progress(&Progress { stage, round, fraction: None, links, elements, error });
    }

    /// Asks whether to end a stage, and tells how far it is: about so many times it is asked.
    pub fn stop_telling(&self, stage: Stage, questions: usize) -> impl Fn() -> bool + Sync + use<'a> {
        let (job, round, claimed) = (self.job, self.report.counts.rounds as u32, self.claimed);
        let elements = (self.hierarchy.len() - self.hierarchy.cluster_count()) as u64;
        let (links, asked) = (self.links.len() as u64, AtomicU64::new(0));
        move || {
            let part = asked.fetch_add(1, Ordering::Relaxed) as f64 / questions.max(1) as f64;
            let fraction = Some(part.min(1.0));
            job.observer.progress(&Progress { stage, round, fraction, links, elements, error: claimed });
            job.is_late()
        }
    }

    /// Gives links half of the time that is left.
    pub fn begin_round(&mut self) {
        self.links_until = self.job.half_time();
    }

    /// Whether links are to be left as they are: on cancellation, or after their part of the time.
    pub fn ends_links(&self) -> impl Fn() -> bool + Sync + use<'a> {
        let (job, until) = (self.job, self.links_until);
        move || job.is_cancelled() || until.is_some_and(|until| Instant::now() >= until)
    }

    /// Tells how far a refinement is, and whether to end it now.
    pub fn refinement_stop(&self) -> impl Fn(u64, u64) -> bool + Sync + use<'a> {
        let (job, round, ends) = (self.job, self.report.counts.rounds as u32, self.ends_links());
        move |links, elements| {
            job.observer.progress(&Progress { stage: Stage::Refine, round, fraction: None, links, elements, error: None });
            ends()
        }
    }

    /// Asks whether refinement may take so many bytes, beside what does not change while it works.
    pub fn refinement_memory(&self) -> impl Fn(u64) -> bool + Sync + use<'a> {
        let (observer, others) = (self.job.observer, self.job.memory.beside_refinement(self.holdings()));
        move |bytes| observer.allows_memory(others + bytes)
    }

    /// Where refinement ends, content or not.
    pub fn refine_limits<'s>(
        &self,
        stop: &'s (dyn Fn(u64, u64) -> bool + Sync),
        allows: &'s (dyn Fn(u64) -> bool + Sync),
        halt: Stop<'s>,
    ) -> RefineLimits<'s> {
        RefineLimits {
            max_links: self.job.options.max_links.unwrap_or(u64::from(u32::MAX)),
            max_bytes: self.job.memory.left_for_refinement(self.holdings(), self.reserved_bytes),
            node_bytes: self.job.memory.bytes_of_new_node(self.job.kept_channels),
            link_bytes: LINK_AT_WORK as u64,
            stop,
            allows,
            halt,
        }
    }

    /// Refines with one oracle and sweeps until no pair is left that slept because its source was dark, and has light now.
    pub fn refine_and_sweep(&mut self, oracle: &dyn RefinementOracle, splits: &HashMap<Pair, Decision>) -> RefineEnd {
        if self.job.is_late() {
            return RefineEnd::Stopped;
        }
        let none = HashMap::new();
        let mut ended = self.refine(oracle, splits);
        self.sweep();
        while ended == RefineEnd::Content && self.dormant_pair_is_lit() {
            if self.job.is_late() {
                return RefineEnd::Stopped;
            }
            ended = self.refine(oracle, &none);
            self.sweep();
        }
        ended
    }

    /// The coarse pass that solvers begin with: it tells where it is bright.
    pub fn refine_coarsely(&mut self, plan: &Plan) -> RefineEnd {
        let tolerance = self.job.options.links.tolerance.unwrap_or(COARSE_TOLERANCE);
        self.refine_and_sweep(&*plan.oracle(tolerance), &HashMap::new())
    }

    /// Splits the links that `splits` names, and refines until the oracle is content.
    fn refine(&mut self, oracle: &dyn RefinementOracle, splits: &HashMap<Pair, Decision>) -> RefineEnd {
        let start = Instant::now();
        self.report.counts.rounds += 1;
        self.progress(Stage::Refine);
        let Job { scene, rays, options, .. } = self.job;
        let context = RefineContext {
            scene,
            rays,
            maps: super::multiresolution96::of_links(self.maps.as_ref(), options),
            oracle,
            radiosity: self.radiosity.values(),
            clusters: self.clusters,
            cluster_reflectance: &self.cluster_reflectance,
            form_factor_accuracy: options.links.form_factor_accuracy,
            rays_per_link: options.links.rays_per_link,
            rays_per_light_link: options.links.rays_per_light_link,
            skips: options.links.skips,
            seed: options.seed,
            form_factor_nanoseconds: AtomicU64::new(0),
        };
        let (stop, allows, halt) = (self.refinement_stop(), self.refinement_memory(), self.job.stop());
        let limits = self.refine_limits(&stop, &allows, &halt);
        let mut refinement = Refinement::of(std::mem::take(&mut self.links), &mut self.dropped);
        let end = refinement.refine(&mut self.hierarchy, splits, &context, &limits);
        let at_work = (refinement.most_pairs() * LINK_AT_WORK) as u64;
        self.links = refinement.into_links(&self.hierarchy);
        self.report.time_s.form_factor += context.form_factor_nanoseconds.into_inner() as f64 * 1e-9;
        // What links take in the solution is a part of what they take at work.
        let more = at_work.saturating_sub(self.links.memory_bytes());
        self.account(self.job.memory.with_sweeps(self.holdings()) + more);
        self.grow();
        let Self { hierarchy, links, exposure, radiosity, clusters, .. } = self;
        self.closure =
            radiosity.without_lobes(hierarchy, exposure, || Closure::needed(scene, hierarchy, links, exposure, *clusters));
        self.report.time_s.refine += start.elapsed().as_secs_f64();
        end
    }

    /// Makes room for nodes that are new.
    pub fn grow(&mut self) {
        let Job { scene, rays, options, .. } = self.job;
        self.exposure.grow(scene, &self.hierarchy, rays, options.seed, &self.job.stop());
        self.lights.grow(Lights::new(scene, rays), &self.hierarchy, &self.exposure, options.seed, &self.job.stop());
        self.radiosity.grow(&self.hierarchy);
    }

    /// Whether a pair that sleeps because its source was dark must be decided again. Where clusters are linked, one with itself sleeps
    /// because it carries little.
    fn dormant_pair_is_lit(&self) -> bool {
        let sleeps_in_the_dark = |pair: &&Pair| pair.receiver != pair.source || !self.clusters;
        let in_the_dark = self.links.dormant().iter().filter(sleeps_in_the_dark);
        in_the_dark.map(|pair| pair.source).any(|source| self.radiosity.of(source).iter().any(|&b| b > 0.0))
    }

    /// Gathers over the links and push-pulls until what is still to come is below the tolerance.
    pub fn sweep(&mut self) {
        self.progress(Stage::Gather);
        let (mut previous, mut irradiance) = (f64::INFINITY, Irradiance::default());
        for _ in 0..MAX_SWEEPS {
            let change = self.sweep_once(&mut irradiance);
            self.report.counts.iterations += 1;
            self.report.energy.residual = change.largest;
            let to_come = change.estimate_to_come(previous);
            previous = change.largest;
            let is_enough = to_come <= self.job.options.links.sweep_tolerance * change.brightest;
            if is_enough || !change.largest.is_finite() || self.job.is_late() {
                break;
            }
        }
    }

    /// Lets light travel once over the links; `irradiance` is memory that is reused.
    fn sweep_once(&mut self, irradiance: &mut Irradiance) -> sweep::Change {
        let Self { job, hierarchy, links, exposure, lights, closure, radiosity, report, .. } = self;
        let reflection = Reflection { scene: job.scene, closure: closure.as_ref(), lights };
        let start = Instant::now();
        match job.options.links.sweep {
            Sweep::Jacobi => {
                sweep::gather_into(irradiance, hierarchy, links, exposure, radiosity);
                let gathered = Instant::now();
                let change = sweep::push_pull(&reflection, hierarchy, exposure, irradiance, radiosity);
                report.time_s.push_pull += gathered.elapsed().as_secs_f64();
                report.time_s.gather += (gathered - start).as_secs_f64();
                change
            }
            Sweep::InPlace => {
                let change = sweep_in_place(reflection, hierarchy, links, exposure, radiosity);
                report.time_s.gather += start.elapsed().as_secs_f64();
                change
            }
        }
    }

    /// Defect correction: takes the radiosity of every leaf anew, by a gather of so many rays at its centre, or where it is exposed, and
    /// follows what that changes over the links.
    pub fn regather_leaves(&mut self, rays: u32) {
        let stop = self.ends_links();
        if rays == 0 || stop() {
            return;
        }
        let start = Instant::now();
        let Job { scene, options, rays: all_rays, .. } = self.job;
        let cast_before: u64 = all_rays.cast_by_all().iter().sum();
        // What lights bring is known as a mean over the leaf, which tells more than one point does.
        let gather = self.gather_with(RayBudget { rays, least_chance: 1.0, seed: options.seed }, LinkGather::without_lights);
        let channels = scene.channels();
        let leaves: Vec<NodeId> = self.leaves().collect();
        let mut values = vec![0.0; leaves.len() * channels];
        let by_plane = ByPlane::new(scene);
        let share = self.job.rays.share();
        values.par_chunks_mut(channels).zip(&leaves).enumerate().for_each_init(
            <(Scratch, Gathered)>::default,
            |(scratch, gathered), (number, (value, &leaf))| {
                if !share.has(number) {
                    return;
                }
                let surface = SurfaceId(self.hierarchy.node(leaf).surface);
                if stop() {
                    value.copy_from_slice(self.radiosity.of(leaf));
                    return;
                }
                match sampled_exposed_point(&self.hierarchy, &by_plane, &self.exposure, self.job.rays, leaf, options.seed) {
                    Some(point) => {
                        gather.values_at(&[gather.place_at(point, surface)], gather.budget, scratch, gathered);
                        value.copy_from_slice(&gathered.radiosity);
                        let of_lights = self.lights.of(leaf, channels).unwrap_or_default();
                        let reflected = of_lights.iter().zip(&scene.material_of(surface).reflectance);
                        value.iter_mut().zip(reflected).for_each(|(b, (h, rho))| *b += rho * h);
                    }
                    None => value.copy_from_slice(self.radiosity.of(leaf)),
                }
            },
        );
        share.exchange_chunks(&mut values, channels);
        self.cast_by_leaves = all_rays.cast_by_all().iter().sum::<u64>() - cast_before;
        let mut change = self.radiosity.clone();
        for (value, &leaf) in values.chunks(channels).zip(&leaves) {
            change.of_mut(leaf).iter_mut().zip(value).for_each(|(old, new)| *old = new - *old);
            self.radiosity.of_mut(leaf).copy_from_slice(value);
        }
        let Self { hierarchy, links, exposure, closure, radiosity, .. } = self;
        Reflections { scene, hierarchy, links, exposure, closure: closure.as_ref() }.add(change, radiosity, &stop);
        radiosity.pull(hierarchy, exposure);
        self.report.time_s.gather += start.elapsed().as_secs_f64();
    }

    /// Gathers values at points over the links.
    pub fn gather(&self, budget: RayBudget) -> Gather<'_> {
        self.gather_with(budget, |gather| gather)
    }

    /// The same by another gather.
    fn gather_with<'b>(&'b self, budget: RayBudget, other: impl Fn(LinkGather<'b>) -> LinkGather<'b>) -> Gather<'b> {
        let Self { hierarchy, links, radiosity, exposure, job: Job { scene, rays, .. }, .. } = self;
        let over = LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays);
        let over = Over::Links(other(LinkGather::with_direct_light(over)));
        Gather { scene, hierarchy, over, budget }
    }

    /// How bright surfaces are, by the radiosities over the links, and where they have bright spots.
    pub fn brightness(&self) -> Brightness {
        let Self { job: Job { scene, .. }, hierarchy, radiosity, .. } = self;
        Brightness::of_surfaces(scene, |surface| radiosity.reflected(scene, hierarchy, surface)).with_spots(scene, &self.landings)
    }

    /// Elements that are not split.
    pub fn leaves(&self) -> impl Iterator<Item = NodeId> {
        self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node))
    }

    /// Keeps memory for the cells of a plan, and its error points. Those that cannot be counted are never found.
    pub fn reserve_cells(&mut self, plan: &Plan) {
        let has_budget = self.job.run.memory_bytes.is_some();
        let demand = if has_budget { self.cell_demand(plan) } else { None };
        self.reserved_bytes = demand.map_or(0, |demand| demand.bytes(self.job.scene));
    }

    /// Whether cells as fine as is planned can be found within the memory.
    pub fn has_room_for_cells(&mut self, plan: &Plan) -> bool {
        if self.job.is_late() {
            // None will be found.
            return true;
        }
        let Some(demand) = self.cell_demand(plan) else { return false };
        let bytes = self.job.memory.kept(self.holdings()) + demand.bytes(self.job.scene);
        let is_allowed = self.job.memory.allows(bytes) && self.job.observer.allows_memory(bytes);
        if is_allowed {
            self.account(bytes);
        }
        is_allowed
    }

    /// The cells that a plan asks for; `None` if they are more than can be counted.
    pub fn cell_demand(&self, plan: &Plan) -> Option<CellDemand> {
        let (resolution, replicates) = (plan.resolution(), plan.replicate_resolution());
        let are_of_values = plan.over_cells;
        let rays = if are_of_values { resolution.rays.max(replicates.rays) } else { replicates.rays };
        let cells = cell_count(self.job.scene, &self.brightness(), resolution.size)?;
        Some(CellDemand { cells, channels: self.job.kept_channels, rays, are_of_values, error_points: plan.error_points() })
    }

    pub fn holdings(&self) -> Holdings<'_> {
        Holdings { hierarchy: &self.hierarchy, links: &self.links, channels: self.job.kept_channels }
    }

    /// Notes that so much is taken by the ledger.
    pub fn account(&mut self, bytes: u64) {
        self.report.accounted_bytes = self.report.accounted_bytes.max(bytes);
    }
}
