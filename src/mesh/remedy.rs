//! What helps most where a function on elements is not yet known to be as good as asked for.
//!
//! What it is off has three parts: noise of its nodes, which more gathers lower; what elements do not follow, which smaller ones do; and what the points
//! at which it was judged leave open, which the claim allows for, and more points lower.

use super::effort::CLAIMED;
use super::judged::Judged;

/// Elements with so much of the squared error, at most and at least, are bisected in a round, twice each: into four.
const BISECTED: (f64, f64) = (0.6, 0.1);

/// The part of their squared error that elements lose then, at least: across an edge of light it falls with the size.
const LOST: f64 = 0.5;

/// If noise of nodes has more of the squared error that is allowed than this, more gathers help most.
const NOISY: f64 = 0.5;

/// Surfaces with so much of the noise take twice the gathers.
pub(super) const NOISIEST: f64 = BISECTED.0;

/// Points at which a function is judged at most.
const MOST_JUDGED: usize = 1 << 20;

/// What is done about a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Remedy {
    /// Elements that make up so much of the squared error are bisected.
    Bisect(f64),
    /// Nodes of surfaces that make up most of the noise take twice the gathers.
    Gather,
    /// It is judged anew, at so many points.
    Judge(usize),
}

/// What is asked for of a function.
pub(super) struct Asked {
    /// The largest error that may be claimed.
    pub error: f64,
    /// Whether more gathers lower its noise.
    pub has_noise: bool,
}

impl Asked {
    /// For a function that was judged at so many points; what it was off without noise, squared, when it was judged before elements were bisected, is
    /// infinite if it was not. `None` if it is as good as asked for.
    pub fn remedy(&self, found: &Judged, judged_at: usize, followed_before: f64) -> Option<Remedy> {
        let allowed_sq = self.error.powi(2);
        // What bisecting does not lower is noise that variances do not tell: few rays of many have most of the light.
        let is_noise = found.noise_sq >= NOISY * allowed_sq || found.followed_sq() >= followed_before;
        let is_clear = found.measured > self.error / CLAIMED;
        if found.claimed <= self.error {
            None
        } else if is_noise && self.has_noise {
            Some(Remedy::Gather)
        } else if !is_clear && judged_at < MOST_JUDGED {
            Some(Remedy::Judge((2 * judged_at).min(MOST_JUDGED)))
        } else {
            Some(Remedy::bisect(found.followed_sq(), allowed_sq / CLAIMED.powi(2) - found.noise_sq))
        }
    }
}

impl Remedy {
    /// For a squared error without noise to become as small as allowed.
    pub fn bisect(error_sq: f64, allowed_sq: f64) -> Self {
        let (most, least) = BISECTED;
        Self::Bisect(if error_sq > allowed_sq { ((error_sq - allowed_sq) / (LOST * error_sq)).clamp(least, most) } else { least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asked for 5%, a function with these parts: what is measured, what is claimed, and what noise has, not squared.
    fn remedy([measured, claimed, noise]: [f64; 3], has_noise: bool, followed_before: f64) -> Option<Remedy> {
        let found = Judged { measured, claimed, noise_sq: noise * noise, by_group: Vec::new() };
        Asked { error: 0.05, has_noise }.remedy(&found, 2000, followed_before)
    }

    #[test]
    fn the_part_that_is_too_large_is_lowered() {
        let anew = f64::INFINITY;
        assert_eq!(remedy([0.04, 0.049, 0.04], true, anew), None);
        assert_eq!(remedy([0.1, 0.12, 0.01], true, anew), Some(Remedy::Bisect(BISECTED.0)));
        assert_eq!(remedy([0.1, 0.12, 0.09], true, anew), Some(Remedy::Gather));
        assert_eq!(remedy([0.03, 0.06, 0.01], true, anew), Some(Remedy::Judge(4000)));
        assert_eq!(remedy([0.1, 0.12, 0.09], false, anew), Some(Remedy::Bisect(BISECTED.0)));
        let Some(Remedy::Bisect(part)) = remedy([0.043, 0.06, 0.0], false, anew) else { panic!("it is clearly off") };
        assert!(BISECTED.1 < part && part < BISECTED.0, "{part}");
    }

    /// Elements have been bisected: if that did not help it is noise, however little of it the variances tell.
    #[test]
    fn what_bisecting_does_not_lower_is_noise() {
        let off = [0.1, 0.12, 0.01];
        assert_eq!(remedy(off, true, 0.12_f64.powi(2)), Some(Remedy::Bisect(BISECTED.0)));
        assert_eq!(remedy(off, true, 0.09_f64.powi(2)), Some(Remedy::Gather));
        assert_eq!(remedy(off, false, 0.09_f64.powi(2)), Some(Remedy::Bisect(BISECTED.0)));
    }

    #[test]
    fn points_to_judge_at_come_to_an_end() {
        let unclear = Judged { measured: 0.0, claimed: 1.0, noise_sq: 0.0, by_group: Vec::new() };
        let asked = Asked { error: 0.05, has_noise: true };
        assert_eq!(asked.remedy(&unclear, MOST_JUDGED - 1, f64::INFINITY), Some(Remedy::Judge(MOST_JUDGED)));
        assert_eq!(asked.remedy(&unclear, MOST_JUDGED, f64::INFINITY), Some(Remedy::Bisect(BISECTED.1)));
    }
}
