//! How radiosity varies over an element, to first order: by what its siblings have.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Frame;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::sweep::Radiosity;

/// A plane through the siblings' radiosities is steep enough to be known if the spread of their centroids, across, is this part of
/// that along.
const LEAST_SPREAD: f64 = 1e-3;

/// The slopes of all elements.
pub(super) struct Slopes {
    channels: usize,
    /// Elements come after clusters.
    first: usize,
    /// In W/m^3, by element and channel, in the element's plane.
    slopes: Vec<DVec3>,
}

impl Slopes {
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
        Self { channels, first, slopes }
    }

    /// The radiosity at a point of a leaf less that of the leaf, by channel.
    pub fn rise(&self, leaf: NodeId, from_centroid: DVec3) -> impl Iterator<Item = f64> {
        let at = (leaf.index() - self.first) * self.channels;
        self.slopes[at..at + self.channels].iter().map(move |slope| slope.dot(from_centroid))
    }
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

        let slopes = Slopes::new(&hierarchy, &radiosity);
        for child in hierarchy.children(split) {
            let centroid = hierarchy.node(child).centroid;
            for &corner in hierarchy.facet(child).vertices {
                let found = slopes.rise(child, corner - centroid).next().unwrap();
                assert!((found - (at(corner) - at(centroid))).abs() < 1e-12, "{found}");
            }
        }
        assert_eq!(slopes.rise(whole, DVec3::X).next(), Some(0.0));
    }
}
