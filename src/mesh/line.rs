//! Lines that elements follow.

use glam::DVec2;

/// A line within a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub ends: [DVec2; 2],
    /// Whether light may have a step there: values are not shared across it.
    pub is_step: bool,
}
