//! Who sees whom within a plane, from one point.
//!
//! A fan is all rays from an apex through the segment from `a` to `a + span`. A point of it is `apex + t (a + u span)`: `u` in [0, 1] names the ray,
//! and `w = 1 / t` tells how near the point is, 1 on the segment itself and more before it. From (x, y) to (u, w) is a projective map, so straight
//! segments stay straight, and what is seen first from the apex is the upper envelope of segments over [0, 1].
//!
//! Parallel rays are a fan as well: a point is `apex + t a + u span`, where `apex` is anywhere before the segment, and `w = 2 - t`.

use glam::DVec3;

use crate::scene::SurfaceId;

/// All rays from an apex through a segment, within one plane; or parallel ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan {
    pub apex: DVec3,
    a: DVec3,
    span: DVec3,
    /// `t` of a point is the dot product with this; `t u` that with the other, or `u` where rays are parallel.
    to_t: DVec3,
    to_tu: DVec3,
    is_parallel: bool,
}

/// A face's section through the plane of a fan, as the apex sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub surface: SurfaceId,
    pub plane: u32,
    /// From which ray to which, ascending.
    pub u: [f64; 2],
    /// How near at both.
    pub w: [f64; 2],
    /// Where it is at both.
    pub ends: [DVec3; 2],
    /// Whether the fan's rays are parallel.
    pub is_parallel: bool,
}

/// Parts of a fan's rays, ascending and apart.
pub(super) type Windows = Vec<[f64; 2]>;

/// Rays so close to each other are one: rounding of `u`.
pub(super) const SAME_RAY: f64 = 1e-12;

/// A part of the way to the segment that is at the apex itself.
const AT_APEX: f64 = 1e-9;

impl Fan {
    /// The fan from `apex` through `apex + a` and `apex + b`, in the plane with the unit normal `normal`; `None` where `a` and `b` are parallel.
    pub fn new(apex: DVec3, [a, b]: [DVec3; 2], normal: DVec3) -> Option<Self> {
        let span = b - a;
        let (across_span, across_a) = (normal.cross(span), normal.cross(a));
        let (t, tu) = (a.dot(across_span), span.dot(across_a));
        let fan = Self { apex, a, span, to_t: across_span / t, to_tu: across_a / tu, is_parallel: false };
        fan.checked()
    }

    /// Parallel rays along `way`, through the segment between two points, in the plane with the unit normal `normal`; `way` is longer than all that is
    /// looked at is wide, so that nothing is at `t` 0. `None` where the segment is parallel to it.
    pub fn parallel(way: DVec3, [from, to]: [DVec3; 2], normal: DVec3) -> Option<Self> {
        let span = to - from;
        let (across_span, across_way) = (normal.cross(span), normal.cross(way));
        let (t, u) = (way.dot(across_span), span.dot(across_way));
        let fan = Self { apex: from - way, a: way, span, to_t: across_span / t, to_tu: across_way / u, is_parallel: true };
        fan.checked()
    }

    fn checked(self) -> Option<Self> {
        (self.to_t.is_finite() && self.to_tu.is_finite()).then_some(self)
    }

    /// The rays from the segment through the apex and on behind it.
    pub fn opposite(&self) -> Self {
        Self { a: -self.a, span: -self.span, to_t: -self.to_t, to_tu: -self.to_tu, ..*self }
    }

    /// The direction of a ray, as long as the way to the segment.
    pub fn direction(&self, u: f64) -> DVec3 {
        if self.is_parallel { self.a } else { self.a + u * self.span }
    }

    /// Whether a box, by its centre and half its extent, may hold points of the fan between `nearest` and `farthest` times the segment.
    #[inline]
    pub fn may_reach(&self, centre: DVec3, half: DVec3, [nearest, farthest]: [f64; 2]) -> bool {
        let from = centre - self.apex;
        let largest = |along: DVec3| along.dot(from) + along.abs().dot(half);
        largest(self.to_t) >= nearest
            && -largest(-self.to_t) <= farthest
            && largest(self.to_tu) >= 0.0
            && if self.is_parallel { -largest(-self.to_tu) <= 1.0 } else { largest(self.to_t - self.to_tu) >= 0.0 }
    }

    /// The part of a segment of the plane that lies in the fan.
    pub fn project(&self, mut from: DVec3, mut to: DVec3, surface: SurfaceId, plane: u32) -> Option<Cut> {
        let coordinates = |point: DVec3| {
            let arm = point - self.apex;
            [if self.is_parallel { 1.0 } else { self.to_t.dot(arm) }, self.to_tu.dot(arm)]
        };
        let [mut p, mut q] = [coordinates(from), coordinates(to)];

        // Clip to t > 0 and 0 <= u <= 1.
        let inside: [fn([f64; 2]) -> f64; 3] = [|[t, _]| t - AT_APEX, |[_, tu]| tu, |[t, tu]| t - tu];
        for height in inside {
            let (at_p, at_q) = (height(p), height(q));
            if at_p < 0.0 && at_q < 0.0 {
                return None;
            }
            let s = at_p / (at_p - at_q);
            let crossing = ([p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])], from.lerp(to, s));
            if at_p < 0.0 {
                (p, from) = crossing;
            } else if at_q < 0.0 {
                (q, to) = crossing;
            }
        }

        let u = [p[1] / p[0], q[1] / q[0]].map(|u: f64| u.clamp(0.0, 1.0));
        let nearness = |t: f64, end: DVec3| if self.is_parallel { 2.0 - self.to_t.dot(end - self.apex) } else { 1.0 / t };
        let w = [nearness(p[0], from), nearness(q[0], to)];
        let mut cut = Cut { surface, plane, u, w, ends: [from, to], is_parallel: self.is_parallel };
        if u[0] > u[1] {
            cut.u.reverse();
            cut.w.reverse();
            cut.ends.reverse();
        }
        (cut.u[1] - cut.u[0] > SAME_RAY).then_some(cut)
    }
}

impl Cut {
    /// `w` on ray `u`.
    pub fn nearness(&self, u: f64) -> f64 {
        let part = ((u - self.u[0]) / (self.u[1] - self.u[0])).clamp(0.0, 1.0);
        self.w[0] + part * (self.w[1] - self.w[0])
    }

    /// Where it is on ray `u`: between its ends, also where it is seen nearly end-on.
    pub fn point(&self, u: f64) -> DVec3 {
        let w = if self.is_parallel { [1.0; 2] } else { self.w };
        let (after, before) = ((u - self.u[0]).max(0.0) * w[1], (self.u[1] - u).max(0.0) * w[0]);
        self.ends[0].lerp(self.ends[1], (after / (after + before)).clamp(0.0, 1.0))
    }

    /// The rays of `range` on which `above`, linear in u, is positive.
    pub fn where_positive(range: [f64; 2], above: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        let [low, high] = range;
        if high - low <= SAME_RAY {
            return None;
        }
        let (at_low, at_high) = (above(low), above(high));
        let crossing = low + (high - low) * (at_low / (at_low - at_high));
        match (at_low > 0.0, at_high > 0.0) {
            (true, true) => Some(range),
            (true, false) => Some([low, crossing]),
            (false, true) => Some([crossing, high]),
            (false, false) => None,
        }
    }

    /// The rays on which it is nearer than `w`.
    pub fn nearer_than(&self, w: f64) -> Option<[f64; 2]> {
        Self::where_positive(self.u, |u| self.nearness(u) - w)
    }

    /// The rays on which it is farther than the one nearness and nearer than the other.
    pub fn between(&self, [farther_than, nearer_than]: [f64; 2]) -> Option<[f64; 2]> {
        let beyond = Self::where_positive(self.u, |u| farther_than - self.nearness(u))?;
        Self::where_positive(beyond, |u| self.nearness(u) - nearer_than)
    }
}

/// Takes the rays of `gone` out of `windows`.
pub(super) fn take_out(windows: &mut Windows, [from, to]: [f64; 2]) {
    if windows.iter().all(|window| window[1] <= from || window[0] >= to) {
        return;
    }
    let left = windows.iter().flat_map(|&[low, high]| [[low, high.min(from)], [low.max(to), high]]);
    *windows = left.filter(|window| window[1] - window[0] > SAME_RAY).collect();
}

/// The rays of both.
pub(super) fn common(some: &[[f64; 2]], others: &[[f64; 2]]) -> Windows {
    let shared = some.iter().flat_map(|a| others.iter().map(|b| [a[0].max(b[0]), a[1].min(b[1])]));
    shared.filter(|[low, high]| high - low > SAME_RAY).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_shared_and_taken_out() {
        let mut windows = vec![[0.0, 0.4], [0.6, 1.0]];
        assert_eq!(common(&windows, &[[0.2, 0.7]]), [[0.2, 0.4], [0.6, 0.7]]);
        take_out(&mut windows, [0.3, 0.8]);
        assert_eq!(windows, [[0.0, 0.3], [0.8, 1.0]]);
        take_out(&mut windows, [0.0, 1.0]);
        assert!(windows.is_empty());
    }
}
