//! What a sweep changed, and what the later ones will.

/// The ratio of successive changes is taken to be at most this: sweeps converge, because no scene reflects more than it receives.
const MAX_RATIO: f64 = 0.9999;

/// What a sweep changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change {
    /// The largest change of any leaf's radiosity, in W/m^2.
    pub largest: f64,
    /// The largest reflected radiosity `rho H` of any leaf, in W/m^2.
    pub brightest: f64,
}

impl Change {
    /// The changes of two sets of leaves together.
    pub fn and(self, other: Self) -> Self {
        Self { largest: self.largest.max(other.largest), brightest: self.brightest.max(other.brightest) }
    }

    /// What all later sweeps together will change, in W/m^2: the rest of a geometric series with the ratio of the last two changes.
    ///
    /// `previous` is the largest change of the sweep before, infinite if there was none; then the result is infinite, too.
    pub fn estimate_to_come(&self, previous: f64) -> f64 {
        if previous.is_infinite() && self.largest > 0.0 {
            return f64::INFINITY;
        }
        let ratio = (self.largest / previous).min(MAX_RATIO);
        if self.largest == 0.0 { 0.0 } else { self.largest * ratio / (1.0 - ratio) }
    }
}
