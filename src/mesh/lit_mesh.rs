//! The lit mesh of a scene.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::locate::Locator;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::scene::{Scene, SurfaceId};

/// Radiosity as a function on the surfaces of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LitMesh {
    /// By surface; `None` where there is no mesh.
    pub(crate) surfaces: Vec<Option<SurfaceMesh>>,
    /// How far it is off the values at points, in the local norm, and the upper confidence limit of that.
    pub(crate) measured: f64,
    pub(crate) claimed: f64,
}

impl LitMesh {
    /// tmp
    pub fn error(&self) -> (f64, f64) { (self.measured, self.claimed) }

    /// Elements in all.
    pub fn elements(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.triangles().len()).sum()
    }

    /// Nodes in all.
    pub fn nodes(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.nodes().len()).sum()
    }
}

/// Reads a lit mesh at points.
pub(crate) struct MeshReader<'a> {
    scene: &'a Scene,
    by_surface: Vec<Option<(&'a SurfaceMesh, Plane, Locator)>>,
}

impl<'a> MeshReader<'a> {
    pub fn new(scene: &'a Scene, mesh: &'a LitMesh) -> Self {
        let reader = |(number, mesh): (usize, &'a Option<SurfaceMesh>)| {
            let mesh = mesh.as_ref()?;
            Some((mesh, Plane::of(scene, SurfaceId(number as u32)), Locator::new(mesh)))
        };
        Self { scene, by_surface: mesh.surfaces.iter().enumerate().map(reader).collect() }
    }

    /// The radiosity at a point of a surface, by channel; `false` if the surface has no mesh.
    pub fn radiosity_at(&self, point: DVec3, surface: SurfaceId, radiosity: &mut [f64]) -> bool {
        let Some((mesh, plane, locator)) = &self.by_surface[surface.index()] else { return false };
        let Some((triangle, at)) = locator.find(mesh, plane.to_plane(point)) else { return false };
        mesh.reflected_at(triangle, at, radiosity);
        let exitance = &self.scene.material_of(surface).exitance;
        radiosity.iter_mut().zip(exitance).for_each(|(b, e)| *b += e);
        true
    }
}
