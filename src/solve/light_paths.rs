//! Light paths that know nothing of links: an independent look at what a solution should be.
//!
//! From a place, rays to lamps and over the hemisphere gather one bounce, with given leaf values where the rays end.

use std::f64::consts::TAU;

use glam::DVec3;

use super::lamps::Lamps;
use crate::geometry::{Frame, sampling};
use crate::hierarchy::Hierarchy;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Radiosity;
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// A point on a surface, and the seed of the rays from there.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub point: DVec3,
    pub surface: SurfaceId,
    pub seed: u64,
}

/// Where a ray ends.
enum End {
    Front(SurfaceId, DVec3),
    Back,
    Outside,
}

/// Casts light paths through a scene.
pub(super) struct LightPaths<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    lamps: Lamps<'a>,
}

impl<'a> LightPaths<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>) -> Self {
        Self { scene, rays, lamps: Lamps::new(scene) }
    }

    /// The irradiance H at each place by one bounce, in W/m^2, place after place: `lamp_rays` to lamps, `hemisphere_rays` to leaves. Also the
    /// part of each place's rays over the hemisphere that meet a back.
    pub fn sampled_irradiance(
        &self,
        places: &[Place],
        leaves: (&Hierarchy, &Radiosity),
        (lamp_rays, hemisphere_rays): (u32, u32),
    ) -> (Vec<f64>, Vec<f64>) {
        let channels = self.scene.channels();
        let mut irradiance = vec![0.0; channels * places.len()];
        self.lamps.add_sampled_irradiance(places, self.rays, lamp_rays, &mut irradiance);
        let weight = 1.0 / f64::from(hemisphere_rays);
        let mut backs = vec![0.0; places.len()];
        for (ray, end) in self.cosine_rays(places, hemisphere_rays).enumerate() {
            let place = ray / hemisphere_rays as usize;
            match end {
                End::Front(surface, point) => {
                    self.add_leaf_value(surface, point, leaves, weight, &mut irradiance[place * channels..][..channels]);
                }
                End::Back => backs[place] += weight,
                End::Outside => {}
            }
        }
        (irradiance, backs)
    }

    /// Adds the leaf value that a ray finds where it ends, less what lamp rays bring already.
    fn add_leaf_value(
        &self,
        surface: SurfaceId,
        point: DVec3,
        (hierarchy, radiosity): (&Hierarchy, &Radiosity),
        weight: f64,
        irradiance: &mut [f64],
    ) {
        let radiosity = radiosity.of(hierarchy.leaf_at(surface, point));
        let exitance = &self.scene.material_of(surface).exitance;
        let known = if self.lamps.contains(surface) { 1.0 } else { 0.0 };
        for (channel, h) in irradiance.iter_mut().enumerate() {
            *h += weight * (radiosity[channel] - known * exitance[channel]);
        }
    }

    /// Casts `count` rays from each place, by the cosine, spread as Sobol points; where each ends.
    fn cosine_rays(&self, places: &[Place], count: u32) -> impl Iterator<Item = End> {
        let mut rays = Vec::with_capacity(places.len() * count as usize);
        for place in places {
            let surface = self.scene.surface(place.surface);
            let frame = Frame::around(surface.polygon.facet().normal);
            rays.extend((0..count).map(|index| {
                let [u, v, ..] = sampling::sobol_4d(index, place.seed);
                let (radius, angle) = (u.sqrt(), TAU * v);
                let direction = frame.to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), (1.0 - u).sqrt()));
                Ray { origin: place.point.to_array(), direction: direction.to_array(), origin_plane: surface.plane }
            }));
        }
        let mut hits = Vec::new();
        self.rays.first_hits(&rays, &mut hits);
        rays.into_iter().zip(hits).map(|(ray, hit)| hit.map_or(End::Outside, |hit| self.end(&ray, hit)))
    }

    fn end(&self, ray: &Ray, hit: Hit) -> End {
        let direction = DVec3::from(ray.direction);
        match self.scene.side_towards(SurfaceId(hit.surface), -direction) {
            Some(surface) => End::Front(surface, DVec3::from(ray.origin) + hit.distance * direction),
            None => End::Back,
        }
    }
}
