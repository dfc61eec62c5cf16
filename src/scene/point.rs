//! A point that somebody asks about.

/// A point that lies on a surface, with the normal of the side that is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// In metres.
    pub position: [f64; 3],
    /// Unit normal of the side that is looked at.
    pub normal: [f64; 3],
}
