//! Who sees whom within a plane, from one point.
//!
//! A fan is all rays from an apex through the segment from `a` to `a + span`. A point of it is `apex + t (a + u span)`: `u` in [0, 1] names the ray,
//! and `w = 1 / t` tells how near the point is, 1 on the segment itself and more before it. From (x, y) to (u, w) is a projective map, so straight
//! segments stay straight, and what is seen first from the apex is the upper envelope of segments over [0, 1].

use glam::DVec3;

use crate::scene::SurfaceId;

/// All rays from an apex through a segment, within one plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan {
    pub apex: DVec3,
    a: DVec3,
    span: DVec3,
    /// `t` of a point is the dot product with this; `t u` that with the other.
    to_t: DVec3,
    to_tu: DVec3,
}

/// A face's section through the plane of a fan, as the apex sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub surface: SurfaceId,
    pub plane: u32,
    /// From which ray to which, ascending.
    pub u: [f64; 2],
    /// How near at both.
    w: [f64; 2],
    /// Where it is at both.
    ends: [DVec3; 2],
}

/// Parts of a fan's rays, ascending and apart.
pub(super) type Windows = Vec<[f64; 2]>;

/// Rays so close to each other are one: rounding of `u`.
const SAME_RAY: f64 = 1e-12;

/// A part of the way to the segment that is at the apex itself.
const AT_APEX: f64 = 1e-9;

impl Fan {
    /// The fan from `apex` through `apex + a` and `apex + b`, in the plane with the unit normal `normal`; `None` where `a` and `b` are parallel.
    pub fn new(apex: DVec3, [a, b]: [DVec3; 2], normal: DVec3) -> Option<Self> {
        let span = b - a;
        let (across_span, across_a) = (normal.cross(span), normal.cross(a));
        let (t, tu) = (a.dot(across_span), span.dot(across_a));
        let fan = Self { apex, a, span, to_t: across_span / t, to_tu: across_a / tu };
        (fan.to_t.is_finite() && fan.to_tu.is_finite()).then_some(fan)
    }

    /// The rays from the segment through the apex and on behind it.
    pub fn opposite(&self) -> Self {
        Self { apex: self.apex, a: -self.a, span: -self.span, to_t: -self.to_t, to_tu: -self.to_tu }
    }

    /// The direction of a ray, as long as the way to the segment.
    pub fn direction(&self, u: f64) -> DVec3 {
        self.a + u * self.span
    }

    /// Whether a box, by its centre and half its extent, may hold points of the fan, no farther than `farthest` times the segment.
    #[inline]
    pub fn may_reach(&self, centre: DVec3, half: DVec3, farthest: f64) -> bool {
        let from = centre - self.apex;
        let largest = |along: DVec3| along.dot(from) + along.abs().dot(half);
        largest(self.to_t) >= 0.0
            && -largest(-self.to_t) <= farthest
            && largest(self.to_tu) >= 0.0
            && largest(self.to_t - self.to_tu) >= 0.0
    }

    /// The part of a segment of the plane that lies in the fan.
    pub fn project(&self, mut from: DVec3, mut to: DVec3, surface: SurfaceId, plane: u32) -> Option<Cut> {
        let coordinates = |point: DVec3| {
            let arm = point - self.apex;
            [self.to_t.dot(arm), self.to_tu.dot(arm)]
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

        let [u, w] = [[p[1] / p[0], q[1] / q[0]].map(|u: f64| u.clamp(0.0, 1.0)), [1.0 / p[0], 1.0 / q[0]]];
        let mut cut = Cut { surface, plane, u, w, ends: [from, to] };
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
    fn nearness(&self, u: f64) -> f64 {
        let part = ((u - self.u[0]) / (self.u[1] - self.u[0])).clamp(0.0, 1.0);
        self.w[0] + part * (self.w[1] - self.w[0])
    }

    /// Where it is on ray `u`: between its ends, also where it is seen nearly end-on.
    pub fn point(&self, u: f64) -> DVec3 {
        let (after, before) = ((u - self.u[0]).max(0.0) * self.w[1], (self.u[1] - u).max(0.0) * self.w[0]);
        self.ends[0].lerp(self.ends[1], (after / (after + before)).clamp(0.0, 1.0))
    }

    /// The rays of `range` on which `above`, linear in u, is positive.
    fn where_positive(range: [f64; 2], above: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
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

    /// The rays on which it is farther than `w`.
    pub fn farther_than(&self, w: f64) -> Option<[f64; 2]> {
        Self::where_positive(self.u, |u| w - self.nearness(u))
    }

    /// The rays on which it hides `other`: surfaces of one plane hide nothing of each other.
    fn before(&self, other: &Self, within: [f64; 2]) -> Option<[f64; 2]> {
        /// What rounding may do to a nearness, as a part of it.
        const SAME_PLACE: f64 = 1e-10;
        if self.plane == other.plane {
            return None;
        }
        let range = [self.u[0].max(within[0]), self.u[1].min(within[1])];
        Self::where_positive(range, |u| self.nearness(u) - other.nearness(u) * (1.0 + SAME_PLACE))
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

/// Takes out what is hidden by anything that is nearer than `w`.
pub(super) fn hide(windows: &mut Windows, cuts: &[Cut], w: f64) {
    for cut in cuts {
        if windows.is_empty() {
            return;
        }
        if let Some(hidden) = cut.nearer_than(w) {
            take_out(windows, hidden);
        }
    }
}

/// Calls `visit` with each cut and the rays of `windows` on which it is the first that is farther than `w`.
pub(super) fn first_hits(cuts: &[Cut], windows: &[[f64; 2]], w: f64, mut visit: impl FnMut(&Cut, [f64; 2])) {
    let beyond = |cut: &Cut| {
        let [low, high] = cut.farther_than(w)?;
        let at_both = [low, high].map(|u| (cut.nearness(u), cut.point(u)));
        Some(Cut { u: [low, high], w: at_both.map(|(w, _)| w), ends: at_both.map(|(_, point)| point), ..*cut })
    };
    let targets: Vec<Cut> = cuts.iter().filter_map(beyond).collect();
    let mut seen = Windows::new();
    for target in &targets {
        seen.clear();
        let clipped = windows.iter().map(|&[low, high]| [low.max(target.u[0]), high.min(target.u[1])]);
        seen.extend(clipped.filter(|[low, high]| high - low > SAME_RAY));
        for other in &targets {
            if seen.is_empty() {
                break;
            }
            if let Some(hidden) = other.before(target, target.u) {
                take_out(&mut seen, hidden);
            }
        }
        seen.iter().for_each(|&rays| visit(target, rays));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    /// The distance along a ray to a segment of the xy plane, in lengths of the ray's direction.
    fn distance(from: DVec3, direction: DVec3, [a, b]: [DVec3; 2]) -> Option<f64> {
        let cross = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
        let span = cross(direction, b - a);
        let (t, s) = (cross(a - from, b - a) / span, cross(a - from, direction) / span);
        (t > 0.0 && (0.0..=1.0).contains(&s)).then_some(t)
    }

    /// Segments that do not cross: within parallel strips.
    fn segments(seed: u64) -> Vec<[DVec3; 2]> {
        let unit = |k: u64| sampling::unit(sampling::hash(seed, k));
        let end = |k: u64, strip: u64| DVec3::new(4.0 * unit(k) - 2.0, 0.1 + 0.25 * (strip as f64 + unit(k + 1)), 0.0);
        (0..12).map(|strip| [end(4 * strip, strip), end(4 * strip + 2, strip)]).collect()
    }

    #[test]
    fn rays_hit_first_what_is_nearest_behind_the_segment() {
        let apex = DVec3::new(0.1, -0.3, 0.0);
        let [a, b] = [DVec3::new(-0.4, 1.3, 0.0), DVec3::new(0.6, 1.1, 0.0)];
        let fan = Fan::new(apex, [a - apex, b - apex], DVec3::Z).unwrap();
        let (mut hits, mut misses) = (0, 0);
        for seed in 0..200 {
            let segments = segments(seed);
            let cuts: Vec<Cut> = (0..).zip(&segments).filter_map(|(k, s)| fan.project(s[0], s[1], SurfaceId(k), k)).collect();
            let mut found = Vec::new();
            first_hits(&cuts, &[[0.0, 1.0]], 1.0, |cut, rays| found.push((*cut, rays)));
            let mut open = vec![[0.0, 1.0]];
            hide(&mut open, &cuts, 1.0);
            for k in 0..50 {
                let u = (f64::from(k) + 0.5) / 50.0;
                let at = |k: usize| distance(apex, fan.direction(u), segments[k]);
                let nearest = (0..12).filter_map(|k| Some((at(k).filter(|&t| t > 1.0)?, k))).min_by(|a, b| a.0.total_cmp(&b.0));
                let hit: Vec<_> = found.iter().filter(|(_, rays)| (rays[0]..rays[1]).contains(&u)).collect();
                assert!(hit.len() <= 1, "seed {seed}: {hit:?}");
                assert_eq!(hit.first().map(|(cut, _)| cut.surface.index()), nearest.map(|(_, k)| k), "seed {seed} ray {u}");
                if let (Some((cut, _)), Some((t, _))) = (hit.first(), nearest) {
                    assert!(cut.point(u).distance(apex + t * fan.direction(u)) < 1e-9);
                }
                let is_hidden = (0..12).filter_map(at).any(|t| t < 1.0);
                assert_eq!(open.iter().any(|window| (window[0]..window[1]).contains(&u)), !is_hidden);
                hits += u32::from(nearest.is_some());
                misses += u32::from(is_hidden);
            }
        }
        assert!(hits > 1000 && misses > 1000, "{hits} {misses}");
    }

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
