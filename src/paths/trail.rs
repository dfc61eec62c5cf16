//! Trails: off which materials the light of paths was reflected, and which emission it was, so that it can be told anew for others.
//!
//! Where rays arrive hangs on geometry alone. What a path brings is a sum of products
//!
//! ```text
//! weight * (reflectances of the materials on the way) * (radiosity of a cell, or emission of a material or light)
//! ```
//!
//! whose weights hang on the random numbers alone. Emission is kept apart in channels that a scene carries, one for each source of it
//! ([`Scene::with_emission_apart`]).

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use crate::scene::{EmissionApart, Material};

/// The product of no reflectance.
pub(crate) const UNREFLECTED: u32 = 0;

/// Light that was collected on the way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collected {
    pub continuation: usize,
    /// Off which materials it was reflected.
    pub product: u32,
    /// The number of its source of emission.
    pub source: u32,
    /// Times the emission of the source it is what the path brings, reflectances left out.
    pub weight: f64,
    /// Whether the path of a value has not ended before.
    pub is_of_value: bool,
}

/// What paths were reflected off; products have numbers of the trail's own.
pub(crate) struct Trail {
    apart: EmissionApart,
    /// By product but the first: the product before, and the material that is multiplied to it.
    pub steps: Vec<[u32; 2]>,
    /// By place, the product that all its paths begin with; empty where that is [`UNREFLECTED`].
    pub begin: Vec<u32>,
    /// By continuation: its product, and the weight that draws gave it.
    pub at: Vec<(u32, f64)>,
    pub collected: Vec<Collected>,
    /// Where paths of values end: product and weight; by continuation, whether that is behind it.
    pub value_ends: Vec<(u32, f64)>,
    has_ended: Vec<bool>,
    /// By entry of [`Ends::seen`](super::Ends::seen): its product and weight.
    pub seen: Vec<(u32, f64)>,
}

impl Trail {
    pub fn new(apart: &EmissionApart) -> Self {
        let (steps, begin, at) = (Vec::new(), Vec::new(), Vec::new());
        let (collected, value_ends, has_ended) = (Vec::new(), Vec::new(), Vec::new());
        Self { apart: apart.clone(), steps, begin, at, collected, value_ends, has_ended, seen: Vec::new() }
    }

    /// The product of one with the reflectance of a material.
    pub fn times(&mut self, product: u32, material: u32) -> u32 {
        self.steps.push([product, material]);
        self.steps.len() as u32
    }

    /// Forgets paths, but not products.
    pub(super) fn clear(&mut self) {
        self.at.clear();
        self.collected.clear();
        self.value_ends.clear();
        self.has_ended.clear();
        self.seen.clear();
    }

    /// A path of a place goes on with a weight.
    pub(super) fn goes_on(&mut self, place: usize, weight: f64) {
        self.at.push((self.begin.get(place).copied().unwrap_or(UNREFLECTED), weight));
        self.has_ended.push(false);
    }

    /// A continuation brings the light by channel, times what it was reflected by before.
    pub(super) fn collect(&mut self, continuation: usize, by_channel: &[f64]) {
        let Self { apart, at, collected, has_ended, .. } = self;
        let ((product, factor), is_of_value) = (at[continuation], !has_ended[continuation]);
        collected.extend(apart.sources_of(by_channel).map(|(source, weight)| Collected {
            continuation,
            product,
            source,
            weight: factor * weight,
            is_of_value,
        }));
    }

    /// A continuation is reflected at a surface whose exitance it brings, if paths do, and so much irradiance that arrives there by channel.
    pub(super) fn reflect(&mut self, continuation: usize, material: u32, brings_exitance: bool, irradiance: &[f64]) {
        let (product, weight) = self.at[continuation];
        if brings_exitance {
            let is_of_value = !self.has_ended[continuation];
            self.collected.push(Collected { continuation, product, source: material, weight, is_of_value });
        }
        self.at[continuation].0 = self.times(product, material);
        self.collect(continuation, irradiance);
    }

    /// A continuation sees a cell with so much of what it carries.
    pub(super) fn see(&mut self, continuation: usize, weight: f64) {
        let (product, factor) = self.at[continuation];
        self.seen.push((product, factor * weight));
    }

    /// The path of a value ends where a continuation is now.
    pub(super) fn end_value(&mut self, continuation: usize) {
        self.value_ends.push(self.at[continuation]);
        self.has_ended[continuation] = true;
    }

    /// A continuation goes on with so many times the weight.
    pub(super) fn weigh(&mut self, continuation: usize, factor: f64) {
        self.at[continuation].1 *= factor;
    }
}

/// Products of reflectances, each that of an earlier one and a material; the first is 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Products {
    steps: Vec<[u32; 2]>,
}

/// Products while they are collected: those of all trails, each once.
#[derive(Default)]
pub(crate) struct ProductNumbers {
    steps: Vec<[u32; 2]>,
    numbers: HashMap<[u32; 2], u32>,
}

impl ProductNumbers {
    /// The numbers here of all products of a trail.
    pub fn of_trail(&mut self, steps: &[[u32; 2]]) -> Vec<u32> {
        let mut numbers = vec![UNREFLECTED];
        for &[before, material] in steps {
            let step = [numbers[before as usize], material];
            let known = self.numbers.entry(step).or_insert_with(|| {
                self.steps.push(step);
                self.steps.len() as u32
            });
            numbers.push(*known);
        }
        numbers
    }

    pub fn finish(self) -> Products {
        Products { steps: self.steps }
    }
}

impl Products {
    /// All of them with the reflectances of these materials, by product and channel.
    pub fn of(&self, materials: &[Material], channels: usize) -> Vec<f64> {
        let mut products = Vec::with_capacity((self.steps.len() + 1) * channels);
        products.resize(channels, 1.0);
        for &[before, material] in &self.steps {
            for (channel, rho) in materials[material as usize].reflectance.iter().enumerate() {
                products.push(rho * products[before as usize * channels + channel]);
            }
        }
        products
    }

    /// How many there are, the one that is 1 among them.
    pub fn len(&self) -> usize {
        self.steps.len() + 1
    }

    /// Bytes that they take.
    pub fn memory_bytes(&self) -> u64 {
        size_of_val(&*self.steps) as u64
    }

    /// Whether each is made of an earlier one, and of one of so many materials.
    pub fn are_valid(&self, materials: usize) -> bool {
        let is_made =
            |(index, &[before, material]): (usize, &[u32; 2])| before as usize <= index && (material as usize) < materials;
        self.steps.len() < u32::MAX as usize && self.steps.iter().enumerate().all(is_made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn material(reflectance: f64) -> Material {
        Material { name: String::new(), reflectance: vec![reflectance, 0.5 * reflectance], exitance: vec![0.0; 2] }
    }

    #[test]
    fn products_of_trails_are_kept_once_and_multiply_reflectances() {
        let mut numbers = ProductNumbers::default();
        // Off 1, then off 0; and in another trail off 1 twice, with a path between that has nothing in common.
        assert_eq!(numbers.of_trail(&[[0, 1], [1, 0]]), [0, 1, 2]);
        assert_eq!(numbers.of_trail(&[[0, 0], [0, 1], [2, 1]]), [0, 3, 1, 4]);
        let products = numbers.finish();
        assert!(products.are_valid(2) && !products.are_valid(1));
        assert_eq!(
            products.of(&[material(0.5), material(0.8)], 2),
            [1.0, 1.0, 0.8, 0.4, 0.4, 0.1, 0.5, 0.25, 0.8 * 0.8, 0.4 * 0.4]
        );
        assert!(!Products { steps: vec![[1, 0]] }.are_valid(2));
    }
}
