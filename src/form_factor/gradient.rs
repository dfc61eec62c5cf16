//! Lambert's polygon sum with its gradient, and how far rounding may have taken both.
//!
//! With `a, b` the ends of an edge as seen from x, `w = a x b`, `l = |w|`, `q = a.b`, `phi = atan2(l, q) / l` and `e = b - a`
//!
//! ```text
//! F = -(1/2pi) sum phi n.w,    grad F = -(1/2pi) sum [ n.w grad phi + phi n x e ],
//! grad phi = psi (w x e) + (a + b) / (l^2 + q^2),    psi = (q / (l^2 + q^2) - phi) / l^2
//! ```
//!
//! for a polygon above the horizon, normal fixed: `d(a x b) = e x dx`, because a and b both move by -dx.

use std::f64::consts::PI;

use glam::DVec3;

use super::lambert::angles;

/// The form factor from a point, its gradient as the point moves, and the largest rounding error of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointFactor {
    pub value: f64,
    pub value_noise: f64,
    /// In 1/m.
    pub gradient: DVec3,
    pub gradient_noise: f64,
}

/// Roundings that a term may have gone through, with room to spare.
const ROUNDINGS: f64 = 16.0;

/// Below this `l / q` the difference in `psi` cancels and its series is taken: the first term left out is less than a rounding.
const SMALL_ANGLE: f64 = 0.03;

/// Looks from `x` with normal `normal` at a polygon that is nowhere below the horizon and seen from its front.
pub(super) fn point_factor(x: DVec3, normal: DVec3, vertices: &[DVec3]) -> PointFactor {
    let (mut value, mut value_size) = (0.0, 0.0);
    let (mut gradient, mut gradient_size) = (DVec3::ZERO, 0.0);
    let Some(&last) = vertices.last() else {
        return PointFactor { value: 0.0, value_noise: 0.0, gradient, gradient_noise: 0.0 };
    };
    let mut a = last - x;
    for &vertex in vertices {
        let b = vertex - x;
        let (w, q, e) = (a.cross(b), a.dot(b), b - a);
        let (l, lengths) = (w.length(), a.length() * b.length());
        let r_sq = l * l + q * q;
        if l > 0.0 {
            // phi and psi; towards a straight line through x both have limits, unless x lies between the ends.
            let phi = l.atan2(q) / l;
            let t = l / q;
            let psi = if q > 0.0 && t < SMALL_ANGLE {
                let z = t * t;
                (-2.0 / 3.0 + z * (4.0 / 5.0 + z * (-6.0 / 7.0 + z * (8.0 / 9.0)))) / (q * q * q)
            } else {
                (q / r_sq - phi) / (l * l)
            };
            let grad_phi = psi * w.cross(e) + (a + b) / r_sq;
            value += phi * normal.dot(w);
            gradient += normal.dot(w) * grad_phi + phi * normal.cross(e);

            // Next to an edge rounding turns its plane as seen from x, the more the nearer.
            let condition = if q > 0.0 { 1.0 } else { lengths / l };
            value_size += condition * (1.0 + phi * lengths);
            gradient_size +=
                condition * condition * (lengths * (psi.abs() * l * e.length() + (a + b).length() / r_sq) + phi * e.length());
        } else if q > 0.0 {
            gradient += normal.cross(e) / q;
            gradient_size += e.length() / q;
        }
        a = b;
    }
    let noise = ROUNDINGS * f64::EPSILON * (0.5 / PI);
    PointFactor {
        value: -value * (0.5 / PI),
        value_noise: noise * value_size,
        gradient: -gradient * (0.5 / PI),
        gradient_noise: noise * gradient_size,
    }
}

/// The form factor alone, and its largest rounding error, as [`point_factor`] finds them.
pub(super) fn point_value(x: DVec3, normal: DVec3, vertices: &[DVec3]) -> [f64; 2] {
    let (mut value, mut size) = (0.0, 0.0);
    let Some(&last) = vertices.last() else { return [0.0, 0.0] };
    let mut a = last - x;
    let mut length_a = a.length();
    for &vertex in vertices {
        let b = vertex - x;
        let length_b = b.length();
        let (w, q, lengths) = (a.cross(b), a.dot(b), length_a * length_b);
        let l = w.length();
        if l > 0.0 {
            let [angle] = angles([l], [q]);
            value += angle * normal.dot(w) / l;
            let condition = if q > 0.0 { 1.0 } else { lengths / l };
            size += condition * (1.0 + angle * lengths / l);
        }
        (a, length_a) = (b, length_b);
    }
    let noise = ROUNDINGS * f64::EPSILON * (0.5 / PI);
    [-value * (0.5 / PI), noise * size]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;
    use crate::geometry::Polygon;

    #[test]
    fn value_and_gradient_are_those_of_the_form_factor() {
        let polygon = Polygon::new(&[[0.2, -0.4, 0.9], [-0.3, 0.8, 1.3], [1.1, 0.5, 0.7]]).unwrap();
        let facet = polygon.facet();
        let normal = DVec3::new(0.1, 0.0, 1.0).normalize();
        for x in [DVec3::new(0.1, 0.2, 0.0), DVec3::new(3.0, -2.0, -1.0), DVec3::new(0.3, 0.3, 0.6), DVec3::new(300.0, 0.0, -900.0)]
        {
            let found = point_factor(x, normal, facet.vertices);
            let exact = |x| point_to_polygon(x, normal, &facet);
            let [value, noise] = point_value(x, normal, facet.vertices);
            assert!((value - found.value).abs() <= noise + found.value_noise && noise <= 2.0 * found.value_noise);
            assert!((found.value - exact(x)).abs() <= 1e-14 + 1e-12 * exact(x), "{x}: {} instead of {}", found.value, exact(x));
            let h = 1e-5 * facet.distance_to(x);
            let difference = |axis: DVec3| {
                (point_factor(x + h * axis, normal, facet.vertices).value
                    - point_factor(x - h * axis, normal, facet.vertices).value)
                    / (2.0 * h)
            };
            let expected = DVec3::new(difference(DVec3::X), difference(DVec3::Y), difference(DVec3::Z));
            let tolerance = 1e-7 * expected.length() + 1e-15 / h + found.gradient_noise;
            assert!(found.gradient.distance(expected) <= tolerance, "{x}: {} instead of {expected}", found.gradient);
        }
    }

    #[test]
    fn the_series_for_small_angles_meets_the_closed_form() {
        // A narrow edge on either side of the change.
        for width in [0.0299, 0.0301] {
            let vertices =
                [DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0), DVec3::new(width, 1.0, 1.0), DVec3::new(width, 0.0, 1.0)];
            let x = DVec3::new(0.4, 0.3, 0.0);
            let found = point_factor(x, DVec3::Z, &vertices);
            let difference = |axis: DVec3| {
                (point_factor(x + 1e-5 * axis, DVec3::Z, &vertices).value
                    - point_factor(x - 1e-5 * axis, DVec3::Z, &vertices).value)
                    / 2e-5
            };
            assert!(
                (found.gradient.x - difference(DVec3::X)).abs() < 1e-10 && (found.gradient.y - difference(DVec3::Y)).abs() < 1e-10
            );
        }
    }
}
