//! Samples of the error as they are kept to be judged again for other materials: what their rays bring, with reflectances, emission and radiosities of
//! cells left open.
//!
//! Points, rays and random numbers are those of the solve that was recorded, so estimates for other materials are as good as that, in all but where
//! the points lie: more of them lie where it was bright then.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::compared::{Judging, by_other_rays};
use super::estimate::{ErrorEstimate, ErrorSamples, EstimateLit, TWICE};
use super::norm::{ErrorNorm, Lit};
use super::replicates::{ErrorSample, REPLICATES, Searched};
use crate::cells::{CellRadiosities, RowMaterials};
use crate::geometry::{sampling, streams};
use crate::paths::{
    Brought, Course, LightPaths, PathScratch, PathTerm, Place, ProductNumbers, RowTerm, Terms, Trail, UNREFLECTED, place_at,
};
use crate::progress::Stop;
use crate::scene::{EmissionApart, Scene, SurfaceId};
use crate::values::{GatherRecorder, Gathered, RayBudget, emitter_rays};

/// Points with what their rays bring.
///
/// Sources are numbered: those of emission, the cells of values, and the cells of one replicate after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredSamples {
    /// By point.
    surface: Vec<u32>,
    /// By point, the area in m^2 that it stands for if it is the only one.
    stands_for: Vec<f64>,
    /// By point, what a search for light found.
    searched: Vec<Option<Searched>>,
    /// By point and replicate: by how much the irradiance of values is too large.
    residuals: Terms,
    /// By point, two of each: the irradiance of values; the second one has no terms where it was not taken.
    values: Terms,
}

/// Records samples, whose paths keep emission apart.
pub(crate) struct SampleRecorder<'a> {
    pub paths: &'a LightPaths<'a>,
    pub apart: &'a EmissionApart,
    /// Of values.
    pub budget: RayBudget,
}

/// The terms of a point: of replicates, and of values.
#[derive(Default)]
struct PointTerms {
    steps: Vec<[u32; 2]>,
    residuals: Vec<RowTerm>,
    values: Vec<RowTerm>,
}

impl SampleRecorder<'_> {
    /// Records all samples anew, each with as many rays as it has; `None` if stopped before, or if there are more cells than can be numbered.
    pub fn record(&self, samples: &ErrorSamples, numbers: &mut ProductNumbers, stop: Stop<'_>) -> Option<StoredSamples> {
        let cells = self.paths.grids.cells();
        u32::try_from(self.paths.scene.emission_sources() + cells * (1 + REPLICATES)).ok()?;
        let of_point = |scratch: &mut PathScratch, (index, sample): (usize, &ErrorSample)| {
            if stop() { PointTerms::default() } else { self.record_point(index, sample, scratch) }
        };
        let points: Vec<PointTerms> =
            samples.samples.par_iter().enumerate().map_init(PathScratch::default, |scratch, of| of_point(scratch, of)).collect();
        if stop() {
            return None;
        }

        let samples = &samples.samples;
        let mut stored = StoredSamples {
            surface: samples.iter().map(|sample| sample.place.surface.0).collect(),
            stands_for: samples.iter().map(|sample| sample.stands_for).collect(),
            searched: samples.iter().map(|sample| sample.searched).collect(),
            residuals: Terms::default(),
            values: Terms::default(),
        };
        for mut point in points {
            let numbers = numbers.of_trail(&point.steps);
            stored.residuals.append(REPLICATES, &mut point.residuals, &numbers);
            stored.values.append(2, &mut point.values, &numbers);
        }
        Some(stored)
    }

    fn record_point(&self, index: usize, sample: &ErrorSample, scratch: &mut PathScratch) -> PointTerms {
        scratch.ends.keep_trail(Trail::new(self.apart));
        let mut terms = PointTerms::default();
        for replicate in 0..REPLICATES {
            let seed = sampling::hash(sample.place.seed, streams::replicate(replicate as u8));
            let place = Place { seed, ..sample.place };
            self.record_residual((place, sample.rays.max(1)), replicate, scratch, &mut terms.residuals);
        }
        let budgets = [Some(self.budget), index.is_multiple_of(TWICE).then(|| by_other_rays(self.budget))];
        let recorder = GatherRecorder { paths: self.paths, apart: self.apart };
        for (row, budget) in (0..).zip(budgets) {
            let Some(RayBudget { rays, seed, .. }) = budget else { continue };
            let place = place_at(sample.place.point, sample.place.surface, seed);
            let mut visit = |_, product, what, weight| {
                terms.values.push(RowTerm { row, product, source: self.source(what, None), weight });
            };
            recorder.irradiance_of_value(place, rays, scratch, &mut visit);
        }
        terms.steps = scratch.ends.trail.take().map(|trail| trail.steps).unwrap_or_default();
        terms
    }

    /// Records what [`ResidualGather`](super::ResidualGather) samples.
    fn record_residual(&self, (place, rays): (Place, u32), replicate: usize, scratch: &mut PathScratch, terms: &mut Vec<RowTerm>) {
        let mut push = |product: u32, source: u32, weight: f64| {
            terms.push(RowTerm { row: replicate as u32, product, source, weight });
        };
        let (of_values, onward) = (|what| self.source(what, None), |what| self.source(what, Some(replicate)));

        // Indirect light: a value's path ends where it may, the longer one goes on.
        let share = 1.0 / f64::from(rays);
        self.paths.follow(&[place], &Course::past_values(rays, 1), scratch);
        let ends = &scratch.ends;
        let at_value_ends = ends.trail.iter().flat_map(|trail| &trail.value_ends);
        for (end, &(product, weight)) in ends.value_ends.iter().zip(at_value_ends) {
            push(product, of_values(Brought::End(end.cell)), share * weight);
        }
        ends.for_each_term(rays as usize, |PathTerm { is_of_value, product, what, weight, .. }| {
            let is_emission = matches!(what, Brought::Emission(_));
            if is_of_value && !is_emission {
                push(product, of_values(what), share * weight);
            }
            if !is_of_value || !is_emission {
                push(product, onward(what), -share * weight);
            }
        });

        // Bright reflectors: the radiosity of the cell, and that at the point.
        self.paths.see_reflectors(&[place], emitter_rays(rays), scratch);
        let seen = std::mem::take(&mut scratch.seen);
        seen.iter().for_each(|seen| push(UNREFLECTED, of_values(Brought::Seen(seen.cell)), seen.weight));
        let recorder = GatherRecorder { paths: self.paths, apart: self.apart };
        let mut visit = |number: usize, product, what, weight: f64| push(product, onward(what), -seen[number].weight * weight);
        recorder.sent(&place, &seen, scratch, &mut visit);
        scratch.seen = seen;
    }

    /// The number of a source, with the cells of values, or of a replicate.
    fn source(&self, what: Brought, replicate: Option<usize>) -> u32 {
        let (emission, cells) = (self.paths.scene.emission_sources(), self.paths.grids.cells());
        match what {
            Brought::Emission(source) => source,
            Brought::End(cell) | Brought::Seen(cell) => (emission + replicate.map_or(0, |number| 1 + number) * cells) as u32 + cell,
        }
    }
}

impl StoredSamples {
    /// The error with these materials, of values and replicates over these cells. Where no light came is known from before, if `no_new_light`:
    /// no material reflects or emits that did not as it was recorded.
    pub fn estimate(
        &self,
        norm: ErrorNorm,
        with: &RowMaterials<'_>,
        (of_values, onward): (&CellRadiosities, &[CellRadiosities]),
        no_new_light: bool,
    ) -> ErrorEstimate {
        let (scene, channels) = (with.scene, with.scene.channels());
        let of_cells = std::iter::once(of_values).chain(onward).flat_map(|cells| cells.values());
        let sources: Vec<f64> = with.emission.iter().copied().chain(of_cells.map(|&sent| f64::from(sent))).collect();
        let irradiance = |terms: &Terms, row: usize| {
            let mut irradiance = vec![0.0; channels];
            terms.add_row(row, with.products, &sources, &mut irradiance);
            irradiance
        };
        let value = |surface: SurfaceId, row: usize| {
            let (material, mut radiosity) = (scene.material_of(surface), irradiance(&self.values, row));
            radiosity.iter_mut().zip(&material.reflectance).for_each(|(b, rho)| *b *= rho);
            scene.clear_dark(&mut radiosity);
            radiosity.iter_mut().zip(&material.exitance).for_each(|(b, e)| *b += e);
            Gathered { radiosity, ..Gathered::default() }
        };
        let point = |(index, &surface): (usize, &u32)| {
            let surface = SurfaceId(surface);
            let sample = ErrorSample {
                place: Place { point: DVec3::ZERO, surface, seed: 0 },
                stands_for: self.stands_for[index],
                found: std::array::from_fn(|replicate| irradiance(&self.residuals, index * REPLICATES + replicate)),
                of_unresolved: std::array::from_fn(|_| vec![0.0; channels]),
                rays: 0,
                noise: 0.0,
                noisiness: 0.0,
                searched: self.searched[index],
            };
            let first = value(surface, 2 * index);
            let second = if index.is_multiple_of(TWICE) { value(surface, 2 * index + 1) } else { first.clone() };
            (sample, [first, second])
        };
        let (samples, values) = self.surface.par_iter().enumerate().map(point).unzip();
        let mut all = ErrorSamples::new(norm);
        (all.samples, all.values) = (samples, values);
        let judging = Judging { scene, is_taken_twice: true };
        let locally = |own: &mut ErrorSamples, lit: &mut [Lit], estimate: &EstimateLit<'_>| {
            Some(own.with_area_searched_before(lit, estimate, no_new_light))
        };
        let found = all.estimate_taken(judging, locally).unwrap_or(ErrorEstimate::UNKNOWN);

        // Light that no point has found may be somewhere all the same.
        let is_lit = with.emission.iter().any(|&emission| emission > 0.0);
        let is_reflected = is_lit && scene.materials().iter().any(|material| material.reflectance.iter().any(|&rho| rho > 0.0));
        if (is_reflected && found.lit == 0.0) || found.claimed.is_nan() { ErrorEstimate::UNKNOWN } else { found }
    }

    /// How many terms there are.
    pub fn terms(&self) -> usize {
        self.residuals.len() + self.values.len()
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        let terms = self.residuals.memory_bytes() + self.values.memory_bytes();
        terms + (size_of_val(&*self.surface) + size_of_val(&*self.stands_for) + size_of_val(&*self.searched)) as u64
    }

    /// Whether it fits a scene, so many cells and so many products.
    pub fn is_valid(&self, scene: &Scene, cells: usize, products: usize) -> bool {
        let points = self.surface.len();
        let sources = scene.emission_sources() + cells * (1 + REPLICATES);
        self.surface.iter().all(|&surface| (surface as usize) < scene.surfaces().len())
            && self.stands_for.len() == points
            && self.stands_for.iter().all(|area| area.is_finite() && *area > 0.0)
            && self.searched.len() == points
            && self.searched.iter().flatten().all(|searched| searched.light.is_finite() && searched.light >= 0.0)
            && self.residuals.are_valid(points * REPLICATES, products, sources)
            && self.values.are_valid(2 * points, products, sources)
    }
}
