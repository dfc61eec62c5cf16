//! The strategies of 1994: a fixed number of iterations, each of which links, refines, and lets light travel once.
//!
//! The k-th iteration performs the k-th bounce of light (Holzschuch, Sillion, Drettakis 1994, footnote 3): only what has become bright is
//! refined, so the tolerance itself stays the same. The first iteration takes most of the time, the first picture is ready after it.

use std::sync::atomic::AtomicU64;
use std::time::Instant;

use super::plan::Plan;
use super::report::{EnergyBalance, IterationReport, SkippedWork};
use super::{RunOptions, SolveOptions, Solver, Strategy};
use crate::bounds::{Light, bound_held_back};
use crate::links::{MutualContext, MutualLinks, RAYS_PER_LINK, RefineEnd, TopLevel};
use crate::progress::Stage;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::{self, Radiosity};
use crate::transmittance::Rays;

impl Solver<'_> {
    /// Runs as many iterations as the options ask for, and accounts for the energy that pairs without a link hold back.
    pub(super) fn bounce(&mut self, plan: &Plan, run: &RunOptions, deadline: Option<Instant>) -> RefineEnd {
        let mut links = MutualLinks::new(top_level(self.options, plan), self.scene);
        let mut ended = RefineEnd::Content;
        for _ in 0..self.options.iterations {
            ended = self.link_and_refine(&mut links, plan, run, deadline);
            let gathering = Instant::now();
            self.links = links.link_set(&self.hierarchy);
            let irradiance = sweep::gather(&self.hierarchy, &self.links, &self.exposure, &self.radiosity);
            let pushing = Instant::now();
            let change = sweep::push_pull(self.scene, &self.hierarchy, &self.exposure, None, irradiance, &mut self.radiosity);
            self.report.time_s.gather += (pushing - gathering).as_secs_f64();
            self.report.time_s.push_pull += pushing.elapsed().as_secs_f64();
            self.report.energy.residual = change.largest;
            self.report.counts.iterations += 1;
            self.note_iteration(&links);
            if ended != RefineEnd::Content {
                break;
            }
        }
        self.balance_energy(&links, plan);
        ended
    }

    /// Links pairs of surfaces, and refines what carries too much by now.
    fn link_and_refine(&mut self, links: &mut MutualLinks, plan: &Plan, run: &RunOptions, deadline: Option<Instant>) -> RefineEnd {
        self.report.counts.rounds += 1;
        self.progress(Stage::Refine);
        let start = Instant::now();
        let stop = self.refinement_stop(deadline);
        let limits = self.refine_limits(plan, run, &stop);
        let context = context(self.scene, self.rays, self.options, &self.radiosity, plan);
        let mut ended = links.link_surfaces(&self.hierarchy, &context, &limits);
        self.report.time_s.initial_linking += start.elapsed().as_secs_f64();
        if ended == RefineEnd::Content {
            ended = links.refine(&mut self.hierarchy, &context, &limits);
        }
        self.report.time_s.form_factor += context.form_factor_nanoseconds.into_inner() as f64 * 1e-9;
        self.exposure.grow(self.scene, &self.hierarchy, self.rays, self.options.seed);
        self.radiosity.grow(&self.hierarchy);
        self.report.time_s.refine += start.elapsed().as_secs_f64();
        ended
    }

    /// Notes what there is after an iteration.
    fn note_iteration(&mut self, links: &MutualLinks) {
        let sums = sweep::row_sums(self.scene, &self.hierarchy, &self.links, &self.exposure);
        let (incorrect, total) = sweep::incorrect_energy(self.scene, &self.hierarchy, &self.exposure, &self.radiosity, &sums);
        self.report.bounces.push(IterationReport {
            links: links.len(),
            elements: (self.hierarchy.len() - self.hierarchy.cluster_count()) as u64,
            link_rays: links.counts.rays,
            top_level_links: 2 * links.counts.top_level,
            top_level_exceeding: 2 * links.counts.top_level_exceeding,
            reduced_links: 2 * links.counts.reduced,
            incorrect_energy: incorrect,
            total_energy: total,
        });
    }

    /// Estimates what pairs without a link hold back, and gives surfaces the ambient term in its place.
    fn balance_energy(&mut self, links: &MutualLinks, plan: &Plan) {
        self.progress(Stage::Error);
        let start = Instant::now();
        let links_alone = std::mem::take(&mut self.links);
        let dormant = links.dormant(&self.hierarchy);
        let mut balance = EnergyBalance::default();
        if !dormant.is_empty() {
            let light = Light { scene: self.scene, hierarchy: &self.hierarchy, radiosity: self.radiosity.values() };
            balance.held_back = bound_held_back(light, &dormant);

            // The ambient term stands for what they carry.
            let context = context(self.scene, self.rays, self.options, &self.radiosity, plan);
            let form_factors = links.estimate_dormant_form_factors(&self.hierarchy, &context);
            let sums = sweep::row_sums(self.scene, &self.hierarchy, &links_alone, &self.exposure);
            let form_factor = |surface: SurfaceId| form_factors[surface.index()];
            let ambient =
                sweep::estimate_ambient(self.scene, &self.hierarchy, &self.exposure, &self.radiosity, &sums, &form_factor);
            let before = self.reflected_power();
            if self.options.ambient {
                sweep::reflect_ambient(self.scene, &self.hierarchy, &self.exposure, &ambient, &mut self.radiosity);
            }
            balance.ambient = self.reflected_power() - before;
        }
        balance.reflected = self.reflected_power();
        self.report.energy_balance = Some(balance);
        self.links = links_alone.with_unlinked(dormant, links.unseen());
        let rays = u64::from(RAYS_PER_LINK);
        let pairs = |what: &str, count: u64, estimate_saved_rays| SkippedWork {
            what: what.to_owned(),
            count: 2 * count,
            estimate_saved_rays,
            ..SkippedWork::default()
        };
        let (behind, unclassified) = (links.counts.behind, self.links.dormant().len() as u64 / 2);
        self.report.skipped = vec![
            pairs("pairs of surfaces behind one another", behind, rays * behind),
            pairs("pairs of surfaces never worth a link", unclassified, rays * unclassified),
            pairs("pairs of which no ray arrived", self.links.unseen().len() as u64 / 2, 0),
            pairs("links not refined because it would tell nothing", links.counts.reduced, 4 * rays * links.counts.reduced),
        ];
        self.report.time_s.error += start.elapsed().as_secs_f64();
    }

    /// What all surfaces reflect, in W, all channels added.
    fn reflected_power(&self) -> f64 {
        let reflected = |surface: u32| {
            let node = self.hierarchy.node_of(SurfaceId(surface));
            let exposed = self.hierarchy.area(node) * self.exposure.of(node);
            let exitance = &self.scene.material_of(SurfaceId(surface)).exitance;
            exposed * self.radiosity.of(node).iter().zip(exitance).map(|(b, e)| b - e).sum::<f64>()
        };
        (0..self.scene.surfaces().len() as u32).map(reflected).sum()
    }
}

/// Which pairs of surfaces the strategy links.
fn top_level(options: &SolveOptions, plan: &Plan) -> TopLevel {
    match options.strategy {
        Strategy::Lazy94 | Strategy::Lazy94Reduction => {
            TopLevel::Lazy { tolerance: options.link_tolerance * plan.irradiance_tolerance() }
        }
        Strategy::Culling94 => TopLevel::Culled { form_factor: options.cull_form_factor },
        _ => TopLevel::All,
    }
}

fn context<'a>(
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    options: &SolveOptions,
    radiosity: &'a Radiosity,
    plan: &Plan,
) -> MutualContext<'a> {
    MutualContext {
        scene,
        rays,
        radiosity: radiosity.values(),
        form_factor_accuracy: options.form_factor_accuracy,
        refine_tolerance: plan.irradiance_tolerance(),
        reduce_tolerance: (options.strategy == Strategy::Lazy94Reduction).then_some(options.reduce_tolerance),
        min_area: plan.min_area(),
        seed: options.seed,
        form_factor_nanoseconds: AtomicU64::new(0),
    }
}
