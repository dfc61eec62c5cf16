//! Radiosities by node.

use serde::{Deserialize, Serialize};

use super::Exposure;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// The radiosity B of every node in W/m^2, a mean over its exposed part: of a leaf its own, above from the children.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Radiosity {
    channels: usize,
    values: Vec<f64>,
}

impl Radiosity {
    /// `B = E` on every node.
    pub fn emitted(scene: &Scene, hierarchy: &Hierarchy, exposure: &Exposure) -> Self {
        let channels = scene.channels();
        let mut radiosity = Self { channels, values: vec![0.0; channels * hierarchy.len()] };
        for node in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
            if let Some(surface) = hierarchy.surface_of(node) {
                radiosity.of_mut(node).copy_from_slice(&scene.material_of(surface).exitance);
            }
        }
        radiosity.pull(hierarchy, exposure);
        radiosity
    }

    /// No radiosity anywhere.
    pub(crate) fn dark(scene: &Scene, hierarchy: &Hierarchy) -> Self {
        Self { channels: scene.channels(), values: vec![0.0; scene.channels() * hierarchy.len()] }
    }

    /// Adds another one of the same hierarchy.
    pub(crate) fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += other);
    }

    /// How many channels each node has.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The radiosity of a node, by channel.
    pub fn of(&self, node: NodeId) -> &[f64] {
        &self.values[node.index() * self.channels..][..self.channels]
    }

    pub(crate) fn of_mut(&mut self, node: NodeId) -> &mut [f64] {
        &mut self.values[node.index() * self.channels..][..self.channels]
    }

    /// All values, node after node.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Makes room for nodes that are new: they take over their parent's radiosity.
    pub(crate) fn grow(&mut self, hierarchy: &Hierarchy) {
        for node in self.values.len() / self.channels..hierarchy.len() {
            let parent = hierarchy.node(NodeId(node as u32)).parent.index() * self.channels;
            self.values.extend_from_within(parent..parent + self.channels);
        }
    }

    /// Sets every inner node to the mean of its children, weighted by exposed area; 0 where all is covered.
    pub(crate) fn pull(&mut self, hierarchy: &Hierarchy, exposure: &Exposure) {
        let channels = self.channels;
        let mut sum = vec![0.0; channels];
        for node in hierarchy.ids().rev().filter(|&node| !hierarchy.is_leaf(node)) {
            sum.fill(0.0);
            let mut area = 0.0;
            for child in hierarchy.children(node) {
                let weight = hierarchy.area(child) * exposure.of(child);
                area += weight;
                for (sum, b) in sum.iter_mut().zip(self.of(child)) {
                    *sum += weight * b;
                }
            }
            for (b, sum) in self.of_mut(node).iter_mut().zip(&sum) {
                *b = if area > 0.0 { sum / area } else { 0.0 };
            }
        }
    }

    /// The area-weighted root mean square of `B - E` over all surfaces, channels pooled, in W/m^2.
    pub fn reflected_rms(&self, scene: &Scene, hierarchy: &Hierarchy) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for node in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
            let weight = hierarchy.area(node);
            let exitance = &scene.material_of(SurfaceId(hierarchy.node(node).surface)).exitance;
            sum += weight * self.of(node).iter().zip(exitance).map(|(b, e)| (b - e) * (b - e)).sum::<f64>();
            area += weight * self.channels as f64;
        }
        (sum / area).sqrt()
    }
}
