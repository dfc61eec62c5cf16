//! A surface and its elements while they are refined.

use super::bisection::Triangles;
use super::element;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::scene::SurfaceId;

/// A surface and its elements.
pub(super) struct Growing {
    pub surface: SurfaceId,
    pub plane: Plane,
    pub triangles: Triangles,
    /// So many channels decide, the first ones; others carry the light of groups.
    pub deciding: usize,
    /// By node and channel: reflected radiosity in W/m^2, and its variance.
    pub found: Vec<[f32; 2]>,
    /// By node: how many gathers that is the mean of.
    pub gathers: Vec<u32>,
    pub tests: Vec<Test>,
    /// By triangle: whether it has tests. Those made last may lie beyond the end.
    pub is_tested: Vec<bool>,
}

/// What a random point in a triangle tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Test {
    pub triangle: u32,
    /// The squared difference of the function and the light there, channels added, in W^2/m^4.
    pub difference_sq: f64,
    /// What of it is to be expected from the noise of the light at the point and at the nodes.
    pub noise_sq: f64,
    /// What nodes have of that.
    pub of_nodes_sq: f64,
    /// The squared light.
    pub light_sq: f64,
    /// The size of the triangle over the distance of what is seen from the point; 0 where that is not known.
    pub relative_size: f64,
}

impl Growing {
    pub fn new(surface: SurfaceId, plane: Plane, triangles: Triangles, deciding: usize) -> Self {
        Self {
            surface,
            plane,
            triangles,
            deciding,
            found: Vec::new(),
            gathers: Vec::new(),
            tests: Vec::new(),
            is_tested: Vec::new(),
        }
    }

    /// The function as it stands.
    pub fn into_mesh(self) -> SurfaceMesh {
        SurfaceMesh::new(&self.triangles, self.found.into_iter().map(|[value, _]| value).collect())
    }

    /// Makes room for nodes that are new. If those that are there get more gathers, up to so many, the tests of the function as it was are forgotten.
    pub fn begin_gathers(&mut self, channels: usize, gathers: u32) {
        if self.gathers.iter().any(|&has| has < gathers) {
            self.tests.clear();
            self.is_tested.fill(false);
        }
        self.found.resize(self.triangles.nodes.len() * channels, [0.0; 2]);
        self.gathers.resize(self.triangles.nodes.len(), 0);
    }

    /// Adds a gather at a node, by channel with its variance: the mean of all stays.
    pub fn add_gather(&mut self, node: usize, light: &[[f64; 2]]) {
        let before = f64::from(self.gathers[node]);
        self.gathers[node] += 1;
        for (found, [value, variance]) in self.found[node * light.len()..].iter_mut().zip(light) {
            let [mean, noise] = found.map(f64::from);
            let mean = (before * mean + value) / (before + 1.0);
            let noise = (before * before * noise + variance) / (before + 1.0).powi(2);
            *found = [mean as f32, noise as f32];
        }
    }

    /// The area of all elements, in m^2.
    pub fn area(&self) -> f64 {
        (0..self.triangles.triangles.len() as u32).map(|triangle| self.triangles.area(triangle)).sum()
    }

    /// The area that a node stands for, in m^2.
    pub fn size(&self) -> f64 {
        self.area() / self.triangles.nodes.len() as f64
    }

    /// The function at a point of a triangle and its variance, in one of so many channels.
    fn at(&self, triangle: u32, weights: [f64; 6], channel: usize, channels: usize) -> [f64; 2] {
        let nodes = self.triangles.triangles[triangle as usize].nodes();
        let (mut function, mut variance) = (0.0, 0.0);
        for (node, weight) in nodes.into_iter().zip(weights) {
            let [value, noise] = self.found[node as usize * channels + channel].map(f64::from);
            function += weight * value;
            variance += weight * weight * noise;
        }
        [function.max(0.0), variance]
    }

    /// Holds the function against the light, by channel with its variance, at a point of a triangle;
    /// `light_sq` is all light there, squared, and `closeness` how close what is seen is.
    pub fn test(&self, triangle: u32, at: [f64; 3], light: &[[f64; 2]], [light_sq, closeness]: [f64; 2]) -> Test {
        let (weights, relative_size) = (element::weights(at), closeness * self.triangles.area(triangle).sqrt());
        let mut test = Test { triangle, difference_sq: 0.0, noise_sq: 0.0, of_nodes_sq: 0.0, light_sq, relative_size };
        for (channel, &[value, variance]) in light.iter().enumerate().take(self.deciding) {
            let [function, noise] = self.at(triangle, weights, channel, light.len());
            test.difference_sq += (function - value).powi(2);
            test.noise_sq += variance + noise;
            test.of_nodes_sq += noise;
        }
        test
    }

    /// The squared errors of the function at a point of a triangle, of all light and of each light group: by two independent samples of the light
    /// there, without bias, so that they may be negative.
    pub fn sampled_errors_sq(&self, triangle: u32, at: [f64; 3], light: [&[[f64; 2]]; 2]) -> Vec<f64> {
        let (weights, [first, second]) = (element::weights(at), light);
        let of_channel = |(channel, (first, second)): (usize, (&[f64; 2], &[f64; 2]))| {
            let [function, _] = self.at(triangle, weights, channel, light[0].len());
            (function - first[0]) * (function - second[0])
        };
        let by_channel: Vec<f64> = first.iter().zip(second).enumerate().map(of_channel).collect();
        by_channel.chunks(self.deciding).map(|of_group| of_group.iter().sum()).collect()
    }

    /// Bisects triangles twice, and forgets the tests of all that changed.
    pub fn refine(&mut self, worst: &[u32]) {
        let before: Vec<[u32; 3]> = self.triangles.triangles.iter().map(|triangle| triangle.middles).collect();
        for &triangle in worst {
            // Others may have bisected it.
            if self.triangles.triangles[triangle as usize].middles == before[triangle as usize] {
                self.triangles.bisect(triangle);
                let second = self.triangles.triangles[triangle as usize].neighbours[1];
                [triangle, second].into_iter().for_each(|half| self.triangles.bisect(half));
            }
        }
        for (number, before) in before.iter().enumerate() {
            self.is_tested[number] &= self.triangles.triangles[number].middles == *before;
        }
        self.tests.retain(|test| self.is_tested[test.triangle as usize]);
    }
}
