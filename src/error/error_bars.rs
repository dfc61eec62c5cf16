//! What error bars of values hang on, by the points of the error estimate: how much of the variance that samples tell is noise of values, and
//! what else is off.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::ops::Range;

use super::compared::{Judging, by_other_rays, compared, values_at};
use super::estimate::{AGAIN, ErrorSamples, TWICE};
use super::moments::Moments;
use super::norm::{ErrorNorm, NormWeights};
use super::pairs::PairProducts;
use crate::paths::Place;
use crate::progress::Stop;
use crate::values::{ErrorBars, Gather, Gathered};

impl ErrorSamples {
    /// What the errors of values hang on in some channels, relative to the light at each point; `again` are second values at some of them.
    pub(super) fn error_bars(&self, gather: &Gather<'_>, again: &[(usize, Gathered)], channels: Range<usize>) -> Option<ErrorBars> {
        let judging = Judging::of(gather);
        let Some(weights) = NormWeights::new(ErrorNorm::Local, &self.lit(judging, &self.values, channels.clone())) else {
            return Some(ErrorBars { noise: 1.0, bias: 0.0, of_light: 0.0 });
        };
        let weights = weights.by_point;

        // The noise that was found, beside what samples tell.
        let told = |value: &Gathered| value.variance[channels.clone()].iter().sum::<f64>();
        let (mut noise_sq, mut told_sq) = (0.0, 0.0);
        for (index, again) in again {
            let value = &self.values[*index][0];
            let difference_sq = value.radiosity[channels.clone()]
                .iter()
                .zip(&again.radiosity[channels.clone()])
                .map(|(value, again)| (value - again).powi(2));
            noise_sq += weights[*index] * 0.5 * difference_sq.sum::<f64>();
            told_sq += weights[*index] * told(value);
        }
        let noise = if told_sq > 0.0 { noise_sq / told_sq } else { 1.0 };

        // What is left of the error, beside what links or cells bring. Over links replicates see the noise of values as well.
        let (mut bias_sq, mut by_sources_sq) = (Moments::default(), 0.0);
        for ((sample, values), weight) in self.samples.iter().zip(&self.values).zip(weights) {
            let mut products = PairProducts::default();
            compared(sample, judging, values, channels.clone()).for_each(|compared| products.add(weight, compared.residuals));
            let of_values = if judging.is_taken_twice { 0.0 } else { weight * noise * told(&values[0]) };
            bias_sq.add(products.all - of_values);
            by_sources_sq += weight * values[0].by_sources_sq[channels.clone()].iter().sum::<f64>();
        }
        let bias_sq = mean_if_positive(bias_sq.sum, bias_sq.deviation_of_sum());
        let bias = if by_sources_sq > 0.0 { (bias_sq / by_sources_sq).sqrt() } else { 0.0 };
        Some(ErrorBars { noise, bias, of_light: bias_sq.sqrt() }).filter(ErrorBars::is_valid)
    }

    /// Second values at some of the points, with their numbers; `None` if stopped.
    pub(super) fn taken_again(&self, gather: &Gather<'_>, stop: Stop<'_>) -> Option<Vec<(usize, Gathered)>> {
        if Judging::of(gather).is_taken_twice {
            return Some(self.values.iter().enumerate().step_by(TWICE).map(|(index, [_, again])| (index, again.clone())).collect());
        }
        let places: Vec<Place> = self.samples.iter().step_by(AGAIN).map(|sample| sample.place).collect();
        Some((0..).step_by(AGAIN).zip(values_at(&places, gather, by_other_rays(gather.budget), stop)?).collect())
    }
}

/// What is to be expected of a number that is not negative, measured with this standard deviation: the mean of the normal distribution around
/// what was measured, cut off at 0.
fn mean_if_positive(measured: f64, deviation: f64) -> f64 {
    // The density at the cut, over the part that is left; beyond thirty deviations both vanish.
    let cut = -measured / deviation.max(f64::MIN_POSITIVE);
    if cut.abs() > 30.0 {
        return measured.max(0.0);
    }
    let left = 0.5 * libm::erfc(cut * FRAC_1_SQRT_2);
    measured + deviation * (-0.5 * cut * cut).exp() / (TAU.sqrt() * left)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_negative_is_expected_above_what_was_measured() {
        // sqrt(2 / pi) of a deviation where nothing was found; little where much was (tables of the inverse Mills ratio).
        for (measured, expected) in [(0.0, 0.797_884_560_8), (3.0, 3.004_437_839_0), (-3.0, 0.283_098_654_9)] {
            assert!((mean_if_positive(0.1 * measured, 0.1) - 0.1 * expected).abs() < 1e-9, "{measured}");
        }
        assert_eq!([mean_if_positive(2.0, 0.0), mean_if_positive(-2.0, 0.0), mean_if_positive(-1.0, 0.01)], [2.0, 0.0, 0.0]);
    }
}
