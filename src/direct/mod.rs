//! Direct light at a point: which part of each emitter it sees, exactly where that costs less than rays would.

mod blockers;
mod candidates;
mod irradiance;
mod outline;
mod pieces;
mod undecided;
mod view;
mod visible_part;

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::sampling;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Visibility;

pub(crate) use blockers::Blockers;
pub use irradiance::{DirectEffort, Method};
pub(crate) use irradiance::{DirectLight, DirectScratch, Receiver};

/// Direct irradiance at points.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectIrradiance {
    /// In W/m^2, by point and channel.
    pub irradiance: Vec<f64>,
    /// An estimate of the variance of each, in W^2/m^4; 0 where it is exact.
    pub variance: Vec<f64>,
    /// Rays that were cast.
    pub rays: u64,
}

/// The irradiance that comes straight from all emitters of a scene at points that lie on surfaces; `seed` picks random numbers.
pub fn direct_irradiance(
    scene: &Scene,
    visibility: &dyn Visibility,
    points: &[(SurfaceId, [f64; 3])],
    effort: DirectEffort,
    seed: u64,
) -> DirectIrradiance {
    let channels = scene.channels();
    let rays = Rays::new(visibility, scene);
    let blockers = Blockers::of(scene);
    let emitters: Vec<SurfaceId> =
        (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| scene.material_of(id).emits()).collect();
    let light = DirectLight { scene, rays: &rays, blockers: &blockers, emitters: &emitters };
    let (mut irradiance, mut variance) = (vec![0.0; points.len() * channels], vec![0.0; points.len() * channels]);
    let sums = irradiance.par_chunks_mut(channels).zip(variance.par_chunks_mut(channels));
    points.par_iter().zip(sums).for_each_init(DirectScratch::default, |scratch, (&(surface, point), (irradiance, variance))| {
        let point = DVec3::from(point);
        let receiver = Receiver { point, surface, seed: sampling::seed_at(point, seed) };
        light.add_irradiance(&receiver, effort, scratch, irradiance, variance);
    });
    DirectIrradiance { irradiance, variance, rays: rays.segments().count() }
}
