//! Claims: upper confidence limits of a measured error.
//!
//! An error is looked at until it can be claimed, so each look is another chance to be wrong. The limit is that of a group sequential test:
//! with [`SIGMAS`] at each of five looks, at sums that grow, all together claim falsely with a probability of 2.5% (Pocock, Biometrika 64,
//! 1977), as far as sums over many points are normal. Fewer looks risk less, more looks more.

use super::replicates::REPLICATES;

/// The one-sided probability with which a claim holds.
pub(crate) const CONFIDENCE: f64 = 0.975;

/// How many standard deviations a claim lies above the measured square, at each of five looks.
pub(crate) const SIGMAS: f64 = 2.413;

/// By how much quantiles are larger where a deviation is known from the scatter of the replicates alone: Student's t with seven degrees of
/// freedom beside the normal quantile, both of the risk of a single look, 0.8%.
pub(super) const FEW_REPLICATES: f64 = 1.31;
const _: () = assert!(REPLICATES - 1 == 7);

/// What the sweeps over cell radiosities leave undone, relative to the reflected light: values and replicates have it in common.
const LEFT_BY_SWEEPS: f64 = 2e-5;

/// The upper limit that is claimed for a measured square with this standard deviation.
pub(crate) fn claim(error_sq: f64, deviation: f64) -> f64 {
    upper_limit(error_sq, deviation) + LEFT_BY_SWEEPS
}

/// The same where nothing is left by sweeps: of what is off values.
pub(crate) fn upper_limit(error_sq: f64, deviation: f64) -> f64 {
    (error_sq.max(0.0) + SIGMAS * deviation).sqrt()
}

/// The standard deviation that leaves room for a claim of 1, if the square of the error is `error_sq`.
pub(crate) fn doubt_for_claim(error_sq: f64) -> f64 {
    (1.0 - error_sq) / SIGMAS
}

/// Standard deviations of a measured square: by the products of replicates at points, by what replicates have in common at all points, and
/// by the noise of values.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Doubts {
    pub replicates: f64,
    pub common: f64,
    pub noise: f64,
}

impl Doubts {
    pub fn all(&self) -> f64 {
        self.replicates.hypot(self.common).hypot(self.noise)
    }
}
