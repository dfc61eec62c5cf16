//! A surface and its elements while they are refined.

use serde::{Deserialize, Serialize};

use super::bends::{Bend, Bends};
use super::bisection::Triangles;
use super::element;
use super::fit::fitted;
use super::plane::Plane;
use super::seen::SeenTriangles;
use super::surface_mesh::SurfaceMesh;
use crate::geometry::{sampling, streams};
use crate::scene::SurfaceId;

/// Nodes for each triangle where many are joined.
const NODES: f64 = 2.0;

/// A surface and its elements.
pub(super) struct Growing {
    pub surface: SurfaceId,
    pub plane: Plane,
    pub triangles: Triangles,
    /// What a view sees of them, if they are made for one.
    seen: Option<SeenTriangles>,
    /// So many channels decide, the first ones; others carry the light of groups.
    pub deciding: usize,
    /// By node and channel: reflected radiosity in W/m^2, and its variance.
    pub found: Vec<[f32; 2]>,
    /// The same as fitted to nodes around each; empty where they are taken as they were found.
    fitted: Vec<[f32; 2]>,
    /// Their variances, and those of tests, for those that were told.
    noise_scale: f64,
    has_new_gathers: bool,
    /// How many gathers nodes are to be the mean of.
    pub wanted_gathers: u32,
    /// By node: of how many it is; 0 where none is wanted.
    pub gathers: Vec<u32>,
    pub tests: Vec<Test>,
    /// By triangle: whether it has tests. Those made last may lie beyond the end.
    pub is_tested: Vec<bool>,
}

/// What a random point in a triangle tells.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
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
}

impl Growing {
    pub fn new(surface: SurfaceId, plane: Plane, triangles: Triangles, seen: Option<SeenTriangles>, deciding: usize) -> Self {
        Self {
            surface,
            plane,
            triangles,
            seen,
            deciding,
            found: Vec::new(),
            fitted: Vec::new(),
            noise_scale: 1.0,
            has_new_gathers: false,
            wanted_gathers: 1,
            gathers: Vec::new(),
            tests: Vec::new(),
            is_tested: Vec::new(),
        }
    }

    /// The function as it stands, with the standard error of each triangle where that is known; with what is not seen as well, or without.
    pub fn into_mesh(self, errors: Vec<f32>, takes_all: bool) -> SurfaceMesh {
        let values = self.values().iter().map(|&[value, _]| value).collect();
        let mesh = SurfaceMesh::new(&self.triangles, values).with_errors(errors);
        let is_seen = |triangle: usize| self.weight(triangle as u32) > 0.0;
        if takes_all { mesh } else { mesh.with_triangles(is_seen) }
    }

    /// What nodes have in the function: by node and channel, with its variance.
    fn values(&self) -> &[[f32; 2]] {
        if self.fitted.is_empty() { &self.found } else { &self.fitted }
    }

    /// Fits each node to those around it, if any got a gather since. Tests of elements that are as they were stay: the function changes there by less
    /// than the noise that they hold.
    pub fn fit(&mut self) {
        if std::mem::take(&mut self.has_new_gathers) {
            let channels = self.found.len() / self.triangles.nodes.len();
            self.fitted = fitted(&self.triangles, &self.found, [self.deciding, channels]);
        }
    }

    /// What a triangle counts in the error: its area in m^2, or how many pixels it covers.
    pub fn weight(&self, triangle: u32) -> f64 {
        self.seen.as_ref().map_or_else(|| self.triangles.area(triangle), |seen| seen.weight(triangle))
    }

    /// Bisects triangles that weigh more than `largest`, or are much longer than what weighs as much.
    pub fn bisect_to(&mut self, largest: f64) {
        let mut number = 0;
        while number < self.triangles.triangles.len() as u32 {
            let weight = self.weight(number);
            if weight > 0.0 && self.triangles.is_large(number, self.triangles.area(number) * largest / weight) {
                self.triangles.bisect(number, &mut Bends::unknown());
                self.follow_halvings();
            } else {
                number += 1;
            }
        }
    }

    fn follow_halvings(&mut self) {
        let halvings = std::mem::take(&mut self.triangles.halvings);
        if let Some(seen) = &mut self.seen {
            halvings.into_iter().for_each(|halving| seen.halve(halving));
        }
    }

    /// A random point of a triangle, uniform over what it weighs by, in barycentric coordinates.
    pub fn sampled_point(&self, triangle: u32, draw: u64) -> [f64; 3] {
        if let Some(at) = self.seen.as_ref().and_then(|seen| seen.sampled(triangle, draw)) {
            // What lies on an edge may have been rounded across it.
            let inside = element::barycentric(self.triangles.corners(triangle), at).map(|l| l.max(0.0));
            let sum: f64 = inside.iter().sum();
            return inside.map(|l| l / sum);
        }
        element::sampled_barycentric(sampling::unit(draw), sampling::unit(sampling::hash(draw, streams::SECOND)))
    }

    /// Makes room for nodes that are new. If those that are there get more gathers, the tests of the function as it was are forgotten.
    pub fn begin_gathers(&mut self, channels: usize) {
        if self.gathers.iter().any(|&has| 0 < has && has < self.wanted_gathers) {
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
        self.has_new_gathers = true;
        for (found, [value, variance]) in self.found[node * light.len()..].iter_mut().zip(light) {
            let [mean, noise] = found.map(f64::from);
            let mean = (before * mean + value) / (before + 1.0);
            let noise = (before * before * noise + self.noise_scale * variance) / (before + 1.0).powi(2);
            *found = [mean as f32, noise as f32];
        }
    }

    /// Tells what variances are for those that are told, of what is found already as well.
    pub fn scale_noise(&mut self, scale: f64) {
        let more = scale / std::mem::replace(&mut self.noise_scale, scale);
        self.found.iter_mut().chain(&mut self.fitted).for_each(|[_, variance]| *variance = (f64::from(*variance) * more) as f32);
        for test in &mut self.tests {
            test.noise_sq *= more;
            test.of_nodes_sq *= more;
        }
        self.has_new_gathers |= more != 1.0;
    }

    /// Tests, each with what it stands for: those of a triangle share what that weighs.
    pub fn tests_with_parts(&self) -> impl Iterator<Item = (&Test, f64)> {
        let mut counts = vec![0_u32; self.triangles.triangles.len()];
        self.tests.iter().for_each(|test| counts[test.triangle as usize] += 1);
        self.tests.iter().map(move |test| (test, self.weight(test.triangle) / f64::from(counts[test.triangle as usize])))
    }

    /// What all elements weigh.
    pub fn whole(&self) -> f64 {
        (0..self.triangles.triangles.len() as u32).map(|triangle| self.weight(triangle)).sum()
    }

    /// What a node weighs in the mean.
    pub fn size(&self) -> f64 {
        let counts = |&number: &u32| self.weight(number) > 0.0;
        let nodes = match &self.seen {
            Some(_) => NODES * (0..self.triangles.triangles.len() as u32).filter(counts).count() as f64,
            None => self.triangles.nodes.len() as f64,
        };
        self.whole() / nodes
    }

    /// What a node in a triangle weighs, where a view shows that: triangles of a surface cover more pixels or fewer. `None` where all are taken alike.
    pub fn size_in(&self, triangle: u32) -> Option<f64> {
        self.seen.as_ref().map(|seen| seen.weight(triangle) / NODES)
    }

    /// What each node weighs by the heaviest of its triangles; 0 if none of them counts.
    pub fn node_sizes(&self) -> Vec<f64> {
        let Some(seen) = &self.seen else { return vec![self.size(); self.triangles.nodes.len()] };
        let mut sizes = vec![0.0_f64; self.triangles.nodes.len()];
        for (number, element) in self.triangles.triangles.iter().enumerate() {
            let size = seen.weight(number as u32) / NODES;
            element.nodes().into_iter().for_each(|node| sizes[node as usize] = sizes[node as usize].max(size));
        }
        sizes
    }

    /// The hierarchical surplus of a triangle: what a linear function between its corners is off in the middles of its edges, squared, channels and
    /// edges added, in W^2/m^4.
    pub fn surplus_sq(&self, triangle: u32) -> f64 {
        let surplus_sq = |edge: usize| (0..self.deciding).map(move |channel| self.bend(triangle, edge, channel).surplus.powi(2));
        (0..3).flat_map(surplus_sq).sum()
    }

    /// How much light bends along all edges, by the nodes in their middles.
    fn bends(&self) -> Bends {
        let mut of_nodes = vec![Bend::default(); self.triangles.nodes.len()];
        for (number, triangle) in self.triangles.triangles.iter().enumerate() {
            for (edge, &middle) in triangle.middles.iter().enumerate() {
                let by_channel = (0..self.deciding).map(|channel| self.bend(number as u32, edge, channel));
                let add = |all: Bend, of: Bend| Bend { surplus: all.surplus + of.surplus, variance: all.variance + of.variance };
                of_nodes[middle as usize] = by_channel.fold(Bend::default(), add);
            }
        }
        Bends::new(of_nodes)
    }

    /// How much light bends along an edge of a triangle, in one channel.
    fn bend(&self, triangle: u32, edge: usize, channel: usize) -> Bend {
        let (nodes, channels) =
            (self.triangles.triangles[triangle as usize].nodes(), self.found.len() / self.triangles.nodes.len());
        let of = |node: usize| self.values()[nodes[node] as usize * channels + channel].map(f64::from);
        let [from, to, middle] = [edge, (edge + 1) % 3, 3 + edge].map(of);
        Bend { surplus: middle[0] - 0.5 * (from[0] + to[0]), variance: middle[1] + 0.25 * (from[1] + to[1]) }
    }

    /// The function at a point of a triangle and its variance, in one of so many channels.
    fn at(&self, triangle: u32, weights: [f64; 6], channel: usize, channels: usize) -> [f64; 2] {
        let nodes = self.triangles.triangles[triangle as usize].nodes();
        let values = nodes.map(|node| self.values()[node as usize * channels + channel].map(f64::from));
        let (mut function, mut variance) = (0.0, 0.0);
        for ([value, noise], weight) in values.into_iter().zip(weights) {
            function += weight * value;
            variance += weight * weight * noise;
        }
        [element::limited(values.map(|[value, _]| value), function).max(0.0), variance]
    }

    /// The light in the middle of a triangle, squared, channels added, in W^2/m^4.
    pub fn light_sq(&self, triangle: u32) -> f64 {
        let (weights, channels) = (element::weights([1.0 / 3.0; 3]), self.found.len() / self.triangles.nodes.len());
        (0..self.deciding).map(|channel| self.at(triangle, weights, channel, channels)[0].powi(2)).sum()
    }

    /// Holds the function against the light, by channel with its variance, at a point of a triangle; `light_sq` is all light there, squared.
    pub fn test(&self, triangle: u32, at: [f64; 3], light: &[[f64; 2]], light_sq: f64) -> Test {
        let weights = element::weights(at);
        let mut test = Test { triangle, difference_sq: 0.0, noise_sq: 0.0, of_nodes_sq: 0.0, light_sq };
        for (channel, &[value, variance]) in light.iter().enumerate().take(self.deciding) {
            let [function, noise] = self.at(triangle, weights, channel, light.len());
            test.difference_sq += (function - value).powi(2);
            test.noise_sq += self.noise_scale * variance + noise;
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

    /// Bisects triangles twice, by how light bends along their edges, and forgets the tests of all that changed.
    pub fn refine(&mut self, worst: &[u32]) {
        let before: Vec<[u32; 3]> = self.triangles.triangles.iter().map(|triangle| triangle.middles).collect();
        let mut bends = self.bends();
        for &triangle in worst {
            // Others may have bisected it.
            if self.triangles.triangles[triangle as usize].middles == before[triangle as usize] {
                self.triangles.bisect(triangle, &mut bends);
                let second = self.triangles.triangles[triangle as usize].neighbours[1];
                [triangle, second].into_iter().for_each(|half| self.triangles.bisect(half, &mut bends));
            }
        }
        self.follow_halvings();
        for (number, before) in before.iter().enumerate() {
            self.is_tested[number] &= self.triangles.triangles[number].middles == *before;
        }
        self.tests.retain(|test| self.is_tested[test.triangle as usize]);
    }
}
