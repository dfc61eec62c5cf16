//! Groups of sources of light: the leaves of a light tree and what bounds some of them together.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::Aabb;

/// Angles are widened by this much against rounding.
const ANGLE_SLACK: f64 = 1e-6;

/// A leaf of the tree: an emitter, or a cell of a bright reflector.
#[derive(Clone)]
pub(super) struct Source {
    pub number: u32,
    pub bounds: Aabb,
    pub normal: DVec3,
    /// The power that it sends, in W.
    pub power: f64,
}

/// The box, cone of normals and power of a group of sources.
pub(super) struct Group {
    pub bounds: Aabb,
    /// All normals are within `half_angle` of `axis`, in radians.
    pub axis: DVec3,
    pub half_angle: f64,
    /// In W.
    pub power: f64,
}

/// Two halves of equal number, along the longest axis of the centres.
pub(super) fn halves(sources: &mut [Source]) -> (&mut [Source], &mut [Source]) {
    let extent = Aabb::around(sources.iter().map(|source| source.bounds.centre())).extent();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let place = |source: &Source| source.bounds.centre()[axis];
    let middle = sources.len().div_ceil(2);
    if middle < sources.len() {
        sources.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)).then(a.number.cmp(&b.number)));
    }
    sources.split_at_mut(middle)
}

impl Default for Group {
    fn default() -> Self {
        Self { bounds: Aabb::EMPTY, axis: DVec3::Z, half_angle: PI, power: 0.0 }
    }
}

impl Group {
    pub fn of(source: &Source) -> Self {
        Self { bounds: source.bounds, axis: source.normal, half_angle: 0.0, power: source.power }
    }

    pub fn union(self, other: Self) -> Self {
        let (axis, half_angle) = cone_around(&self, &other);
        Self { bounds: self.bounds.union(other.bounds), axis, half_angle, power: self.power + other.power }
    }
}

/// A cone around the normals of two groups.
fn cone_around(a: &Group, b: &Group) -> (DVec3, f64) {
    let (wide, narrow) = if a.half_angle >= b.half_angle { (a, b) } else { (b, a) };
    let between = wide.axis.dot(narrow.axis).clamp(-1.0, 1.0).acos();
    if between + narrow.half_angle <= wide.half_angle {
        return (wide.axis, wide.half_angle);
    }
    let half_angle = 0.5 * (between + wide.half_angle + narrow.half_angle);
    let aside = (narrow.axis - wide.axis.dot(narrow.axis) * wide.axis).try_normalize();
    match aside.filter(|_| half_angle < PI) {
        Some(aside) => {
            let turn = half_angle - wide.half_angle;
            (turn.cos() * wide.axis + turn.sin() * aside, half_angle + ANGLE_SLACK)
        }
        None => {
            let around = between + narrow.half_angle;
            (wide.axis, if around < PI { around.max(wide.half_angle) } else { PI })
        }
    }
}
