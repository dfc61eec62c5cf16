//! Who sees whom: occlusion of segments and first hits of rays, by a choice of backends.
//!
//! # The contract
//! Every backend, asked through [`Visibility`],
//! - may be asked from many threads at once and gives the same answer to the same question, always;
//! - excludes both ends of a segment;
//! - ignores triangles in the plane of either end (`from_plane`, `to_plane`): coplanar surfaces cannot block;
//! - occludes from both sides of a triangle;
//! - answers "occluded" to a segment that is not finite or has no length, before the native code sees it.

mod backend;
mod brute_force;
mod mesh;

pub use backend::{Backend, VisibilityError, build};
pub use mesh::OccluderMesh;

/// A plane number that belongs to no surface: nothing is ignored at that end.
pub const NO_PLANE: u32 = u32::MAX;

/// The open segment between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// One end, in metres.
    pub from: [f64; 3],
    /// The other end, in metres.
    pub to: [f64; 3],
    /// Triangles of this plane are ignored, see [`OccluderMesh`]; [`NO_PLANE`] for a point on no surface.
    pub from_plane: u32,
    /// Triangles of this plane are ignored too.
    pub to_plane: u32,
}

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in metres.
    pub origin: [f64; 3],
    /// Where it goes; need not have length 1.
    pub direction: [f64; 3],
    /// Triangles of this plane are ignored; [`NO_PLANE`] for a point on no surface.
    pub origin_plane: u32,
}

/// The first triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The surface that the triangle belongs to, by [`OccluderMesh`]; seen from either side.
    pub surface: u32,
    /// In lengths of the ray's direction, positive.
    pub distance: f64,
}

/// Answers occlusion and first-hit queries in batches. The module documentation is the contract.
pub trait Visibility: Send + Sync {
    /// Name and version of what answers, as in `embree 3.13.5`.
    fn description(&self) -> String;

    /// Sets `occluded[i]` to whether anything lies on the open segment `segments[i]`. Both slices have the same length.
    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]);

    /// Sets `hits[i]` to the first triangle on `rays[i]`, from either side. Both slices have the same length.
    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]);
}
