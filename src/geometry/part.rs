//! A part of a polygon that owns its corners.

use glam::DVec3;

use super::Facet;

/// A part of a polygon, of three or four corners, from splitting it so and so often.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    corners: [DVec3; 4],
    count: u8,
    /// How many times the polygon was split.
    pub splits: u8,
}

impl Part {
    /// A part with three or four corners.
    pub fn new(corners: &[DVec3], splits: u8) -> Self {
        let mut part = Self { corners: [DVec3::ZERO; 4], count: corners.len() as u8, splits };
        part.corners[..corners.len()].copy_from_slice(corners);
        part
    }

    /// The part as a polygon with the normal of the whole.
    pub fn facet(&self, normal: DVec3) -> Facet<'_> {
        Facet::of_part(&self.corners[..usize::from(self.count)], normal)
    }
}
