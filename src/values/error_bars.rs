//! Error bars: the standard error of a value, from what its samples say and from what the error estimate has found.
//!
//! ```text
//! se^2 = noise * s^2 + bias^2 * (sum over sources k of b_k^2)
//! ```
//!
//! s^2 is the variance of the value by its own samples, as if these were independent; they are spread more evenly than that, by about as much
//! everywhere. b_k is what link or cell k brings to the value: each is off by itself, so values to which a few bring most are off by more than
//! others. Both factors are measured at the points of the error estimate.

use serde::{Deserialize, Serialize};

use super::gather::Gathered;

/// What the values of a solve share of their errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ErrorBars {
    /// The variance of values, as a part of what their samples say.
    pub noise: f64,
    /// What links or cells are off by, as a part of what they bring: a root mean square.
    pub bias: f64,
    /// What values are off by beside their noise, as a part of the light at each place, or of typical light where it is darker: a root mean square.
    pub of_light: f64,
}

impl ErrorBars {
    /// The standard error of value `index`, in W/m^2; not a number where its samples are too few to tell.
    pub fn standard_error(&self, gathered: &Gathered, index: usize) -> f64 {
        let variance = self.noise * gathered.variance[index] + self.bias.powi(2) * gathered.by_sources_sq[index];
        let standard_error = variance.sqrt();
        if standard_error.is_finite() { standard_error } else { f64::NAN }
    }

    pub fn is_valid(&self) -> bool {
        let is_valid = |x: f64| x.is_finite() && x >= 0.0;
        is_valid(self.noise) && is_valid(self.bias) && is_valid(self.of_light)
    }
}
