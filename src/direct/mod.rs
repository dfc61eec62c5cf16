//! Direct light at a point: which part of each emitter it sees, exactly where that is worth it, else by rays.
//!
//! A tree of boxes gives the polygons that may stand between a point and a source (`candidates`); their outlines, as seen from the point, are taken out
//! of the source (`visible_part`, `pieces`); Lambert's sum over the pieces that are left is the form factor. The same rules hold as for rays
//! (`visibility`). Work that grows beyond its worth ends in rays to what is undecided, with their variance (`irradiance`, `undecided`).
//!
//! # Where a point touches something
//! A polygon that the point touches hides nothing. So in the plane of a wall, at its foot, what is behind it shines through, exactly as for rays:
//! who wants the light on one side asks a little off the wall.

mod blockers;
mod candidates;
mod irradiance;
mod lights;
mod outline;
mod pieces;
mod receiver;
mod towards;
mod undecided;
mod view;
mod visible_part;

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::sampling;
use crate::scene::{Emitter, Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Visibility;

pub(crate) use blockers::Blockers;
pub use irradiance::{DirectEffort, Method};
pub(crate) use irradiance::{DirectLight, DirectScratch};
pub(crate) use lights::{LightRays, Lights};
pub(crate) use receiver::Receiver;
pub(crate) use towards::Towards;

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

/// The irradiance that comes straight from all emitters and lights of a scene at points that lie on the surfaces named with them; `seed` picks random numbers.
///
/// Skies are always seen by rays. Exact parts are good to about 1e-12 for each edge of what stands between, as a part of the exitance. Each point looks at all emitters: where there
/// are thousands, that alone takes longer than rays to some would.
pub fn direct_irradiance(
    scene: &Scene,
    visibility: &dyn Visibility,
    points: &[(SurfaceId, [f64; 3])],
    effort: DirectEffort,
    seed: u64,
) -> DirectIrradiance {
    let channels = scene.channels();
    let rays = Rays::new(visibility, scene);
    let emitters = Emitter::all(scene);
    let light = DirectLight { scene, rays: &rays, blockers: Blockers::of(scene, &rays), emitters: &emitters };
    let (mut irradiance, mut variance) = (vec![0.0; points.len() * channels], vec![0.0; points.len() * channels]);
    let sums = irradiance.par_chunks_mut(channels).zip(variance.par_chunks_mut(channels));
    points.par_iter().zip(sums).for_each_init(DirectScratch::default, |scratch, (&(surface, point), (irradiance, variance))| {
        let point = DVec3::from(point);
        let receiver = Receiver::on(scene.surface(surface), point, sampling::seed_at(point, seed));
        light.add_irradiance(&receiver, effort, scratch, irradiance, variance);
        light.add_lights(&receiver, effort.rays, scratch, irradiance, variance);
        light.add_sky(&receiver, effort.rays, scratch, irradiance, variance);
    });
    DirectIrradiance { irradiance, variance, rays: rays.segments().count() }
}
