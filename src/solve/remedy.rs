//! What may be done about an error that is too large, or of which too little is known to claim it.
//!
//! The square of the error has two parts: noise of the gather at points, which is sampled by gathering again and falls as rays are
//! added, and the rest, which falls as radiosities at the ends of paths are resolved more finely. The less is left of both, the fewer
//! looks it takes to claim what is requested.

use super::error_estimate::ErrorEstimate;

/// Of what is not noise of the gather at points, resolving anew leaves this part of the square.
const LEFT_BY_RESOLVING: f64 = 0.5;

/// What makes values better, if they are noisy.
pub(super) struct Remedy {
    /// So many times the rays to each point.
    pub rays: f64,
    /// Radiosities resolved anew, at more positions with more rays.
    pub resolves: bool,
}

/// An error of which too little is known to claim it.
pub(super) struct Doubtful<'a> {
    error: &'a ErrorEstimate,
    requested: f64,
    /// What the square of the error may be, and the part of it that is noise of the gather at points.
    pub error_sq: f64,
    noise_sq: f64,
}

impl<'a> Doubtful<'a> {
    /// Of what is measured, half as much may be noise of looks as the claim allows; but the error is not below the noise of values,
    /// which is known better.
    pub fn new(error: &'a ErrorEstimate, gather_noise: f64, requested: f64) -> Self {
        let noise_sq = gather_noise.powi(2);
        let error_sq = (error.measured.powi(2) - 0.5 * error.doubt_sq()).max(noise_sq);
        Self { error, requested, error_sq, noise_sq }
    }

    pub fn is_noise(&self) -> bool {
        self.noise_sq > 0.5 * self.error_sq
    }

    /// What may be left of the square of the error.
    pub fn left_by(&self, remedy: &Remedy) -> f64 {
        let other_sq = self.error_sq - self.noise_sq;
        self.noise_sq / remedy.rays + if remedy.resolves { LEFT_BY_RESOLVING * other_sq } else { other_sq }
    }

    /// How many times as many looks as there are must be added to claim what is requested, if the square of the error is `error_sq`.
    pub fn estimate_more_looks(&self, error_sq: f64) -> f64 {
        (self.error.estimate_looks(error_sq, self.requested) - 1.0).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(measured: f64, claimed: f64, look_scatter: f64) -> ErrorEstimate {
        ErrorEstimate { measured, claimed, look_scatter }
    }

    #[test]
    fn what_is_left_shrinks_with_its_own_remedy_alone() {
        let error = estimate(0.02, 0.022, 0.0);
        let noisy = Doubtful::new(&error, 0.02, 0.01);
        assert!(noisy.is_noise());
        assert!((noisy.left_by(&Remedy { rays: 4.0, resolves: false }) / 1e-4 - 1.0).abs() < 1e-12);
        assert!((noisy.left_by(&Remedy { rays: 4.0, resolves: true }) / 1e-4 - 1.0).abs() < 1e-12);
        let coarse = Doubtful::new(&error, 1e-6, 0.01);
        assert!(!coarse.is_noise());
        let left = coarse.left_by(&Remedy { rays: 8.0, resolves: false });
        assert!((left / coarse.error_sq - 1.0).abs() < 1e-6);
        assert!(coarse.left_by(&Remedy { rays: 1.0, resolves: true }) < 0.51 * left);
    }

    #[test]
    fn looks_grow_with_the_doubt_and_never_suffice_above_the_request() {
        // A doubt twice as large as allowed takes four times the points; where all scatter is noise of looks, twice the rays.
        let requested: f64 = 0.011;
        let doubt_sq = 2.0 * (0.01_f64.powi(2) - 0.005_f64.powi(2));
        let claimed = 1.1 * (0.005_f64.powi(2) + doubt_sq).sqrt();
        let more =
            |scatter: f64| Doubtful::new(&estimate(0.005, claimed, scatter), 0.0, requested).estimate_more_looks(0.005_f64.powi(2));
        assert!((more(0.0) - 3.0).abs() < 1e-9, "{}", more(0.0));
        assert!((more(1.0) - 1.0).abs() < 1e-9, "{}", more(1.0));
        let doubtful_error = estimate(0.005, claimed, 0.0);
        let doubtful = Doubtful::new(&doubtful_error, 0.0, requested);
        assert!(doubtful.estimate_more_looks(0.012_f64.powi(2)).is_infinite());
    }

    #[test]
    fn the_error_is_not_thought_below_the_noise_of_values() {
        let error = estimate(0.0, 0.03, 1.0);
        let doubtful = Doubtful::new(&error, 0.008, 0.01);
        assert_eq!(doubtful.error_sq, 0.008_f64.powi(2));
    }
}
