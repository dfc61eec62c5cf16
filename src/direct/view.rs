//! A point that looks at a source.

use glam::DVec3;

use crate::geometry::Facet;

/// A point on a surface, and a convex polygon that it looks at.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub point: DVec3,
    /// The unit normal of the side of the point that looks.
    pub normal: DVec3,
    /// The number of the point's plane.
    pub plane: u32,
    pub source: Facet<'a>,
    pub source_plane: u32,
}
