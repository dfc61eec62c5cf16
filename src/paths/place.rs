//! Places: where rays start, and by which random numbers.

use glam::DVec3;

use crate::geometry::sampling;
use crate::scene::SurfaceId;

/// A point on a surface, and the seed of all random numbers of the rays from there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub point: DVec3,
    pub surface: SurfaceId,
    pub seed: u64,
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
