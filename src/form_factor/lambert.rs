//! From a point: the kernel and Lambert's polygon formula.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::Facet;

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

/// The form factor from a point to a polygon (Lambert 1760; Baum, Rushmeier, Winget 1989, eq. for the polygon).
pub(crate) fn point_to_polygon(x: DVec3, normal: DVec3, source: &Facet<'_>) -> f64 {
    if source.height(x) <= 0.0 {
        return 0.0;
    }
    // Clip to the horizon of x, walking around the polygon once; each clipped edge adds its term.
    let mut clipped: [DVec3; 16] = [DVec3::ZERO; 16];
    let mut count = 0;
    let vertices = source.vertices;
    for k in 0..vertices.len() {
        let (a, b) = (vertices[k] - x, vertices[(k + 1) % vertices.len()] - x);
        let (ha, hb) = (normal.dot(a), normal.dot(b));
        if ha >= 0.0 {
            clipped[count] = a;
            count += 1;
        }
        if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
            clipped[count] = a + (b - a) * (ha / (ha - hb));
            count += 1;
        }
    }
    if count < 3 {
        return 0.0;
    }
    let mut sum = 0.0;
    for k in 0..count {
        let (a, b) = (clipped[k], clipped[(k + 1) % count]);
        let cross = a.cross(b);
        let sine = cross.length();
        if sine > 0.0 {
            sum += sine.atan2(a.dot(b)) * normal.dot(cross) / sine;
        }
    }
    // Seen from the front a polygon runs clockwise around the direction to it.
    (sum.abs() / (2.0 * PI)).min(1.0)
}
