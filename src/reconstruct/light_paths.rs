//! Light paths that know nothing of links: rays to lamps and over the hemisphere, and what they find.
//!
//! A path leaves a place by the cosine. Where it ends it finds the radiosity that is resolved in the cell there, if the cell looks
//! small from where the path comes. Else, near by, the cell's one value is no good: one ray to a lamp and one over the hemisphere
//! take its place, and the path goes on.

use std::f64::consts::TAU;

use glam::DVec3;

use super::lamps::Lamps;
use super::lattice::Lattice;
use crate::geometry::{Frame, sampling};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// A point on a surface, and the seed of the rays from there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub point: DVec3,
    pub surface: SurfaceId,
    pub seed: u64,
}

/// A cell looks small from so many times its size.
const SMALL_FROM: f64 = 1.5;

/// A path ends after so many bounces, wherever it is.
const MAX_BOUNCES: u32 = 16;

/// The cell of a path that ends on none.
pub(super) const NO_CELL: u32 = u32::MAX;

/// Where paths end, path after path: each brings `constant + weight * (what its cell sends)`, by channel.
#[derive(Default)]
pub(crate) struct Ends {
    pub(super) cell: Vec<u32>,
    /// Whether the first thing that the path met was a back.
    pub(super) back: Vec<bool>,
    pub(super) constant: Vec<f64>,
    pub(super) weight: Vec<f64>,
}

/// A path that goes on from a place.
struct Walk {
    path: usize,
    place: Place,
}

/// Casts light paths through a scene.
pub(crate) struct LightPaths<'a> {
    pub(super) scene: &'a Scene,
    pub(super) lattice: Lattice,
    rays: &'a Rays<'a>,
    lamps: Lamps<'a>,
}

impl<'a> LightPaths<'a> {
    /// Paths that end in cells of about `side` metres.
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, side: f64) -> Self {
        Self { scene, rays, lamps: Lamps::new(scene, rays), lattice: Lattice::new(scene, side) }
    }

    /// Adds the irradiance from lamps at each place, by `count` rays, place after place.
    pub(super) fn add_lamps(&self, places: &[Place], count: u32, irradiance: &mut [f64]) {
        self.lamps.add_sampled_irradiance(places, self.rays, count, irradiance);
    }

    /// What a surface emits that lamp rays do not bring, by channel.
    pub(super) fn unlamped_exitance(&self, surface: SurfaceId) -> Option<&'a [f64]> {
        (!self.lamps.contains(surface)).then(|| &self.scene.material_of(surface).exitance[..])
    }

    /// Follows `count` paths from each place to their ends; each takes `bounces` bounces at least.
    pub(super) fn follow(&self, places: &[Place], count: u32, bounces: u32, ends: &mut Ends) {
        let channels = self.scene.channels();
        let paths = places.len() * count as usize;
        ends.cell.clear();
        ends.cell.resize(paths, NO_CELL);
        ends.back.clear();
        ends.back.resize(paths, false);
        ends.constant.clear();
        ends.constant.resize(paths * channels, 0.0);
        ends.weight.clear();
        ends.weight.resize(paths * channels, 1.0);

        // The first rays, from the places.
        let mut walks = Vec::new();
        let looks: Vec<Ray> = places.iter().flat_map(|place| self.cosine_rays(place, 0..count)).collect();
        let mut hits = Vec::new();
        self.rays.first_hits(&looks, &mut hits);
        let seed = |path: usize| sampling::hash(places[path / count as usize].seed, (path % count as usize) as u64 | 1 << 32);
        for (path, (look, hit)) in looks.iter().zip(&hits).enumerate() {
            self.arrive(path, look, *hit, bounces > 0, || seed(path), ends, &mut walks);
        }

        // Bounce by bounce, those that have not ended go on from where they are.
        let (mut bounce, mut irradiance) = (1, Vec::new());
        while !walks.is_empty() {
            let places: Vec<Place> = walks.iter().map(|walk| walk.place).collect();
            irradiance.clear();
            irradiance.resize(places.len() * channels, 0.0);
            self.add_lamps(&places, 1, &mut irradiance);
            for (walk, irradiance) in walks.iter().zip(irradiance.chunks(channels)) {
                let material = self.scene.material_of(walk.place.surface);
                let exitance = self.unlamped_exitance(walk.place.surface);
                for channel in 0..channels {
                    let own = exitance.map_or(0.0, |exitance| exitance[channel]);
                    let (rho, index) = (material.reflectance[channel], walk.path * channels + channel);
                    ends.constant[index] += ends.weight[index] * (own + rho * irradiance[channel]);
                    ends.weight[index] *= rho;
                }
            }

            let looks: Vec<Ray> = places.iter().flat_map(|place| self.cosine_rays(place, 0..1)).collect();
            self.rays.first_hits(&looks, &mut hits);
            let mut further = Vec::new();
            if bounce < MAX_BOUNCES {
                for (walk, (look, hit)) in walks.iter().zip(looks.iter().zip(&hits)) {
                    let seed = || sampling::hash(walk.place.seed, 1 << 33);
                    self.arrive(walk.path, look, *hit, bounce < bounces, seed, ends, &mut further);
                }
            }
            walks = further;
            bounce += 1;
        }
    }

    /// Ends a path where its ray arrives, or lets it go on from there.
    #[allow(clippy::too_many_arguments, reason = "what a ray knows at its end")]
    fn arrive(
        &self,
        path: usize,
        ray: &Ray,
        hit: Option<Hit>,
        goes_on: bool,
        seed: impl Fn() -> u64,
        ends: &mut Ends,
        further: &mut Vec<Walk>,
    ) {
        let Some(hit) = hit else { return };
        let direction = DVec3::from(ray.direction);
        let Some(surface) = self.scene.side_towards(SurfaceId(hit.surface), -direction) else {
            ends.back[path] = true;
            return;
        };
        let point = DVec3::from(ray.origin) + hit.distance * direction;
        match self.lattice.cell_at(surface, point) {
            Some((cell, size)) if !goes_on && hit.distance >= SMALL_FROM * size => ends.cell[path] = cell,
            _ => further.push(Walk { path, place: Place { point, surface, seed: seed() } }),
        }
    }

    /// Rays from a place by the cosine, spread as Sobol points.
    fn cosine_rays(&self, place: &Place, indices: std::ops::Range<u32>) -> impl Iterator<Item = Ray> + use<> {
        let surface = self.scene.surface(place.surface);
        let frame = Frame::around(surface.polygon.facet().normal);
        let (origin, origin_plane, seed) = (place.point.to_array(), surface.plane, place.seed);
        let spread = sampling::shifted_sobol_2d(seed);
        indices.map(move |index| {
            let [u, v] = spread(index);
            let (radius, angle) = (u.sqrt(), TAU * v);
            let direction = frame.to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), (1.0 - u).sqrt()));
            Ray { origin, direction: direction.to_array(), origin_plane }
        })
    }
}
