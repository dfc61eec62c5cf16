//! Who sees whom: occlusion of segments and first hits of rays, by a choice of backends.
//!
//! # The contract
//! A triangle **blocks** a segment if
//! - the segment passes through it, from either side;
//! - it lies in neither `from_plane` nor `to_plane`: what lies in the plane of an end surface cannot hide anything from it;
//! - the two ends lie on different sides of its plane, each farther from it than [`OccluderMesh::contact_tolerance`]: so both
//!   ends are excluded, and a surface that an end touches does not block, from whatever angle it is seen.
//!
//! Triangles without area block nothing, not even where they are.
//!
//! Every backend, asked through [`Visibility`],
//! - may be asked from many threads at once, and gives the same answer to the same question, always and in any company, but for one kind of query
//!   ([`Visibility::coherent_first_hits`]);
//! - answers "occluded" to a segment that is not finite (its ends, or their difference) or has no length, and "nothing" to a ray
//!   that is not finite or has no direction, before any native code sees it;
//! - works on the thread that asks. Callers cut large batches into pieces of about a thousand and give these to their threads.
//!
//! # How exact the answers are
//! The sides of planes, and with them contact, are decided in f64 by every backend: a closed convex surface never hides its
//! inside from itself, wherever it stands. Whether a segment passes through a triangle is decided in f64 by
//! [`Backend::BruteForce`] and in f32 by the others, in a frame around the occluders: there edges are known to about 1e-7 of their
//! distance from the median of the vertices, so a segment that passes an edge more closely than this may go either way, and what is
//! thinner than this, or nearer than this to an end, may be missed.

mod backend;
mod box_tree;
mod brute_force;
mod build;
#[cfg(has_embree)]
mod embree;
#[cfg(feature = "embree4-sys")]
mod embree4_sys;
mod mesh;
mod near;
mod obvhs;
mod occluders;

use std::sync::Arc;

pub use backend::{Backend, VisibilityError};
pub(crate) use box_tree::{BoxTree, HalfSpace};
pub use build::build;
pub use mesh::OccluderMesh;
pub(crate) use mesh::contact_tolerance;
pub(crate) use near::SurfaceBoxes;

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
    /// The surface that the triangle belongs to, by [`OccluderMesh`]; seen from either side. Where several triangles lie at the
    /// same distance it is that of any of them, always the same.
    pub surface: u32,
    /// In lengths of the ray's direction, positive; to f64 precision the distance of the triangle's plane.
    pub distance: f64,
}

/// Answers occlusion and first-hit queries in batches. The module documentation is the contract.
pub trait Visibility: Send + Sync {
    /// Name and version of what answers, as in `embree 3.13.5`.
    fn description(&self) -> String;

    /// Sets `occluded[i]` to whether any triangle blocks `segments[i]`. Of slices of different lengths the longer one's rest is
    /// left.
    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]);

    /// Sets `hits[i]` to the first triangle that blocks `rays[i]`, a segment without a far end. Lengths as in [`Self::occluded`].
    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]);

    /// The same, as fast or faster, for rays from one point of which each goes almost the same way as the next, as through the pixels of a camera. A call gives
    /// the same answers always, but its other rays may decide which of two triangles at one distance a ray meets.
    fn coherent_first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.first_hits(rays, hits);
    }
}

/// Several solves of the same geometry ask one structure.
impl<V: Visibility + ?Sized> Visibility for Arc<V> {
    fn description(&self) -> String {
        (**self).description()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        (**self).occluded(segments, occluded);
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        (**self).first_hits(rays, hits);
    }

    fn coherent_first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        (**self).coherent_first_hits(rays, hits);
    }
}
