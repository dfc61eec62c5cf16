//! Gauss-Legendre points on the unit interval and on planar convex polygons.

use std::sync::LazyLock;

use glam::DVec3;

/// The largest number of points a rule may have.
const MAX_GAUSS_POINTS: usize = 32;

static RULES: LazyLock<Vec<Vec<(f64, f64)>>> = LazyLock::new(|| (1..=MAX_GAUSS_POINTS).map(compute_rule).collect());

/// Abscissas in (0, 1) and weights that sum to 1 of the rule with `points` points, exact for polynomials up to degree `2 points - 1`.
///
/// `points` below 1 is taken as 1 and above 32 as 32.
pub(crate) fn gauss_rule(points: usize) -> &'static [(f64, f64)] {
    &RULES[points.clamp(1, MAX_GAUSS_POINTS) - 1]
}

/// The roots of the Legendre polynomial by Newton's method from Tricomi's estimate.
fn compute_rule(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    let mut rule = vec![(0.0, 0.0); points];
    for k in 0..points.div_ceil(2) {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            // P_n and its derivative by the three-term recurrence.
            let (mut previous, mut value) = (1.0, x);
            for degree in 2..=points {
                let d = degree as f64;
                (previous, value) = (value, ((2.0 * d - 1.0) * x * value - (d - 1.0) * previous) / d);
            }
            slope = n * (x * value - previous) / (x * x - 1.0);
            x -= value / slope;
        }
        if 2 * k + 1 == points {
            x = 0.0;
        }
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        rule[k] = (0.5 * (1.0 - x), weight);
        rule[points - 1 - k] = (0.5 * (1.0 + x), weight);
    }
    rule
}

/// Calls `visit(point, weight)` for the points of a tensor rule on the convex polygon `vertices` with unit normal `normal`;
/// the weights are in m^2 and sum to the area.
///
/// The polygon is a fan of quadrilaterals around vertex 0, the last one a triangle where the count is odd. Each is the image
/// of the unit square under the bilinear map, whose Jacobian is linear, so that polynomials up to degree `2 points - 2` are exact.
pub(crate) fn for_each_gauss_point(vertices: &[DVec3], normal: DVec3, points: usize, mut visit: impl FnMut(DVec3, f64)) {
    let rule = gauss_rule(points);
    let origin = vertices[0];
    let mut k = 1;
    while k + 1 < vertices.len() {
        // The corners as seen from vertex 0; a triangle has its first corner twice.
        let b = vertices[k] - origin;
        let c = vertices[k + 1] - origin;
        let d = vertices.get(k + 2).map_or(DVec3::ZERO, |&d| d - origin);
        let twist = c - b - d;
        let (jacobian, jacobian_s, jacobian_t) = (b.cross(d).dot(normal), b.cross(twist).dot(normal), twist.cross(d).dot(normal));
        for &(s, weight_s) in rule {
            for &(t, weight_t) in rule {
                let stretch = jacobian + s * jacobian_s + t * jacobian_t;
                visit(origin + s * b + t * (d + s * twist), weight_s * weight_t * stretch);
            }
        }
        k += 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    #[test]
    fn a_rule_is_exact_up_to_its_degree() {
        for points in 1..=MAX_GAUSS_POINTS {
            for degree in [0, 1, points, 2 * points - 1] {
                let sum: f64 = gauss_rule(points).iter().map(|&(x, w)| w * x.powi(degree as i32)).sum();
                assert!((sum * (degree + 1) as f64 - 1.0).abs() < 1e-13, "{points} points, degree {degree}: {sum}");
            }
        }
    }

    #[test]
    fn points_on_polygons_integrate_area_and_centroid() {
        let corners = |n: usize| -> Vec<[f64; 3]> {
            (0..n)
                .map(|k| {
                    let (sin, cos) = (k as f64 * std::f64::consts::TAU / n as f64).sin_cos();
                    [3.0 + 2.0 * cos, sin, 0.5 * sin + 1.0]
                })
                .collect()
        };
        for n in 3..12 {
            let polygon = Polygon::new(&corners(n)).unwrap();
            let facet = polygon.facet();
            for points in 2..6 {
                let (mut area, mut moment) = (0.0, DVec3::ZERO);
                for_each_gauss_point(facet.vertices, facet.normal, points, |x, weight| {
                    area += weight;
                    moment += weight * x;
                    assert!(weight > 0.0);
                });
                assert!((area / facet.area - 1.0).abs() < 1e-14);
                assert!((moment / area).distance(facet.centroid) < 1e-14);
            }
        }
    }
}
