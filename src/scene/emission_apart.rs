//! Scenes in which the light of each source of emission is kept apart, in channels behind those of all light.
//!
//! Sources are numbered: the materials of the scene, then its lights. What emits nothing has no channel.

use super::{Light, Material, Scene};

/// Which channel keeps which source.
#[derive(Clone, Debug)]
pub(crate) struct EmissionApart {
    /// Channels of all light.
    bands: usize,
    /// By channel behind them: the source, and the emission that it has there.
    sources: Vec<(u32, f64)>,
}

impl EmissionApart {
    /// Of numbers by channel: how many times the emission of each source they are.
    pub fn sources_of<'a>(&'a self, by_channel: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let own = self.sources.iter().zip(&by_channel[self.bands..]);
        own.filter(|(_, brought)| **brought != 0.0).map(|(&(source, emission), brought)| (source, brought / emission))
    }
}

impl Scene {
    /// The same with a channel for each source of emission behind its own. There it emits as much as in its brightest channel, and nothing reflects, so
    /// all that is decided by the brightest channel stays as it is.
    pub(crate) fn with_emission_apart(&self) -> (Self, EmissionApart) {
        let brightest = |by_channel: &[f64]| by_channel.iter().copied().fold(0.0, f64::max);
        let of_materials = self.materials.iter().map(|material| brightest(&material.exitance));
        let of_lights = self.lights.iter().map(|light| brightest(&light.strength));
        let all = (0..).zip(of_materials.chain(of_lights));
        let sources: Vec<(u32, f64)> = all.filter(|(_, emission)| *emission > 0.0).collect();

        let apart = |by_channel: &[f64], number: usize| -> Vec<f64> {
            let of_source = |&(source, emission): &(u32, f64)| if source as usize == number { emission } else { 0.0 };
            by_channel.iter().copied().chain(sources.iter().map(of_source)).collect()
        };
        let material = |(number, material): (usize, &Material)| {
            let reflectance = material.reflectance.iter().copied().chain(sources.iter().map(|_| 0.0)).collect();
            Material { name: material.name.clone(), reflectance, exitance: apart(&material.exitance, number) }
        };
        let materials = self.materials.iter().enumerate().map(material).collect();
        let light = |(number, light): (usize, &Light)| Light {
            strength: apart(&light.strength, self.materials.len() + number),
            ..light.clone()
        };
        let lights = self.lights.iter().enumerate().map(light).collect();
        let (bands, carried) = (self.channels, sources.len());
        let scene = Self { channels: bands + carried, carried, materials, lights, ..self.clone() };
        (scene, EmissionApart { bands, sources })
    }

    /// How many sources of emission are numbered.
    pub(crate) fn emission_sources(&self) -> usize {
        self.materials.len() + self.lights.len()
    }

    /// The emission of all sources, by source and channel: exitance in W/m^2, and the strength of lights.
    pub(crate) fn emission_by_source(&self) -> Vec<f64> {
        let of_materials = self.materials.iter().flat_map(|material| &material.exitance);
        of_materials.chain(self.lights.iter().flat_map(|light| &light.strength)).copied().collect()
    }
}
