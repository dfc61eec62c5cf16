//! How wrong the values are: an estimate from light paths that are independent of the values.
//!
//! At random points x the values B~(x) that a user would get are compared with independent replicates of the truth T, by
//! next-event estimation and paths. Where values go over links, a replicate estimates all of the light:
//!
//! ```text
//! T(x) = E + rho (direct + mean of what paths find),        r(x) = B~(x) - T(x)
//! ```
//!
//! Where values go over cells, a replicate and a value have most in common. There a replicate estimates the difference alone, the
//! one-bounce residual of the cells ([`ResidualGather`](super::ResidualGather)). The noise of the values' gathers is found by
//! taking them twice at half of the points:
//!
//! ```text
//! e^2 = mean of r_i r_j over all pairs i, j and all points, + (B~_1 - B~_2)^2 / 2
//! ```
//!
//! relative to the light, as the norm says. The expected product of two independent replicates is the square of the error, free of the noise
//! of either; over links B~_1 = B~_2. Each replicate has its own cell radiosities, from other positions and other paths, and its paths take
//! one bounce more than those of values, so it shares neither the noise nor the size of the values' cells. Replicates take more rays where
//! they are noisier, else a few points would make up most of the scatter; pilot rays of their own tell where that is.
//!
//! The result is an estimate, with a confidence limit from its scatter over the points and from what replicates have in common at all points.
//! It does not see errors on areas so small that no point falls on them, or errors of light paths as such: leaks of rays, and the size of
//! cells two bounces away.

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::claim::{Doubts, FEW_REPLICATES, claim, error_of};
use super::compared::{Judging, by_other_rays, compared, lit, values_at};
use super::moments::Moments;
use super::norm::{ErrorNorm, Lit, MEDIAN_SIGMAS, NormWeights, lit_points};
use super::pairs::{PairProducts, mean_and_variance, variance_by_noise};
use super::points::{ErrorPoint, Surroundings};
use super::replicates::{ErrorSample, REPLICATES, RayShares, ReplicateGather, Replication};
use crate::geometry::sampling;
use crate::paths::{PathScratch, Place};
use crate::progress::Stop;
use crate::values::{Gather, Gathered};

/// An error with its upper confidence limit, see [`claim`]; infinite where nothing can be said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ErrorFigure {
    /// The error itself. Its square is unbiased; 0 where that came out negative.
    pub measured: f64,
    pub claimed: f64,
}

impl ErrorFigure {
    pub(super) const UNKNOWN: Self = Self { measured: f64::INFINITY, claimed: f64::INFINITY };
}

/// The estimated error.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorEstimate {
    /// In the norm that was asked for.
    pub measured: f64,
    pub claimed: f64,
    pub energy: ErrorFigure,
    pub local: ErrorFigure,
    /// Standard deviations of the parts of the measured square.
    pub doubts: Doubts,
    /// The part of the replicates' variance that is noise of their rays, and falls with more rays; the rest is scatter of the error
    /// itself over the points.
    pub ray_share: f64,
    /// The part of the error that is noise of the values' gathers; known where values are taken twice.
    pub value_noise: Option<f64>,
    /// By how much cells on unresolved surfaces make values wrong, at least; where values go over cells.
    pub by_unresolved: f64,
    /// The part of the area of reflecting surfaces where light was found, 0 to 1.
    pub lit: f64,
    /// Whether light comes to more area by paths so rare that it cannot be told how much: all that is told leaves that area out.
    pub is_elsewhere: bool,
}

impl ErrorEstimate {
    /// Nothing can be said.
    pub const UNKNOWN: Self = Self {
        measured: f64::INFINITY,
        claimed: f64::INFINITY,
        energy: ErrorFigure::UNKNOWN,
        local: ErrorFigure::UNKNOWN,
        doubts: Doubts { replicates: 0.0, common: 0.0, noise: 0.0, median: 0.0, skewness: 0.0 },
        ray_share: 0.0,
        value_noise: None,
        by_unresolved: 0.0,
        lit: 0.0,
        is_elsewhere: false,
    };

    /// What is measured and claimed.
    pub fn told(&self) -> ErrorFigure {
        ErrorFigure { measured: self.measured, claimed: self.claimed }
    }

    /// What is claimed of all area that light comes to.
    pub fn claimed_of_all(&self) -> f64 {
        if self.is_elsewhere { f64::INFINITY } else { self.claimed }
    }

    /// The same with so much more of the square of the error.
    fn missing(self, sq: f64) -> Self {
        Self { measured: self.measured.hypot(sq.sqrt()), claimed: self.claimed.hypot(sq.sqrt()), ..self }
    }
}

/// Values over cells are taken twice at one of so many points.
pub(crate) const TWICE: usize = 2;

/// The noise of values over links is sampled at one of so many points.
pub(super) const AGAIN: usize = 4;

/// The parts of the error of values, relative to the light.
pub(crate) struct ErrorParts {
    /// What is off without the noise of values. Its square is unbiased; 0 where that came out negative.
    pub bias: f64,
    /// The variance of values.
    pub noise_sq: f64,
}

/// Samples of the error in one norm. Replicates are kept while values change; points and rays are added as they are needed.
pub(crate) struct ErrorSamples {
    pub(super) norm: ErrorNorm,
    pub(super) samples: Vec<ErrorSample>,
    /// By sample, the value that a user gets there; two independent ones where they are taken twice, else equal ones.
    pub(super) values: Vec<[Gathered; 2]>,
    /// Seconds that one took on all threads, of those that were taken last; 0 if there were none.
    pub seconds_of_value: f64,
}

/// What is claimed locally of samples, if they are lit so; `None` if nothing can be said.
pub(super) type EstimateLit<'a> = dyn Fn(&ErrorSamples, &[Lit]) -> Option<ErrorEstimate> + 'a;

impl ErrorSamples {
    pub fn new(norm: ErrorNorm) -> Self {
        Self { norm, samples: Vec::new(), values: Vec::new(), seconds_of_value: 0.0 }
    }

    /// Bytes that a point takes: what replicates found, two values, and what estimates make of them.
    pub fn bytes_of_point(channels: usize) -> u64 {
        /// Beside what was asked for each allocation takes its header, and numbers of channels are rounded to 16 bytes.
        const ALLOCATION: usize = 24;
        let numbers = channels * size_of::<f64>() + ALLOCATION;
        let values = 2 * (size_of::<Gathered>() + 3 * numbers);
        (size_of::<ErrorSample>() + 2 * REPLICATES * numbers + values + 2 * size_of::<Lit>() + 16 * size_of::<ErrorPoint>()) as u64
    }

    /// How many rays all replicates have taken.
    pub fn rays(&self) -> u64 {
        self.samples.iter().map(|sample| REPLICATES as u64 * u64::from(sample.rays)).sum()
    }

    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.values.clear();
    }

    /// Forgets the values, because they have changed.
    pub fn forget_values(&mut self) {
        self.values.clear();
    }

    /// Adds points until there are `points`, and samples how noisy replicates are there. `false` if stopped before it is done.
    pub fn add_points(&mut self, points: usize, pilot_rays: u32, with: &Replication<'_>, stop: Stop<'_>) -> bool {
        let (first, channels) = (self.samples.len(), with.scene.channels());

        // By energy, more points where much is reflected.
        let around = Surroundings { scene: with.scene, hierarchy: with.hierarchy, radiosity: with.radiosity };
        let seed = sampling::hash(with.seed, first as u64);
        let reflected = |place: &Place| match &with.gathers[0] {
            ReplicateGather::Residual(gather) => gather.estimate_reflected(place),
            ReplicateGather::Truth(_) => 0.0,
        };
        let knows_cells = matches!(with.gathers[0], ReplicateGather::Residual(_));
        let more = points.saturating_sub(first);
        let points = around.sampled_points(self.norm, more, seed, knows_cells.then_some(&reflected as &dyn Fn(&Place) -> f64));
        let lit = |point: &ErrorPoint| {
            let light = if knows_cells { reflected(&point.place) } else { 1.0 };
            Lit::of(point.stands_for, light)
        };
        let weights = NormWeights::new(self.norm, &points.iter().map(lit).collect::<Vec<_>>());
        let untaken = |(number, ErrorPoint { place, stands_for, .. })| ErrorSample {
            place,
            stands_for,
            found: std::array::from_fn(|_| vec![0.0; channels]),
            of_unresolved: std::array::from_fn(|_| vec![0.0; channels]),
            rays: 0,
            noise: 0.0,
            noisiness: weights.as_ref().map_or(1.0, |weights| weights.by_point[number]),
            searched: None,
        };
        self.samples.extend(points.into_iter().enumerate().map(untaken));

        // Pilot rays.
        let share = with.gathers[0].share();
        self.samples[first..].par_iter_mut().enumerate().for_each_init(PathScratch::default, |scratch, (number, sample)| {
            if share.has(number) && !stop() {
                sample.noise = with.gathers[0].sampled_noise(sample.place, pilot_rays, with.scene, scratch);
                sample.noisiness *= sample.noise;
            }
        });
        share.exchange(&mut self.samples[first..]);
        !stop()
    }

    /// Takes more rays, until each replicate has `rays` on average. `false` if stopped before it is done.
    pub fn take_replicates(&mut self, rays: u32, with: &Replication<'_>, stop: Stop<'_>) -> bool {
        let (channels, share) = (with.scene.channels(), with.gathers[0].share());
        let shares = RayShares::new(&self.samples);
        self.samples.par_iter_mut().enumerate().for_each_init(
            || (PathScratch::default(), vec![0.0; 2 * channels]),
            |(scratch, found), (number, sample)| {
                if share.has(number) && !stop() {
                    let wanted = (f64::from(rays) * shares.of(sample)).ceil() as u32;
                    sample.take_up_to(wanted, &with.gathers, scratch, found);
                }
            },
        );
        share.exchange(&mut self.samples);
        !stop()
    }

    /// Estimates the error of the values that `gather` gives, 0 if no light is reflected, infinite if
    /// nothing can be said. `None` if stopped.
    pub fn estimate(&mut self, gather: &Gather<'_>, with: &Replication<'_>, stop: Stop<'_>) -> Option<ErrorEstimate> {
        self.take_values(gather, stop)?;
        self.estimate_taken(Judging::of(gather), |own, lit, estimate| own.with_dark_area(lit, with, estimate, stop))
    }

    /// The same of the values that there are; `locally` makes the estimate in the local norm of what it is with such light.
    pub(super) fn estimate_taken(
        &mut self,
        judging: Judging<'_>,
        locally: impl FnOnce(&mut Self, &mut [Lit], &EstimateLit<'_>) -> Option<ErrorEstimate>,
    ) -> Option<ErrorEstimate> {
        let mut lit = self.lit(judging, &self.values, judging.channels());
        if lit.iter().all(|point| point.light == 0.0 && point.light_sq == 0.0) {
            return Some(ErrorEstimate::default());
        }

        let in_norm = |own: &Self, norm, lit: &[Lit]| {
            let weights = NormWeights::new(norm, lit)?;
            let estimate = own.estimate_weighted(judging, &weights, judging.channels());
            let missed_sq: f64 =
                lit.iter().zip(&weights.by_point).map(|(point, weight)| weight * point.missed * point.missed).sum();
            estimate.measured.is_finite().then(|| estimate.missing(missed_sq))
        };
        let by_energy = in_norm(self, ErrorNorm::Energy, &lit).unwrap_or(ErrorEstimate::UNKNOWN);
        let locally = locally(self, &mut lit, &|own, lit| in_norm(own, ErrorNorm::Local, lit))?;
        let (energy, local) = (by_energy.told(), if locally.is_elsewhere { ErrorFigure::UNKNOWN } else { locally.told() });
        let asked = if self.norm == ErrorNorm::Energy { by_energy } else { locally };
        let part = lit_points(&lit).map(|point| point.area).sum::<f64>() / lit.iter().map(|point| point.area).sum::<f64>();
        Some(ErrorEstimate { energy, local, lit: part, ..asked })
    }

    /// The estimate in some channels, with weights for the squares at each point.
    pub(super) fn estimate_weighted(&self, judging: Judging<'_>, weights: &NormWeights, channels: Range<usize>) -> ErrorEstimate {
        // Point by point, the products of replicates and the variances of values.
        let (mut replicates, mut noise, mut both) = (Moments::default(), Moments::default(), Moments::default());
        let (mut ray_variance, mut noise_of_rays, mut if_dimmer) = (0.0, 0.0, 0.0);
        let weights_of_points = weights.by_point.iter().zip(&weights.if_dimmer);
        for ((sample, values), (&weight, more)) in self.samples.iter().zip(&self.values).zip(weights_of_points) {
            let (mut products, mut of_rays, mut of_values) = (PairProducts::default(), 0.0, 0.0);
            for compared in compared(sample, judging, values, channels.clone()) {
                products.add(weight, compared.residuals);
                of_rays += weight * REPLICATES as f64 * mean_and_variance(compared.residuals).1;
                of_values += weight * TWICE as f64 * compared.variance();
            }
            replicates.add(products.all);
            noise.add(of_values);
            both.add(products.all + of_values);
            ray_variance += variance_by_noise(products.all, of_rays);
            noise_of_rays += of_rays;
            if_dimmer += more * (products.all + of_values);
        }

        // What light it is relative to, the scatter of the points, and what replicates have in common at all of them, give the confidence limit. Where
        // single rays of single replicates find much light, products are small, but not the scatter of replicates: as much as if all points were as noisy
        // counts at least.
        let of_noise = variance_by_noise(0.0, noise_of_rays).sqrt() / (self.samples.len() as f64).sqrt();
        let of_replicates = replicates.deviation_of_sum().max(of_noise);
        let common = FEW_REPLICATES * self.common_variance(judging, &weights.by_point, channels.clone()).sqrt();
        let median = (if_dimmer - both.sum).max(0.0) / MEDIAN_SIGMAS;
        let scatter = both.scatter_of_sum().at_least(of_replicates).beside(common.hypot(median));
        let ray_share = if of_replicates > 0.0 { (ray_variance / of_replicates.powi(2)).clamp(0.0, 1.0) } else { 0.0 };
        ErrorEstimate {
            measured: error_of(both.sum),
            claimed: claim(both.sum, scatter),
            doubts: Doubts {
                replicates: of_replicates,
                common,
                noise: noise.deviation_of_sum(),
                median,
                skewness: scatter.skewness,
            },
            ray_share,
            by_unresolved: if judging.is_taken_twice {
                self.least_by_unresolved(judging, &weights.by_point, channels)
            } else {
                0.0
            },
            value_noise: judging.is_taken_twice.then(|| noise.sum.sqrt()),
            ..ErrorEstimate::default()
        }
    }

    /// The part of the error that is noise of the values' gathers, and falls with more rays to points: values at some of the points
    /// are taken again by other rays. 0 if stopped.
    pub fn sampled_value_noise(&self, gather: &Gather<'_>, stop: Stop<'_>) -> f64 {
        let (judging, samples) = (Judging::of(gather), self.samples.iter().step_by(AGAIN));
        let places: Vec<Place> = samples.map(|sample| sample.place).collect();
        let Some(again) = values_at(&places, gather, by_other_rays(gather.budget), stop) else { return 0.0 };
        let Some(weights) = NormWeights::new(self.norm, &self.lit(judging, &self.values, judging.channels())) else { return 0.0 };
        let noise_of = |(weight, ([value, _], again)): (&f64, (&[Gathered; 2], &Gathered))| {
            let pairs = value.radiosity[judging.channels()].iter().zip(&again.radiosity);
            let difference_sq: f64 = pairs.map(|(value, again)| (value - again).powi(2)).sum();
            weight * AGAIN as f64 * 0.5 * difference_sq
        };
        weights.by_point.iter().step_by(AGAIN).zip(self.values.iter().step_by(AGAIN).zip(&again)).map(noise_of).sum::<f64>().sqrt()
    }

    /// The two parts of the error, by taking all values twice; `None` if stopped, or if nothing is reflected.
    pub fn sampled_parts(&self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<ErrorParts> {
        let judging = Judging::of(gather);
        let places: Vec<Place> = self.samples.iter().map(|sample| sample.place).collect();
        let values = values_at(&places, gather, gather.budget, stop)?;
        let again = values_at(&places, gather, by_other_rays(gather.budget), stop)?;
        let values: Vec<[Gathered; 2]> = values.into_iter().zip(again).map(|(value, again)| [value, again]).collect();
        let weights = NormWeights::new(self.norm, &self.lit(judging, &values, judging.channels()))?.by_point;
        let (mut bias_sq, mut noise_sq) = (0.0, 0.0);
        for ((sample, values), &weight) in self.samples.iter().zip(&values).zip(&weights) {
            // Of (B~_1 - T_i) (B~_2 - T_j), over all pairs.
            let (mut residuals, mut variance) = (PairProducts::default(), 0.0);
            for compared in compared(sample, judging, values, judging.channels()) {
                residuals.add(weight, compared.residuals);
                variance += weight * compared.variance();
            }
            bias_sq += residuals.all - 0.5 * variance;
            noise_sq += variance;
        }
        Some(ErrorParts { bias: bias_sq.max(0.0).sqrt(), noise_sq })
    }

    /// The points as norms see them, in some channels.
    pub(super) fn lit(&self, judging: Judging<'_>, values: &[[Gathered; 2]], channels: Range<usize>) -> Vec<Lit> {
        let area = |sample: &ErrorSample| sample.stands_for / self.samples.len() as f64;
        self.samples
            .iter()
            .zip(values)
            .map(|(sample, values)| lit(area(sample), compared(sample, judging, values, channels.clone()), judging))
            .collect()
    }

    /// Takes the values at points that have none yet. `None` if stopped.
    pub(super) fn take_values(&mut self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<()> {
        let (first, start) = (self.values.len(), Instant::now());
        let places: Vec<Place> = self.samples[first..].iter().map(|sample| sample.place).collect();
        let taken = values_at(&places, gather, gather.budget, stop)?;
        let indices = (first..self.samples.len()).filter(|index| Judging::of(gather).is_taken_twice && index % TWICE == 0);
        let indices: Vec<usize> = indices.collect();
        let places: Vec<Place> = indices.iter().map(|&index| self.samples[index].place).collect();
        let again = values_at(&places, gather, by_other_rays(gather.budget), stop)?;
        if !taken.is_empty() {
            self.seconds_of_value = start.elapsed().as_secs_f64() / (taken.len() + again.len()) as f64;
        }
        self.values.extend(taken.into_iter().map(|value| [value.clone(), value]));
        indices.into_iter().zip(again).for_each(|(index, again)| self.values[index][1] = again);
        Some(())
    }
}
