//! Which solver is taken: the one whose predicted work is less.
//!
//! What values over links take hangs on how much must be linked, and that on what few links leave wrong; what values over cells take the law
//! of effort tells beforehand. So a pilot makes the coarse pass over links that either solver begins with, sees how wrong values over these
//! few links are and how noisy values either way, and the law says what links would have to be made for the requested error. Whenever links are to be refined anew, the same
//! is asked again.

use std::sync::Arc;

use super::beginning::Beginning;
use super::cells_way::CellsWay;
use super::effort::{AIM, Law};
use super::first_error::error_to_begin_with;
use super::job::Job;
use super::judge::{cell_seed, particle_seed};
use super::linked::Linked;
use super::links_way::LinksWay;
use super::options::{Solver, Strategy};
use super::plan::{COARSE_TOLERANCE, Plan};
use super::strategies::ErrorSearch;
use super::way::Way;
use super::worthwhile_cells::Areas;
use crate::cells::SolvedCells;
use crate::error::{ErrorParts, ErrorSamples, REPLICATES, ReplicateGather, Replication};
use crate::geometry::{sampling, streams};
use crate::links::RefineEnd;
use crate::paths::{CellSize, Illumination, LightPaths, Resolution};
use crate::scene::{Material, SurfaceId};
use crate::values::{FinalGather, Gather, Over, RayBudget};

/// Points at which the pilot looks what few links leave wrong, rays of a value, of a replicate and of a leaf, and positions and paths for
/// the replicates: enough to know the error to a third, for a few percent of the work of a solve to 2%.
const POINTS: usize = 64;
const VALUE_RAYS: u32 = 64;
const REPLICATE_RAYS: u32 = 8;
const LEAF_RAYS: u32 = 16;
const POSITIONS: f64 = 256.0;
const POSITION_RAYS: u32 = 1;

/// Before any values over links are judged their work counts as so many times what is foreseen: links may have to be refined once more, or end in
/// cells after all. Measured: in rooms and boxes choices lose least between 1.2 and 1.5.
const LINKS_COUNT: f64 = 1.4;

/// The solver for a job, with its plan.
pub(super) fn choose<'a>(job: &Job<'a>, beginning: Beginning) -> Box<dyn Way<'a> + 'a> {
    let Beginning { hierarchy, importance } = beginning;
    let illumination = Illumination::sampled(job.scene, job.rays, particle_seed(job.options.seed), &job.stop());
    let areas = Areas::of_scene(job.scene);
    let law = Law::new(job.options, illumination.clone());
    let plan_for = |error, over_cells| Plan::new(job.scene, &areas, job.options, Law { error, ..law.clone() }, over_cells);
    let error = error_to_begin_with(job, |error| plan_for(error, true).work_with(job.run.values_in_time as f64));
    let plan = |over_cells| plan_for(error, over_cells);
    let search = ErrorSearch::new(importance);
    let (mut links, cells) = (plan(false), plan(true));
    let linked = || Linked::new(*job, &illumination, hierarchy, links.links_clusters(pairs(job), cells.work()));
    let options = job.options;
    match options.solver {
        _ if options.keep_transport => return Box::new(CellsWay::new(linked(), cells, search)),
        Solver::Cells => return Box::new(CellsWay::new(linked(), cells, search)),
        Solver::Auto if options.strategy == Strategy::Default => {}
        Solver::Auto | Solver::Links => return Box::new(LinksWay::new(linked(), links, search)),
    }

    // The coarse pass. Where the links that any scene takes would be too many, no more need be known.
    let mut linked = linked();
    if linked.refine_coarsely(&cells) != RefineEnd::Content {
        // A limit ends the solve here.
        return Box::new(LinksWay::new(linked, links, search));
    }
    let (coarse_links, leaves) = (linked.links.len(), linked.leaves().count());
    let at_law = links.tolerance() / COARSE_TOLERANCE;
    let over_links =
        |links: &Plan, tolerance_factor: f64| links.work_over_links(coarse_links, leaves, tolerance_factor.min(at_law));
    if over_links(&links, at_law) > cells.work() {
        return Box::new(CellsWay::new(linked, cells, search));
    }

    // What it leaves wrong, and how noisy values are.
    let swept = linked.radiosity.clone();
    linked.regather_leaves(LEAF_RAYS);
    let Some(Tried { over_links: ErrorParts { bias, noise_sq }, cells_noise_sq }) = try_both(&linked, &cells) else {
        return Box::new(LinksWay::new(linked, links, search).or_over(cells));
    };
    links.fit_point_rays(noise_sq, VALUE_RAYS);
    let mut fitted = cells.clone();
    fitted.fit_point_rays(cells_noise_sq, VALUE_RAYS);
    if LINKS_COUNT * over_links(&links, Law::tolerance_factor_of_pilot(bias, AIM * error)) > fitted.work() {
        // Rays are fitted by a pilot over cells of their own, which knows more.
        linked.radiosity = swept;
        Box::new(CellsWay::new(linked, cells, search))
    } else {
        Box::new(LinksWay::new(linked, links, search).or_over(fitted))
    }
}

/// Ordered pairs of surfaces that may exchange light.
fn pairs(job: &Job<'_>) -> f64 {
    let count = |may: &dyn Fn(&Material) -> bool| {
        let materials = (0..job.scene.surfaces().len() as u32).map(|id| job.scene.material_of(SurfaceId(id)));
        materials.filter(|material| may(material)).count() as f64
    };
    let reflects = |material: &Material| material.reflectance.iter().any(|&rho| rho > 0.0);
    count(&reflects) * count(&|material| reflects(material) || material.emits())
}

/// What the pilot found.
struct Tried {
    /// The parts of the error of values over the links as they are.
    over_links: ErrorParts,
    /// The variance of values over cells.
    cells_noise_sq: f64,
}

/// Tries values of few rays over the links as they are, and over cells; `None` if nothing is reflected, or if stopped.
fn try_both(linked: &Linked<'_>, cells: &Plan) -> Option<Tried> {
    let job = linked.job;
    let side = (cells.law.illumination.lit_area / POSITIONS).sqrt();
    let size = CellSize { side, ..cells.resolution().size };
    let resolution = Resolution { size, rays: POSITION_RAYS };
    let paths = Arc::new(LightPaths::new(job.scene, job.rays, &linked.brightness(), resolution.size, &job.stop()));
    let seeds = std::array::from_fn(|number| cell_seed(job.options.seed, (1 + REPLICATES + number) as u64));
    let stop = job.stop();
    let cells = SolvedCells::solve(paths, resolution, seeds, &stop)?;
    let gathers = cells
        .radiosities
        .each_ref()
        .map(|radiosities| ReplicateGather::Truth(FinalGather { paths: &cells.paths, radiosities, bounces: 0, vertex_rays: 1 }));
    let seed = sampling::hash(job.options.seed, streams::PILOT_POINTS);
    let with = Replication {
        scene: job.scene,
        hierarchy: &linked.hierarchy,
        radiosity: &linked.radiosity,
        gathers,
        seed,
        most_paths: f64::INFINITY,
    };
    let mut samples = ErrorSamples::new(job.options.norm.into());
    let taken = samples.add_points(POINTS, 1, &with, &stop) && samples.take_replicates(REPLICATE_RAYS, &with, &stop);
    let budget = RayBudget::of_values(VALUE_RAYS, job.options.seed);
    let over_cells =
        Over::Cells(FinalGather { paths: &cells.paths, radiosities: &cells.radiosities[0], bounces: 0, vertex_rays: 1 });
    let over_cells = Gather { scene: job.scene, hierarchy: &linked.hierarchy, over: over_cells, budget };
    let found = || Some((samples.sampled_parts(&linked.gather(budget), &stop)?, samples.pilot(&over_cells, &stop)?));
    let (over_links, of_cells) = taken.then(found).flatten()?;
    Some(Tried { over_links, cells_noise_sq: of_cells.noise_sq })
}
