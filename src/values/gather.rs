//! Values at points, over links or over cells.

use glam::DVec3;

use super::budget::RayBudget;
use super::final_gather::FinalGather;
use super::over_links::{LinkGather, LinkScratch};
use crate::hierarchy::Hierarchy;
use crate::paths::{PathScratch, Place, place_at};
use crate::scene::{Scene, SurfaceId};

/// What values at points are gathered over.
pub(crate) enum Over<'a> {
    /// Over the links above the point.
    Links(LinkGather<'a>),
    /// Cells, by paths.
    Cells(FinalGather<'a>),
}

/// Gathers values at points.
pub(crate) struct Gather<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub over: Over<'a>,
    pub budget: RayBudget,
}

/// Memory that is reused from point to point.
#[derive(Default)]
pub(crate) struct Scratch {
    links: LinkScratch,
    pub paths: PathScratch,
}

impl Gather<'_> {
    /// A point with the seed of its value.
    pub fn place_at(&self, point: DVec3, surface: SurfaceId) -> Place {
        place_at(point, surface, self.budget.seed)
    }

    /// The radiosities at places, in W/m^2, by place and channel. A value does not depend on the other places.
    pub fn radiosities_at(&self, places: &[Place], budget: RayBudget, scratch: &mut Scratch, radiosity: &mut [f64]) {
        match &self.over {
            Over::Links(gather) => {
                for (place, radiosity) in places.iter().zip(radiosity.chunks_mut(self.scene.channels())) {
                    gather.radiosity_at(place, budget, &mut scratch.links, radiosity);
                }
            }
            Over::Cells(gather) => {
                gather.sampled_irradiance(places, budget.rays, &mut scratch.paths, radiosity);
                self.reflect(places, radiosity);
            }
        }
    }

    /// Turns irradiances into radiosities: `B = E + rho H`.
    pub(crate) fn reflect(&self, places: &[Place], irradiance: &mut [f64]) {
        for (place, irradiance) in places.iter().zip(irradiance.chunks_mut(self.scene.channels())) {
            let material = self.scene.material_of(place.surface);
            for (channel, value) in irradiance.iter_mut().enumerate() {
                // Noise may take the irradiance below zero where all is dark.
                *value = material.exitance[channel] + material.reflectance[channel] * value.max(0.0);
            }
        }
    }
}
