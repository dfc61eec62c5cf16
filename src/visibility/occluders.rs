//! What the f32 backends share: a frame of their own around the occluders, and the sides of planes in f64.
//!
//! The frame puts the median of the vertices at 0 and scales the scene by a power of two into a cube of some thousands. Both are done in
//! f64 before anything is rounded to f32, so a scene of any size and place is represented to the same part of its size, 2^-24, and to more
//! where most of it is: a wide ground far below takes nothing from a room.

use glam::{DVec3, Vec3};

use super::{Hit, OccluderMesh, Ray, Segment};
use crate::geometry::median_point;

/// Half the side of the cube that holds the occluders in the frame. obvhs ignores what lies within 1e-4 of a ray's origin and
/// divides by no component of a direction below 1.2e-7, in absolute terms: at this size the first is less than the resolution of
/// f32, and directions of length 1 lose less than that to the second.
pub(super) const HALF_SIDE: f64 = 4096.0;

/// Segments are cut to a cube with this half side before they are rounded to f32.
const CUT: f64 = 1.001 * HALF_SIDE;

/// Embree is asked from this distance on, as a part of the origin's largest coordinate: four roundings of it, of which two may be in the
/// origin already. Nearly all nearer hits are on the surface that the origin lies on, and calls of the filter for them would cost time.
const NEAR: f32 = 4.0 / (1 << 24) as f32;

/// Directions whose length differs from 1 by less than half of this are taken as they are.
const NEARLY_UNIT: f64 = 1e-3;

/// How far a ray reaches from where it enters the cube: beyond its diagonal.
const REACH: f64 = 4.0 * CUT;

/// The change from the coordinates of the scene to those of the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayFrame {
    centre: DVec3,
    /// Lengths in the frame per metre, a power of two.
    scale: f64,
    /// [`OccluderMesh::contact_tolerance`], in the frame.
    tolerance: f64,
}

/// A segment as the f32 backends see it, in the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// The ends, as given.
    pub from: DVec3,
    pub to: DVec3,
    /// The traced part is `origin + t direction`, 0 <= t <= 1: all but what lies outside of the cube.
    pub origin: Vec3,
    pub direction: Vec3,
    /// The t of the distance [`NEAR`], for Embree; the trees of obvhs do without.
    #[cfg_attr(not(any(has_embree, feature = "embree4-sys")), expect(dead_code, reason = "only Embree is told"))]
    pub near: f32,
    /// Where the traced part starts and ends, as parts of the way from `from` to `to`.
    pub start: f64,
    pub end: f64,
    /// The planes that are ignored.
    pub planes: [u32; 2],
}

/// A segment that is answered already, or must be traced.
pub(super) enum Question {
    Answered(bool),
    Open(Probe),
}

impl RayFrame {
    pub(super) fn new(mesh: &OccluderMesh) -> Self {
        let vertices = mesh.vertices.iter().map(|&vertex| DVec3::from(vertex));
        let centre = median_point(vertices.clone());
        let half = vertices.map(|vertex| (vertex - centre).abs().max_element()).fold(0.0, f64::max);
        // A mesh that is one point, or none, needs no scale.
        let scale = if half > 0.0 { (HALF_SIDE / half).log2().floor().exp2() } else { 1.0 };
        let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        Self { centre, scale, tolerance: scale * mesh.contact_tolerance() }
    }

    #[cfg_attr(not(any(has_embree, feature = "embree4-sys")), expect(dead_code, reason = "only Embree is told"))]
    pub(super) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    pub(super) fn point(&self, point: [f64; 3]) -> DVec3 {
        (DVec3::from(point) - self.centre) * self.scale
    }

    pub(super) fn segment(&self, segment: &Segment) -> Question {
        let (from, to) = (self.point(segment.from), self.point(segment.to));
        let planes = [segment.from_plane, segment.to_plane];
        let way = to - from;

        // Nothing can lie between ends that both touch whatever lies between them.
        let short = way.abs().max_element() <= self.tolerance;
        if short || segment.from == segment.to {
            return Question::Answered(segment.from == segment.to || !way.is_finite());
        }

        // Nearly all segments lie within the cube; NaN compares false.
        let inside = from.abs().cmple(DVec3::splat(CUT)).all() && to.abs().cmple(DVec3::splat(CUT)).all();
        let (start, end) = if inside {
            (0.0, 1.0)
        } else if !from.is_finite() || !to.is_finite() || !way.is_finite() {
            return Question::Answered(true);
        } else {
            match cut(from, way, 1.0) {
                Some(part) => part,
                None => return Question::Answered(false),
            }
        };
        Question::Open(Probe::new(from, to, start, end, planes))
    }

    /// The ray as a segment that ends beyond the cube, and the length of that segment in lengths of the ray's direction;
    /// `None` where there is nothing to hit.
    pub(super) fn ray(&self, ray: &Ray) -> Option<(Probe, f64)> {
        let (from, direction) = (self.point(ray.origin), DVec3::from(ray.direction));
        let length_sq = direction.length_squared();
        if !from.is_finite() {
            return None;
        }

        // Most directions have length 1; of others the square may overflow.
        let (unit, direction_length) = if (length_sq - 1.0).abs() < NEARLY_UNIT {
            (direction, 1.0)
        } else {
            let largest = direction.abs().max_element();
            if !direction.is_finite() || largest == 0.0 {
                return None;
            }
            let scaled = direction / largest;
            (scaled.normalize(), scaled.length() * largest)
        };

        let (enter, length) = if from.abs().cmple(DVec3::splat(CUT)).all() {
            (0.0, REACH)
        } else {
            let (enter, leave) = cut(from, unit, f64::INFINITY)?;
            (enter, leave + REACH)
        };
        let probe = Probe::new(from, from + length * unit, enter / length, 1.0, [ray.origin_plane; 2]);
        Some((probe, length / self.scale / direction_length))
    }
}

impl Probe {
    fn new(from: DVec3, to: DVec3, start: f64, end: f64, planes: [u32; 2]) -> Self {
        let way = to - from;
        let entry = if start > 0.0 { from + start * way } else { from };
        let exit = if end < 1.0 { from + end * way } else { to };
        let origin = entry.as_vec3();
        // From the rounded origin to the exact end, unless rounding has moved the one onto the other.
        let direction = (exit - origin.as_dvec3()).as_vec3();
        let direction = if direction == Vec3::ZERO { (exit - entry).as_vec3() } else { direction };
        let near = (NEAR * origin.abs().max_element() / direction.abs().max_element()).min(0.25);
        Self { from, to, origin, direction, near, start, end, planes }
    }
}

/// The part of `from + t way`, 0 <= t <= `last`, that lies in the cube.
fn cut(from: DVec3, way: DVec3, last: f64) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, last);
    for axis in 0..3 {
        if way[axis] == 0.0 {
            if from[axis].abs() > CUT {
                return None;
            }
            continue;
        }
        let (a, b) = ((-CUT - from[axis]) / way[axis], (CUT - from[axis]) / way[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then_some((enter, leave))
}

/// The planes of the triangles, by number and by equation, in the frame.
#[derive(Clone, Debug)]
pub(super) struct Sides {
    /// Numbers of planes, per triangle.
    pub planes: Vec<u32>,
    /// Unit normal n and d with dot(n, x) = d, per triangle; all 0 for a triangle without area.
    pub equations: Vec<[f64; 4]>,
    tolerance: f64,
}

impl Sides {
    pub(super) fn new(mesh: &OccluderMesh, frame: &RayFrame) -> Self {
        let equation = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| frame.point(mesh.vertices[vertex as usize]));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            [normal.x, normal.y, normal.z, normal.dot((a + b + c) / 3.0)]
        };
        Self { planes: mesh.planes.clone(), equations: mesh.triangles.iter().map(equation).collect(), tolerance: frame.tolerance }
    }

    /// The same for the triangles in another order: `order[k]` becomes `k`.
    pub(super) fn reordered(&self, order: &[u32]) -> Self {
        Self {
            planes: order.iter().map(|&k| self.planes[k as usize]).collect(),
            equations: order.iter().map(|&k| self.equations[k as usize]).collect(),
            tolerance: self.tolerance,
        }
    }

    /// Whether a triangle that the probe passes through blocks it.
    #[inline]
    pub(super) fn blocks(&self, triangle: usize, probe: &Probe) -> bool {
        let plane = self.planes[triangle];
        if plane == probe.planes[0] || plane == probe.planes[1] {
            return false;
        }
        let (from, to) = self.heights(triangle, probe);
        (from > self.tolerance && to < -self.tolerance) || (from < -self.tolerance && to > self.tolerance)
    }

    /// Where the probe meets the plane of a triangle that blocks it, as a part of the way from its one end to the other.
    pub(super) fn crossing(&self, triangle: usize, probe: &Probe) -> f64 {
        let (from, to) = self.heights(triangle, probe);
        from / (from - to)
    }

    /// The distances of the ends from the plane of a triangle, with signs.
    #[inline]
    fn heights(&self, triangle: usize, probe: &Probe) -> (f64, f64) {
        let [x, y, z, d] = self.equations[triangle];
        let height = |point: DVec3| x * point.x + y * point.y + z * point.z - d;
        (height(probe.from), height(probe.to))
    }

    /// The hit of a ray, made into a probe of `length` lengths of its direction, on a triangle.
    pub(super) fn hit(&self, triangle: usize, surface: u32, probe: &Probe, length: f64) -> Hit {
        Hit { surface, distance: self.crossing(triangle, probe) * length }
    }
}
