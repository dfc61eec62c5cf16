//! How wrong the values are: an estimate from light paths that are independent of the values.
//!
//! At random points x the values B~(x) that a user would get are compared with two independent replicates of the truth T, by
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
//! e^2 = mean of r_1 r_2 + (B~_1 - B~_2)^2 / 2
//! ```
//!
//! The expected product of two independent replicates is the square of the error, free of the noise of either; over links B~_1 =
//! B~_2. Each replicate has its own cell radiosities, from other positions and other paths, and its paths take one bounce more than
//! those of values, so it shares neither the noise nor the size of the values' cells. Replicates take more rays where they are
//! noisier, else a few points would make up most of the scatter; pilot rays of their own tell where that is.
//!
//! The result is an estimate, with a confidence limit from its scatter over the points. It does not see errors on areas so small
//! that no point falls on them, noise of a replicate's cells that all points share (most in bright rooms), or errors of light paths
//! as such: leaks of rays, and the size of cells two bounces away.

use rayon::prelude::*;

use super::points::{ErrorPoint, Surroundings};
use super::replicates::{ErrorSample, RayShares, ReplicateGather, Replication};
use crate::geometry::{sampling, streams};
use crate::paths::{PathScratch, Place};
use crate::values::{Gather, Over, RayBudget, Scratch};

/// The estimated error, relative to `||B - E||`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorEstimate {
    /// The error itself. Its square is unbiased; 0 where that came out negative.
    pub measured: f64,
    /// An upper confidence limit, see [`claim`].
    pub claimed: f64,
    /// Standard deviations of the two parts of the measured square.
    pub doubts: Doubts,
    /// The part of the replicates' variance that is noise of their rays, and falls with more rays; the rest is scatter of the error
    /// itself over the points.
    pub ray_share: f64,
    /// The part of the error that is noise of the values' gathers; known where values are taken twice.
    pub value_noise: Option<f64>,
}

/// Standard deviations of a measured square: by the products of replicates, and by the noise of values.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Doubts {
    pub replicates: f64,
    pub noise: f64,
}

impl Doubts {
    pub fn both(&self) -> f64 {
        self.replicates.hypot(self.noise)
    }
}

/// The upper limit that is claimed for a measured square with this standard deviation: [`CONFIDENCE_SIGMAS`] above it, times
/// [`UNSEEN`].
pub(crate) fn claim(error_sq: f64, deviation: f64) -> f64 {
    UNSEEN * (error_sq.max(0.0) + CONFIDENCE_SIGMAS * deviation).sqrt() + LEFT_BY_SWEEPS
}

/// The standard deviation that leaves room for a claim of 1, if the square of the error is `error_sq`.
pub(crate) fn doubt_for_claim(error_sq: f64) -> f64 {
    ((1.0 / UNSEEN).powi(2) - error_sq) / CONFIDENCE_SIGMAS
}

/// The claim lies so many standard deviations above the measured square.
pub(crate) const CONFIDENCE_SIGMAS: f64 = 2.0;

/// A factor on the claim for what scatter does not show: most sets of points miss errors on a small area. Empirical.
const UNSEEN: f64 = 1.1;

/// What the sweeps over cell radiosities leave undone, relative to the reflected light: values and replicates have it in common.
const LEFT_BY_SWEEPS: f64 = 2e-5;

/// The one-sided probability that belongs to [`CONFIDENCE_SIGMAS`], for normal scatter.
pub(crate) const CONFIDENCE: f64 = 0.977;

/// Values over cells are taken twice at one of so many points.
pub(crate) const TWICE: usize = 2;

/// The noise of values over links is sampled at one of so many points.
const AGAIN: usize = 4;

/// Whether to stop working.
type Cancelled<'a> = &'a (dyn Fn() -> bool + Sync);

/// Sums over points.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    sum: f64,
    sum_sq: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.sum_sq += value * value;
    }

    /// The standard deviation of the sum, by the scatter of what was added.
    fn deviation_of_sum(&self) -> f64 {
        let scatter = (self.sum_sq - self.sum * self.sum / self.count).max(0.0);
        (scatter / (self.count - 1.0).max(1.0) * self.count).sqrt()
    }
}

/// A prediction of the noise of values and replicates, relative to `||B - E||^2`.
pub(crate) struct Pilot {
    /// The variance of values with the rays that were tried.
    pub noise_sq: f64,
    /// The standard deviation of the measured square by replicates of one ray on average; it falls as one over the number of rays.
    pub replicate_doubt: f64,
}

/// The parts of the error of values, relative to the reflected light.
pub(crate) struct ErrorParts {
    /// What is off without the noise of values. Its square is unbiased; 0 where that came out negative.
    pub bias: f64,
    /// The variance of values.
    pub noise_sq: f64,
}

/// Samples of the error. Replicates are kept while values change; points and rays are added as they are needed.
#[derive(Default)]
pub(crate) struct ErrorSamples {
    samples: Vec<ErrorSample>,
    /// By sample, the radiosities that a user gets there, by channel; two independent values where they are taken twice, else equal
    /// ones.
    values: Vec<[Vec<f64>; 2]>,
}

impl ErrorSamples {
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Forgets the values, because they have changed.
    pub fn forget_values(&mut self) {
        self.values.clear();
    }

    /// Adds points until there are `points`, and samples how noisy replicates are there. `false` if cancelled before it is done.
    pub fn add_points(&mut self, points: usize, pilot_rays: u32, with: &Replication<'_>, cancelled: Cancelled<'_>) -> bool {
        let (first, channels) = (self.samples.len(), with.scene.channels());

        // More points where much is reflected.
        let around = Surroundings { scene: with.scene, hierarchy: with.hierarchy, radiosity: with.radiosity };
        let seed = sampling::hash(with.seed, first as u64);
        let reflected = |place: &Place| match &with.gathers[0] {
            ReplicateGather::Residual(gather) => gather.estimate_reflected(place),
            ReplicateGather::Truth(_) => 0.0,
        };
        let knows_cells = matches!(with.gathers[0], ReplicateGather::Residual(_));
        let more = points.saturating_sub(first);
        let points = around.sampled_points(more, seed, knows_cells.then_some(&reflected as &dyn Fn(&Place) -> f64));
        let untaken = |ErrorPoint { place, stands_for, .. }| ErrorSample {
            place,
            stands_for,
            found: [0, 1].map(|_| vec![0.0; channels]),
            rays: 0,
            noisiness: 0.0,
        };
        self.samples.extend(points.into_iter().map(untaken));

        // Pilot rays.
        self.samples[first..].par_iter_mut().for_each_init(PathScratch::default, |scratch, sample| {
            if !cancelled() {
                let of_rays = with.gathers[0].sampled_noisiness(sample.place, pilot_rays, with.scene, scratch);
                sample.noisiness = sample.stands_for * of_rays;
            }
        });
        !cancelled()
    }

    /// Predicts the noise of values, by values of few rays, and of replicates, by pilot rays. `None` if cancelled, or if nothing is
    /// reflected.
    pub fn pilot(&self, gather: &Gather<'_>, cancelled: Cancelled<'_>) -> Option<Pilot> {
        let samples = || self.samples.iter().step_by(TWICE);
        let places: Vec<Place> = samples().map(|sample| sample.place).collect();
        let values = [gather.budget, by_other_rays(gather.budget)].map(|budget| values_at(&places, gather, budget, cancelled));
        let [Some(values), Some(again)] = values else { return None };

        // Of values, by the differences of two.
        let (mut norm_sq, mut noise_sq) = (0.0, 0.0);
        for (sample, (values, again)) in samples().zip(values.iter().zip(&again)) {
            let weight = sample.stands_for / places.len() as f64;
            let exitance = &gather.scene.material_of(sample.place.surface).exitance;
            for ((value, again), exitance) in values.iter().zip(again).zip(exitance) {
                norm_sq += weight * (value - exitance) * (again - exitance);
                noise_sq += weight * 0.5 * (value - again).powi(2);
            }
        }

        // Of replicates: the variance of a product of two is the square of the variance of each.
        let shares = RayShares::new(&self.samples);
        let variance_of = |sample: &ErrorSample| sample.noisiness / shares.of(sample) / self.samples.len() as f64;
        let replicate_doubt = self.samples.iter().map(|sample| variance_of(sample).powi(2)).sum::<f64>().sqrt();
        (norm_sq > 0.0).then(|| Pilot { noise_sq: noise_sq / norm_sq, replicate_doubt: replicate_doubt / norm_sq })
    }

    /// Takes more rays, until each replicate has `rays` on average. `false` if cancelled before it is done.
    pub fn take_replicates(&mut self, rays: u32, with: &Replication<'_>, cancelled: Cancelled<'_>) -> bool {
        let channels = with.scene.channels();
        let shares = RayShares::new(&self.samples);
        self.samples.par_iter_mut().for_each_init(
            || (PathScratch::default(), vec![0.0; channels]),
            |(scratch, found), sample| {
                if !cancelled() {
                    let wanted = (f64::from(rays) * shares.of(sample)).ceil() as u32;
                    sample.take_up_to(wanted, &with.gathers, scratch, found);
                }
            },
        );
        !cancelled()
    }

    /// Estimates the error of the values that `gather` gives: 0 if no light is reflected, infinite if nothing can be said. `None`
    /// if cancelled.
    pub fn estimate(&mut self, gather: &Gather<'_>, cancelled: Cancelled<'_>) -> Option<ErrorEstimate> {
        self.take_values(gather, cancelled)?;

        // Point by point, the products of the two replicates and the variances of values.
        let count = self.samples.len() as f64;
        let norm_sq = self.norm_sq(gather);
        let (mut replicates, mut noise, mut both) = (Moments::default(), Moments::default(), Moments::default());
        let mut ray_variance = 0.0;
        for (sample, values) in self.samples.iter().zip(&self.values) {
            let weight = sample.stands_for / count;
            let (mut product, mut apart, mut value_apart) = (0.0, 0.0, 0.0);
            for [(value, residual), (again, residual_again)] in compared(sample, gather, values) {
                product += weight * residual * residual_again;
                apart += weight * 0.5 * (residual - residual_again).powi(2);
                value_apart += weight * TWICE as f64 * 0.5 * (value - again).powi(2);
            }
            replicates.add(product);
            noise.add(value_apart);
            both.add(product + value_apart);
            // With normal noise of variance s^2 in each replicate of an error e, their product has the variance s^4 + 2 s^2 e^2.
            ray_variance += apart * apart + 2.0 * product * apart;
        }
        let error_sq = both.sum;
        if error_sq == 0.0 && norm_sq == 0.0 {
            return Some(ErrorEstimate::default());
        }
        if error_sq.is_nan() || norm_sq.is_nan() || norm_sq <= 0.0 {
            return Some(ErrorEstimate { measured: f64::INFINITY, claimed: f64::INFINITY, ..ErrorEstimate::default() });
        }

        // The scatter of the points gives the confidence limit.
        let [of_replicates, of_noise, of_both] = [replicates, noise, both].map(|moments| moments.deviation_of_sum() / norm_sq);
        let variance_of_replicates = replicates.deviation_of_sum().powi(2);
        Some(ErrorEstimate {
            measured: (error_sq.max(0.0) / norm_sq).sqrt(),
            claimed: claim(error_sq / norm_sq, of_both),
            doubts: Doubts { replicates: of_replicates, noise: of_noise },
            ray_share: if variance_of_replicates > 0.0 { (ray_variance / variance_of_replicates).clamp(0.0, 1.0) } else { 0.0 },
            value_noise: is_taken_twice(gather).then(|| (noise.sum / norm_sq).sqrt()),
        })
    }

    /// The part of the error that is noise of the values' gathers, and falls with more rays to points: values at some of the points
    /// are taken again by other rays. 0 if cancelled.
    pub fn sampled_value_noise(&self, gather: &Gather<'_>, cancelled: Cancelled<'_>) -> f64 {
        let samples = || self.samples.iter().step_by(AGAIN);
        let places: Vec<Place> = samples().map(|sample| sample.place).collect();
        let Some(again) = values_at(&places, gather, by_other_rays(gather.budget), cancelled) else { return 0.0 };
        let noise_of = |(sample, ([value, _], again)): (&ErrorSample, (&[Vec<f64>; 2], &Vec<f64>))| {
            let difference_sq: f64 = value.iter().zip(again).map(|(value, again)| (value - again).powi(2)).sum();
            sample.stands_for / places.len() as f64 * 0.5 * difference_sq
        };
        let noise_sq: f64 = samples().zip(self.values.iter().step_by(AGAIN).zip(&again)).map(noise_of).sum();
        (noise_sq / self.norm_sq(gather)).sqrt()
    }

    /// The two parts of the error, by taking all values twice; `None` if cancelled, or if nothing is reflected.
    pub fn sampled_parts(&self, gather: &Gather<'_>, cancelled: Cancelled<'_>) -> Option<ErrorParts> {
        let places: Vec<Place> = self.samples.iter().map(|sample| sample.place).collect();
        let values = values_at(&places, gather, gather.budget, cancelled)?;
        let again = values_at(&places, gather, by_other_rays(gather.budget), cancelled)?;
        let (mut bias_sq, mut noise_sq, mut norm_sq) = (0.0, 0.0, 0.0);
        for (sample, values) in self.samples.iter().zip(values.into_iter().zip(again).map(|(value, again)| [value, again])) {
            let weight = sample.stands_for / places.len() as f64;
            for [(value, residual), (again, residual_again)] in compared(sample, gather, &values) {
                bias_sq += weight * residual * residual_again;
                noise_sq += weight * 0.5 * (value - again).powi(2);
                norm_sq += weight * (value - residual) * (again - residual_again);
            }
        }
        (norm_sq > 0.0).then(|| ErrorParts { bias: (bias_sq.max(0.0) / norm_sq).sqrt(), noise_sq: noise_sq / norm_sq })
    }

    /// `||B - E||^2`, in W^2/m^2, by products of independent replicates, whose mean is free of noise.
    fn norm_sq(&self, gather: &Gather<'_>) -> f64 {
        let of_sample = |(sample, values): (&ErrorSample, &[Vec<f64>; 2])| {
            let product =
                |[(value, residual), (again, residual_again)]: [(f64, f64); 2]| (value - residual) * (again - residual_again);
            sample.stands_for / self.samples.len() as f64 * compared(sample, gather, values).map(product).sum::<f64>()
        };
        self.samples.iter().zip(&self.values).map(of_sample).sum()
    }

    /// Takes the values at points that have none yet. `None` if cancelled.
    fn take_values(&mut self, gather: &Gather<'_>, cancelled: Cancelled<'_>) -> Option<()> {
        let first = self.values.len();
        let places: Vec<Place> = self.samples[first..].iter().map(|sample| sample.place).collect();
        let taken = values_at(&places, gather, gather.budget, cancelled)?;
        self.values.extend(taken.into_iter().map(|value| [value.clone(), value]));
        if is_taken_twice(gather) {
            let indices: Vec<usize> = (first..self.samples.len()).filter(|index| index % TWICE == 0).collect();
            let places: Vec<Place> = indices.iter().map(|&index| self.samples[index].place).collect();
            let again = values_at(&places, gather, by_other_rays(gather.budget), cancelled)?;
            indices.into_iter().zip(again).for_each(|(index, again)| self.values[index][1] = again);
        }
        Some(())
    }
}

/// By channel, for both replicates at a point: the reflected radiosity of the value, and by how much the replicate finds it too
/// bright, in W/m^2.
fn compared<'a>(
    sample: &'a ErrorSample,
    gather: &'a Gather<'_>,
    values: &'a [Vec<f64>; 2],
) -> impl Iterator<Item = [(f64, f64); 2]> + 'a {
    let material = gather.scene.material_of(sample.place.surface);
    let finds_residual = is_taken_twice(gather);
    (0..gather.scene.channels()).map(move |channel| {
        [0, 1].map(|half: usize| {
            let value = values[half][channel] - material.exitance[channel];
            let found = material.reflectance[channel] * sample.found[half][channel];
            (value, if finds_residual { found } else { value - found })
        })
    })
}

/// Whether values are taken twice: over cells, where replicates find residuals.
fn is_taken_twice(gather: &Gather<'_>) -> bool {
    matches!(gather.over, Over::Cells(_))
}

/// The same budget with other random numbers.
fn by_other_rays(budget: RayBudget) -> RayBudget {
    RayBudget { seed: sampling::hash(budget.seed, streams::VALUES_AGAIN), ..budget }
}

/// The radiosities at `places`, by channel, that `gather` gives with a budget; `None` if cancelled.
fn values_at(places: &[Place], gather: &Gather<'_>, budget: RayBudget, cancelled: Cancelled<'_>) -> Option<Vec<Vec<f64>>> {
    let value = |scratch: &mut Scratch, place: &Place| {
        let mut value = vec![0.0; gather.scene.channels()];
        let place = crate::paths::place_at(place.point, place.surface, budget.seed);
        gather.radiosities_at(&[place], budget, scratch, &mut value);
        (!cancelled()).then_some(value)
    };
    places.par_iter().map_init(Scratch::default, value).collect()
}
