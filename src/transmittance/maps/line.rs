//! Lines by four numbers: how they run, and where they cross a plane.

use glam::DVec3;

/// A line, along the axis in which it goes farthest: per metre along this axis it goes `slopes` metres along the two others.
///
/// A line and its reverse are the same. Slopes are from -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// 0 to 2; of the others the next comes first, 0 after 2.
    pub axis: usize,
    pub slopes: [f64; 2],
    point: DVec3,
}

impl Line {
    /// The line through two points. One that is none, because they coincide, runs along x.
    pub fn through(from: DVec3, to: DVec3) -> Self {
        let way = to - from;
        let length = way.abs();
        let axis = if length.x >= length.y.max(length.z) { 0 } else { 1 + usize::from(length.z > length.y) };
        let slopes = across(axis).map(|other| if way[axis] == 0.0 { 0.0 } else { way[other] / way[axis] });
        Self { axis, slopes, point: from }
    }

    /// Where the line crosses the plane through `centre` at right angles to its axis, in metres from there.
    pub fn offsets(&self, centre: DVec3) -> [f64; 2] {
        offsets(self.axis, self.slopes, self.point - centre)
    }
}

/// The two axes that are not this one.
pub(super) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Where a line of these slopes through a point crosses the plane through 0 at right angles to the axis.
pub(super) fn offsets(axis: usize, slopes: [f64; 2], point: DVec3) -> [f64; 2] {
    let [u, v] = across(axis);
    [point[u] - slopes[0] * point[axis], point[v] - slopes[1] * point[axis]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling::{hash, unit};

    #[test]
    fn a_line_is_that_of_any_two_of_its_points() {
        for seed in 0..200 {
            let number = |k: u64| 4.0 * unit(hash(seed, k)) - 2.0;
            let point = |k: u64| DVec3::new(number(k), number(k + 1), number(k + 2));
            let (from, to, centre) = (point(0), point(3), point(6));
            let (line, other) = (Line::through(from, to), Line::through(to, from + 0.4 * (to - from)));
            assert_eq!(line.axis, other.axis);
            assert!(line.slopes.iter().all(|slope| slope.abs() <= 1.0));
            for k in 0..2 {
                assert!((line.slopes[k] - other.slopes[k]).abs() < 1e-12);
                assert!((line.offsets(centre)[k] - other.offsets(centre)[k]).abs() < 1e-12);
            }

            // Back to a point of the line.
            let [u, v] = across(line.axis);
            let mut crossing = centre;
            crossing[u] += line.offsets(centre)[0];
            crossing[v] += line.offsets(centre)[1];
            let way = (to - from).normalize();
            assert!((crossing - from).cross(way).length() < 1e-12);
        }
    }
}
