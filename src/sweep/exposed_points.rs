//! Points of nodes on which nothing stands.

use glam::DVec3;

use super::Exposure;
use super::exposure::{ByPlane, PIECE_SAMPLES, sampled_points};
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::transmittance::Rays;

/// An exposed point of `node`: the centroid if the node is wholly exposed, else the first exposed one of [`PIECE_SAMPLES`] sampled
/// points; `None` if there is none.
pub(crate) fn sampled_exposed_point(
    hierarchy: &Hierarchy,
    by_plane: &ByPlane<'_>,
    exposure: &Exposure,
    rays: &Rays<'_>,
    node: NodeId,
    seed: u64,
) -> Option<DVec3> {
    match exposure.of(node) {
        1.0 => Some(hierarchy.facet(node).centroid),
        0.0 => None,
        _ => {
            let mut points = sampled_points(hierarchy, by_plane, rays, node, PIECE_SAMPLES, seed);
            points.find_map(|point| (!point.is_hidden).then_some(point.point))
        }
    }
}

/// About `count` exposed points of a node, uniform by area; fewer where something stands on it, none if that is all.
pub(super) fn sampled_exposed_points(
    hierarchy: &Hierarchy,
    by_plane: &ByPlane<'_>,
    exposure: &Exposure,
    rays: &Rays<'_>,
    (node, count): (NodeId, u32),
    seed: u64,
) -> Vec<DVec3> {
    match exposure.of(node) {
        1.0 => {
            let (facet, sobol) = (hierarchy.facet(node), sampling::shifted_sobol_2d(seed));
            (0..count).map(sobol).map(|[u, v]| facet.point_at(u, v)).collect()
        }
        0.0 => Vec::new(),
        _ => {
            let points = sampled_points(hierarchy, by_plane, rays, node, count, seed);
            points.filter(|point| !point.is_hidden).map(|point| point.point).collect()
        }
    }
}
