//! Radiosities by node.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Exposure, PARALLEL};
use crate::geometry::Lobes;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{DistinctChannels, Scene, SurfaceId};

/// The radiosity B of every node in W/m^2, a mean over its exposed part; above the leaves the mean of the children.
///
/// Clusters also have a radiosity by direction: they send light in the directions that their faces face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Radiosity {
    channels: usize,
    values: Vec<f64>,
    /// The exposed area of each cluster by direction, and that area times its radiosity, by channel; not stored.
    #[serde(skip)]
    exposed: Vec<Lobes>,
    #[serde(skip)]
    shown: Vec<Lobes>,
}

/// A cluster is taken to show at least this part of its area to every direction: results are divided by what it shows.
const LEAST_SHOWN: f64 = 0.1;

impl Radiosity {
    /// `B = E` on every node.
    pub fn emitted(scene: &Scene, hierarchy: &Hierarchy, exposure: &Exposure) -> Self {
        let exitance = |_, surface, b: &mut [f64]| b.copy_from_slice(&scene.material_of(surface).exitance);
        Self::of_leaves(hierarchy, exposure, scene.channels(), exitance)
    }

    /// One channel with radiosity 1 everywhere: a leaf gathers the sum of its form factors from it.
    pub(crate) fn ones(hierarchy: &Hierarchy, exposure: &Exposure) -> Self {
        Self::of_leaves(hierarchy, exposure, 1, |_, _, b| b.fill(1.0))
    }

    /// The part that is reflected.
    pub(crate) fn without_exitance(&self, scene: &Scene, hierarchy: &Hierarchy, exposure: &Exposure) -> Self {
        Self::of_leaves(hierarchy, exposure, self.channels, |leaf, surface, b| {
            let parts = self.of(leaf).iter().zip(&scene.material_of(surface).exitance);
            b.iter_mut().zip(parts).for_each(|(b, (sent, emitted))| *b = sent - emitted);
            scene.clear_dark(b);
        })
    }

    /// The radiosities that `set` tells of leaves and the surfaces that they are pieces of, by channel.
    fn of_leaves(
        hierarchy: &Hierarchy,
        exposure: &Exposure,
        channels: usize,
        set: impl Fn(NodeId, SurfaceId, &mut [f64]) + Sync,
    ) -> Self {
        let mut values = vec![0.0; channels * hierarchy.len()];
        values.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(index, b)| {
            let node = NodeId(index as u32);
            if let Some(surface) = hierarchy.surface_of(node).filter(|_| hierarchy.is_leaf(node)) {
                set(node, surface, b);
            }
        });

        let mut radiosity = Self { channels, values, exposed: Vec::new(), shown: Vec::new() };
        radiosity.make_room_for_lobes(hierarchy);
        radiosity.pull(hierarchy, exposure);
        radiosity
    }

    fn make_room_for_lobes(&mut self, hierarchy: &Hierarchy) {
        let lobes = |count| rayon::iter::repeat_n(Lobes::default(), count).collect();
        let clusters = hierarchy.cluster_count();
        (self.exposed, self.shown) = (lobes(clusters), lobes(self.channels * clusters));
    }

    /// Forgets what clusters show, which takes most of the memory, while `work` has no use for that.
    pub fn without_lobes<T>(&mut self, hierarchy: &Hierarchy, exposure: &Exposure, work: impl FnOnce() -> T) -> T {
        (self.exposed, self.shown) = (Vec::new(), Vec::new());
        let done = work();
        self.make_room_for_lobes(hierarchy);
        let clusters = hierarchy.cluster_count();
        hierarchy
            .levels()
            .into_iter()
            .rev()
            .filter(|level| level.start < clusters)
            .for_each(|level| self.pull_lobes(hierarchy, exposure, level));
        done
    }

    /// How many channels each node has.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The radiosity of a node, by channel.
    pub fn of(&self, node: NodeId) -> &[f64] {
        &self.values[node.index() * self.channels..][..self.channels]
    }

    /// All values, to change them.
    pub(super) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The radiosity of a node, to change it.
    pub(crate) fn of_mut(&mut self, node: NodeId) -> &mut [f64] {
        &mut self.values[node.index() * self.channels..][..self.channels]
    }

    /// Adds `weight` times the radiosity that `source` shows to `receiver`, by channel.
    pub(crate) fn add_shown(&self, hierarchy: &Hierarchy, receiver: NodeId, source: NodeId, weight: f64, sum: &mut [f64]) {
        if !hierarchy.is_cluster(source) {
            sum.iter_mut().zip(self.of(source)).for_each(|(sum, b)| *sum += weight * b);
            return;
        }
        let direction = hierarchy.direction(source, receiver);
        let Some(area) = self.exposed_area(source, direction) else { return };
        for (sum, shown) in sum.iter_mut().zip(&self.shown[source.index() * self.channels..]) {
            *sum += weight * shown.at(direction) / area;
        }
    }

    /// What a surface reflects, in W/m^2 in its brightest channel.
    pub(crate) fn reflected(&self, scene: &Scene, hierarchy: &Hierarchy, surface: SurfaceId) -> f64 {
        let exitance = &scene.material_of(surface).exitance[..scene.deciding()];
        let sent = self.of(hierarchy.node_of(surface));
        sent.iter().zip(exitance).map(|(sent, emitted)| sent - emitted).fold(0.0, f64::max)
    }

    /// The exposed area in m^2 that a cluster shows to a direction; `None` if none of it is exposed.
    pub(crate) fn exposed_area(&self, cluster: NodeId, direction: DVec3) -> Option<f64> {
        let exposed = &self.exposed[cluster.index()];
        (exposed.weight() > 0.0).then(|| exposed.at(direction).max(LEAST_SHOWN * exposed.weight()))
    }

    /// The same for all channels, from those that were solved for.
    pub(crate) fn expanded(&self, channels: &DistinctChannels) -> Self {
        let (values, shown) = (channels.expand(&self.values), channels.expand(&self.shown));
        Self { channels: channels.count_of(self.channels), values, exposed: self.exposed.clone(), shown }
    }

    /// The same in some of the channels.
    pub(crate) fn of_channels(&self, channels: Range<usize>) -> Self {
        let values = self.values.chunks(self.channels).flat_map(|of_node| &of_node[channels.clone()]).copied().collect();
        let shown = self.shown.chunks(self.channels).flat_map(|of_cluster| &of_cluster[channels.clone()]).copied().collect();
        Self { channels: channels.len(), values, exposed: self.exposed.clone(), shown }
    }

    /// The same with other radiosities of the leaves, by leaf and channel; in the order of their ids.
    pub(crate) fn with_leaves(&self, hierarchy: &Hierarchy, exposure: &Exposure, leaves: &[f64]) -> Self {
        let mut radiosity = self.clone();
        let nodes = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node));
        nodes.zip(leaves.chunks(self.channels)).for_each(|(node, b)| radiosity.of_mut(node).copy_from_slice(b));
        radiosity.pull(hierarchy, exposure);
        radiosity
    }

    /// Makes anew what is not stored, and checks what later stages rely on, in a scene of so many channels.
    ///
    /// # Errors
    /// Says what is wrong, for radiosities that were read from a file.
    pub(crate) fn restore(&mut self, hierarchy: &Hierarchy, exposure: &Exposure, channels: usize) -> Result<(), String> {
        if self.channels != channels || self.values.len() != channels * hierarchy.len() {
            return Err("the radiosities do not fit the hierarchy".to_owned());
        }
        if !self.is_in_range() {
            return Err("a radiosity is negative or not finite".to_owned());
        }
        let restored = Self::of_leaves(hierarchy, exposure, channels, |leaf, _, b| b.copy_from_slice(self.of(leaf)));
        if restored.values != self.values {
            return Err("the radiosity of a node is not that of its children".to_owned());
        }
        *self = restored;
        Ok(())
    }

    /// Whether no radiosity is negative, and all can be told in f32.
    pub(crate) fn is_in_range(&self) -> bool {
        self.values.iter().all(|b| (0.0..=f64::from(f32::MAX)).contains(b))
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

    /// Sets every inner node to the mean of its children, weighted by exposed area; 0 if none is exposed.
    pub(crate) fn pull(&mut self, hierarchy: &Hierarchy, exposure: &Exposure) {
        for level in hierarchy.levels().into_iter().rev() {
            self.pull_level(hierarchy, exposure, level);
        }
    }

    /// The same for a run of nodes of which none is above another; their children must be up to date.
    pub(super) fn pull_level(&mut self, hierarchy: &Hierarchy, exposure: &Exposure, level: Range<usize>) {
        let channels = self.channels;
        let (means, below) = self.values[level.start * channels..].split_at_mut(level.len() * channels);
        means.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(k, mean)| {
            let node = NodeId((level.start + k) as u32);
            if hierarchy.is_leaf(node) {
                return;
            }
            let mut area = 0.0;
            mean.fill(0.0);
            for child in hierarchy.children(node) {
                let weight = hierarchy.area(child) * exposure.of(child);
                area += weight;
                let child = &below[(child.index() - level.end) * channels..][..channels];
                mean.iter_mut().zip(child).for_each(|(mean, b)| *mean += weight * b);
            }
            mean.iter_mut().for_each(|mean| *mean = if area > 0.0 { *mean / area } else { 0.0 });
        });
        if level.start < hierarchy.cluster_count() {
            self.pull_lobes(hierarchy, exposure, level);
        }
    }

    /// Sets what clusters show to the sum over their children.
    fn pull_lobes(&mut self, hierarchy: &Hierarchy, exposure: &Exposure, clusters: Range<usize>) {
        let Self { channels, ref values, ref mut exposed, ref mut shown } = *self;
        let (exposed, exposed_below) = exposed[clusters.start..].split_at_mut(clusters.len());
        let (shown, shown_below) = shown[clusters.start * channels..].split_at_mut(clusters.len() * channels);
        let places = exposed.par_iter_mut().zip(shown.par_chunks_mut(channels)).with_min_len(PARALLEL).enumerate();
        places.for_each(|(k, (exposed, shown))| {
            *exposed = Lobes::default();
            shown.fill(Lobes::default());
            for child in hierarchy.children(NodeId((clusters.start + k) as u32)) {
                if hierarchy.is_cluster(child) {
                    let below = child.index() - clusters.end;
                    *exposed += exposed_below[below];
                    shown.iter_mut().zip(&shown_below[below * channels..]).for_each(|(shown, child)| *shown += *child);
                } else {
                    let (area, normal) = (hierarchy.area(child) * exposure.of(child), hierarchy.normal(child));
                    exposed.add(area, normal);
                    let radiosity = &values[child.index() * channels..][..channels];
                    shown.iter_mut().zip(radiosity).for_each(|(shown, b)| shown.add(area * b, normal));
                }
            }
        });
    }

    /// The area-weighted root mean square of `B - E` over all surfaces, channels pooled, in W/m^2; those of light groups are left out.
    pub fn reflected_rms(&self, scene: &Scene, hierarchy: &Hierarchy) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for node in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
            let weight = hierarchy.area(node);
            let exitance = &scene.material_of(SurfaceId(hierarchy.node(node).surface)).exitance;
            let reflected = self.of(node).iter().zip(exitance).take(scene.deciding()).map(|(b, e)| b - e);
            sum += weight * reflected.map(|reflected| reflected * reflected).sum::<f64>();
            area += weight * scene.deciding() as f64;
        }
        (sum / area).sqrt()
    }
}

/// The largest reflectance below each cluster, by channel: what it may do with light that arrives. A mean would hang on what light does not
/// meet.
pub(crate) fn cluster_reflectance(scene: &Scene, hierarchy: &Hierarchy) -> Vec<f64> {
    let (channels, clusters) = (scene.channels(), hierarchy.cluster_count());
    let mut reflectance = vec![0.0_f64; channels * clusters];
    for level in hierarchy.levels().into_iter().rev().filter(|level| level.start < clusters) {
        let (own, below) = reflectance[level.start * channels..].split_at_mut(level.len() * channels);
        own.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(k, own)| {
            for child in hierarchy.children(NodeId((level.start + k) as u32)) {
                let of_child = match hierarchy.surface_of(child) {
                    Some(surface) => &scene.material_of(surface).reflectance[..],
                    None => &below[(child.index() - level.end) * channels..][..channels],
                };
                own.iter_mut().zip(of_child).for_each(|(own, of_child)| *own = own.max(*of_child));
            }
        });
    }
    reflectance
}
