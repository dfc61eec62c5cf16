//! The light on one surface as a function: quadratic elements.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::bisection::{Triangle, Triangles};
use super::element;
use crate::scene::DistinctChannels;

/// Elements on one surface, and the radiosity at their nodes. Between elements it is continuous, but across edges where they share no nodes:
/// there light may have a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SurfaceMesh {
    /// In the surface's plane, in metres.
    nodes: Vec<DVec2>,
    /// Numbers of nodes: three corners, counter-clockwise, then the middles of the edges from each.
    triangles: Vec<[u32; 6]>,
    /// Reflected radiosity by node and channel, in W/m^2.
    reflected: Vec<f32>,
}

impl SurfaceMesh {
    pub fn new(triangles: &Triangles, reflected: Vec<f32>) -> Self {
        let nodes = triangles.nodes.iter().map(|node| node.at).collect();
        Self { nodes, triangles: triangles.triangles.iter().map(Triangle::nodes).collect(), reflected }
    }

    /// The same with some of the triangles alone, and their nodes.
    pub fn with_triangles(self, is_kept: impl Fn(usize) -> bool) -> Self {
        let triangles = self.triangles.iter().enumerate().filter(|(number, _)| is_kept(*number)).map(|(_, nodes)| *nodes);
        let mut triangles: Vec<[u32; 6]> = triangles.collect();
        if triangles.len() == self.triangles.len() {
            return self;
        }
        let channels = self.reflected.len() / self.nodes.len();
        let mut kept: Vec<u32> = triangles.as_flattened().to_vec();
        kept.sort_unstable();
        kept.dedup();
        let number = |node: u32| kept.partition_point(|&other| other < node) as u32;
        triangles.as_flattened_mut().iter_mut().for_each(|node| *node = number(*node));
        let nodes = kept.iter().map(|&node| self.nodes[node as usize]).collect();
        let reflected = kept.iter().flat_map(|&node| self.reflected(node, channels)).copied().collect();
        Self { nodes, triangles, reflected }
    }

    pub fn nodes(&self) -> &[DVec2] {
        &self.nodes
    }

    pub fn triangles(&self) -> &[[u32; 6]] {
        &self.triangles
    }

    /// Reflected radiosity by node and channel, in W/m^2.
    pub fn all_reflected(&self) -> &[f32] {
        &self.reflected
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(&self, channels: &DistinctChannels) -> Self {
        Self { reflected: channels.expand(&self.reflected), ..self.clone() }
    }

    /// The same with other radiosities at the nodes.
    pub fn with_reflected(&self, reflected: Vec<f32>) -> Self {
        Self { reflected, ..self.clone() }
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        (size_of::<Self>() + size_of_val(&*self.nodes) + size_of_val(&*self.triangles) + size_of_val(&*self.reflected)) as u64
    }

    /// The reflected radiosity at a node, by channel.
    pub fn reflected(&self, node: u32, channels: usize) -> &[f32] {
        &self.reflected[node as usize * channels..][..channels]
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec2; 3] {
        let [a, b, c, ..] = self.triangles[triangle];
        [a, b, c].map(|node| self.nodes[node as usize])
    }

    /// The reflected radiosity in a triangle at barycentric coordinates, by channel; below 0 where noise takes it there.
    pub fn reflected_at(&self, triangle: usize, at: [f64; 3], reflected: &mut [f64]) {
        let (weights, channels) = (element::weights(at), reflected.len());
        for (channel, sum) in reflected.iter_mut().enumerate() {
            *sum = element::value(self.reflected_in(triangle, channel, channels), weights);
        }
    }

    /// The reflected radiosity at the six nodes of a triangle, in one of so many channels.
    pub fn reflected_in(&self, triangle: usize, channel: usize, channels: usize) -> [f64; 6] {
        self.triangles[triangle].map(|node| f64::from(self.reflected[node as usize * channels + channel]))
    }
}
