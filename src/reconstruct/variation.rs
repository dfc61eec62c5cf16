//! How radiosity varies over an element: over a leaf to first order, by what its siblings have; over others by what their leaves have.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Frame;
use crate::hierarchy::{Hierarchy, Node, NodeId};
use crate::sweep::Radiosity;

/// A plane through the siblings' radiosities is steep enough to be known if the spread of their centroids, across, is this part of
/// that along.
const LEAST_SPREAD: f64 = 1e-3;

/// How radiosity varies over all elements.
pub(super) struct Variation {
    channels: usize,
    /// Elements come after clusters.
    first: usize,
    /// In W/m^3, by element and channel, in the element's plane.
    slopes: Vec<DVec3>,
    /// The standard deviation from the element's mean, over its area, in W/m^2, by element and channel.
    deviations: Vec<f64>,
}

impl Variation {
    /// Children of one element lie on a plane of least squares.
    pub fn new(hierarchy: &Hierarchy, radiosity: &Radiosity) -> Self {
        let (channels, first) = (radiosity.channels(), hierarchy.cluster_count());
        let mut slopes = vec![DVec3::ZERO; channels * (hierarchy.len() - first)];
        slopes.par_chunks_mut(channels).enumerate().with_min_len(256).for_each(|(index, slopes)| {
            let node = NodeId((first + index) as u32);
            if let Some(parent) = hierarchy.parent(node).filter(|&parent| !hierarchy.is_cluster(parent)) {
                fit(hierarchy, radiosity, parent, slopes);
            }
        });
        let deviations = deviations(hierarchy, radiosity, &slopes);
        Self { channels, first, slopes, deviations }
    }

    /// The radiosity at a point of a leaf less that of the leaf, by channel.
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

/// The standard deviations over all elements, by channel: what varies from leaf to leaf, and over these.
fn deviations(hierarchy: &Hierarchy, radiosity: &Radiosity, slopes: &[DVec3]) -> Vec<f64> {
    let (channels, first) = (radiosity.channels(), hierarchy.cluster_count());
    let elements = || (first..hierarchy.len()).map(|index| NodeId(index as u32));
    let at = |element: NodeId| (element.index() - first) * channels;

    // Mean squares, children before parents. Over a square a unit slope has the square of its radius over 6.
    let mut of = vec![0.0; slopes.len()];
    for element in elements().rev() {
        let Node { radius, area, .. } = *hierarchy.node(element);
        for channel in 0..channels {
            of[at(element) + channel] = if hierarchy.is_leaf(element) {
                radiosity.of(element)[channel].powi(2) + slopes[at(element) + channel].length_squared() * radius * radius / 6.0
            } else {
                let of_child = |child| hierarchy.area(child) * of[at(child) + channel];
                hierarchy.children(element).map(of_child).sum::<f64>() / area
            };
        }
    }

    for element in elements() {
        let squares = of[at(element)..][..channels].iter_mut().zip(radiosity.of(element));
        squares.for_each(|(of, mean)| *of = (*of - mean * mean).max(0.0).sqrt());
    }
    of
}

/// The slopes of the plane through the radiosities of the children of `parent`, at their centroids.
fn fit(hierarchy: &Hierarchy, radiosity: &Radiosity, parent: NodeId, slopes: &mut [DVec3]) {
    let count = hierarchy.children(parent).len() as f64;
    let centroid = |node: NodeId| hierarchy.node(node).centroid;
    let middle = hierarchy.children(parent).map(centroid).sum::<DVec3>() / count;
    let Frame { tangent, bitangent, .. } = Frame::around(hierarchy.normal(parent));
    let flat = |node: NodeId| [tangent, bitangent].map(|axis| axis.dot(centroid(node) - middle));

    let mut spread = [0.0; 3];
    for [u, v] in hierarchy.children(parent).map(flat) {
        spread = [spread[0] + u * u, spread[1] + u * v, spread[2] + v * v];
    }
    let [uu, uv, vv] = spread;
    let determinant = uu * vv - uv * uv;
    if determinant <= LEAST_SPREAD * (uu + vv) * (uu + vv) {
        return;
    }
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

    /// Radiosities that rise evenly over a surface are found between the centroids, and a surface that is not split is even.
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
        exposure.grow(&scene, &hierarchy, &Rays::new(&*visibility, &scene), 0);
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
