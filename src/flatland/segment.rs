//! Segments of the plane, one-sided where they receive or send, and the parts of them that lie in front of others.

use glam::DVec2;
use thiserror::Error;

/// The largest coordinate. Products of three stay finite.
const MOST: f64 = 1e100;

/// A segment from a to b. Its front is to the left of that direction. It blocks light from either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    a: DVec2,
    b: DVec2,
}

/// Why two points make no segment.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SegmentError {
    /// A coordinate is not a number from -1e100 to 1e100.
    #[error("coordinate {0} is not a number from -1e100 to 1e100")]
    Coordinate(f64),
}

impl Segment {
    /// The segment between two points, x and y in metres. They may be equal: such a segment sees, sends and blocks nothing.
    ///
    /// # Errors
    ///
    /// If a coordinate is not a number from -1e100 to 1e100.
    pub fn new(a: [f64; 2], b: [f64; 2]) -> Result<Self, SegmentError> {
        let is_bad = |x: &f64| x.is_nan() || x.abs() > MOST;
        match [a, b].as_flattened().iter().copied().find(is_bad) {
            Some(coordinate) => Err(SegmentError::Coordinate(coordinate)),
            None => Ok(Self { a: a.into(), b: b.into() }),
        }
    }

    /// Its first and its second end.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [self.a.into(), self.b.into()]
    }

    /// In metres.
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }

    pub(super) fn points(&self) -> [DVec2; 2] {
        [self.a, self.b]
    }

    /// How far a point lies in front of its line, times its length.
    pub(super) fn height(&self, point: DVec2) -> f64 {
        (self.b - self.a).perp_dot(point - self.a)
    }

    /// The part in front of another segment's line. Nothing, if no point of it is.
    pub(super) fn in_front_of(&self, other: &Self) -> Option<Self> {
        let [at_a, at_b] = self.points().map(|end| other.height(end));
        if at_a <= 0.0 && at_b <= 0.0 {
            return None;
        }
        let cut = || self.a + (self.b - self.a) * (at_a / (at_a - at_b));
        let a = if at_a < 0.0 { cut() } else { self.a };
        let b = if at_b < 0.0 { cut() } else { self.b };
        Some(Self { a, b })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(a: [f64; 2], b: [f64; 2]) -> Segment {
        Segment::new(a, b).unwrap()
    }

    #[test]
    fn what_is_behind_is_cut_off() {
        let floor = segment([0.0, 0.0], [2.0, 0.0]);
        assert_eq!(segment([0.0, -1.0], [4.0, 3.0]).in_front_of(&floor), Some(segment([1.0, 0.0], [4.0, 3.0])));
        assert_eq!(segment([4.0, 3.0], [0.0, -1.0]).in_front_of(&floor), Some(segment([4.0, 3.0], [1.0, 0.0])));
        assert_eq!(segment([0.0, 0.0], [5.0, 1.0]).in_front_of(&floor), Some(segment([0.0, 0.0], [5.0, 1.0])));
        assert_eq!(segment([-1.0, 0.0], [5.0, 0.0]).in_front_of(&floor), None);
        // Nothing is in front of what has no length.
        assert_eq!(floor.in_front_of(&segment([0.0, -1.0], [0.0, -1.0])), None);
    }

    #[test]
    fn coordinates_must_be_numbers() {
        assert!(matches!(Segment::new([0.0, f64::NAN], [1.0, 0.0]), Err(SegmentError::Coordinate(x)) if x.is_nan()));
        assert_eq!(Segment::new([0.0, 0.0], [1.0, 1e101]), Err(SegmentError::Coordinate(1e101)));
    }
}
