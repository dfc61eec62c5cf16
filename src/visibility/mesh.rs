//! The triangles that occlude.

use crate::scene::Scene;

/// Triangles with, for each, the surface it belongs to and the plane it lies in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OccluderMesh {
    /// In metres.
    pub vertices: Vec<[f64; 3]>,
    /// Indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// The surface that each triangle belongs to. Of a sheet with two sides only the first side is here.
    pub surfaces: Vec<u32>,
    /// The plane that each triangle lies in: a number shared by coplanar triangles.
    pub planes: Vec<u32>,
}

impl OccluderMesh {
    /// The triangles of a scene: each surface as a fan.
    pub fn of_scene(scene: &Scene) -> Self {
        let mut mesh = Self::default();
        for (id, surface) in scene.surfaces().iter().enumerate() {
            if surface.twin.is_some_and(|twin| twin.index() < id) {
                continue;
            }
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(surface.polygon.vertices());
            for k in 1..surface.polygon.vertices().len() as u32 - 1 {
                mesh.triangles.push([first, first + k, first + k + 1]);
                mesh.surfaces.push(id as u32);
                mesh.planes.push(surface.plane);
            }
        }
        mesh
    }
}
