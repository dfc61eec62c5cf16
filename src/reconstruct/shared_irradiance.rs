//! Indirect irradiance that many points share.
//!
//! Direct light changes within a finger's breadth, indirect light mostly does not. Where points lie close, records are taken in cells
//! of their planes, from large cells to small ones, and a point takes its indirect irradiance from a fit through the records around
//! it wherever that can be trusted. Cells have records only where more points than these ask for it, so few points share nothing.
//!
//! Values that share must be as good as those that do not, or a claim made for these would not hold. At some points, drawn at random,
//! both are taken: two gathers of the point's own are set against the fit, whose error is the mean product of the differences, free of
//! the noise of either. What sharing spares in noise, the other points may spend, so that the mean square stays what it was; if it
//! spares nothing, nothing is shared.

use std::collections::HashMap;

use rayon::prelude::*;

use super::hemisphere::HemisphereGather;
use super::irradiance_record::{Record, Recorder, Seat};
use super::light_paths::{PathScratch, Place};
use super::plane_cells::{CellKey, PlaneCells};
use crate::geometry::sampling;
use crate::hierarchy::Hierarchy;

/// The first cells have this part of the side of a square with the area of all surfaces.
const FIRST_CELL: f64 = 1.0 / 32.0;

/// Each level of cells is half as large as the one before; so many levels at most.
const LEVELS: i32 = 8;

/// Points in a cell that make records worth it.
const LEAST_POINTS: usize = 6;

/// Records of a level are taken only if there are so many times as many points for them.
const POINTS_PER_RECORD: usize = 2;

/// How many cells a fit reaches to every side, rounded up.
const CELLS_AROUND: i64 = 2;

/// Points at which shared values are set against own ones.
const CONTROLS: usize = 512;

/// The limit that must hold for the error of what is shared lies so many standard deviations above its mean.
const CONFIDENCE_SIGMAS: f64 = 2.0;

/// The variance of a gather falls with this power of its rays, or a higher one: they are spread evenly.
const NOISE_POWER: f64 = 1.4;

/// The most that rays to a point are cut by.
const MOST_SPARED: f64 = 2.0;

/// Records taken together.
const BATCH: usize = 16;

/// What points share, and how many rays are enough for the rest.
pub(super) struct SharedIrradiance {
    channels: usize,
    /// In W/m^2, by point and channel; NaN where a point gathers its own.
    irradiance: Vec<f32>,
    /// Rays of gathers of a point's own, and for direct light.
    pub rays: u32,
}

/// What is known at a control.
struct Control {
    index: usize,
    /// The reflected radiosity by two gathers of its own, in W/m^2 by channel: indirect and direct light.
    indirect: [Vec<f64>; 2],
    direct: [Vec<f64>; 2],
}

/// Shares among places.
pub(super) struct Sharing<'a> {
    pub gather: &'a HemisphereGather<'a>,
    pub hierarchy: &'a Hierarchy,
    /// Rays to a point.
    pub rays: u32,
    pub seed: u64,
    /// A point lies on a surface within so many metres.
    pub tolerance: f64,
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl SharedIrradiance {
    /// Nothing is shared.
    fn none(channels: usize, places: usize, rays: u32) -> Self {
        Self { channels, irradiance: vec![f32::NAN; channels * places], rays }
    }

    /// What the place number `index` shares with others.
    pub fn of(&self, index: usize) -> Option<&[f32]> {
        let irradiance = &self.irradiance[index * self.channels..][..self.channels];
        (!irradiance[0].is_nan()).then_some(irradiance)
    }
}

impl Sharing<'_> {
    /// Finds what `places` share.
    pub fn share(&self, places: &[Option<Place>]) -> SharedIrradiance {
        let scene = self.gather.paths.scene;
        let channels = scene.channels();
        let mut shared = SharedIrradiance::none(channels, places.len(), self.rays);
        let cells = PlaneCells::new(scene);
        let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
        let mut left: Vec<usize> = (0..places.len()).filter(|&index| places[index].is_some()).collect();
        let mut controls = Vec::new();

        // From large cells to small ones, for the points that are left, while there are many more of them than records.
        for size in (0..LEVELS).map(|level| FIRST_CELL * area.sqrt() * 0.5_f64.powi(level)) {
            let open = crowded_cells(&cells, places, &left, size);
            let groups: Vec<&[(CellKey, usize)]> = open.chunk_by(|a, b| a.0 == b.0).collect();
            let mut wanted: Vec<CellKey> = groups.iter().flat_map(|group| group[0].0.around(CELLS_AROUND)).collect();
            wanted.par_sort_unstable();
            wanted.dedup();
            let Self { gather, hierarchy, rays, seed, tolerance, .. } = *self;
            let recorder = Recorder { gather, hierarchy, cells: &cells, paths: rays, seed, size, tolerance };
            let seats: Vec<(CellKey, Seat)> = wanted.par_iter().filter_map(|&cell| Some((cell, recorder.seat(cell)?))).collect();
            if seats.len() * POINTS_PER_RECORD > open.len() || open.is_empty() || (self.cancelled)() {
                break;
            }
            if controls.is_empty() {
                controls = self.controls(places, &left);
            }

            // A fit is trusted as far as a gather of the point's own.
            let records = self.records(&recorder, &seats);
            let allowed_sq = mean_noise_sq(&controls);
            let fitted = groups.into_par_iter().flat_map_iter(|group| {
                let around: Vec<&Record> = group[0].0.around(CELLS_AROUND).filter_map(|cell| records.get(&cell)).collect();
                let mut irradiance = vec![0.0; channels];
                let fit = |&(_, index): &(CellKey, usize)| {
                    let place = places[index].as_ref()?;
                    let is_good = recorder.fit(place, &around, allowed_sq, &mut irradiance);
                    is_good.then(|| (index, irradiance.clone()))
                };
                group.iter().filter_map(fit).collect::<Vec<_>>()
            });
            for (index, irradiance) in fitted.collect::<Vec<_>>() {
                let own = &mut shared.irradiance[index * channels..][..channels];
                own.iter_mut().zip(irradiance).for_each(|(own, fitted)| *own = fitted as f32);
            }
            left.retain(|&index| shared.of(index).is_none());
        }
        if controls.is_empty() { shared } else { self.spare_rays(&controls, places, shared) }
    }

    /// The records of cells.
    fn records(&self, recorder: &Recorder<'_>, seats: &[(CellKey, Seat)]) -> HashMap<CellKey, Record> {
        let of_batch = |scratch: &mut PathScratch, seats: &[(CellKey, Seat)]| -> Vec<(CellKey, Record)> {
            if (self.cancelled)() {
                return Vec::new();
            }
            seats.iter().map(|(cell, seat)| (*cell, recorder.record(seat, scratch))).collect()
        };
        seats.par_chunks(BATCH).map_init(PathScratch::default, of_batch).flatten_iter().collect()
    }

    /// Gathers twice at some of the places.
    fn controls(&self, places: &[Option<Place>], left: &[usize]) -> Vec<Control> {
        let count = CONTROLS.min(left.len());
        let drawn = (0..count).map(|number| {
            let random = sampling::unit(sampling::hash(self.seed, 0xc0_u64 << 32 | number as u64));
            left[((number as f64 + random) / count as f64 * left.len() as f64) as usize]
        });
        let drawn: Vec<usize> = drawn.collect();
        let gather = |scratch: &mut PathScratch, index: usize| {
            let place = places[index]?;
            let material = self.gather.paths.scene.material_of(place.surface);
            let reflected = |half: u64, take: &mut dyn FnMut(Place, &mut [f64])| {
                let mut irradiance = vec![0.0; material.reflectance.len()];
                take(Place { seed: sampling::hash(place.seed, 100 + half), ..place }, &mut irradiance);
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
        drawn.into_par_iter().map_init(PathScratch::default, gather).flatten_iter().collect()
    }

    /// Spends what sharing spares in noise on fewer rays for the rest, or gives sharing up.
    fn spare_rays(&self, controls: &[Control], places: &[Option<Place>], shared: SharedIrradiance) -> SharedIrradiance {
        let scene = self.gather.paths.scene;
        let count = controls.len() as f64;
        let noise_sq = mean_noise_sq(controls);
        let (mut spared_sq, mut sum, mut sum_sq) = (0.0, 0.0, 0.0);
        for control in controls {
            let (Some(irradiance), Some(place)) = (shared.of(control.index), &places[control.index]) else { continue };
            let reflectance = &scene.material_of(place.surface).reflectance;
            let [first, second] = &control.indirect;
            let off = |channel: usize, own: &[f64]| reflectance[channel] * f64::from(irradiance[channel]) - own[channel];
            let wrong_sq: f64 = (0..scene.channels()).map(|channel| off(channel, first) * off(channel, second)).sum();
            sum += wrong_sq;
            sum_sq += wrong_sq * wrong_sq;
            spared_sq += variance(first, second) / count;
        }

        // The noise that is left beside what the fits have wrong may be louder by so much.
        let wrong_sq = ((sum + CONFIDENCE_SIGMAS * sum_sq.sqrt()) / count).max(0.0);
        let louder = (noise_sq - wrong_sq) / (noise_sq - spared_sq);
        let is_spared = louder >= 1.0 && noise_sq > spared_sq;
        if !is_spared {
            return SharedIrradiance::none(scene.channels(), places.len(), self.rays);
        }
        let fewer = louder.powf(1.0 / NOISE_POWER).min(MOST_SPARED);
        SharedIrradiance { rays: (f64::from(self.rays) / fewer).ceil() as u32, ..shared }
    }
}

/// Those of the places `left` that lie in cells with several of them, by cell.
fn crowded_cells(cells: &PlaneCells<'_>, places: &[Option<Place>], left: &[usize], size: f64) -> Vec<(CellKey, usize)> {
    let keyed = |&index: &usize| places[index].as_ref().map(|place| (cells.cell_at(place.surface, place.point, size), index));
    let mut keyed: Vec<(CellKey, usize)> = left.par_iter().filter_map(keyed).collect();
    keyed.par_sort_unstable();
    keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() >= LEAST_POINTS).flatten().copied().collect()
}

/// The mean variance of values by gathers of their own, summed over the channels.
fn mean_noise_sq(controls: &[Control]) -> f64 {
    controls.iter().map(Control::noise_sq).sum::<f64>() / controls.len() as f64
}

impl Control {
    /// The variance of a value by a gather of its own, summed over the channels.
    fn noise_sq(&self) -> f64 {
        let whole = |half: usize| -> Vec<f64> { self.indirect[half].iter().zip(&self.direct[half]).map(|(a, b)| a + b).collect() };
        variance(&whole(0), &whole(1))
    }
}

/// The variance of two samples, summed over the channels.
fn variance(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
}
