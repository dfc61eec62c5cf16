//! The irradiance that lights and skies bring to leaves: they send it over no link.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::exposed_points::sampled_exposed_points;
use super::exposure::ByPlane;
use super::{Exposure, PARALLEL};
use crate::direct::{LightRays, Lights, Receiver};
use crate::geometry::{sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::progress::Stop;
use crate::scene::{DistinctChannels, SurfaceId};

/// Points at which the light on a leaf is sampled: fewer where leaves are many, so that all of them take [`ALL_POINTS`], but within this range.
/// Sixteen tell the mean of a leaf that is half in the shade to an eighth; values at points ask lights anew.
const POINTS: std::ops::RangeInclusive<usize> = 1..=16;
const ALL_POINTS: usize = 1 << 16;

/// Rays to the sky from each of these points.
const SKY_RAYS: u32 = 4;

/// The irradiance H of the exposed part of every leaf by lights and skies, in W/m^2; of other nodes 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LightIrradiance {
    /// By node and channel; empty in scenes without lights.
    by_node: Vec<f64>,
}

impl LightIrradiance {
    /// Adds that of a leaf.
    pub fn add(&self, leaf: NodeId, irradiance: &mut [f64]) {
        if let Some(own) = self.of(leaf, irradiance.len()) {
            irradiance.iter_mut().zip(own).for_each(|(sum, h)| *sum += h);
        }
    }

    /// That of a leaf, of so many channels; `None` in scenes without lights.
    pub fn of(&self, leaf: NodeId, channels: usize) -> Option<&[f64]> {
        self.by_node.get(leaf.index() * channels..(leaf.index() + 1) * channels)
    }

    /// Samples that of new leaves; once stopped, what is left is dark.
    pub fn grow(&mut self, lights: Lights<'_>, hierarchy: &Hierarchy, exposure: &Exposure, seed: u64, stop: Stop<'_>) {
        let (scene, channels) = (lights.scene, lights.scene.channels());
        let known = self.by_node.len() / channels;
        if scene.lights().is_empty() || known == hierarchy.len() {
            return;
        }
        self.by_node.resize(hierarchy.len() * channels, 0.0);
        let (least, most) = POINTS.into_inner();
        let points = (ALL_POINTS / hierarchy.len()).clamp(least, most) as u32;
        let by_plane = ByPlane::new(scene);
        let seed = sampling::hash(seed, streams::LIGHT_IRRADIANCE);
        let nodes = self.by_node[known * channels..].par_chunks_mut(channels).with_min_len(PARALLEL.min(16)).enumerate();
        nodes.for_each_init(
            || (LightRays::default(), vec![0.0; channels]),
            |(memory, variance), (index, sum)| {
                let node = NodeId((known + index) as u32);
                if !hierarchy.is_leaf(node) || hierarchy.is_cluster(node) || stop() {
                    return;
                }
                let surface = SurfaceId(hierarchy.node(node).surface);
                let seed = sampling::hash(seed, u64::from(node.0));
                let at = sampled_exposed_points(hierarchy, &by_plane, exposure, lights.rays, (node, points), seed);
                let receivers = at
                    .iter()
                    .zip(0..)
                    .map(|(&point, number)| Receiver::on(scene.surface(surface), point, sampling::hash(seed, number)));
                for receiver in receivers.clone() {
                    lights.add_sky(&receiver, SKY_RAYS, memory, sum, variance);
                }
                let most = scene.lights().len() as u32;
                lights.add_irradiance(receivers, most, memory, |_, h, _| sum.iter_mut().zip(h).for_each(|(sum, h)| *sum += h));
                sum.iter_mut().for_each(|sum| *sum /= at.len().max(1) as f64);
            },
        );
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(&self, channels: &DistinctChannels) -> Self {
        Self { by_node: channels.expand(&self.by_node) }
    }

    /// By node and channel; none in scenes without lights.
    pub fn values(&self) -> &[f64] {
        &self.by_node
    }

    /// What is given by node and channel.
    pub fn of_values(by_node: Vec<f64>) -> Self {
        Self { by_node }
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        size_of_val(&*self.by_node) as u64
    }

    /// Whether it fits nodes and channels, and a scene that has lights or none.
    pub fn is_valid(&self, nodes: usize, channels: usize, has_lights: bool) -> bool {
        let wanted = if has_lights { nodes * channels } else { 0 };
        self.by_node.len() == wanted && self.by_node.iter().all(|h| (0.0..=f64::from(f32::MAX)).contains(h))
    }
}
