//! Between two polygons, exactly: `A_r F_rs`, the integral of the kernel over both.
//!
//! The polygons are first clipped to what is in front of the other's plane. From there the integrand has no kinks and each of three
//! ways reaches 1e-11 in its place; distance and sizes choose:
//!
//! - near or touching, sizes alike: the double contour integral, see `contour`;
//! - one polygon small beside the distance: Lambert's sum at Gauss points of the small one;
//! - both small beside the distance: the kernel at Gauss points of both, where contour and Lambert cancel.
//!
//! Everything is computed in an order that geometry alone decides, so exchanging the arguments changes no bit. Cost: 1 to 100 us.

use std::cmp::Ordering;

use glam::DVec3;

use super::contour::{PanelRule, contour_exchange};
use super::lambert::{kernel, point_to_polygon};
use crate::geometry::{Clip, Facet, clip_to_front, for_each_gauss_point, halves};

/// `A_r F_rs` in m^2: relative error about 1e-11, 0 between polygons that face away from each other or lie in one plane.
///
/// Bit for bit symmetric in its arguments.
pub(crate) fn exact_exchange(receiver: &Facet<'_>, source: &Facet<'_>) -> f64 {
    with_visible_parts(receiver, source, 0.0, exact_exchange_of_facing)
}

/// Calls `body(small, large)` with the parts of two polygons that are in front of each other, in an order that does not depend on
/// which is the receiver; `otherwise` if there are none.
pub(super) fn with_visible_parts<T>(
    receiver: &Facet<'_>,
    source: &Facet<'_>,
    otherwise: T,
    body: impl FnOnce(&Facet<'_>, &Facet<'_>) -> T,
) -> T {
    // Most pairs are in front of each other by far.
    let between = source.centroid - receiver.centroid;
    if receiver.normal.dot(between) > CERTAINLY * source.radius && -source.normal.dot(between) > CERTAINLY * receiver.radius {
        return in_order(receiver, source, body);
    }

    let receiver_part = clip_to_front(receiver, source.vertices[0], source.normal);
    let source_part = clip_to_front(source, receiver.vertices[0], receiver.normal);
    let (a, b) = match (&receiver_part, &source_part) {
        (Clip::Nothing, _) | (_, Clip::Nothing) => return otherwise,
        (Clip::Whole, Clip::Whole) => (*receiver, *source),
        (Clip::Whole, Clip::Part(source)) => (*receiver, source.facet()),
        (Clip::Part(receiver), Clip::Whole) => (receiver.facet(), *source),
        (Clip::Part(receiver), Clip::Part(source)) => (receiver.facet(), source.facet()),
    };
    in_order(&a, &b, body)
}

/// Wide enough for what rounding and the tolerance of planarity do to a height.
const CERTAINLY: f64 = 1.001;

/// Calls `body` with the smaller first.
#[inline]
fn in_order<T>(a: &Facet<'_>, b: &Facet<'_>, body: impl FnOnce(&Facet<'_>, &Facet<'_>) -> T) -> T {
    match compare(a, b) {
        Ordering::Greater => body(b, a),
        _ => body(a, b),
    }
}

/// Smaller first; among equals the order of the coordinates decides. Polygons that compare equal lie in one plane.
fn compare(a: &Facet<'_>, b: &Facet<'_>) -> Ordering {
    let by_coordinates = |a: DVec3, b: DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
    a.radius
        .total_cmp(&b.radius)
        .then_with(|| a.area.total_cmp(&b.area))
        .then_with(|| by_coordinates(a.centroid, b.centroid))
        .then_with(|| by_coordinates(a.normal, b.normal))
}

/// Two polygons entirely in front of each other, the smaller first.
pub(super) fn exact_exchange_of_facing(small: &Facet<'_>, large: &Facet<'_>) -> f64 {
    exchange(small, large, MOST_CUTS).max(0.0)
}

/// The same, with `large` cut up to `cuts_left` times.
fn exchange(small: &Facet<'_>, large: &Facet<'_>, cuts_left: u32) -> f64 {
    // From the centre of one to the nearest point of the other, in radii.
    let small_clearance = large.distance_to(small.centroid) / small.radius;
    let large_clearance = small.distance_to(large.centroid) / large.radius;

    if large_clearance > GAUSS_CLEARANCE {
        return product_exchange(small, large, gauss_points(small_clearance), gauss_points(large_clearance));
    }
    if small_clearance > GAUSS_CLEARANCE {
        return lambert_exchange(small, large, gauss_points(small_clearance));
    }
    let integral = contour_exchange(small, large, PanelRule::EXACT);
    if integral.magnitude > WORST_CANCELLATION * integral.value && large.radius > 2.0 * small.radius && cuts_left > 0 {
        return halves(large).map(|half| exchange(small, &half.facet(), cuts_left - 1)).sum();
    }
    integral.value
}

/// From this distance, in radii, Gauss points are both cheaper and more exact than the contour. Empirical, see bench `form_factor`.
const GAUSS_CLEARANCE: f64 = 8.0;

/// A contour integral that lost more than this factor to cancellation is taken apart: halves of the large polygon that are far from
/// the small one are then out of it, and those that are near come down to its size.
const WORST_CANCELLATION: f64 = 1e5;

/// Enough to come from any size to any other that f64 can tell apart.
const MOST_CUTS: u32 = 100;

/// How many Gauss points per direction integrate a function to 1e-13 whose singularities are `clearance` half lengths away or more.
///
/// The rule converges as `rho^(-2n)` with `rho = clearance + sqrt(clearance^2 - 1)`; two points more pay for the fourth power.
fn gauss_points(clearance: f64) -> usize {
    let rho = clearance + (clearance * clearance - 1.0).max(0.0).sqrt();
    (30.0 / (2.0 * rho.ln())).ceil() as usize + 2
}

/// Lambert's sum at the Gauss points of `from`.
pub(super) fn lambert_exchange(from: &Facet<'_>, to: &Facet<'_>, points: usize) -> f64 {
    let mut sum = 0.0;
    for_each_gauss_point(from.vertices, from.normal, points, |x, weight| {
        sum += weight * point_to_polygon(x, from.normal, to);
    });
    sum
}

/// The kernel at the Gauss points of both.
pub(super) fn product_exchange(a: &Facet<'_>, b: &Facet<'_>, points_a: usize, points_b: usize) -> f64 {
    let mut nodes_b = Vec::with_capacity(points_b * points_b * b.vertices.len() / 2);
    for_each_gauss_point(b.vertices, b.normal, points_b, |y, weight| nodes_b.push((y, weight)));
    let mut sum = 0.0;
    for_each_gauss_point(a.vertices, a.normal, points_a, |x, weight| {
        let row: f64 = nodes_b.iter().map(|&(y, weight)| weight * kernel(x, a.normal, y, b.normal)).sum();
        sum += weight * row;
    });
    sum
}
