//! What two nodes exchange if nothing is in between: form factors between polygons, between clusters, and across.

use std::f64::consts::PI;

use glam::DVec3;

use super::link_set::Pair;
use crate::form_factor::{estimate_exchange, exact_exchange, point_to_polygon};
use crate::geometry::{Aabb, Facet};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// Whether it is proved that no light passes: both in one plane, or one behind the other.
pub(super) fn is_dark(scene: &Scene, hierarchy: &Hierarchy, pair: Pair) -> bool {
    match (hierarchy.is_cluster(pair.receiver), hierarchy.is_cluster(pair.source)) {
        (false, false) => {
            let plane = |node| scene.surface(SurfaceId(hierarchy.node(node).surface)).plane;
            let (receiver, source) = (hierarchy.facet(pair.receiver), hierarchy.facet(pair.source));
            plane(pair.receiver) == plane(pair.source) || behind(&receiver, &source) || behind(&source, &receiver)
        }
        (false, true) => box_behind(&hierarchy.facet(pair.receiver), hierarchy.bounds(pair.source)),
        (true, false) => box_behind(&hierarchy.facet(pair.source), hierarchy.bounds(pair.receiver)),
        (true, true) => false,
    }
}

/// Whether all of `polygon` is behind `front`, or in its plane.
pub(super) fn behind(front: &Facet<'_>, polygon: &Facet<'_>) -> bool {
    let tolerance = 1e-12 * (front.radius + polygon.radius);
    polygon.vertices.iter().all(|&vertex| front.height(vertex) <= tolerance)
}

/// Whether all of a box is behind `front`, or touches its plane from there.
fn box_behind(front: &Facet<'_>, bounds: &Aabb) -> bool {
    let tolerance = 1e-12 * (front.radius + bounds.diagonal());
    let highest = DVec3::select(front.normal.cmpgt(DVec3::ZERO), bounds.max, bounds.min);
    front.height(highest) <= tolerance
}

/// Form factor F_rs of two polygons, to the relative accuracy asked for; 0 asks for the exact one.
pub(super) fn polygon_form_factor(receiver: &Facet<'_>, source: &Facet<'_>, accuracy: f64) -> f64 {
    let exchange =
        if accuracy > 0.0 { estimate_exchange(receiver, source, accuracy).value } else { exact_exchange(receiver, source) };
    (exchange / receiver.area).clamp(0.0, 1.0)
}

/// A form factor good enough to decide by: at the receiver's centroid, or the largest at its corners where the centroid sees nothing.
pub(super) fn quick_form_factor(receiver: &Facet<'_>, source: &Facet<'_>) -> f64 {
    let at_centroid = point_to_polygon(receiver.centroid, receiver.normal, source);
    if at_centroid > 0.0 {
        return at_centroid;
    }
    receiver.vertices.iter().map(|&vertex| point_to_polygon(vertex, receiver.normal, source)).fold(0.0, f64::max)
}

/// Form factor F_rs of [`separated`] nodes of which one at least is a cluster: from the areas that they show to each other, at the distance
/// of their middles.
pub(super) fn estimate_cluster_form_factor(hierarchy: &Hierarchy, pair: Pair) -> f64 {
    let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
    let direction = hierarchy.direction(pair.receiver, pair.source);
    let distance = receiver.centroid.distance(source.centroid);
    let shown = shown_area(hierarchy, pair.receiver, direction, source.radius / distance)
        * shown_area(hierarchy, pair.source, -direction, receiver.radius / distance);
    (shown / (PI * distance * distance * receiver.area)).min(bound_form_factor(hierarchy, pair))
}

/// Whether two nodes are farther apart than they are large.
pub(super) fn separated(hierarchy: &Hierarchy, pair: Pair) -> bool {
    let (receiver, source) = (hierarchy.node(pair.receiver), hierarchy.node(pair.source));
    receiver.radius + source.radius < receiver.centroid.distance(source.centroid)
}

/// What two nodes can exchange at most, as a form factor: all that the smaller one sends.
pub(super) fn bound_form_factor(hierarchy: &Hierarchy, pair: Pair) -> f64 {
    (hierarchy.area(pair.source) / hierarchy.area(pair.receiver)).min(1.0)
}

/// The area in m^2 that a node shows to something in a `direction` that takes up an angle of tangent `spread` to each side. A polygon that
/// is seen from both sides of its plane shows what it shows on average.
fn shown_area(hierarchy: &Hierarchy, node: NodeId, direction: DVec3, spread: f64) -> f64 {
    if hierarchy.is_cluster(node) {
        return hierarchy.shown_area(node, direction).max(0.0);
    }
    let (cosine, spread) = (hierarchy.normal(node).dot(direction), 0.5 * spread);
    let mean = if cosine.abs() < spread { (cosine + spread).powi(2) / (4.0 * spread) } else { cosine.max(0.0) };
    hierarchy.area(node) * mean
}
