//! The errors of light groups one by one, and how their light overlaps: what a weighted sum of them may claim.
//!
//! With weights w the error of the sum is `sum over g of w_g r_g`, r_g being the residual of group g. Residuals of groups have rays and cells in
//! common, so they may add up: the root mean square of the sum is at most the sum of theirs. The light of the sum follows from the products of
//! the light of all pairs of groups, by band.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::compared::{Compared, Judging, compared};
use super::estimate::{ErrorFigure, ErrorSamples};
use super::norm::{ErrorNorm, NormWeights};
use super::replicates::REPLICATES;
use crate::progress::Stop;
use crate::scene::DistinctChannels;
use crate::values::{ErrorBars, Gather};

/// What is known of the errors of values beside their estimate.
#[derive(Clone, Debug)]
pub(crate) struct KnownErrors {
    pub error_bars: ErrorBars,
    /// Where there are light groups.
    pub groups: Option<GroupErrors>,
}

/// What is known of light groups: root mean squares and mean products over the area of surfaces that reflect, in W/m^2 and W^2/m^4.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GroupErrors {
    /// The error of all light, then of each group, channels added; infinite where nothing can be said.
    pub values: Vec<ErrorFigure>,
    /// What error bars of each hang on.
    pub error_bars: Vec<ErrorBars>,
    /// The mean product of the reflected light of two groups, by the first, the second, and the band: without bias.
    pub light: Vec<f64>,
}

impl ErrorSamples {
    /// What is known of the values that `gather` gives, beside their error; `None` if stopped, or if there are no points.
    pub fn known_errors(&mut self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<KnownErrors> {
        self.take_values(gather, stop).filter(|()| !self.is_empty())?;
        let again = self.taken_again(gather, stop)?;
        let (channels, bands) = (gather.scene.channels(), gather.scene.deciding());
        let ranges = || (0..channels).step_by(bands).map(|first| first..first + bands);
        let error_bars: Vec<ErrorBars> =
            ranges().map(|channels| self.error_bars(gather, &again, channels)).collect::<Option<_>>()?;
        let groups = (channels > bands).then(|| GroupErrors {
            values: ranges().map(|channels| self.error_by_energy(gather, channels)).collect(),
            light: self.light_products(gather, bands),
            error_bars: error_bars.clone(),
        });
        Some(KnownErrors { error_bars: *error_bars.first()?, groups })
    }

    /// The error in some channels, in W/m^2; unknown where no point has found light.
    fn error_by_energy(&self, gather: &Gather<'_>, channels: Range<usize>) -> ErrorFigure {
        let judging = Judging::of(gather);
        let lit = self.lit(judging, &self.values, channels.clone());
        let Some(weights) = NormWeights::new(ErrorNorm::Energy, &lit) else { return ErrorFigure::UNKNOWN };
        let relative = self.estimate_weighted(judging, &weights, channels);
        if !relative.measured.is_finite() {
            return ErrorFigure::UNKNOWN;
        }
        let sum = |of: &dyn Fn(usize) -> f64| (0..lit.len()).map(of).sum::<f64>();
        let light = (sum(&|point| lit[point].area * lit[point].light_sq) / sum(&|point| lit[point].area)).sqrt();
        ErrorFigure { measured: relative.measured * light, claimed: relative.claimed * light }
    }

    /// The mean products of the light of groups, by two groups and the band.
    fn light_products(&self, gather: &Gather<'_>, bands: usize) -> Vec<f64> {
        let (judging, channels, mut area) = (Judging::of(gather), gather.scene.channels(), 0.0);
        let groups = channels / bands - 1;
        let mut products = vec![0.0; groups * groups * bands];
        for (sample, values) in self.samples.iter().zip(&self.values) {
            let found: Vec<Compared> = compared(sample, judging, values, bands..channels).collect();
            area += sample.stands_for;
            for (pair, products) in products.chunks_mut(bands).enumerate() {
                let [first, second] = [pair / groups, pair % groups].map(|group| &found[group * bands..][..bands]);
                for (product, (first, second)) in products.iter_mut().zip(first.iter().zip(second)) {
                    *product += sample.stands_for * first.light_product(second, judging.is_taken_twice);
                }
            }
        }
        products.iter().map(|product| product / area).collect()
    }
}

impl Compared {
    /// The product of the true light in two channels, without the noise that replicates have, or values if they are taken twice.
    fn light_product(&self, other: &Self, is_taken_twice: bool) -> f64 {
        let (own, others) = (self.truths(), other.truths());
        let same: f64 = own.iter().zip(others).map(|(a, b)| a * b).sum();
        let count = REPLICATES as f64;
        let of_pairs = (own.iter().sum::<f64>() * others.iter().sum::<f64>() - same) / (count * (count - 1.0));
        let difference = |of: &Self| of.values[0] - of.values[1];
        of_pairs - if is_taken_twice { 0.25 * difference(self) * difference(other) } else { 0.0 }
    }
}

impl GroupErrors {
    /// How many groups there are.
    pub fn groups(&self) -> usize {
        self.values.len() - 1
    }

    /// The root mean square of the reflected light with weights by group and band, channels added, in W/m^2.
    pub fn light(&self, weights: &[Vec<f64>]) -> f64 {
        let groups = self.groups();
        let bands = weights.first().map_or(0, Vec::len);
        let of_pair = |pair: usize| {
            let (first, second) = (&weights[pair / groups], &weights[pair % groups]);
            (0..bands).map(|band| first[band] * second[band] * self.light[pair * bands + band]).sum::<f64>()
        };
        (0..groups * groups).map(of_pair).sum::<f64>().max(0.0).sqrt()
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(self, channels: &DistinctChannels) -> Self {
        let scale = (channels.copies as f64).sqrt();
        let scaled = |of: &ErrorFigure| ErrorFigure { measured: scale * of.measured, claimed: scale * of.claimed };
        Self { values: self.values.iter().map(scaled).collect(), light: channels.expand(&self.light), ..self }
    }

    /// Whether it fits so many groups and bands, and all is in range.
    pub fn is_valid(&self, groups: usize, bands: usize) -> bool {
        let is_error = |of: &ErrorFigure| of.measured >= 0.0 && of.claimed >= 0.0;
        let fits = self.values.len() == 1 + groups && self.error_bars.len() == 1 + groups;
        fits && self.light.len() == groups * groups * bands
            && self.light.iter().all(|product| product.is_finite())
            && self.values.iter().all(is_error)
            && self.error_bars.iter().all(ErrorBars::is_valid)
    }
}
