//! Between two polygons, as exactly as asked: quadrature chosen by distance.
//!
//! With radii R, distance d of the centroids and heights h of each centroid above the other's plane, the relative error of the
//! kernel between the centroids is of second order,
//!
//! ```text
//! e = sum over both of  R^2/d^2 + 0.3 R^2/(d h),
//! ```
//!
//! the first term from 1/r^4, the second from its product with the heights, which are linear. Lambert's sum at the centroid of
//! the smaller polygon has no error from the larger one; there d is the distance to the larger polygon and only the smaller one
//! counts. Rules with more points have powers of e. The factors and powers of all claims are empirical, fitted to 50,000 random
//! pairs of all kinds so that at least 99.8% stay within them; tests/form_factors counts those that do not.
//!
//! The rules, cheapest first: kernel between centroids, Lambert at the centroid, kernel at 2x2 points of each, Lambert at 2x2 and 3x3
//! points, the contour integral to few digits, `exact_exchange`. The first whose claim is within the accuracy is used. The
//! clipped polygons and the order in which they are used depend on geometry alone, so the arguments can be exchanged.

use std::f64::consts::PI;

use super::contour::{PanelRule, contour_exchange};
use super::exact::{exact_exchange_of_facing, lambert_exchange, product_exchange, with_visible_parts};
use super::point_to_polygon;
use crate::geometry::{Clip, Facet, clip_to_front};

/// An integral with the error that its quadrature claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The claimed absolute error; an estimate, no bound.
    pub error: f64,
}

/// What `exact_exchange` claims, relative.
const EXACT_ACCURACY: f64 = 1e-10;

/// `A_r F_rs` in m^2 with relative error about `accuracy`, and the error that the chosen rule claims: an estimate, no bound.
///
/// Bit for bit symmetric in its arguments. An `accuracy` below 1e-10 or NaN asks for the exact value.
pub(crate) fn estimate_exchange(receiver: &Facet<'_>, source: &Facet<'_>, accuracy: f64) -> Estimate {
    with_visible_parts(receiver, source, Estimate { value: 0.0, error: 0.0 }, |small, large| {
        estimate_of_facing(small, large, accuracy)
    })
}

/// Two polygons entirely in front of each other, the smaller first.
fn estimate_of_facing(small: &Facet<'_>, large: &Facet<'_>, accuracy: f64) -> Estimate {
    let claim = |value: f64, relative: f64| Estimate { value, error: relative * value };
    if accuracy.is_nan() || accuracy <= EXACT_ACCURACY {
        return claim(exact_exchange_of_facing(small, large), EXACT_ACCURACY);
    }

    // Both far from each other: the kernel between the centroids, h h / (pi d^4).
    let between = large.centroid - small.centroid;
    let height_of_small = -large.normal.dot(between);
    let height_of_large = small.normal.dot(between);
    if height_of_small <= 0.0 || height_of_large <= 0.0 {
        // What is in front is in front by rounding only.
        return claim(0.0, 0.0);
    }
    let distance_sq = between.length_squared();
    let distance = distance_sq.sqrt();
    let order = second_order(small.radius, distance, height_of_small) + second_order(large.radius, distance, height_of_large);
    if order <= accuracy {
        let mean = height_of_small * height_of_large / (PI * distance_sq * distance_sq);
        return claim(small.area * large.area * mean, order);
    }

    // The smaller one far from the other, seen in its own measure: Lambert's sum, at one point if that will do.
    let gap = large.distance_to(small.centroid);
    let order_of_small = second_order(small.radius, gap, height_of_small);
    if order_of_small <= accuracy {
        return claim(small.area * point_to_polygon(small.centroid, small.normal, large), order_of_small);
    }
    let error = higher_order(order, 2);
    if error <= accuracy {
        return claim(product_exchange(small, large, 2, 2), error);
    }
    for points in 2..=4 {
        let error = higher_order(order_of_small, points);
        if error <= accuracy {
            return claim(lambert_exchange(small, large, points), error);
        }
    }

    // Near or touching: the contour, whose terms tell how much will cancel and so which precision it takes.
    let mut cancellation = 0.0;
    for (rule, share) in CONTOUR_RULES {
        if share * cancellation > accuracy {
            continue;
        }
        let integral = contour_exchange(small, large, rule);
        cancellation = integral.magnitude / integral.value;
        if cancellation > 0.0 && share * cancellation <= accuracy {
            return claim(integral.value, share * cancellation);
        }
    }
    claim(exact_exchange_of_facing(small, large), EXACT_ACCURACY)
}

/// The relative error of the mid-point rule on one polygon, to second order.
#[inline]
fn second_order(radius: f64, distance: f64, height: f64) -> f64 {
    radius * radius * (height + 0.3 * distance) / (distance * distance * height)
}

/// The relative error of `points` by `points` Gauss points where the mid-point rule has `order`; none is claimed above 1.5.
#[inline]
fn higher_order(order: f64, points: usize) -> f64 {
    const LARGEST_ORDER: f64 = 1.5;
    let power = |factor: f64, n: i32| factor * order.powi(n) * order.sqrt();
    match points {
        _ if order.is_nan() || order > LARGEST_ORDER => f64::INFINITY,
        2 => power(0.2, 1),
        3 => power(0.05, 2),
        _ => power(0.0125, 3),
    }
}

/// Contour integrals of rising precision, each with its error as a share of the magnitudes that cancel in it.
const CONTOUR_RULES: [(PanelRule, f64); 4] = [
    (PanelRule { digits: 2.0, max_points: 4, max_halvings: 0 }, 1e-3),
    (PanelRule { digits: 4.0, max_points: 4, max_halvings: 1 }, 1.2e-4),
    (PanelRule { digits: 6.0, max_points: 4, max_halvings: 3 }, 6e-6),
    (PanelRule { digits: 10.0, max_points: 6, max_halvings: 6 }, 5e-8),
];

/// `A_r F_rs` in m^2 by Lambert's sum at `points` by `points` Gauss points of the receiver, which are not those of the source: not
/// symmetric, and so a check on what is.
///
/// The claimed error is empirical like the others: above it lie less than 0.2% of random pairs. Where the source is near the receiver
/// and smaller than the distance of the points, they may miss it, and the claim is all that the source can receive.
/// `points` is at least 2; above 4 the claim stays that of 4.
pub(crate) fn sided_exchange(receiver: &Facet<'_>, source: &Facet<'_>, points: usize) -> Estimate {
    let clipped = clip_to_front(receiver, source.vertices[0], source.normal);
    let receiver = match &clipped {
        Clip::Whole => *receiver,
        Clip::Part(part) => part.facet(),
        Clip::Nothing => return Estimate { value: 0.0, error: 0.0 },
    };
    let points = points.max(2);
    let value = lambert_exchange(&receiver, source, points);

    // Far: the error is of the order that the rule has. The source may cross the horizon, so its distance is taken to all of it.
    let order = second_order(receiver.radius, source.distance_to(receiver.centroid), source.height(receiver.centroid));
    let relative = higher_order(order, points);
    if relative.is_finite() {
        return Estimate { value, error: relative.max(EXACT_ACCURACY) * value };
    }

    // Near: what one point less would have changed, and a share of what could pass between the points.
    let coarse = lambert_exchange(&receiver, source, points - 1);
    let share = if source.radius * (points as f64) < receiver.radius { 1.0 } else { 0.1 };
    Estimate { value, error: 2.0 * (value - coarse).abs() + share * receiver.area.min(source.area) }
}
