//! What meshes hold: first indirect light alone, which is smooth and dear, then all light.

use super::lit_mesh::MeshReader;
use crate::direct::{DirectEffort, DirectLight, DirectScratch, Method};
use crate::paths::{Place, Receives};
use crate::scene::Scene;
use crate::team::Share;
use crate::values::{IndirectGather, RayBudget, Scratch};

/// How direct light is found where it only tells how bright a place is, which the norm asks: one over the root of the rays is error enough in a weight.
const COARSE: DirectEffort = DirectEffort { rays: 8, method: Method::Rays };

/// Memory that is reused from point to point.
#[derive(Default)]
pub(super) struct LightScratch {
    gather: Scratch,
    direct: DirectScratch,
    numbers: Vec<f64>,
    found: Vec<[f64; 2]>,
}

/// Some of the light that surfaces reflect.
pub(super) trait Light: Sync {
    /// Which batches of places this process takes.
    fn share(&self) -> Share<'_>;

    /// The reflected radiosity at a place and its variance, by channel, by so many times the rays that this light takes.
    fn take(&self, place: &Place, rays: f64, scratch: &mut LightScratch, found: &mut [[f64; 2]]);

    /// All reflected light where `found` was found, squared, channels added.
    fn all_sq(&self, place: &Place, scratch: &mut LightScratch, found: &[[f64; 2]]) -> f64;
}

/// Direct light.
pub(super) struct Direct<'a> {
    pub scene: &'a Scene,
    pub light: &'a DirectLight<'a>,
}

/// Indirect light.
pub(super) struct Indirect<'a> {
    pub direct: &'a Direct<'a>,
    pub gather: &'a IndirectGather<'a>,
    /// How points are gathered, but for the number of rays.
    pub budget: RayBudget,
    /// The rays of a place.
    pub rays: f64,
    /// The true variance for one that batches tell.
    pub noise_scale: f64,
}

/// Direct light, and indirect light by its meshes.
pub(super) struct All<'a> {
    pub direct: &'a Direct<'a>,
    pub indirect: MeshReader<'a>,
    /// By how many rays direct light is found, about, where that is cheaper than to find it exactly.
    pub rays: f64,
}

impl Direct<'_> {
    /// Adds the direct light that is reflected at a place, and its variance.
    fn add(
        &self,
        place: &Place,
        effort: DirectEffort,
        scratch: &mut DirectScratch,
        numbers: &mut Vec<f64>,
        found: &mut [[f64; 2]],
    ) {
        numbers.clear();
        numbers.resize(2 * found.len(), 0.0);
        let (irradiance, variance) = numbers.split_at_mut(found.len());
        let receiver = place.receiver(self.scene);
        self.light.add_irradiance(&receiver, effort, scratch, irradiance, variance);
        self.light.add_lights(&receiver, effort.rays, scratch, irradiance, variance);
        let reflectance = &self.scene.material_of(place.surface).reflectance;
        for (channel, [value, noise]) in found.iter_mut().enumerate() {
            let rho = reflectance[channel];
            *value += rho * irradiance[channel];
            *noise += rho * rho * variance[channel];
        }
    }
}

/// A place takes at least so many rays.
const LEAST_RAYS: f64 = 8.0;

impl Light for Indirect<'_> {
    fn share(&self) -> Share<'_> {
        self.direct.light.rays.share()
    }

    fn take(&self, place: &Place, rays: f64, scratch: &mut LightScratch, found: &mut [[f64; 2]]) {
        let rays = (rays * self.rays).max(LEAST_RAYS).ceil() as u32;
        self.gather.sampled_irradiance(place, RayBudget { rays, ..self.budget }, &mut scratch.gather, found);
        let reflectance = &self.direct.scene.material_of(place.surface).reflectance;
        found.iter_mut().zip(reflectance).for_each(|([value, variance], rho)| {
            *value *= rho;
            *variance *= self.noise_scale * rho * rho;
        });
    }

    fn all_sq(&self, place: &Place, scratch: &mut LightScratch, found: &[[f64; 2]]) -> f64 {
        let LightScratch { direct, numbers, found: all, .. } = scratch;
        all.clear();
        all.extend_from_slice(found);
        self.direct.add(place, COARSE, direct, numbers, all);
        all[..self.direct.scene.deciding()].iter().map(|[value, _]| value * value).sum()
    }
}

impl Light for All<'_> {
    fn share(&self) -> Share<'_> {
        self.direct.light.rays.share()
    }

    fn take(&self, place: &Place, rays: f64, scratch: &mut LightScratch, found: &mut [[f64; 2]]) {
        scratch.numbers.clear();
        scratch.numbers.resize(found.len(), 0.0);
        self.indirect.reflected_at(place.point, place.surface, &mut scratch.numbers);
        found.iter_mut().zip(&scratch.numbers).for_each(|(found, &value)| *found = [value, 0.0]);
        let rays = (rays * self.rays).max(LEAST_RAYS).ceil() as u32;
        let effort = DirectEffort { rays, method: Method::Cheaper };
        self.direct.add(place, effort, &mut scratch.direct, &mut scratch.numbers, found);
    }

    fn all_sq(&self, _place: &Place, _scratch: &mut LightScratch, found: &[[f64; 2]]) -> f64 {
        found[..self.direct.scene.deciding()].iter().map(|[value, _]| value * value).sum()
    }
}
