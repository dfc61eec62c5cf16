//! Places: where rays start, and by which random numbers.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::direct::Receiver;
use crate::geometry::{Frame, sampling};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::Ray;

/// A point on a surface, and the seed of all random numbers of the rays from there.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Place {
    pub point: DVec3,
    pub surface: SurfaceId,
    pub seed: u64,
}

/// Where light is gathered: a place on a surface, or a sensor in space.
pub(crate) trait Receives: Copy {
    /// The point, which way it faces, and the seed of its rays.
    fn receiver(&self, scene: &Scene) -> Receiver;

    /// The surface that it lies on.
    fn surface(&self) -> Option<SurfaceId>;
}

impl Receives for Place {
    fn receiver(&self, scene: &Scene) -> Receiver {
        Receiver::on(scene.surface(self.surface), self.point, self.seed)
    }

    fn surface(&self) -> Option<SurfaceId> {
        Some(self.surface)
    }
}

impl Receives for Receiver {
    fn receiver(&self, _: &Scene) -> Receiver {
        *self
    }

    fn surface(&self) -> Option<SurfaceId> {
        None
    }
}

/// The directions that a seed gives, from number `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Directions {
    pub seed: u64,
    pub first: u32,
}

/// A point, with random numbers that depend on it and `seed` alone.
pub(crate) fn place_at(point: DVec3, surface: SurfaceId, seed: u64) -> Place {
    Place { point, surface, seed: sampling::seed_at(point, seed) }
}

/// Cosine-distributed rays from a receiver, by the Sobol points of these indices.
pub(super) fn cosine_rays<I: Iterator<Item = u32>>(receiver: &Receiver, indices: I) -> impl Iterator<Item = Ray> + use<I> {
    let &Receiver { point, normal, plane: origin_plane, seed } = receiver;
    let (frame, origin, sobol) = (Frame::around(normal), point.to_array(), sampling::shifted_sobol_2d(seed));
    indices.map(move |index| {
        let [u, v] = sobol(index);
        Ray { origin, direction: frame.sampled_by_cosine(u, v).to_array(), origin_plane }
    })
}
