//! The texels of a chart, with their values as far as these are known.

use glam::DVec3;
use rayon::prelude::*;

use super::atlas::{Atlas, Placed};
use super::charts::Chart;
use super::coverage::{Site, sites};
use crate::paths::{Place, place_at};
use crate::progress::Stop;
use crate::scene::{Material, Scene, SurfaceId};

/// The texels of a chart.
pub(crate) struct Texels<'a> {
    pub chart: &'a Chart,
    pub material: &'a Material,
    /// By texel, row after row.
    pub sites: Vec<Site>,
    /// Reflected radiosity by texel and channel in W/m^2, or a part of it; NaN where it is not known. Where direct light is kept apart, as many numbers
    /// follow for each texel: what of it emitters sent straight.
    pub reflected: Vec<f32>,
    /// The other part, as far as it is known already, else 0.
    pub before: Vec<f32>,
    /// Whether direct light is kept apart.
    pub is_apart: bool,
    /// Whether all of its light is the solver's own: no part of it is to be found any more.
    pub is_coarse: bool,
    /// How many texels a limit kept from being found, in the part where these are most.
    pub not_found: u64,
}

/// The texels of all charts of an atlas. Those of faces that reflect nothing are known. Stopped, charts have none.
pub(crate) fn texels_of<'a>(atlas: &'a Atlas, scene: &'a Scene, stop: Stop<'_>) -> Vec<Texels<'a>> {
    let is_apart = atlas.options.separate;
    let of_chart = |placed: &'a Placed| {
        let (chart, material) = (&placed.chart, &scene.materials()[placed.chart.material as usize]);
        let sites = if stop() { Vec::new() } else { sites(scene, chart) };
        let numbers = |number: f32| vec![number; sites.len() * scene.channels() * if is_apart { 2 } else { 1 }];
        let (reflected, before) = (numbers(if material.reflects() { f32::NAN } else { 0.0 }), numbers(0.0));
        Texels { chart, material, sites, reflected, before, is_apart, is_coarse: false, not_found: 0 }
    };
    atlas.charts.par_iter().map(of_chart).collect()
}

impl Texels<'_> {
    /// Bytes that a texel takes while it is found, with so many numbers for it: what is kept of it, and what it takes to gather it.
    pub fn bytes_of(channels: usize, numbers: usize) -> usize {
        let kept = size_of::<Site>() + 2 * numbers * size_of::<f32>() + size_of::<f32>() + 3 * size_of::<bool>();
        let gathered = 2 * size_of::<[usize; 2]>() + size_of::<Place>() + channels * 2 * size_of::<[f32; 3]>();
        kept + gathered
    }

    /// In a row.
    pub fn columns(&self) -> usize {
        self.chart.size()[0]
    }

    pub fn channels(&self) -> usize {
        self.material.exitance.len()
    }

    /// Numbers for each texel: its channels, and once more where direct light is kept apart.
    pub fn numbers(&self) -> usize {
        self.channels() * if self.is_apart { 2 } else { 1 }
    }

    /// Whether a texel shall have a value and has none yet.
    pub fn is_wanted(&self, index: usize) -> bool {
        self.sites[index].is_covered() && !self.is_known(index)
    }

    /// Whether a texel has a value.
    pub fn is_known(&self, index: usize) -> bool {
        !self.reflected[index * self.numbers()].is_nan()
    }

    /// What is known of the light that a texel reflects.
    pub fn reflected_of(&self, index: usize) -> &[f32] {
        &self.reflected[index * self.numbers()..][..self.channels()]
    }

    /// All numbers of a texel.
    pub fn numbers_of(&self, index: usize) -> &[f32] {
        &self.reflected[index * self.numbers()..][..self.numbers()]
    }

    /// Sets what is reflected, and where direct light is kept apart, what of it is that.
    pub fn set(&mut self, index: usize, reflected: &[f32], straight: &[f32]) {
        let (channels, numbers) = (self.channels(), self.numbers());
        let (whole, apart) = self.reflected[index * numbers..][..numbers].split_at_mut(channels);
        whole.copy_from_slice(reflected);
        apart.iter_mut().zip(straight).for_each(|(number, straight)| *number = *straight);
    }

    /// The square of all light that a texel reflects, channels added, when its value is `reflected`.
    pub fn light_sq(&self, index: usize, reflected: &[f32]) -> f64 {
        let before = &self.before[index * self.numbers()..][..self.channels()];
        reflected.iter().zip(before).map(|(&a, &b)| f64::from(a + b).powi(2)).sum()
    }

    /// Takes the values of texels away.
    pub fn forget(&mut self, indices: impl Iterator<Item = usize>) {
        let numbers = self.numbers();
        indices.for_each(|index| self.reflected[index * numbers..][..numbers].fill(f32::NAN));
    }

    /// What was found is a part: the other one is looked for.
    pub fn begin_next_part(&mut self) {
        if self.material.reflects() {
            let unknown = vec![if self.is_coarse { 0.0 } else { f32::NAN }; self.reflected.len()];
            self.before = std::mem::replace(&mut self.reflected, unknown);
        }
    }

    /// Both parts are one.
    pub fn join_parts(&mut self) {
        self.reflected.iter_mut().zip(&self.before).for_each(|(reflected, before)| *reflected += before);
        self.before.fill(0.0);
    }

    /// Where the value of a texel is taken.
    pub fn point(&self, scene: &Scene, index: usize) -> DVec3 {
        self.sites[index].point(scene, self.chart, [index % self.columns(), index / self.columns()])
    }

    /// The same with random numbers.
    pub fn place(&self, scene: &Scene, index: usize, seed: u64) -> Place {
        place_at(self.point(scene, index), SurfaceId(self.sites[index].surface), seed)
    }
}
