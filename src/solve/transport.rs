//! Stored transport: what the rays of a solve over cells bring, with reflectances and emission left open, so that the same surfaces can be solved for
//! other materials without a ray.
//!
//! Where paths go hangs on geometry and random numbers. Which of them are taken hangs on the materials that were solved, and so does how noisy their sum
//! is for others: the error is estimated anew, by the rays of the replicates, which are stored as well.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::judge::{Judge, cell_seed};
use super::linked::Linked;
use super::plan::Plan;
use super::report::TransportReport;
use crate::cells::{CellRadiosities, RowMaterials, StoredRows};
use crate::error::{ErrorEstimate, ErrorNorm, REPLICATES, SampleRecorder, StoredSamples};
use crate::paths::{Brightness, LightPaths, ProductNumbers, Products};
use crate::progress::{Stage, Stop};
use crate::scene::{Scene, SurfaceId};
use crate::values::RayBudget;

/// What is stored to solve again for other materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Transport {
    products: Products,
    /// By material: whether it reflected or emitted, so that paths were followed from there.
    is_followed: Vec<bool>,
    /// By material: whether next-event estimation brings its emission.
    is_sampled: Vec<bool>,
    /// By material: whether it reflected, and whether it emitted.
    had_light: Vec<[bool; 2]>,
    /// By surface, what it reflected as it was solved, in W/m^2 in its brightest channel: by that cells are laid out.
    reflected: Vec<f64>,
    /// Of values, then of replicates.
    rows: Vec<StoredRows>,
    samples: StoredSamples,
}

/// Bytes of each path that is recorded, at work and stored: some three terms, of 24 and 12 bytes.
const BYTES_OF_PATH: u64 = 3 * (24 + 12);

impl Transport {
    /// Whether there is memory to record it, and to keep it.
    pub(super) fn has_room(linked: &mut Linked<'_>, plan: &Plan, judge: &Judge<'_>) -> bool {
        let (job, Some(demand)) = (linked.job, linked.cell_demand(plan)) else { return false };
        let of_cell = u64::from(plan.resolution().rays) + REPLICATES as u64 * u64::from(plan.replicate_resolution().rays);
        let of_points = judge.replicate_rays() + 2 * plan.error_points() as u64 * u64::from(plan.point_rays());
        let recorded = (demand.cells as u64 * of_cell + of_points) * BYTES_OF_PATH;
        let bytes = job.memory.kept(linked.holdings()) + demand.bytes(job.scene) + recorded;
        let is_allowed = job.memory.allows(bytes) && job.observer.allows_memory(bytes);
        if is_allowed {
            linked.account(bytes);
        }
        is_allowed
    }

    /// Follows all paths of the solve again, and keeps what they bring; `None` if stopped before.
    pub(super) fn record(linked: &Linked<'_>, plan: &Plan, judge: &Judge<'_>, point_rays: u32) -> Option<Self> {
        let job = linked.job;
        let (scene, apart) = job.scene.with_emission_apart();
        let brightness = linked.brightness();
        let paths = LightPaths::new(&scene, job.rays, &brightness, plan.resolution().size, &job.stop());
        let questions = (1 + REPLICATES) * CellRadiosities::questions(paths.grids.cells()) + plan.error_points();
        let stop = linked.stop_telling(Stage::Cells, questions);

        let mut numbers = ProductNumbers::default();
        let rows = (0..=REPLICATES as u64).map(|number| {
            let rays = if number == 0 { plan.resolution().rays } else { plan.replicate_resolution().rays };
            StoredRows::record(&paths, &apart, (rays, cell_seed(job.options.seed, number)), &mut numbers, &stop)
        });
        let rows = rows.collect::<Option<_>>()?;
        let budget = RayBudget::of_values(point_rays, job.options.seed);
        let samples = judge.record(&SampleRecorder { paths: &paths, apart: &apart, budget }, &mut numbers, &stop)?;

        let surfaces = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let mut is_sampled = vec![false; scene.materials().len()];
        for surface in surfaces().filter(|&surface| paths.unsampled_exitance(surface).is_none()) {
            is_sampled[scene.surface(surface).material as usize] = true;
        }
        let materials = job.scene.materials().iter().zip(&is_sampled);
        let is_followed = materials
            .map(|(material, is_sampled)| material.reflectance.iter().any(|&rho| rho > 0.0) || (material.emits() && !is_sampled));
        let reflected = surfaces().map(|surface| linked.radiosity.reflected(job.scene, &linked.hierarchy, surface));
        let (is_followed, reflected) = (is_followed.collect(), reflected.collect());
        let had_light = light_of_materials(job.scene).collect();
        Some(Self { products: numbers.finish(), is_followed, is_sampled, had_light, reflected, rows, samples })
    }

    /// How bright surfaces were as they were solved.
    pub fn brightness(&self, scene: &Scene) -> Brightness {
        Brightness::of_surfaces(scene, |surface| self.reflected[surface.index()])
    }

    /// Whether paths were followed from surfaces of a material.
    pub fn follows(&self, material: usize) -> bool {
        self.is_followed[material]
    }

    /// The cell radiosities of a scene whose materials may be others, and the error of values over them; `None` if stopped before.
    pub fn solve(&self, scene: &Scene, norm: ErrorNorm, stop: Stop<'_>) -> Option<(CellRadiosities, ErrorEstimate)> {
        let products = self.products.of(scene.materials(), scene.channels());
        let emission = scene.emission_by_source();
        let with = RowMaterials { scene, products: &products, emission: &emission, is_sampled: &self.is_sampled };
        let mut cells = self.rows.par_iter().map(|rows| rows.solve(&with, stop)).collect::<Option<Vec<_>>>()?;
        let onward = cells.split_off(1);
        let of_values = cells.pop()?;
        let no_new_light = light_of_materials(scene).zip(&self.had_light).all(|(now, had)| now[0] <= had[0] && now[1] <= had[1]);
        let is_known = onward.iter().all(|cells| cells.is_valid(of_values.cells(), scene.channels()));
        let estimate = || self.samples.estimate(norm, &with, (&of_values, &onward), no_new_light);
        let error = if is_known { estimate() } else { ErrorEstimate::UNKNOWN };
        Some((of_values, error))
    }

    /// What is stored.
    pub fn report(&self) -> TransportReport {
        let cells = self.rows.first().map_or(0, StoredRows::cells);
        let terms = self.rows.iter().map(StoredRows::terms).sum::<usize>() + self.samples.terms();
        TransportReport {
            cells: cells as u64,
            terms: terms as u64,
            products: self.products.len() as u64,
            bytes: self.memory_bytes(),
        }
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        self.products.memory_bytes()
            + self.rows.iter().map(StoredRows::memory_bytes).sum::<u64>()
            + self.samples.memory_bytes()
            + size_of_val(&*self.reflected) as u64
    }

    /// Whether what surfaces reflected is told for all of a scene, in range.
    pub fn tells_brightness(&self, scene: &Scene) -> bool {
        let is_light = |reflected: &f64| (0.0..=f64::from(f32::MAX)).contains(reflected);
        self.reflected.len() == scene.surfaces().len() && self.reflected.iter().all(is_light)
    }

    /// Whether all of it fits a scene with so many cells.
    pub fn is_valid(&self, scene: &Scene, cells: usize) -> bool {
        let (materials, products) = (scene.materials().len(), self.products.len());
        self.products.are_valid(materials)
            && [self.is_followed.len(), self.is_sampled.len()] == [materials; 2]
            && self.had_light.len() == materials
            && self.rows.len() == 1 + REPLICATES
            && self.rows.iter().all(|rows| rows.is_valid(scene, cells, products))
            && self.samples.is_valid(scene, cells, products)
    }
}

/// By material: whether it reflects, and whether it emits, in any channel.
fn light_of_materials(scene: &Scene) -> impl Iterator<Item = [bool; 2]> {
    scene.materials().iter().map(|material| [material.reflectance.iter().any(|&rho| rho > 0.0), material.emits()])
}
