//! How much of what leaves a point arrives at a polygon: the kernel and Lambert's polygon formula.
//!
//! For receiver point x with unit normal n and source polygon with vertices v_i, counter-clockwise seen from its front,
//!
//! ```text
//! F(x) = -(1/2pi) sum_i gamma_i n.(a_i x a_{i+1}) / |a_i x a_{i+1}|,   a_i = v_i - x,   gamma_i = angle(a_i, a_{i+1})
//! ```
//!
//! (Lambert 1760; Baum, Rushmeier, Winget 1989), where the polygon has been clipped to the half-space n.a >= 0 above the
//! horizon of x. The sum is signed: seen from its back a polygon would count negative, so it is cut off at 0, not mirrored.
//! Cost: one square root, two divisions and one polynomial per edge.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use crate::geometry::{Facet, plane_noise};

/// The kernel `h_s(x) h_r(y) / (pi |x - y|^4)` between receiver point `x` and source point `y`; 0 unless each is in front of the other.
#[inline]
pub(crate) fn kernel(x: DVec3, normal_x: DVec3, y: DVec3, normal_y: DVec3) -> f64 {
    let d = y - x;
    let (height_y, height_x) = (normal_x.dot(d), -normal_y.dot(d));
    if height_y <= 0.0 || height_x <= 0.0 {
        return 0.0;
    }
    let distance_sq = d.length_squared();
    height_x * height_y / (PI * distance_sq * distance_sq)
}

/// The form factor from a point to a polygon, in [0, 1]: Lambert's sum after clipping to the horizon.
///
/// 0 on the plane of the source (within rounding of the coordinates) and behind it. The error is a few ulp of the largest edge
/// term, so relative to the value it grows as distance over size for sources that are small and far.
pub(crate) fn point_to_polygon(x: DVec3, normal: DVec3, source: &Facet<'_>) -> f64 {
    let height = source.height(x);
    if height <= 0.0 || height <= plane_noise(x, source.vertices[0]) {
        return 0.0;
    }
    let sum = match *source.vertices {
        [a, b, c] => sum_of_few(&[a - x, b - x, c - x], normal),
        [a, b, c, d] => sum_of_few(&[a - x, b - x, c - x, d - x], normal),
        ref many => sum_above_horizon(many.iter().map(|&v| v - x), normal),
    };
    (sum * (-0.5 / PI)).clamp(0.0, 1.0)
}

/// The same for a polygon of which the directions to its corners are known: of any length, counter-clockwise seen from its front.
pub(crate) fn from_directions(corners: &[DVec3], normal: DVec3) -> f64 {
    let sum = match *corners {
        [a, b, c] => sum_of_few(&[a, b, c], normal),
        [a, b, c, d] => sum_of_few(&[a, b, c, d], normal),
        ref many => sum_above_horizon(many.iter().copied(), normal),
    };
    (sum * (-0.5 / PI)).clamp(0.0, 1.0)
}

/// The sum over the edges of a triangle or quadrilateral: straight through where all of it is above the horizon.
#[inline(always)]
fn sum_of_few<const N: usize>(vertices: &[DVec3; N], normal: DVec3) -> f64 {
    let lowest = vertices.iter().fold(f64::INFINITY, |lowest, a| lowest.min(normal.dot(*a)));
    if lowest < 0.0 {
        return sum_above_horizon(vertices.iter().copied(), normal);
    }

    // One array per quantity, so that the edges go through the arithmetic side by side.
    let (mut sine_sq, mut cosine, mut projected) = ([0.0; N], [0.0; N], [0.0; N]);
    for k in 0..N {
        let (a, b) = (vertices[k], vertices[if k + 1 == N { 0 } else { k + 1 }]);
        let cross = a.cross(b);
        sine_sq[k] = cross.length_squared();
        cosine[k] = a.dot(b);
        projected[k] = normal.dot(cross);
    }
    edge_terms(sine_sq, cosine, projected)
}

/// The sum over the edges of what is above the horizon, in one pass around the polygon and without storing the clipped one.
///
/// Where the polygon goes below the horizon and comes up again, the edge that closes it runs along the horizon.
fn sum_above_horizon(vertices: impl Iterator<Item = DVec3> + Clone, normal: DVec3) -> f64 {
    let Some(mut a) = vertices.clone().last() else { return 0.0 };
    let mut height_a = normal.dot(a);
    let (mut first_entry, mut exit) = (None, None);
    let mut sum = 0.0;

    for b in vertices {
        let height_b = normal.dot(b);
        match (height_a >= 0.0, height_b >= 0.0) {
            (true, true) => sum += edge(a, b, normal),
            (true, false) => {
                let crossing = a + (b - a) * (height_a / (height_a - height_b));
                sum += edge(a, crossing, normal);
                exit = Some(crossing);
            }
            (false, true) => {
                let crossing = b + (a - b) * (height_b / (height_b - height_a));
                sum += edge(crossing, b, normal);
                match exit.take() {
                    Some(exit) => sum += edge(exit, crossing, normal),
                    None => first_entry = Some(crossing),
                }
            }
            (false, false) => {}
        }
        (a, height_a) = (b, height_b);
    }

    // The pass may have started below the horizon.
    if let (Some(exit), Some(entry)) = (exit, first_entry) {
        sum += edge(exit, entry, normal);
    }
    sum
}

/// The term of the edge from `a` to `b`, both as seen from x.
#[inline(always)]
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let cross = a.cross(b);
    edge_terms([cross.length_squared()], [a.dot(b)], [normal.dot(cross)])
}

/// The sum of `gamma n.w / |w|` over edges with `|w|^2`, `a.b` and `n.w` given; an edge that points straight at x adds 0.
#[inline(always)]
fn edge_terms<const N: usize>(sine_sq: [f64; N], cosine: [f64; N], projected: [f64; N]) -> f64 {
    let sine = sine_sq.map(f64::sqrt);
    let angle = angles(sine, cosine);
    let mut sum = 0.0;
    for k in 0..N {
        sum += if sine[k] > 0.0 { angle[k] * projected[k] / sine[k] } else { 0.0 };
    }
    sum
}

/// `atan2(sine, cosine)` for `sine >= 0`, within 2 ulp.
///
/// The ratio of the smaller to the larger leg is brought below tan(pi/8) by atan(t) = pi/4 + atan((t-1)/(t+1)); the polynomial
/// interpolates (atan(t)/t - 1)/t^2 in t^2 at Chebyshev points of that range, with error 5e-18. Selections instead of branches
/// and whole arrays let the edges of a polygon go through side by side.
#[inline(always)]
pub(super) fn angles<const N: usize>(sine: [f64; N], cosine: [f64; N]) -> [f64; N] {
    const TAN_PI_8: f64 = 0.414_213_562_373_095_03;

    // The angle is in the octant below or above pi/4, of the quadrant below or above pi/2.
    let (mut numerator, mut denominator, mut offset) = ([0.0; N], [0.0; N], [0.0; N]);
    for k in 0..N {
        let adjacent = cosine[k].abs();
        let short = if sine[k] < adjacent { sine[k] } else { adjacent };
        let long = if sine[k] < adjacent { adjacent } else { sine[k] };
        let reduced = short > TAN_PI_8 * long;
        numerator[k] = short - if reduced { long } else { 0.0 };
        denominator[k] = long + if reduced { short } else { 0.0 };
        offset[k] = if reduced { FRAC_PI_4 } else { 0.0 };
    }

    // atan of the reduced ratio, the polynomial in parts that do not wait for each other.
    let mut octant = [0.0; N];
    for k in 0..N {
        let t = numerator[k] / denominator[k];
        let z = t * t;
        let z2 = z * z;
        let z4 = z2 * z2;
        let low = (-0.333_333_333_333_333_3 + z * 0.199_999_999_999_955_2)
            + z2 * (-0.142_857_142_846_665_42 + z * 0.111_111_110_152_562_92);
        let middle = (-0.090_909_045_781_210_85 + z * 0.076_921_831_907_606_51)
            + z2 * (-0.066_645_114_464_602_2 + z * 0.058_581_489_047_951_24);
        let high = (-0.050_854_496_960_392_584 + z * 0.039_231_657_085_083_686) + z2 * -0.019_176_885_636_589_05;
        octant[k] = offset[k] + (t + t * z * (low + z4 * (middle + z4 * high)));
    }

    // Back through the reductions: mirrored at pi/4, then at pi/2.
    let mut angle = [0.0; N];
    for k in 0..N {
        let quadrant = if sine[k] < cosine[k].abs() { octant[k] } else { FRAC_PI_2 - octant[k] };
        angle[k] = if cosine[k] < 0.0 { PI - quadrant } else { quadrant };
    }
    angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    #[test]
    fn angles_agree_with_atan2() {
        let check = |sine: f64, cosine: f64| {
            let [angle] = angles([sine], [cosine]);
            let want = sine.atan2(cosine);
            assert!((angle - want).abs() <= 4.0 * f64::EPSILON * want, "atan2({sine:e}, {cosine:e}) = {want}, not {angle}");
        };
        for k in 0..=100_000 {
            let (sine, cosine) = (f64::from(k) * (PI / 100_000.0)).sin_cos();
            check(sine.abs(), cosine);
            check(3e7 * sine.abs(), 3e7 * cosine);
        }
        for tiny in [1e-300, 1e-20, 1e-9] {
            check(tiny, 1.0);
            check(tiny, -1.0);
            check(1.0, tiny);
            check(1.0, -tiny);
            check(0.0, tiny);
        }
    }

    #[test]
    fn a_source_seen_from_its_back_counts_nothing() {
        let square = Polygon::new(&[[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]).unwrap();
        let x = DVec3::new(0.5, 0.5, 0.0);
        assert!(point_to_polygon(x, DVec3::Z, &square.facet()) > 0.2);
        assert_eq!(point_to_polygon(x, DVec3::Z, &square.reversed().facet()), 0.0);
        assert_eq!(point_to_polygon(x, -DVec3::Z, &square.facet()), 0.0);
    }

    #[test]
    fn the_kernel_is_the_limit_for_small_sources() {
        let (x, y, normal) = (DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.4, -0.3, 1.1), DVec3::new(0.2, 0.3, -1.0).normalize());
        let frame = crate::geometry::Frame::around(normal);
        let corner = |s: f64, t: f64| (y + 1e-4 * (s * frame.tangent + t * frame.bitangent)).to_array();
        let small = Polygon::new(&[corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)]).unwrap();
        let expected = small.area() * kernel(x, DVec3::Z, y, normal);
        assert!((point_to_polygon(x, DVec3::Z, &small.facet()) / expected - 1.0).abs() < 1e-7);
        assert_eq!(kernel(x, DVec3::Z, x, normal), 0.0);
        assert_eq!(kernel(x, -DVec3::Z, y, normal), 0.0);
    }
}
