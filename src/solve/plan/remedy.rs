//! What may be done about an error that is too large, or of which too little is known to claim it.
//!
//! The square of the error has two parts: noise of the gather at points, which is sampled by gathering again and falls as rays are
//! added, and the rest, which falls as radiosities at the ends of paths are resolved more finely. Either is known as well as looks and
//! points are many. What is claimed follows from all four, so what each remedy will let be claimed is foreseen, and the least work
//! that should do is found among all of them.

use crate::solve::error_estimate::{CONFIDENCE_SIGMAS, Doubts, ErrorEstimate, claim};

/// Of what is not noise of the gather at points, resolving anew leaves this part of the square, and of its doubt.
const LEFT_BY_RESOLVING: f64 = 0.5;

/// What makes values better, or known better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remedy {
    /// So many times the rays to each point.
    pub rays: f64,
    /// Radiosities resolved anew, with more rays.
    pub resolves: bool,
    /// So many times the points that are looked at.
    pub points: f64,
    /// So many times the rays of each look.
    pub look_rays: f64,
}

impl Remedy {
    pub const NONE: Self = Self { rays: 1.0, resolves: false, points: 1.0, look_rays: 1.0 };

    /// Whether values stay as they are.
    pub fn only_looks(&self) -> bool {
        self.rays == 1.0 && !self.resolves
    }
}

/// An error that cannot be claimed yet.
pub(super) struct Doubtful<'a> {
    error: &'a ErrorEstimate,
    /// The parts of the square of the error: noise of the gather at points, and all other.
    noise_sq: f64,
    other_sq: f64,
}

impl<'a> Doubtful<'a> {
    /// The error is not below the noise of values, which is known better.
    pub fn new(error: &'a ErrorEstimate, gather_noise: f64) -> Self {
        let noise_sq = gather_noise.powi(2);
        Self { error, noise_sq, other_sq: (error.measured.powi(2) - noise_sq).max(0.0) }
    }

    pub fn is_noise(&self) -> bool {
        self.noise_sq > self.other_sq
    }

    /// Whether all that is not noise of the gather at points may be a chance of the looks.
    pub fn may_be_chance(&self) -> bool {
        self.other_sq < CONFIDENCE_SIGMAS * self.error.doubts.looks
    }

    /// The next step to know better: more rays where looks are noisy, else more points.
    pub fn closer_look(&self) -> Remedy {
        if self.error.look_scatter > 0.5 {
            Remedy { look_rays: 2.0, ..Remedy::NONE }
        } else {
            Remedy { points: 1.5, ..Remedy::NONE }
        }
    }

    /// What may be claimed after a remedy, as far as it can be foreseen.
    pub fn estimate_claim(&self, remedy: &Remedy) -> f64 {
        let left = if remedy.resolves { LEFT_BY_RESOLVING } else { 1.0 };
        let ErrorEstimate { doubts, look_scatter, .. } = self.error;
        let of_looks = look_scatter / remedy.look_rays.powi(2) + (1.0 - look_scatter);
        let doubts = Doubts { looks: left * doubts.looks * of_looks.sqrt(), noise: doubts.noise / remedy.rays };
        claim(self.noise_sq / remedy.rays + left * self.other_sq, doubts.both() / remedy.points.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(measured: f64, looks: f64, look_scatter: f64) -> ErrorEstimate {
        ErrorEstimate { measured, doubts: Doubts { looks, noise: 0.0 }, look_scatter, ..ErrorEstimate::default() }
    }

    #[test]
    fn what_is_left_shrinks_with_its_own_remedy_alone() {
        let error = estimate(0.02, 0.0, 0.0);
        let (rays, resolved) = (Remedy { rays: 4.0, ..Remedy::NONE }, Remedy { resolves: true, ..Remedy::NONE });
        let noisy = Doubtful::new(&error, 0.02);
        assert!(noisy.is_noise());
        assert!((noisy.estimate_claim(&rays) / claim(1e-4, 0.0) - 1.0).abs() < 1e-12);
        assert_eq!(noisy.estimate_claim(&resolved), noisy.estimate_claim(&Remedy::NONE));
        let coarse = Doubtful::new(&error, 0.0);
        assert!(!coarse.is_noise());
        assert_eq!(coarse.estimate_claim(&rays), coarse.estimate_claim(&Remedy::NONE));
        assert!((coarse.estimate_claim(&resolved) / claim(2e-4, 0.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn doubt_falls_with_points_and_where_it_is_noise_of_looks_faster_with_their_rays() {
        let points = Remedy { points: 4.0, ..Remedy::NONE };
        let rays = Remedy { look_rays: 4.0, ..Remedy::NONE };
        let foreseen = |scatter: f64, remedy: &Remedy| Doubtful::new(&estimate(0.01, 1e-4, scatter), 0.0).estimate_claim(remedy);
        for scatter in [0.0, 1.0] {
            assert!((foreseen(scatter, &points) / claim(1e-4, 0.5e-4) - 1.0).abs() < 1e-12);
        }
        assert!((foreseen(1.0, &rays) / claim(1e-4, 0.25e-4) - 1.0).abs() < 1e-12);
        assert_eq!(foreseen(0.0, &rays), foreseen(0.0, &Remedy::NONE));
    }

    #[test]
    fn the_error_is_not_thought_below_the_noise_of_values() {
        let error = estimate(0.0, 1e-5, 1.0);
        assert_eq!(Doubtful::new(&error, 0.008).estimate_claim(&Remedy::NONE), claim(0.008_f64.powi(2), 1e-5));
    }
}
