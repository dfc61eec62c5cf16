//! Axis-aligned boxes.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// An axis-aligned box, in metres. The empty box has `min > max`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aabb {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self { min: bounds.min.min(point), max: bounds.max.max(point) })
    }

    /// The smallest box around both.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The lower corner, in metres.
    pub fn min(&self) -> [f64; 3] {
        self.min.to_array()
    }

    /// The upper corner, in metres.
    pub fn max(&self) -> [f64; 3] {
        self.max.to_array()
    }

    /// Whether the box contains nothing.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The distance between the nearest points of both, in metres.
    pub(crate) fn distance_to(&self, other: &Self) -> f64 {
        (other.min - self.max).max(self.min - other.max).max(DVec3::ZERO).length()
    }

    pub(crate) fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    pub(crate) fn extent(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// The length of the diagonal, in metres; 0 for the empty box.
    pub fn diagonal(&self) -> f64 {
        self.extent().length()
    }
}
