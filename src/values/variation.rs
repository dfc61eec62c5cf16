//! How radiosity varies over elements: over a leaf linearly, with the slope that its siblings tell; over others from leaf to leaf.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Frame;
use crate::hierarchy::{Hierarchy, Node, NodeId};
use crate::sweep::Radiosity;

/// A slope is known only if the siblings' centroids do not lie on a line: the least determinant of their second moments, as a part
/// of the square of the trace.
const LEAST_DETERMINANT: f64 = 1e-3;

/// The least number of elements that is worth a task of its own.
const PARALLEL: usize = 256;

/// How radiosity varies over all elements.
pub(super) struct Variation {
    channels: usize,
    /// The number of the first element: elements come after clusters.
    first: usize,
    /// Gradients in the element's plane, in W/m^3, by element and channel.
    slopes: Vec<DVec3>,
    /// Standard deviations over the element's area, in W/m^2, by element and channel.
    deviations: Vec<f64>,
}

impl Variation {
    /// Fits a plane by least squares through the radiosities of each element's children.
    pub fn new(hierarchy: &Hierarchy, radiosity: &Radiosity) -> Self {
        let (channels, first) = (radiosity.channels(), hierarchy.cluster_count());
        let mut slopes = vec![DVec3::ZERO; channels * (hierarchy.len() - first)];
        slopes.par_chunks_mut(channels).enumerate().with_min_len(PARALLEL).for_each(|(index, slopes)| {
            let node = NodeId((first + index) as u32);
            if let Some(parent) = hierarchy.parent(node).filter(|&parent| !hierarchy.is_cluster(parent)) {
                fit(hierarchy, radiosity, parent, slopes);
            }
        });
        let deviations = deviations(hierarchy, radiosity, &slopes);
        Self { channels, first, slopes, deviations }
    }

    /// By how much the radiosity at a point of a leaf lies above that of the leaf, by channel.
    pub fn rise(&self, leaf: NodeId, from_centroid: DVec3) -> impl Iterator<Item = f64> {
        self.of(&self.slopes, leaf).iter().map(move |slope| slope.dot(from_centroid))
    }

    /// The standard deviation of the radiosity over an element, by channel, in W/m^2.
    pub fn deviation(&self, element: NodeId) -> &[f64] {
        self.of(&self.deviations, element)
    }

    fn of<'a, T>(&self, all: &'a [T], element: NodeId) -> &'a [T] {
        &all[(element.index() - self.first) * self.channels..][..self.channels]
    }
}

/// The standard deviations over all elements, by channel: between leaves, and within each.
fn deviations(hierarchy: &Hierarchy, radiosity: &Radiosity, slopes: &[DVec3]) -> Vec<f64> {
    let (channels, first) = (radiosity.channels(), hierarchy.cluster_count());

    // Mean squares, children before parents. A unit slope over a square has the variance of its radius squared over 6.
    let mut of = vec![0.0; slopes.len()];
    for level in hierarchy.levels().into_iter().rev().filter(|level| level.start >= first) {
        let (start, end) = (level.start - first, level.end - first);
        let (own, below) = of[start * channels..].split_at_mut(level.len() * channels);
        own.par_chunks_mut(channels).enumerate().with_min_len(PARALLEL).for_each(|(index, own)| {
            let element = NodeId((level.start + index) as u32);
            let Node { radius, area, .. } = *hierarchy.node(element);
            for (channel, own) in own.iter_mut().enumerate() {
                *own = if hierarchy.is_leaf(element) {
                    let slope = slopes[(start + index) * channels + channel];
                    radiosity.of(element)[channel].powi(2) + slope.length_squared() * radius * radius / 6.0
                } else {
                    let of_child =
                        |child: NodeId| hierarchy.area(child) * below[(child.index() - first - end) * channels + channel];
                    hierarchy.children(element).map(of_child).sum::<f64>() / area
                };
            }
        });
    }

    // Less the squares of the means.
    of.par_chunks_mut(channels).enumerate().with_min_len(PARALLEL).for_each(|(index, of)| {
        let means = radiosity.of(NodeId((first + index) as u32));
        of.iter_mut().zip(means).for_each(|(of, mean)| *of = (*of - mean * mean).max(0.0).sqrt());
    });
    of
}

/// The slopes of the plane through the radiosities of the children of `parent`, at their centroids.
fn fit(hierarchy: &Hierarchy, radiosity: &Radiosity, parent: NodeId, slopes: &mut [DVec3]) {
    let count = hierarchy.children(parent).len() as f64;
    let centroid = |node: NodeId| hierarchy.node(node).centroid;
    let middle = hierarchy.children(parent).map(centroid).sum::<DVec3>() / count;
    let Frame { tangent, bitangent, .. } = Frame::around(hierarchy.normal(parent));
    let flat = |node: NodeId| [tangent, bitangent].map(|axis| axis.dot(centroid(node) - middle));

    // Second moments of the children's centroids, in the plane.
    let mut moments = [0.0; 3];
    for [u, v] in hierarchy.children(parent).map(flat) {
        moments = [moments[0] + u * u, moments[1] + u * v, moments[2] + v * v];
    }
    let [uu, uv, vv] = moments;
    let determinant = uu * vv - uv * uv;
    if determinant <= LEAST_DETERMINANT * (uu + vv) * (uu + vv) {
        return;
    }

    // The normal equations, channel by channel.
    for (channel, slope) in slopes.iter_mut().enumerate() {
        let (mut ub, mut vb) = (0.0, 0.0);
        for child in hierarchy.children(parent) {
            let ([u, v], b) = (flat(child), radiosity.of(child)[channel]);
            (ub, vb) = (ub + u * b, vb + v * b);
        }
        *slope = (tangent * (vv * ub - uv * vb) + bitangent * (uu * vb - uv * ub)) / determinant;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides, SurfaceId};
    use crate::sweep::Exposure;
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// A linear radiosity is found exactly; a surface that is not split has no slope.
    #[test]
    fn a_plane_is_found_and_nothing_where_there_are_no_siblings() {
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let triangle = [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0], [1.0, 2.0, 0.5]];
        let square = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [1.0, 1.0, 5.0], [0.0, 1.0, 5.0]];
        let faces = vec![(Polygon::new(&triangle).unwrap(), 0, 0), (Polygon::new(&square).unwrap(), 0, 1)];
        let scene = Scene::new(1, vec![grey], faces, Sides::Front).unwrap();
        let mut hierarchy = Hierarchy::new(&scene);
        let (split, whole) = (hierarchy.node_of(SurfaceId(0)), hierarchy.node_of(SurfaceId(1)));
        hierarchy.split(split);
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &Rays::new(&*visibility, &scene), 0, &|| false);
        let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let at = |x: DVec3| 2.0 + x.dot(DVec3::new(0.3, -0.2, 0.7));
        for child in hierarchy.children(split) {
            radiosity.of_mut(child)[0] = at(hierarchy.node(child).centroid);
        }

        let variation = Variation::new(&hierarchy, &radiosity);
        for child in hierarchy.children(split) {
            let centroid = hierarchy.node(child).centroid;
            for &corner in hierarchy.facet(child).vertices {
                let found = variation.rise(child, corner - centroid).next().unwrap();
                assert!((found - (at(corner) - at(centroid))).abs() < 1e-12, "{found}");
            }
        }
        assert_eq!(variation.rise(whole, DVec3::X).next(), Some(0.0));
    }
}
