//! Products of pairs of independent replicates, and how much they scatter.
//!
//! The mean product of two replicates of a residual is its square, without the noise of either. All pairs are taken, and all but those of one
//! replicate: the jackknife over replicates.

use super::replicates::REPLICATES;

const COUNT: f64 = REPLICATES as f64;

/// What the replicates at a point, or at all, found, by all pairs and by the pairs without one of them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PairProducts {
    pub all: f64,
    without: [f64; REPLICATES],
}

impl PairProducts {
    /// Adds what the replicates found in one channel.
    pub fn add(&mut self, weight: f64, found: [f64; REPLICATES]) {
        let (sum, sum_sq) = found.iter().fold((0.0, 0.0), |(sum, sum_sq), x| (sum + x, sum_sq + x * x));
        self.all += weight * (sum * sum - sum_sq) / (COUNT * (COUNT - 1.0));
        for (without, x) in self.without.iter_mut().zip(found) {
            let (sum, sum_sq) = (sum - x, sum_sq - x * x);
            *without += weight * (sum * sum - sum_sq) / ((COUNT - 1.0) * (COUNT - 2.0));
        }
    }

    /// Adds those of a point.
    pub fn add_all(&mut self, other: &Self) {
        self.all += other.all;
        self.without.iter_mut().zip(other.without).for_each(|(sum, product)| *sum += product);
    }

    /// The variance of the mean product over draws of the replicates, by the jackknife.
    pub fn variance(&self) -> f64 {
        let mean = self.without.iter().sum::<f64>() / COUNT;
        (COUNT - 1.0) / COUNT * self.without.iter().map(|without| (without - mean).powi(2)).sum::<f64>()
    }
}

/// The mean of what replicates found, and the variance of that mean.
pub(super) fn mean_and_variance(found: [f64; REPLICATES]) -> (f64, f64) {
    let mean = found.iter().sum::<f64>() / COUNT;
    (mean, found.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (COUNT * (COUNT - 1.0)))
}

/// The variance of a mean product of a residual whose square is `product`, where each replicate has normal noise of this variance.
pub(super) fn variance_by_noise(product: f64, variance: f64) -> f64 {
    2.0 / (COUNT * (COUNT - 1.0)) * variance * variance + 4.0 / COUNT * product.max(0.0) * variance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    /// About normal: a sum of twelve uniform numbers.
    fn normal(seed: u64) -> f64 {
        (0..12).map(|k| sampling::unit(sampling::hash(seed, k))).sum::<f64>() - 6.0
    }

    #[test]
    fn products_are_free_of_noise_and_scatter_as_is_foreseen() {
        let (residual, noise, trials) = (0.7, 1.3, 40_000_u64);
        let (mut sum, mut sum_sq, mut jackknife) = (0.0, 0.0, 0.0);
        for trial in 0..trials {
            let mut products = PairProducts::default();
            products.add(2.0, std::array::from_fn(|k| residual + noise * normal(sampling::hash(trial, k as u64))));
            sum += products.all;
            sum_sq += products.all * products.all;
            jackknife += products.variance();
        }
        let mean = sum / trials as f64;
        let variance = sum_sq / trials as f64 - mean * mean;
        let foreseen = 4.0 * variance_by_noise(residual * residual, noise * noise);
        // Four standard deviations of the mean, and what 40,000 trials know of a variance with tails.
        assert!((mean - 2.0 * residual * residual).abs() < 4.0 * (variance / trials as f64).sqrt(), "{mean}");
        assert!((variance / foreseen - 1.0).abs() < 0.05, "{variance} for {foreseen}");
        // The jackknife is somewhat large on the square of the noise, never small (Efron and Stein 1981).
        assert!(jackknife / trials as f64 > 0.95 * variance && jackknife / (trials as f64) < 2.0 * variance);
    }
}
