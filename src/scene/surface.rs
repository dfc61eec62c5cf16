//! One surface.

use serde::{Deserialize, Serialize};

use crate::geometry::Polygon;

/// The number of a surface in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SurfaceId(pub u32);

impl SurfaceId {
    /// The id as an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A planar convex one-sided polygon of one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Its shape; the front emits and receives.
    pub polygon: Polygon,
    /// Index into [`Scene::materials`](super::Scene::materials).
    pub material: u32,
    /// The 0-based number of the face in the input file that it comes from.
    pub face: u32,
    /// Its group of coplanar surfaces: a surface never hides anything from a point in its own plane.
    pub(crate) plane: u32,
    /// The surface on the back of the same sheet, if there is one.
    pub(crate) twin: Option<SurfaceId>,
}

impl Surface {
    /// The number of its plane: surfaces of one scene have the same number if and only if they are coplanar, on either side.
    pub fn plane(&self) -> u32 {
        self.plane
    }

    /// The surface on the back of the same sheet, if there is one.
    pub fn twin(&self) -> Option<SurfaceId> {
        self.twin
    }
}
