//! Shadows: what segments cover of the axis of offsets rho, seen along lines of one direction or of a range of directions.
//!
//! Lines are `x cos theta + y sin theta = rho` (Soler and Sillion 1996, section 8), so a point casts its shadow at `p . n(theta)` with
//! `n = (cos theta, sin theta)`, and lines of direction theta are parallel with normal n.

use glam::DVec2;

/// Disjoint intervals of rho, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadow(Vec<[f64; 2]>);

impl Shadow {
    /// Of segments, given by their ends, along lines with normal `normal`.
    pub fn at(segments: &[[DVec2; 2]], normal: DVec2) -> Self {
        Self::union(segments.iter().map(|ends| {
            let [a, b] = ends.map(|end| end.dot(normal));
            [a.min(b), a.max(b)]
        }))
    }

    /// What is covered somewhere in a range of directions of less than pi, and what everywhere in it.
    ///
    /// The first holds the shadow of each direction of the range. The second lies in each: it is where single segments cover throughout.
    pub fn over(segments: &[[DVec2; 2]], range: [f64; 2]) -> [Self; 2] {
        let normals = range.map(DVec2::from_angle);
        let ranges = || segments.iter().map(|ends| ends.map(|end| offsets(end, normals)));
        let somewhere = ranges().map(|[a, b]| [a[0].min(b[0]), a[1].max(b[1])]);
        // One end stays below the other's least, so what lies between is covered.
        let everywhere =
            ranges().filter_map(|[a, b]| if a[1] < b[0] { Some([a[1], b[0]]) } else { (b[1] < a[0]).then_some([b[1], a[0]]) });
        [Self::union(somewhere), Self::union(everywhere)]
    }

    fn union(intervals: impl Iterator<Item = [f64; 2]>) -> Self {
        let mut sorted: Vec<[f64; 2]> = intervals.filter(|[low, high]| low < high).collect();
        sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for [low, high] in sorted {
            match joined.last_mut() {
                Some(last) if low <= last[1] => last[1] = last[1].max(high),
                _ => joined.push([low, high]),
            }
        }
        Self(joined)
    }

    pub fn length(&self) -> f64 {
        self.0.iter().map(|[low, high]| high - low).sum()
    }

    /// The length that both cover.
    pub fn overlap(&self, other: &Self) -> f64 {
        let (mut i, mut j, mut length) = (0, 0, 0.0);
        while let (Some(a), Some(b)) = (self.0.get(i), other.0.get(j)) {
            length += (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
            if a[1] < b[1] {
                i += 1;
            } else {
                j += 1;
            }
        }
        length
    }
}

/// The least and the largest offset of a point while the normal turns from the first to the second, by less than pi.
fn offsets(point: DVec2, normals: [DVec2; 2]) -> [f64; 2] {
    let [first, last] = normals.map(|normal| point.dot(normal));
    let [starts, ends] = normals.map(|normal| normal.perp().dot(point));
    // Turning points, where the normal points at the point or away from it.
    let high = if starts > 0.0 && ends < 0.0 { point.length() } else { first.max(last) };
    let low = if starts < 0.0 && ends > 0.0 { -point.length() } else { first.min(last) };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    const SEGMENTS: [[DVec2; 2]; 3] = [
        [DVec2::new(-1.0, 0.2), DVec2::new(-0.2, 0.5)],
        [DVec2::new(-0.5, -0.4), DVec2::new(0.4, -0.3)],
        [DVec2::new(0.7, -1.0), DVec2::new(0.6, 1.0)],
    ];

    #[test]
    fn shadows_join_where_segments_overlap() {
        let shadow = Shadow::at(&SEGMENTS, DVec2::X);
        assert_eq!(shadow.0, [[-1.0, 0.4], [0.6, 0.7]]);
        assert!((shadow.length() - 1.5).abs() < 1e-15);
        let other = Shadow(vec![[-2.0, -0.9], [0.3, 0.65]]);
        assert!((shadow.overlap(&other) - 0.25).abs() < 1e-15 && (other.overlap(&shadow) - 0.25).abs() < 1e-15);
    }

    #[test]
    fn the_shadow_of_each_direction_lies_between_those_of_its_range() {
        for cell in 0..64 {
            let [low, high] = [cell, cell + 1].map(|k| FRAC_PI_2 * f64::from(k) / 16.0);
            let [somewhere, everywhere] = Shadow::over(&SEGMENTS, [low, high]);
            for step in 0..=10 {
                let shadow = Shadow::at(&SEGMENTS, DVec2::from_angle(low + (high - low) * f64::from(step) / 10.0));
                assert!(shadow.overlap(&somewhere) > shadow.length() - 1e-12);
                assert!(shadow.overlap(&everywhere) > everywhere.length() - 1e-12);
            }
        }
    }

    #[test]
    fn offsets_turn_where_the_normal_points_at_the_point() {
        let [low, high] = offsets(DVec2::new(1.0, 1.0), [0.0, FRAC_PI_2].map(DVec2::from_angle));
        assert!((high - 2.0_f64.sqrt()).abs() < 1e-15 && (low - 1.0).abs() < 1e-15);
        let [low, high] = offsets(DVec2::new(1.0, 1.0), [3.0 * FRAC_PI_4, 6.0 * FRAC_PI_4].map(DVec2::from_angle));
        assert!(high.abs() < 1e-15 && (low + 2.0_f64.sqrt()).abs() < 1e-15);
    }
}
