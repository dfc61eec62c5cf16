//! The strategies of 1994: a fixed number of iterations, each of which links, refines, and lets light travel once.
//!
//! The k-th iteration performs the k-th bounce of light (Holzschuch, Sillion, Drettakis 1994, footnote 3): only what has become bright is
//! refined, so the tolerance itself stays the same. The first iteration takes most of the time, the first picture is ready after it.

use std::sync::atomic::AtomicU64;
use std::time::Instant;

use crate::bounds::{Light, bound_held_back};
use crate::links::{MutualContext, MutualLinks, Pair, RAYS_PER_LINK, RefineEnd, TopLevel};
use crate::progress::Stage;
use crate::scene::SurfaceId;
use crate::solve::job::Job;
use crate::solve::linked::Linked;
use crate::solve::options::Strategy;
use crate::solve::plan::Plan;
use crate::solve::report::{EnergyBalance, IterationReport, SkippedWork};
use crate::sweep::{self, Radiosity, Reflection};

/// Runs as many iterations as the options ask for, and accounts for the energy that pairs without a link hold back.
pub(super) fn bounce(linked: &mut Linked<'_>, plan: &Plan) -> RefineEnd {
    let (stop, allows, halt) = (linked.refinement_stop(), linked.refinement_memory(), linked.job.stop());
    let limits = linked.refine_limits(&stop, &allows, &halt);
    let mut links = match MutualLinks::new(top_level(&linked.job, plan), linked.job.scene, &linked.hierarchy, &limits) {
        Ok(links) => links,
        Err(limit) => return limit,
    };
    let mut ended = RefineEnd::Content;
    for _ in 0..linked.job.options.holzschuch94.iterations {
        ended = link_and_refine(linked, &mut links, plan);
        let gathering = Instant::now();
        linked.links = links.link_set(&linked.hierarchy);
        let mut irradiance = sweep::gather(&linked.hierarchy, &linked.links, &linked.exposure, &linked.radiosity);
        let pushing = Instant::now();
        let reflection = Reflection { scene: linked.job.scene, closure: None, lights: &linked.lights };
        let change = sweep::push_pull(&reflection, &linked.hierarchy, &linked.exposure, &mut irradiance, &mut linked.radiosity);
        linked.report.time_s.gather += (pushing - gathering).as_secs_f64();
        linked.report.time_s.push_pull += pushing.elapsed().as_secs_f64();
        linked.report.energy.residual = change.largest;
        linked.report.counts.iterations += 1;
        note_iteration(linked, &links);
        if ended != RefineEnd::Content {
            break;
        }
    }
    balance_energy(linked, &links, plan);
    ended
}

/// Links pairs of surfaces, and refines what carries too much by now.
fn link_and_refine(linked: &mut Linked<'_>, links: &mut MutualLinks, plan: &Plan) -> RefineEnd {
    linked.report.counts.rounds += 1;
    linked.progress(Stage::Refine);
    let start = Instant::now();
    let (stop, allows, halt) = (linked.refinement_stop(), linked.refinement_memory(), linked.job.stop());
    let limits = linked.refine_limits(&stop, &allows, &halt);
    let context = context(&linked.job, &linked.radiosity, plan);
    let mut ended = links.link_surfaces(&linked.hierarchy, &context, &limits);
    linked.report.time_s.initial_linking += start.elapsed().as_secs_f64();
    if ended == RefineEnd::Content {
        ended = links.refine(&mut linked.hierarchy, &context, &limits);
    }
    linked.report.time_s.form_factor += context.form_factor_nanoseconds.into_inner() as f64 * 1e-9;
    linked.grow();
    linked.report.time_s.refine += start.elapsed().as_secs_f64();
    ended
}

/// Notes what there is after an iteration.
fn note_iteration(linked: &mut Linked<'_>, links: &MutualLinks) {
    let sums = sweep::row_sums(linked.job.scene, &linked.hierarchy, &linked.links, &linked.exposure);
    let (incorrect, total) =
        sweep::incorrect_energy(linked.job.scene, &linked.hierarchy, &linked.exposure, &linked.radiosity, &sums);
    linked.report.bounces.push(IterationReport {
        links: links.len(),
        elements: (linked.hierarchy.len() - linked.hierarchy.cluster_count()) as u64,
        link_rays: links.counts.rays,
        top_level_links: 2 * links.counts.top_level,
        top_level_exceeding: 2 * links.counts.top_level_exceeding,
        reduced_links: 2 * links.counts.reduced,
        incorrect_energy: incorrect,
        total_energy: total,
    });
}

/// Estimates what pairs without a link hold back, and gives surfaces the ambient term in its place; without the time for it, any pair counts as one
/// of them.
fn balance_energy(linked: &mut Linked<'_>, links: &MutualLinks, plan: &Plan) {
    linked.progress(Stage::Error);
    let start = Instant::now();
    let links_alone = std::mem::take(&mut linked.links);
    let is_late = linked.job.is_late();
    let dormant = if is_late { vec![Pair::ALL] } else { links.dormant(&linked.hierarchy) };
    let mut balance = EnergyBalance::default();
    if !dormant.is_empty() {
        let light = Light { scene: linked.job.scene, hierarchy: &linked.hierarchy, radiosity: linked.radiosity.values() };
        balance.held_back = bound_held_back(light, &dormant, &linked.job.stop());

        // The ambient term stands for what they carry.
        let context = context(&linked.job, &linked.radiosity, plan);
        if let Some(form_factors) = links.estimate_dormant_form_factors(&linked.hierarchy, &context, &linked.job.stop()) {
            let sums = sweep::row_sums(linked.job.scene, &linked.hierarchy, &links_alone, &linked.exposure);
            let form_factor = |surface: SurfaceId| form_factors[surface.index()];
            let Linked { job, hierarchy, exposure, radiosity, .. } = &*linked;
            let ambient = sweep::estimate_ambient(job.scene, hierarchy, exposure, radiosity, &sums, &form_factor);
            let before = reflected_power(linked);
            if linked.job.options.holzschuch94.ambient {
                sweep::reflect_ambient(linked.job.scene, &linked.hierarchy, &linked.exposure, &ambient, &mut linked.radiosity);
            }
            balance.ambient = reflected_power(linked) - before;
        }
    }
    balance.reflected = reflected_power(linked);
    linked.report.energy_balance = Some(balance);
    linked.links = links_alone.with_unlinked(dormant, links.unseen());
    let rays = u64::from(RAYS_PER_LINK);
    let pairs = |what: &str, count: u64, estimate_saved_rays| SkippedWork {
        what: what.to_owned(),
        count: 2 * count,
        estimate_saved_rays,
        ..SkippedWork::default()
    };
    let (behind, unclassified) = (links.counts.behind, links.unclassified_count() as u64);
    linked.report.skipped = vec![
        pairs("pairs of surfaces behind one another", behind, rays * behind),
        pairs("pairs of surfaces never worth a link", unclassified, rays * unclassified),
        pairs("pairs of which no ray arrived", linked.links.unseen().len() as u64 / 2, 0),
        pairs("links not refined because it would tell nothing", links.counts.reduced, 4 * rays * links.counts.reduced),
    ];
    linked.report.time_s.error += start.elapsed().as_secs_f64();
}

/// What all surfaces reflect, in W, all channels added.
fn reflected_power(linked: &Linked<'_>) -> f64 {
    let reflected = |surface: u32| {
        let node = linked.hierarchy.node_of(SurfaceId(surface));
        let exposed = linked.hierarchy.area(node) * linked.exposure.of(node);
        let exitance = &linked.job.scene.material_of(SurfaceId(surface)).exitance;
        exposed * linked.radiosity.of(node).iter().zip(exitance).map(|(b, e)| b - e).sum::<f64>()
    };
    (0..linked.job.scene.surfaces().len() as u32).map(reflected).sum()
}

/// Which pairs of surfaces the strategy links.
fn top_level(job: &Job<'_>, plan: &Plan) -> TopLevel {
    let options = job.options;
    match options.strategy {
        Strategy::Lazy94 | Strategy::Lazy94Reduction => {
            TopLevel::Lazy { tolerance: options.holzschuch94.link_tolerance * plan.irradiance_tolerance() }
        }
        Strategy::Culling94 => TopLevel::Culled { form_factor: options.holzschuch94.cull_form_factor },
        _ => TopLevel::All,
    }
}

fn context<'a>(job: &Job<'a>, radiosity: &'a Radiosity, plan: &Plan) -> MutualContext<'a> {
    let options = job.options;
    MutualContext {
        scene: job.scene,
        rays: job.rays,
        radiosity: radiosity.values(),
        form_factor_accuracy: options.links.form_factor_accuracy,
        refine_tolerance: plan.irradiance_tolerance(),
        reduce_tolerance: (options.strategy == Strategy::Lazy94Reduction).then_some(options.holzschuch94.reduce_tolerance),
        min_area: plan.min_area(),
        seed: options.seed,
        form_factor_nanoseconds: AtomicU64::new(0),
    }
}
