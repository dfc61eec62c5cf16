//! Builds the irradiance cache of a set of points.
//!
//! Indirect light mostly varies slowly, direct light does not. Where points lie close, records are taken in cells of their planes,
//! from large cells to small ones. A point takes its indirect irradiance from a fit through the records around it, where the fit is
//! good enough. Records are taken only where they are fewer than the points that need them, so a few points use no cache.
//!
//! Values by the cache must be as good as others, or the claimed error would not hold for them. So at random control points two
//! independent gathers are compared with the fit: the mean product of the two differences is the fit's mean squared error, free of
//! noise. Where fits have less noise than gathers, the other points may take fewer rays, so that the mean squared error over all
//! stays the same. If nothing is saved that way, the cache is not used.

use std::collections::HashMap;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::plane_cells::{CellKey, PlaneCells};
use super::record::{Fitted, Record, Recorder, Site};
use crate::geometry::{sampling, streams};
use crate::hierarchy::Hierarchy;
use crate::paths::{BatchSums, PathScratch, Place};
use crate::scene::Scene;
use crate::values::budget::NOISE_POWER;
use crate::values::final_gather::FinalGather;

/// The size of the largest cells, as a part of the side of a square with the area of all surfaces that points lie on.
const FIRST_CELL: f64 = 1.0 / 32.0;

/// So many levels of cells at most, each of half the size of the one before.
const LEVELS: i32 = 8;

/// Records are taken around a cell with at least so many points.
const LEAST_POINTS: usize = 6;

/// Records of a level are taken only if so many points or more share each on average.
const POINTS_PER_RECORD: usize = 2;

/// How many cells a fit reaches to every side, as in `record`, rounded up.
const CELLS_AROUND: i64 = 2;

/// Control points, at which the fit is compared with gathers.
const CONTROLS: usize = 512;

/// The fit's squared error is taken at so many standard deviations above its mean.
const CONFIDENCE_SIGMAS: f64 = 2.0;

/// Rays to a point are divided by at most this.
const MOST_SPARED: f64 = 2.0;

/// Records taken together.
const BATCH: usize = 16;

/// Indirect irradiance at points, and how many rays the others take.
pub(crate) struct IrradianceCache {
    channels: usize,
    /// By point and channel; NaN where a point gathers itself.
    irradiance: Vec<Fitted>,
    /// Rays from each point: for gathers, and for direct light.
    pub rays: u32,
}

/// A control point.
#[derive(Serialize, Deserialize)]
struct Control {
    index: usize,
    /// The reflected indirect and direct light by two independent gathers, in W/m^2 by channel.
    indirect: [Vec<f64>; 2],
    direct: [Vec<f64>; 2],
}

/// Builds the irradiance cache of some places.
pub(crate) struct CacheBuilder<'a> {
    pub gather: &'a FinalGather<'a>,
    pub hierarchy: &'a Hierarchy,
    /// Rays to a point.
    pub rays: u32,
    pub seed: u64,
    /// A point lies on a surface within so many metres.
    pub tolerance: f64,
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl IrradianceCache {
    /// A cache that holds nothing.
    fn none(channels: usize, places: usize, rays: u32) -> Self {
        Self { channels, irradiance: vec![Fitted::NONE; channels * places], rays }
    }

    /// The indirect irradiance at place number `index`, by channel, if the cache has it.
    pub fn of(&self, index: usize) -> Option<&[Fitted]> {
        let irradiance = &self.irradiance[index * self.channels..][..self.channels];
        (!irradiance[0].irradiance.is_nan()).then_some(irradiance)
    }
}

impl CacheBuilder<'_> {
    /// Builds the cache for `places`.
    pub fn build(&self, places: &[Option<Place>]) -> IrradianceCache {
        let scene = self.gather.paths.scene;
        let channels = scene.channels();
        let mut cache = IrradianceCache::none(channels, places.len(), self.rays);
        let cells = PlaneCells::new(scene);
        let area = area_with_places(scene, places);
        let mut left: Vec<usize> = (0..places.len()).filter(|&index| places[index].is_some()).collect();
        let mut controls = Vec::new();

        // From large cells to small ones, while enough points are left for the records that a level needs.
        for size in (0..LEVELS).map(|level| FIRST_CELL * area.sqrt() * 0.5_f64.powi(level)) {
            let open = crowded_cells(&cells, places, &left, size);
            let groups: Vec<&[(CellKey, usize)]> = open.chunk_by(|a, b| a.0 == b.0).collect();
            let mut wanted: Vec<CellKey> = groups.iter().flat_map(|group| group[0].0.around(CELLS_AROUND)).collect();
            wanted.par_sort_unstable();
            wanted.dedup();
            let Self { gather, hierarchy, rays, seed, tolerance, .. } = *self;
            let recorder = Recorder { gather, hierarchy, cells: &cells, paths: rays, seed, size, tolerance };
            let sites: Vec<(CellKey, Site)> = wanted.par_iter().filter_map(|&cell| Some((cell, recorder.site(cell)?))).collect();
            if sites.len() * POINTS_PER_RECORD > open.len() || open.is_empty() || (self.cancelled)() {
                break;
            }
            if controls.is_empty() {
                controls = self.controls(places, &left);
            }

            // Fits that are as good as a gather go into the cache.
            let records = self.records(&recorder, &sites);
            let allowed_sq = mean_noise_sq(&controls);
            let fitted = groups.into_par_iter().flat_map_iter(|group| {
                let around: Vec<&Record> = group[0].0.around(CELLS_AROUND).filter_map(|cell| records.get(&cell)).collect();
                let mut irradiance = vec![Fitted::NONE; channels];
                let fit = |&(_, index): &(CellKey, usize)| {
                    let place = places[index].as_ref()?;
                    let is_good = recorder.fit(place, &around, allowed_sq, &mut irradiance);
                    is_good.then(|| (index, irradiance.clone()))
                };
                group.iter().filter_map(fit).collect::<Vec<_>>()
            });
            for (index, irradiance) in fitted.collect::<Vec<_>>() {
                cache.irradiance[index * channels..][..channels].copy_from_slice(&irradiance);
            }
            left.retain(|&index| cache.of(index).is_none());
        }
        if controls.is_empty() { cache } else { self.spare_rays(&controls, places, cache) }
    }

    /// The records of cells.
    fn records(&self, recorder: &Recorder<'_>, sites: &[(CellKey, Site)]) -> HashMap<CellKey, Record> {
        let share = self.gather.paths.rays.share();
        let of_batch = |scratch: &mut PathScratch, (number, sites): (usize, &[(CellKey, Site)])| -> Vec<(CellKey, Record)> {
            if (self.cancelled)() || !share.has(number) {
                return Vec::new();
            }
            sites.iter().map(|(cell, site)| (*cell, recorder.record(site, scratch))).collect()
        };
        let mut records: Vec<Vec<(CellKey, Record)>> =
            sites.par_chunks(BATCH).enumerate().map_init(PathScratch::default, of_batch).collect();
        share.exchange(&mut records);
        records.into_iter().flatten().collect()
    }

    /// Draws control points among the places `left`, one in each of as many strata, and gathers twice at each.
    fn controls(&self, places: &[Option<Place>], left: &[usize]) -> Vec<Control> {
        let count = CONTROLS.min(left.len());
        let drawn = (0..count).map(|number| {
            let random = sampling::unit(sampling::hash(self.seed, streams::CACHE_CONTROLS + number as u64));
            left[((number as f64 + random) / count as f64 * left.len() as f64) as usize]
        });
        let drawn: Vec<usize> = drawn.collect();

        // Two gathers at each.
        let share = self.gather.paths.rays.share();
        let gather = |scratch: &mut PathScratch, (number, index): (usize, usize)| {
            let place = places[index].filter(|_| share.has(number))?;
            let material = self.gather.paths.scene.material_of(place.surface);
            let reflected = |half: u64, take: &mut dyn FnMut(Place, &mut BatchSums<'_>)| {
                let mut irradiance = vec![0.0; material.reflectance.len()];
                let place = Place { seed: sampling::hash(place.seed, streams::CONTROL_GATHERS + half), ..place };
                take(place, &mut BatchSums::whole(material.reflectance.len(), &mut irradiance));
                irradiance.iter_mut().zip(&material.reflectance).for_each(|(h, rho)| *h *= rho);
                irradiance
            };
            let indirect = [0, 1].map(|half| {
                reflected(half, &mut |place, irradiance| self.gather.add_sampled_indirect(&[place], self.rays, scratch, irradiance))
            });
            let direct = [0, 1].map(|half| {
                reflected(half, &mut |place, irradiance| self.gather.add_sampled_direct(&[place], self.rays, scratch, irradiance))
            });
            Some(Control { index, indirect, direct })
        };
        let mut controls: Vec<Option<Control>> = drawn.into_par_iter().enumerate().map_init(PathScratch::default, gather).collect();
        share.exchange(&mut controls);
        controls.into_iter().flatten().collect()
    }

    /// Cuts the rays of all points by what the cache saves in noise, or drops the cache if it saves nothing.
    fn spare_rays(&self, controls: &[Control], places: &[Option<Place>], cache: IrradianceCache) -> IrradianceCache {
        let scene = self.gather.paths.scene;
        let count = controls.len() as f64;
        let noise_sq = mean_noise_sq(controls);

        // The fits' squared error, and the gathers' noise that they replace.
        let (mut spared_sq, mut sum, mut sum_sq) = (0.0, 0.0, 0.0);
        for control in controls {
            let (Some(irradiance), Some(place)) = (cache.of(control.index), &places[control.index]) else { continue };
            let reflectance = &scene.material_of(place.surface).reflectance;
            let [first, second] = &control.indirect;
            let off = |channel: usize, own: &[f64]| reflectance[channel] * f64::from(irradiance[channel].irradiance) - own[channel];
            let wrong_sq: f64 = (0..scene.channels()).map(|channel| off(channel, first) * off(channel, second)).sum();
            sum += wrong_sq;
            sum_sq += wrong_sq * wrong_sq;
            spared_sq += variance(first, second) / count;
        }

        // By so much the noise that is left may grow.
        let wrong_sq = ((sum + CONFIDENCE_SIGMAS * sum_sq.sqrt()) / count).max(0.0);
        let louder = (noise_sq - wrong_sq) / (noise_sq - spared_sq);
        let is_spared = louder >= 1.0 && noise_sq > spared_sq;
        if !is_spared {
            return IrradianceCache::none(scene.channels(), places.len(), self.rays);
        }
        let fewer = louder.powf(1.0 / NOISE_POWER).min(MOST_SPARED);
        IrradianceCache { rays: (f64::from(self.rays) / fewer).ceil() as u32, ..cache }
    }
}

/// The area of the surfaces that places lie on, in m^2.
fn area_with_places(scene: &Scene, places: &[Option<Place>]) -> f64 {
    let mut has_place = vec![false; scene.surfaces().len()];
    places.iter().flatten().for_each(|place| has_place[place.surface.index()] = true);
    scene.surfaces().iter().zip(has_place).filter(|(_, has)| *has).map(|(surface, _)| surface.polygon.area()).sum()
}

/// Those of the places `left` that share their cell with enough others, by cell.
fn crowded_cells(cells: &PlaneCells<'_>, places: &[Option<Place>], left: &[usize], size: f64) -> Vec<(CellKey, usize)> {
    let keyed = |&index: &usize| places[index].as_ref().map(|place| (cells.cell_at(place.surface, place.point, size), index));
    let mut keyed: Vec<(CellKey, usize)> = left.par_iter().filter_map(keyed).collect();
    keyed.par_sort_unstable();
    keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() >= LEAST_POINTS).flatten().copied().collect()
}

/// The mean variance of gathered values, summed over the channels.
fn mean_noise_sq(controls: &[Control]) -> f64 {
    controls.iter().map(Control::noise_sq).sum::<f64>() / controls.len() as f64
}

impl Control {
    /// The variance of a gathered value, summed over the channels.
    fn noise_sq(&self) -> f64 {
        let whole = |half: usize| -> Vec<f64> { self.indirect[half].iter().zip(&self.direct[half]).map(|(a, b)| a + b).collect() };
        variance(&whole(0), &whole(1))
    }
}

/// The variance of two samples, summed over the channels.
fn variance(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
}
