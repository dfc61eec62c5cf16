//! Independent replicates: at every point a few estimates, by other random numbers, of the true light or of by how much values are
//! too bright.

use serde::{Deserialize, Serialize};

use crate::geometry::{sampling, streams};
use crate::hierarchy::Hierarchy;
use crate::paths::{PathScratch, Place};
use crate::scene::Scene;
use crate::sweep::Radiosity;
use crate::team::Share;
use crate::values::FinalGather;

use super::residual::{ResidualGather, Residuals};

/// How many there are. All pairs count, so more of them with fewer rays each know as much of the error; and they tell how much they have in
/// common at all points, with one degree of freedom less than they are. At least three; the more, the less evenly the rays of
/// each are spread.
pub(crate) const REPLICATES: usize = 8;

/// The rays of the replicates at a point, relative to the mean over all points, lie between these. Ratios.
const LEAST_SHARE: f64 = 0.25;
const MOST_SHARE: f64 = 32.0;

/// What a replicate estimates at a point, as irradiance.
pub(crate) enum ReplicateGather<'a> {
    /// The true irradiance, where values go over links.
    Truth(FinalGather<'a>),
    /// By how much the irradiance of values over cells is too large.
    Residual(ResidualGather<'a>),
}

/// What replicates are taken with.
pub(crate) struct Replication<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    /// Radiosities of the leaves: more points lie where it is bright.
    pub radiosity: &'a Radiosity,
    pub gathers: [ReplicateGather<'a>; REPLICATES],
    pub seed: u64,
    /// Paths that may leave a point, times the square of the error that is asked for: see [`dark`](super::dark).
    pub most_paths: f64,
}

/// A point with what its replicates found.
#[derive(Serialize, Deserialize)]
pub(super) struct ErrorSample {
    pub place: Place,
    /// The area in m^2 that the point stands for if it is the only one.
    pub stands_for: f64,
    /// By replicate: the mean of what its rays found, in W/m^2 by channel.
    pub found: [Vec<f64>; REPLICATES],
    /// What its own cells on unresolved surfaces bring of that: see [`residual`](super::residual).
    pub of_unresolved: [Vec<f64>; REPLICATES],
    /// Rays of each replicate so far.
    pub rays: u32,
    /// The mean square of what a single ray finds, in W^2/m^4.
    pub noise: f64,
    /// How much that matters in the norm, relative to other points.
    pub noisiness: f64,
    /// Where it was searched for light.
    pub searched: Option<Searched>,
}

/// What the paths of a search for light found at a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Searched {
    /// What is reflected there, in W/m^2; 0 where no light was found.
    pub light: f64,
}

impl ReplicateGather<'_> {
    /// Which of the points this process takes.
    pub(super) fn share(&self) -> Share<'_> {
        match self {
            Self::Truth(gather) => gather.paths.rays.share(),
            Self::Residual(gather) => gather.paths.rays.share(),
        }
    }

    /// The mean square of the reflected residual by a single ray, in W^2/m^4, by pilot rays that no replicate takes; 0 over links.
    pub(super) fn sampled_noise(&self, place: Place, count: u32, scene: &Scene, scratch: &mut PathScratch) -> f64 {
        let Self::Residual(gather) = self else { return 0.0 };
        let channels = scene.channels();
        let of_ray = |ray| Place { seed: sampling::hash(place.seed, streams::REPLICATE_PILOT + ray), ..place };
        let rays: Vec<Place> = (0..u64::from(count)).map(of_ray).collect();
        let mut found = vec![0.0; rays.len() * channels];
        let mut of_unresolved = vec![0.0; found.len()];
        gather.sampled_residual(&rays, 1, scratch, &mut Residuals { all: &mut found, of_unresolved: &mut of_unresolved });
        let reflectance = &scene.material_of(place.surface).reflectance[..scene.deciding()];
        let deciding = found.chunks(channels).flat_map(|found| found.iter().zip(reflectance));
        deciding.map(|(found, rho)| (rho * found).powi(2)).sum::<f64>() / f64::from(count)
    }

    fn sample(&self, place: Place, rays: u32, scratch: &mut PathScratch, found: &mut Residuals<'_>) {
        match self {
            Self::Truth(gather) => gather.sampled_irradiance(&[place], rays, scratch, found.all),
            Self::Residual(gather) => gather.sampled_residual(&[place], rays, scratch, found),
        }
    }
}

impl ErrorSample {
    /// Takes more rays, until each replicate has `rays`; `found` is memory for two results.
    pub fn take_up_to(
        &mut self,
        rays: u32,
        gathers: &[ReplicateGather<'_>; REPLICATES],
        scratch: &mut PathScratch,
        found: &mut [f64],
    ) {
        let more = rays.saturating_sub(self.rays);
        if more == 0 {
            return;
        }
        let share = f64::from(more) / f64::from(self.rays + more);
        let (all, of_unresolved) = found.split_at_mut(found.len() / 2);
        for (number, gather) in gathers.iter().enumerate() {
            let seed = sampling::hash(self.place.seed, streams::replicate(number as u8) + u64::from(self.rays));
            gather.sample(Place { seed, ..self.place }, more, scratch, &mut Residuals { all, of_unresolved });
            let known = self.found[number].iter_mut().chain(&mut self.of_unresolved[number]);
            known.zip(all.iter().chain(&*of_unresolved)).for_each(|(known, found)| *known += share * (found - *known));
        }
        self.rays += more;
    }
}

/// How the rays of replicates are shared out over the points.
///
/// The variance of a product of two replicates goes with the square of `noisiness / rays`. For a given number of rays in all, the
/// variance of the sum over points is least with `rays` in proportion to `noisiness^(2/3)`.
pub(super) struct RayShares {
    mean_power: f64,
}

impl RayShares {
    pub fn new(samples: &[ErrorSample]) -> Self {
        let powers = samples.iter().map(|sample| sample.noisiness.cbrt().powi(2));
        Self { mean_power: powers.sum::<f64>() / samples.len().max(1) as f64 }
    }

    /// The rays at a sample as a multiple of the mean.
    pub fn of(&self, sample: &ErrorSample) -> f64 {
        let share = if self.mean_power > 0.0 { sample.noisiness.cbrt().powi(2) / self.mean_power } else { 1.0 };
        share.clamp(LEAST_SHARE, MOST_SHARE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SurfaceId;

    #[test]
    fn noisy_points_take_more_rays_within_limits() {
        let sample = |noisiness: f64| ErrorSample {
            place: Place { point: glam::DVec3::ZERO, surface: SurfaceId(0), seed: 0 },
            stands_for: 1.0,
            found: Default::default(),
            of_unresolved: Default::default(),
            rays: 0,
            noise: 0.0,
            noisiness,
            searched: None,
        };
        let samples: Vec<ErrorSample> = [1.0, 8.0, 0.0, 1e9].map(sample).into();
        let shares = RayShares::new(&samples[..2]);
        assert!((shares.of(&samples[1]) / shares.of(&samples[0]) - 4.0).abs() < 1e-12);
        assert!((shares.of(&samples[0]) + shares.of(&samples[1]) - 2.0).abs() < 1e-12);
        assert_eq!((shares.of(&samples[2]), shares.of(&samples[3])), (LEAST_SHARE, MOST_SHARE));
        assert_eq!(RayShares::new(&samples[2..3]).of(&samples[2]), 1.0);
    }
}
