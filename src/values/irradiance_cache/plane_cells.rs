//! Square cells on the planes that surfaces lie in; coplanar surfaces share them.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::geometry::Frame;
use crate::scene::{Scene, SurfaceId};

/// A side of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Side {
    pub plane: u32,
    pub is_front: bool,
}

/// A cell on a side of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct CellKey {
    pub side: Side,
    pub column: i64,
    pub row: i64,
}

impl CellKey {
    /// The cell and its neighbours up to `reach` cells to every side.
    pub fn around(self, reach: i64) -> impl Iterator<Item = CellKey> {
        let steps = move || -reach..=reach;
        steps().flat_map(move |up| steps().map(move |aside| CellKey { column: self.column + aside, row: self.row + up, ..self }))
    }
}

/// The planes of a scene, each with coordinates of its own.
pub(super) struct PlaneCells<'a> {
    scene: &'a Scene,
    /// By plane: its frame, and its distance from the origin along the normal.
    planes: Vec<(Frame, f64)>,
}

impl<'a> PlaneCells<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        // Planes are numbered by their first surfaces.
        let mut planes = Vec::new();
        for surface in scene.surfaces() {
            if surface.plane as usize == planes.len() {
                let facet = surface.polygon.facet();
                planes.push((Frame::around(facet.normal), facet.normal.dot(facet.centroid)));
            }
        }
        Self { scene, planes }
    }

    /// The side of its plane that a surface faces.
    pub fn side_of(&self, surface: SurfaceId) -> Side {
        let surface = self.scene.surface(surface);
        let (frame, _) = self.planes[surface.plane as usize];
        Side { plane: surface.plane, is_front: frame.normal.dot(surface.polygon.facet().normal) > 0.0 }
    }

    /// Coordinates of a point in its plane, in metres.
    pub fn to_plane(&self, side: Side, point: DVec3) -> DVec2 {
        let (frame, _) = self.planes[side.plane as usize];
        DVec2::new(frame.tangent.dot(point), frame.bitangent.dot(point))
    }

    /// The point at coordinates of a plane, and the normal of the side.
    pub fn to_space(&self, side: Side, at: DVec2) -> (DVec3, DVec3) {
        let (frame, height) = self.planes[side.plane as usize];
        (frame.to_world(at.extend(height)), if side.is_front { frame.normal } else { -frame.normal })
    }

    /// The cell of `size` metres that a point of a surface lies in.
    pub fn cell_at(&self, surface: SurfaceId, point: DVec3, size: f64) -> CellKey {
        let side = self.side_of(surface);
        let at = (self.to_plane(side, point) / size).floor();
        CellKey { side, column: at.x as i64, row: at.y as i64 }
    }
}
