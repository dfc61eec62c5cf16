//! Values at points, over links or over cells, and what tells of their errors.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::budget::RayBudget;
use super::final_gather::{FinalGather, emitter_rays};
use super::over_links::{LinkGather, LinkScratch};
use crate::hierarchy::Hierarchy;
use crate::paths::{BATCHES, BatchSums, PathScratch, Place, place_at};
use crate::scene::{Scene, SurfaceId};
use crate::team::Share;

/// What values at points are gathered over.
pub(crate) enum Over<'a> {
    /// Over the links above the point.
    Links(LinkGather<'a>),
    /// Cells, by paths.
    Cells(FinalGather<'a>),
}

/// A part of the reflected light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// By next-event estimation or exactly: of emitters and bright reflectors. Over links, where values are not gathered in parts, all.
    Sharp,
    /// By paths; over links none.
    Smooth,
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
    pub(super) links: LinkScratch,
    pub(super) paths: PathScratch,
    pub(super) sums: Vec<f64>,
}

/// Values at places, by place and channel.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Gathered {
    /// In W/m^2.
    pub radiosity: Vec<f64>,
    /// What their samples say of their variance, in W^2/m^4: right up to a factor that all values of a solve share.
    pub variance: Vec<f64>,
    /// The sum over links or cells of the squares of what each brings, in W^2/m^4: their variance if each is off by itself.
    pub by_sources_sq: Vec<f64>,
    /// Of a part of the reflected light: what of it emitters sent straight, in W/m^2.
    pub straight: Vec<f64>,
}

impl Gathered {
    /// Makes room for so many numbers of each kind, 0 all.
    fn reset(&mut self, count: usize) {
        for numbers in [&mut self.radiosity, &mut self.variance, &mut self.by_sources_sq, &mut self.straight] {
            numbers.clear();
            numbers.resize(count, 0.0);
        }
    }
}

impl Gather<'_> {
    /// A point with the seed of its value.
    pub fn place_at(&self, point: DVec3, surface: SurfaceId) -> Place {
        place_at(point, surface, self.budget.seed)
    }

    /// Which batches of what is gathered this process does.
    pub fn share(&self) -> Share<'_> {
        match &self.over {
            Over::Links(gather) => gather.share(),
            Over::Cells(gather) => gather.paths.rays.share(),
        }
    }

    /// Values at places, each with so many rays. A value does not depend on the other places.
    pub fn values_at(&self, places: &[Place], budget: RayBudget, scratch: &mut Scratch, gathered: &mut Gathered) {
        let channels = self.scene.channels();
        gathered.reset(places.len() * channels);
        match &self.over {
            Over::Links(gather) => {
                for (number, place) in places.iter().enumerate() {
                    let own = number * channels..(number + 1) * channels;
                    gather.radiosity_at(place, budget, &mut scratch.links, &mut gathered.radiosity[own.clone()]);
                    let reflectance = &self.scene.material_of(place.surface).reflectance;
                    let reflected = |found: &mut [f64], of_irradiance: &[f64]| {
                        let found = found.iter_mut().zip(of_irradiance).zip(reflectance);
                        found.for_each(|((found, of_irradiance), rho)| *found = rho * rho * of_irradiance);
                    };
                    reflected(&mut gathered.variance[own.clone()], &scratch.links.variance);
                    reflected(&mut gathered.by_sources_sq[own.clone()], &scratch.links.by_sources_sq);
                    let straight = scratch.links.straight.iter().zip(reflectance).map(|(h, rho)| rho * h);
                    gathered.straight[own].iter_mut().zip(straight).for_each(|(found, straight)| *found = straight);
                }
            }
            Over::Cells(gather) => {
                let Scratch { paths, sums, .. } = scratch;
                self.add_reflected(places, budget.rays.max(1), sums, gathered, |sums| {
                    gather.add_sampled_indirect(places, budget.rays, paths, sums);
                });
                self.add_direct(gather, places, budget, scratch, gathered);
            }
        }
    }

    /// A part of the reflected light at places, each with the rays of its budget. What a place reflects does not depend on the others.
    pub fn reflected_at(&self, places: &[Place], part: Part, scratch: &mut Scratch, gathered: &mut Gathered) {
        let rays = self.budget.rays;
        match (&self.over, part) {
            (Over::Links(_), Part::Sharp) => {
                self.values_at(places, self.budget, scratch, gathered);
                for (place, radiosity) in places.iter().zip(gathered.radiosity.chunks_mut(self.scene.channels())) {
                    let exitance = &self.scene.material_of(place.surface).exitance;
                    radiosity.iter_mut().zip(exitance).for_each(|(radiosity, e)| *radiosity -= e);
                }
            }
            (Over::Links(_), Part::Smooth) => gathered.reset(places.len() * self.scene.channels()),
            (Over::Cells(gather), _) => {
                gathered.reset(places.len() * self.scene.channels());
                let Scratch { paths, sums, .. } = scratch;
                match part {
                    Part::Sharp => self.add_reflected(places, emitter_rays(rays), sums, gathered, |sums| {
                        gather.add_sampled_direct(places, rays, paths, sums);
                    }),
                    Part::Smooth => self.add_reflected(places, rays.max(1), sums, gathered, |sums| {
                        gather.add_sampled_indirect(places, rays, paths, sums);
                    }),
                }
                // Noise may take the light below zero where all is dark.
                gathered.radiosity.iter_mut().for_each(|radiosity| *radiosity = radiosity.max(0.0));
            }
        }
        let found = gathered.straight.iter_mut().zip(&gathered.radiosity);
        found.for_each(|(straight, radiosity)| *straight = straight.clamp(0.0, radiosity.max(0.0)));
    }

    /// The same, which tells what emitters send straight wherever that is; over links that may cost more.
    pub fn keeping_apart(self) -> Self {
        let over = match self.over {
            Over::Links(gather) => Over::Links(gather.keeping_apart()),
            over @ Over::Cells(_) => over,
        };
        Self { over, ..self }
    }

    /// Values at places over cells, indirect irradiance being `known` by place and channel, with what cells bring to it squared: direct light
    /// is gathered.
    pub fn values_with_indirect(
        &self,
        gather: &FinalGather<'_>,
        places: &[Place],
        budget: RayBudget,
        known: impl Iterator<Item = [f64; 2]>,
        scratch: &mut Scratch,
    ) -> Gathered {
        let channels = self.scene.channels();
        let mut gathered = Gathered::default();
        gathered.reset(places.len() * channels);
        for (index, [irradiance, by_cells_sq]) in known.enumerate() {
            let rho = self.scene.material_of(places[index / channels].surface).reflectance[index % channels];
            gathered.radiosity[index] = rho * irradiance;
            gathered.by_sources_sq[index] = rho * rho * by_cells_sq;
        }
        self.add_direct(gather, places, budget, scratch, &mut gathered);
        gathered
    }

    /// Adds direct light and exitance over cells.
    fn add_direct(
        &self,
        gather: &FinalGather<'_>,
        places: &[Place],
        budget: RayBudget,
        scratch: &mut Scratch,
        gathered: &mut Gathered,
    ) {
        let Scratch { paths, sums, .. } = scratch;
        self.add_reflected(places, emitter_rays(budget.rays), sums, gathered, |sums| {
            gather.add_sampled_direct(places, budget.rays, paths, sums);
        });
        for (place, radiosity) in places.iter().zip(gathered.radiosity.chunks_mut(self.scene.channels())) {
            let exitance = &self.scene.material_of(place.surface).exitance;
            // Noise may take the light below zero where all is dark.
            self.scene.clear_dark(radiosity);
            radiosity.iter_mut().zip(exitance).for_each(|(radiosity, e)| *radiosity += e);
        }
    }

    /// Adds what is reflected of the irradiance that `gather` adds to sums of `rays` samples at each place, and what tells of its error.
    fn add_reflected(
        &self,
        places: &[Place],
        rays: u32,
        memory: &mut Vec<f64>,
        gathered: &mut Gathered,
        gather: impl FnOnce(&mut BatchSums<'_>),
    ) {
        let (channels, batches) = (self.scene.channels(), rays.min(BATCHES));
        let values = places.len() * channels;
        memory.clear();
        memory.resize(values * (batches as usize + 2), 0.0);
        let (sums, notes) = memory.split_at_mut(values * batches as usize);
        let (by_cells_sq, straight) = notes.split_at_mut(values);
        let mut sums = BatchSums::new(channels, batches, sums, by_cells_sq).with_straight(straight);
        gather(&mut sums);
        for (number, place) in places.iter().enumerate() {
            for (channel, rho) in self.scene.material_of(place.surface).reflectance.iter().enumerate() {
                let (irradiance, variance) = sums.sum_and_variance(number, channel);
                let by_cells_sq = sums.by_cells_sq(number).map_or(0.0, |sums| sums[channel]);
                let index = number * channels + channel;
                gathered.radiosity[index] += rho * irradiance;
                gathered.variance[index] += rho * rho * variance;
                gathered.by_sources_sq[index] += rho * rho * by_cells_sq;
                gathered.straight[index] += rho * sums.straight(number).map_or(0.0, |straight| straight[channel]);
            }
        }
    }
}
