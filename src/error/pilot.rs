//! How noisy values and replicates will be, by few rays at the points of the error estimate.

use rayon::prelude::*;

use super::compared::{Judging, by_other_rays, values_at};
use super::estimate::{ErrorSamples, TWICE};
use super::norm::{Lit, NormWeights};
use super::pairs::variance_by_noise;
use super::replicates::{ErrorSample, RayShares};
use crate::paths::{PathScratch, Place};
use crate::progress::Stop;
use crate::values::{FinalGather, Gather};

/// A prediction of the noise of values and replicates, relative to the light.
pub(crate) struct Pilot {
    /// The variance of values with the rays that were tried.
    pub noise_sq: f64,
    /// The standard deviation of the measured square by replicates of one ray on average; it falls as one over the number of rays.
    pub replicate_doubt: f64,
    /// By point, what the variance of its light counts.
    weights: Vec<f64>,
}

impl ErrorSamples {
    /// Predicts the noise of values, by values of few rays, and of replicates, by pilot rays. `None` if stopped, or if nothing is
    /// reflected.
    pub fn pilot(&self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<Pilot> {
        let samples: Vec<&ErrorSample> = self.samples.iter().step_by(TWICE).collect();
        let places: Vec<Place> = samples.iter().map(|sample| sample.place).collect();
        let values = values_at(&places, gather, gather.budget, stop)?;
        let again = values_at(&places, gather, by_other_rays(gather.budget), stop)?;

        // The light, and the noise of values, by the differences of two.
        let (mut lit, mut variances) = (Vec::new(), Vec::new());
        for (sample, (values, again)) in samples.iter().zip(values.iter().zip(&again)) {
            let exitance = &gather.scene.material_of(sample.place.surface).exitance[Judging::of(gather).channels()];
            let channels =
                || values.radiosity.iter().zip(&again.radiosity).zip(exitance).map(|((value, again), e)| (value - e, again - e));
            let light_sq: f64 = channels().map(|(value, again)| value * again).sum();
            let (area, light) = (sample.stands_for / samples.len() as f64, light_sq.max(0.0).sqrt());
            lit.push(Lit { light_sq, ..Lit::of(area, light) });
            variances.push(channels().map(|(value, again)| 0.5 * (value - again).powi(2)).sum::<f64>());
        }
        let weights = NormWeights::new(self.norm, &lit)?.by_point;

        // Of replicates.
        let shares = RayShares::new(&self.samples);
        let of_replicates =
            |(sample, weight): (&&ErrorSample, &f64)| variance_by_noise(0.0, weight * sample.noise / shares.of(sample));
        let replicate_doubt = (samples.iter().zip(&weights).map(of_replicates).sum::<f64>() / TWICE as f64).sqrt();
        let noise_sq = weights.iter().zip(variances).map(|(weight, variance)| weight * variance).sum();
        Some(Pilot { noise_sq, replicate_doubt, weights })
    }

    /// How much more the variance of values by so many paths would be if these saw emitters by next-event rays: foreseen by what they see exactly, since
    /// rays that are hardly ever right do not show in few paths. `None` if stopped.
    pub fn next_event_noise(&self, pilot: &Pilot, gather: &FinalGather<'_>, rays: u32, stop: Stop<'_>) -> Option<f64> {
        let (scene, share) = (gather.paths.scene, gather.paths.rays.share());
        let channels = scene.channels();
        let of_sample = |scratch: &mut PathScratch, (number, sample): (usize, &ErrorSample)| {
            let mut variance = vec![0.0; channels];
            if share.has(number) && !stop() {
                gather.add_next_event_variance(&sample.place, rays, scratch, &mut variance);
            }
            let reflectance = &scene.material_of(sample.place.surface).reflectance[..scene.deciding()];
            variance.iter().zip(reflectance).map(|(variance, rho)| rho * rho * variance).sum::<f64>()
        };
        let samples: Vec<&ErrorSample> = self.samples.iter().step_by(TWICE).collect();
        let mut variances: Vec<f64> = samples.par_iter().copied().enumerate().map_init(PathScratch::default, of_sample).collect();
        share.exchange(&mut variances);
        let noise_sq = pilot.weights.iter().zip(variances).map(|(weight, variance)| weight * variance).sum();
        (!stop()).then_some(noise_sq)
    }
}
