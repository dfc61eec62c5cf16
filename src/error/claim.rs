//! Claims: upper confidence limits of a measured error.
//!
//! An error is looked at until it can be claimed, so each look is another chance to be wrong. The limit is that of a group sequential test:
//! with [`SIGMAS`] at each of five looks, at sums that grow, all together claim falsely with a probability of 2.5% (Pocock, Biometrika 64,
//! 1977), as far as sums over many points are normal. Fewer looks risk less, more looks more.
//!
//! Squared errors are skewed: a few points hold much of their sum. Where chance leaves such points out, both the sum and its deviation come out
//! small, and so many deviations hold less often than they should. So the limit is the quantile of a distribution that is as skewed as the sum is found,
//! and at least as skewed as a sum that is as large as the limit may be expected to be ([`LEAST_SKEWNESS`]). What no point shows, it cannot tell: light so
//! rare that none of the points meets it.

use super::moments::Scatter;
use super::replicates::REPLICATES;

/// The one-sided probability with which a claim holds.
pub(crate) const CONFIDENCE: f64 = 0.975;

/// How many standard deviations a claim lies above the measured square at each of five looks, where sums are normal.
pub(crate) const SIGMAS: f64 = 2.413;

/// The least skewness of a sum of squares, times its deviation over its mean. Of squares of normal errors at least 2, by the inequality of Cauchy and
/// Schwarz; 3, as of a lognormal sum, where errors at points differ: measured over seven scenes (docs/experiments.md).
const LEAST_SKEWNESS: f64 = 3.0;

/// The largest skewness that is found: that of a sum of any number of values, one of which holds all.
const ALL_IN_ONE: f64 = 1.0;

/// By how much quantiles are larger where a deviation is known from the scatter of the replicates alone: Student's t with seven degrees of
/// freedom beside the normal quantile, both of the risk of a single look, 0.8%.
pub(super) const FEW_REPLICATES: f64 = 1.31;
const _: () = assert!(REPLICATES - 1 == 7);

/// What the sweeps over cell radiosities leave undone, relative to the reflected light: values and replicates have it in common.
const LEFT_BY_SWEEPS: f64 = 2e-5;

/// The upper limit that is claimed for a measured square that scatters so.
pub(crate) fn claim(error_sq: f64, scatter: Scatter) -> f64 {
    upper_limit(error_sq, scatter) + LEFT_BY_SWEEPS
}

/// The same where nothing is left by sweeps: of what is off values.
pub(crate) fn upper_limit(error_sq: f64, scatter: Scatter) -> f64 {
    if scatter.deviation == 0.0 || !error_sq.is_finite() {
        return error_of(error_sq);
    }
    let measured = error_sq.max(0.0);
    (scatter.deviation * limit_in_deviations(measured / scatter.deviation, scatter.skewness)).sqrt()
}

/// An error by an unbiased estimate of its square: 0 where that came out negative, infinite where it is not a number.
pub(super) fn error_of(error_sq: f64) -> f64 {
    if error_sq.is_nan() { f64::INFINITY } else { error_sq.max(0.0).sqrt() }
}

/// The upper limit of a sum, from the sum and its skewness, both numbers in units of its deviation: the largest true value that is not too far above
/// what was measured, if the sum is as skewed as was found and as that value says.
fn limit_in_deviations(measured: f64, skewness: f64) -> f64 {
    let rejects = |limit: f64| limit >= measured + sigmas(expected_skewness(skewness, limit));
    let (mut below, mut above) = (measured + sigmas(skewness.min(ALL_IN_ONE)), measured + sigmas(ALL_IN_ONE));
    if rejects(below) {
        return below;
    }
    // Forty halvings leave roundings.
    for _ in 0..40 {
        let middle = 0.5 * (below + above);
        *(if rejects(middle) { &mut above } else { &mut below }) = middle;
    }
    above
}

/// The skewness of a sum that is as large as a limit, from what was found and from the limit in units of the sum's deviation.
fn expected_skewness(found: f64, limit: f64) -> f64 {
    (LEAST_SKEWNESS / limit).clamp(found.min(ALL_IN_ONE), ALL_IN_ONE)
}

/// How many of the deviations that were found with it a sum of this skewness lies below its mean, with the risk of a look: as a multiple of a chi-square
/// variable of that skewness does (three moments: Solomon and Stephens, Journal of the American Statistical Association 72, 1977), its quantile by
/// Wilson and Hilferty (1931). To first order in the skewness that is right for any sum. One that is skewed the other way counts as normal.
fn sigmas(skewness: f64) -> f64 {
    /// Below, what the skewness adds is lost in roundings.
    const SKEWED: f64 = 1e-6;

    if skewness <= SKEWED {
        return SIGMAS;
    }
    let part_of_mean = (1.0 - skewness * skewness / 36.0 - SIGMAS * skewness / 6.0).powi(3);
    2.0 / skewness * (1.0 / part_of_mean - 1.0)
}

/// The standard deviation that leaves room for a claim of 1, if the square of the error is `error_sq` and the sum is no more skewed than sums of
/// squares are at least.
pub(crate) fn doubt_for_claim(error_sq: f64) -> f64 {
    // The limit is 1, so its skewness is LEAST_SKEWNESS times what is looked for.
    let cube_root_of_part = (1.0 + 0.5 * LEAST_SKEWNESS * (1.0 - error_sq).max(0.0)).cbrt().recip();
    let skewness = 3.0 * ((SIGMAS * SIGMAS + 4.0 * (1.0 - cube_root_of_part)).sqrt() - SIGMAS);
    skewness / LEAST_SKEWNESS
}

/// The largest measured square that scatters so and lets `limit` be claimed; below 0 where none does.
pub(crate) fn largest_sq_for_claim(limit: f64, scatter: Scatter) -> f64 {
    let limit_sq = (limit - LEFT_BY_SWEEPS).max(0.0).powi(2);
    if scatter.deviation == 0.0 {
        return limit_sq;
    }
    let in_deviations = limit_sq / scatter.deviation;
    limit_sq - scatter.deviation * sigmas(expected_skewness(scatter.skewness, in_deviations))
}

/// Standard deviations of a measured square: by the products of replicates at points, by what replicates have in common at all points, by the
/// noise of values, and by what light it is relative to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Doubts {
    pub replicates: f64,
    pub common: f64,
    pub noise: f64,
    pub median: f64,
    /// Of their sum.
    pub skewness: f64,
}

impl Doubts {
    pub fn all(&self) -> Scatter {
        let deviation = self.replicates.hypot(self.common).hypot(self.noise).hypot(self.median);
        Scatter { deviation, skewness: self.skewness }
    }
}

#[cfg(test)]
mod tests {
    use super::super::moments::Moments;
    use super::*;
    use crate::geometry::sampling;

    const CHI_SQUARE: [(f64, f64); 3] = [(20.0, 7.9662), (50.0, 29.1026), (200.0, 154.9675)];

    /// Quantiles of the chi-square distribution at the risk of a look, 0.791%, from tables: the limit of a variable with so many degrees of freedom.
    #[test]
    fn the_limit_of_a_sum_of_equal_squares_is_that_of_chi_square() {
        for (degrees, quantile) in CHI_SQUARE {
            let (deviation, skewness) = ((2.0 / degrees).sqrt(), (8.0 / degrees).sqrt());
            let limit = 1.0 + deviation * sigmas(skewness);
            assert!((limit * quantile / degrees - 1.0).abs() < 0.01, "{limit} with {degrees} degrees of freedom");
        }
        assert_eq!([sigmas(0.0), sigmas(-1.0)], [SIGMAS; 2]);
        assert!((sigmas(1e-5) - SIGMAS).abs() < 1e-4);
    }

    #[test]
    fn limits_grow_with_what_is_measured_and_with_skewness() {
        let limit = |measured: f64, skewness: f64| limit_in_deviations(measured, skewness);
        let mut last = 0.0;
        for step in 0..200 {
            let measured = 0.1 * f64::from(step);
            let found = limit(measured, 0.0);
            // It is as far above as its own skewness says.
            assert!((found - measured - sigmas(LEAST_SKEWNESS / found)).abs() < 1e-6 && found > last, "{found} at {measured}");
            assert!(limit(measured, 0.9) > found);
            last = found;
        }
        assert!((limit(1e6, 0.0) - 1e6 - SIGMAS).abs() < 1e-4);
        assert_eq!(upper_limit(4.0, Scatter::default()), 2.0);
    }

    #[test]
    fn what_leaves_room_for_a_claim_leaves_just_that() {
        for error_sq in [0.0, 0.3, 0.6, 0.95] {
            let scatter = Scatter { deviation: doubt_for_claim(error_sq), skewness: 0.0 };
            assert!((upper_limit(error_sq, scatter) - 1.0).abs() < 1e-9, "{scatter:?} at {error_sq}");
        }
        assert_eq!(doubt_for_claim(1.5), 0.0);
    }

    #[test]
    fn the_largest_square_for_a_claim_is_claimed_just_so() {
        for (deviation, skewness) in [(0.0, 0.0), (1e-6, 0.0), (2e-5, 0.3), (1e-5, 0.9)] {
            let scatter = Scatter { deviation, skewness };
            let largest = largest_sq_for_claim(0.01, scatter);
            assert!(largest >= 0.0 && (claim(largest, scatter) / 0.01 - 1.0).abs() < 1e-9, "{largest} with {scatter:?}");
        }
        assert!(largest_sq_for_claim(0.01, Scatter { deviation: 1e-4, skewness: 0.0 }) < 0.0);
    }

    /// Of 512 values each the square of an exponential number, whose mean is 2: as skewed as the squared errors of rooms. The risk of a look is 0.8%.
    #[test]
    fn skewed_sums_are_claimed_too_small_about_as_rarely_as_the_limit_says() {
        const TRIALS: u64 = 8_000;
        let (mut normal, mut claimed) = (0, 0);
        for trial in 0..TRIALS {
            let mut moments = Moments::default();
            moments.extend((0..512).map(|k| sampling::unit(sampling::hash(trial, k)).max(1e-18).ln().powi(2) / 512.0));
            let scatter = moments.scatter_of_sum();
            normal += u64::from(moments.sum + SIGMAS * scatter.deviation < 2.0);
            claimed += u64::from(upper_limit(moments.sum, scatter).powi(2) < 2.0);
        }
        // By 20,000 trials of another program 2.71 and 1.15%; four standard deviations of 8,000 trials are 0.7 and 0.5%.
        let percent = |missed: u64| 100.0 * missed as f64 / TRIALS as f64;
        let (normal, claimed) = (percent(normal), percent(claimed));
        assert!(claimed < 1.6 && normal > 2.0, "{claimed}% for {normal}%");
    }

    #[test]
    fn nothing_is_claimed_of_what_is_not_a_number() {
        let scatter = |deviation| Scatter { deviation, skewness: 0.0 };
        assert_eq!([error_of(f64::NAN), claim(f64::NAN, scatter(0.0)), claim(f64::NAN, scatter(f64::NAN))], [f64::INFINITY; 3]);
        assert_eq!(error_of(-1.0), 0.0);
    }
}
