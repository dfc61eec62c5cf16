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
    /// By triangle, the standard error of what is read there, in W/m^2, all channels together; empty where it is not known.
    errors: Vec<f32>,
}

impl SurfaceMesh {
    pub fn new(triangles: &Triangles, reflected: Vec<f32>) -> Self {
        let nodes = triangles.nodes.iter().map(|node| node.at).collect();
        Self { nodes, triangles: triangles.triangles.iter().map(Triangle::nodes).collect(), reflected, errors: Vec::new() }
    }

    /// The same with a standard error for each triangle, or with none.
    pub fn with_errors(self, errors: Vec<f32>) -> Self {
        Self { errors, ..self }
    }

    /// The same with some of the triangles alone, and their nodes.
    pub fn with_triangles(self, is_kept: impl Fn(usize) -> bool) -> Self {
        let kept = |(number, nodes): (usize, &[u32; 6])| is_kept(number).then_some(*nodes);
        let mut triangles: Vec<[u32; 6]> = self.triangles.iter().enumerate().filter_map(kept).collect();
        if triangles.len() == self.triangles.len() {
            return self;
        }
        let channels = self.reflected.len() / self.nodes.len();
        let mut kept: Vec<u32> = triangles.as_flattened().to_vec();
        kept.sort_unstable();
        kept.dedup();
        let number = |node: u32| kept.partition_point(|&other| other < node) as u32;
        triangles.as_flattened_mut().iter_mut().for_each(|node| *node = number(*node));
        let errors = self.errors.iter().enumerate().filter(|(number, _)| is_kept(*number)).map(|(_, error)| *error).collect();
        let nodes = kept.iter().map(|&node| self.nodes[node as usize]).collect();
        let reflected = kept.iter().flat_map(|&node| self.reflected(node, channels)).copied().collect();
        Self { nodes, triangles, reflected, errors }
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

    /// By triangle, the standard error of what is read there, in W/m^2, all channels together; empty where it is not known.
    pub fn errors(&self) -> &[f32] {
        &self.errors
    }

    /// The standard error of what is read in a triangle, as [`Self::errors`]; NaN where it is not known.
    pub fn error(&self, triangle: usize) -> f32 {
        self.errors.get(triangle).copied().unwrap_or(f32::NAN)
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(&self, channels: &DistinctChannels) -> Self {
        let scale = (channels.copies as f32).sqrt();
        let errors = self.errors.iter().map(|error| scale * error).collect();
        Self { reflected: channels.expand(&self.reflected), errors, ..self.clone() }
    }

    /// The same with other radiosities at the nodes.
    pub fn with_reflected(&self, reflected: Vec<f32>) -> Self {
        Self { reflected, ..self.clone() }
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        let Self { nodes, triangles, reflected, errors } = self;
        (size_of::<Self>() + size_of_val(&**nodes) + size_of_val(&**triangles) + size_of_val(&**reflected) + size_of_val(&**errors))
            as u64
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
