//! The exchange of two polygons that see each other entirely, as a double integral along their contours.
//!
//! ```text
//! A_r F_rs = (1/2pi) oint_r oint_s ln|x - y| dx.dy        (Stokes; Schroeder, Hanrahan 1993, eq. 3)
//! ```
//!
//! The integral along a straight edge from a fixed point is elementary: with u the abscissa on the edge measured from the foot of
//! the perpendicular and h its length, `int ln r du = u ln r - u + h atan(u/h)`. The other integral is done by Gauss panels that
//! shrink towards its singularities, whose places in the complex plane are known: touching polygons need no special case.
//! Terms of the size of an edge squared cancel down to the result, so this is for polygons that are not far apart.

use std::f64::consts::PI;

use glam::DVec3;

use super::lambert::angles;
use crate::geometry::{Facet, gauss_rule};

/// How well the panels follow the outer integrand.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanelRule {
    /// The natural logarithm of the relative error allowed in a panel, negated.
    pub digits: f64,
    /// A panel that would need more points is split.
    pub max_points: usize,
    /// How often a panel may be halved towards a singularity on the contour itself.
    pub max_halvings: u32,
}

impl PanelRule {
    /// Near the rounding limit. What is left of a singularity `t ln t` after 14 halvings is about `2^-28 / max_points^4` of an edge squared.
    pub const EXACT: Self = Self { digits: 31.0, max_points: 16, max_halvings: 14 };
}

/// The contour integral and the sum of the magnitudes that cancelled in it, both in m^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourIntegral {
    pub value: f64,
    pub magnitude: f64,
}

/// An edge of the inner contour.
#[derive(Clone, Copy)]
struct Edge {
    start: DVec3,
    direction: DVec3,
    length: f64,
}

/// A singularity of the outer integrand at abscissa `along +- i off` of the outer edge.
#[derive(Clone, Copy)]
struct Singularity {
    along: f64,
    off: f64,
}

/// `A F` of two polygons of which each is entirely in front of the other; the quadrature runs along `outer`.
pub(super) fn contour_exchange(outer: &Facet<'_>, inner: &Facet<'_>, rule: PanelRule) -> ContourIntegral {
    // Constant multiples of r change nothing, as the contours are closed; a typical distance as unit keeps logarithms small.
    let unit_sq = outer.centroid.distance_squared(inner.centroid).max(outer.radius * outer.radius).max(f64::MIN_POSITIVE);
    let per_unit_sq = 1.0 / unit_sq;
    let inner_edges: Vec<Edge> = edges(inner.vertices).collect();

    let (mut value, mut magnitude) = (0.0, 0.0);
    let mut singularities = Vec::with_capacity(3 * inner_edges.len());
    for edge in edges(outer.vertices) {
        find_singularities(&edge, &inner_edges, &mut singularities);
        integrate_panels(edge.length, &singularities, rule, &mut |t, weight| {
            let (sum, size) = potential(edge.start + t * edge.direction, edge.direction, &inner_edges, per_unit_sq);
            value += weight * sum;
            magnitude += weight * size;
        });
    }
    ContourIntegral { value: value / (2.0 * PI), magnitude: magnitude / (2.0 * PI) }
}

/// The edges of a contour that have a length.
fn edges(vertices: &[DVec3]) -> impl Iterator<Item = Edge> + '_ {
    vertices.iter().enumerate().filter_map(|(k, &start)| {
        let end = vertices[if k + 1 == vertices.len() { 0 } else { k + 1 }];
        let length = start.distance(end);
        (length > 0.0).then(|| Edge { start, direction: (end - start) / length, length })
    })
}

/// `direction . oint ln|x - y| dy` along the inner contour, and the sum of the magnitudes of its terms.
///
/// The term `-u` of the antiderivative is left out: it gives each inner edge the same value everywhere, which a closed outer contour
/// cancels.
fn potential(x: DVec3, direction: DVec3, inner: &[Edge], per_unit_sq: f64) -> (f64, f64) {
    let (mut sum, mut size) = (0.0, 0.0);
    let Some(first) = inner.first() else { return (0.0, 0.0) };
    let first_sq = first.start.distance_squared(x);
    let first_log = half_log(first_sq * per_unit_sq);
    let mut start_log = first_log;
    for (k, edge) in inner.iter().enumerate() {
        let end_log = match inner.get(k + 1) {
            Some(next) => half_log(next.start.distance_squared(x) * per_unit_sq),
            None => first_log,
        };
        let cosine = direction.dot(edge.direction);
        if cosine.abs() > 1e-16 {
            let from_x = edge.start - x;
            let u_start = from_x.dot(edge.direction);
            let u_end = u_start + edge.length;
            let height = from_x.cross(edge.direction).length();
            let [seen] = angles([height * edge.length], [height * height + u_start * u_end]);
            let (end, start, arc) = (u_end * end_log, u_start * start_log, height * seen);
            sum += cosine * (end - start + arc);
            size += (cosine * end).abs() + (cosine * start).abs() + (cosine * arc).abs();
        }
        start_log = end_log;
    }
    (sum, size)
}

/// `ln(r)` from `r^2`; where x is a vertex its factor u is 0.
fn half_log(distance_sq: f64) -> f64 {
    if distance_sq > 0.0 { 0.5 * distance_sq.ln() } else { 0.0 }
}

/// Where the outer integrand is not analytic: above and below the feet of the inner vertices, where r = 0 at an end of an inner edge,
/// and where an inner edge passes closest, where h = 0 pinches it.
fn find_singularities(outer: &Edge, inner: &[Edge], found: &mut Vec<Singularity>) {
    found.clear();
    for edge in inner {
        let from_start = edge.start - outer.start;
        let along = from_start.dot(outer.direction);
        found.push(Singularity { along, off: (from_start - along * outer.direction).length() });

        // The closest points of the two lines; h^2 = sine^2 (t - along)^2 + gap^2 along the outer edge.
        let cross = outer.direction.cross(edge.direction);
        let sine_sq = cross.length_squared();
        let cosine = outer.direction.dot(edge.direction);
        if sine_sq < 1e-12 || cosine.abs() < 1e-16 {
            continue;
        }
        let along = from_start.cross(edge.direction).dot(cross) / sine_sq;
        let along_inner = from_start.cross(outer.direction).dot(cross) / sine_sq;
        let off = from_start.dot(cross).abs() / sine_sq;
        if along_inner > -off && along_inner < edge.length + off {
            found.push(Singularity { along, off });
        }
    }
}

/// Calls `visit(t, weight)` for Gauss points on panels of `[0, length]` that are short beside their distance to the singularities.
///
/// A rule of n points converges as `rho^(-2n)`, rho the sum of the half axes of the largest ellipse around the panel, with foci at
/// its ends and half length 1, that has no singularity inside (Trefethen 2013, theorem 19.3).
fn integrate_panels(length: f64, singularities: &[Singularity], rule: PanelRule, visit: &mut impl FnMut(f64, f64)) {
    // Start with panels that end where a singularity is on the edge or close to it.
    const CLOSE: f64 = 0.05;
    let mut breaks: Vec<f64> = singularities
        .iter()
        .filter(|singularity| singularity.off < CLOSE * length && singularity.along > 0.0 && singularity.along < length)
        .map(|singularity| singularity.along)
        .chain([0.0, length])
        .collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|b, a| *b - *a < 1e-9 * length);
    let mut panels: Vec<(f64, f64, u32)> = breaks.windows(2).map(|ends| (ends[0], ends[1], 0)).collect();

    while let Some((from, to, halvings)) = panels.pop() {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let axis = singularities
            .iter()
            .map(|singularity| {
                let (x, y_sq) = ((singularity.along - middle) / half, (singularity.off / half).powi(2));
                0.5 * (((x + 1.0) * (x + 1.0) + y_sq).sqrt() + ((x - 1.0) * (x - 1.0) + y_sq).sqrt())
            })
            .fold(f64::INFINITY, f64::min);
        let rho = axis + (axis * axis - 1.0).max(0.0).sqrt();
        let needed = (rule.digits / (2.0 * rho.ln())).ceil() + 1.0;
        if needed > rule.max_points as f64 && halvings < rule.max_halvings {
            panels.push((middle, to, halvings + 1));
            panels.push((from, middle, halvings + 1));
            continue;
        }
        let points = if needed < rule.max_points as f64 { needed as usize } else { rule.max_points };
        for &(s, weight) in gauss_rule(points) {
            visit(from + s * (to - from), weight * (to - from));
        }
    }
}
