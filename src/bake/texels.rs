//! The texels of a chart, with their values as far as these are known.

use glam::DVec3;
use rayon::prelude::*;

use super::atlas::{Atlas, Placed};
use super::charts::Chart;
use super::coverage::{Site, sites};
use crate::paths::{Place, place_at};
use crate::scene::{Material, Scene, SurfaceId};

/// The texels of a chart.
pub(crate) struct Texels<'a> {
    pub chart: &'a Chart,
    pub material: &'a Material,
    /// By texel, row after row.
    pub sites: Vec<Site>,
    /// Radiosity by texel and channel in W/m^2; NaN where it is not known.
    pub radiosity: Vec<f32>,
}

/// The texels of all charts of an atlas. Those of faces that reflect nothing are known: they are as bright as they emit.
pub(crate) fn texels_of<'a>(atlas: &'a Atlas, scene: &'a Scene) -> Vec<Texels<'a>> {
    let of_chart = |placed: &'a Placed| {
        let (chart, material) = (&placed.chart, &scene.materials()[placed.chart.material as usize]);
        let sites = sites(scene, chart);
        let radiosity = vec![f32::NAN; sites.len() * scene.channels()];
        let mut texels = Texels { chart, material, sites, radiosity };
        if !material.reflects() {
            let exitance: Vec<f32> = material.exitance.iter().map(|&e| e as f32).collect();
            (0..texels.sites.len()).for_each(|index| texels.set(index, &exitance));
        }
        texels
    };
    atlas.charts.par_iter().map(of_chart).collect()
}

impl Texels<'_> {
    /// In a row.
    pub fn columns(&self) -> usize {
        self.chart.size()[0]
    }

    pub fn channels(&self) -> usize {
        self.material.exitance.len()
    }

    /// Whether a texel shall have a value and has none yet.
    pub fn is_wanted(&self, index: usize) -> bool {
        self.sites[index].is_covered() && !self.is_known(index)
    }

    /// Whether a texel has a value.
    pub fn is_known(&self, index: usize) -> bool {
        !self.radiosity[index * self.channels()].is_nan()
    }

    pub fn radiosity_of(&self, index: usize) -> &[f32] {
        &self.radiosity[index * self.channels()..][..self.channels()]
    }

    pub fn set(&mut self, index: usize, radiosity: &[f32]) {
        let channels = self.channels();
        self.radiosity[index * channels..][..channels].copy_from_slice(radiosity);
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
