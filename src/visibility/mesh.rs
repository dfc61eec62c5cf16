//! The triangles that occlude.

use glam::DVec3;

use super::{NO_PLANE, VisibilityError};
use crate::{geometry::Aabb, scene::Scene};

/// Coordinates may not be larger than this, so that squares and products of them stay finite.
const LARGEST_COORDINATE: f64 = 1e75;

/// The part of the scene's diagonal within which an end counts as touching a plane: room for points that callers compute in several
/// steps. Points that are exact to rounding need none of it (tests/backends).
const CONTACT_OF_SIZE: f64 = 1e-12;

/// Roundings of the largest coordinate within which an end counts as touching a plane: one for the point, one for each vertex,
/// and a few for what is computed from them.
const CONTACT_ROUNDINGS: f64 = 8.0;

/// Triangles with, for each, the surface it belongs to and the plane it lies in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OccluderMesh {
    /// In metres.
    pub vertices: Vec<[f64; 3]>,
    /// Indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// The surface that each triangle belongs to. Of a sheet with two sides only the first side is here.
    pub surfaces: Vec<u32>,
    /// The plane that each triangle lies in: a number shared by coplanar triangles, never [`NO_PLANE`].
    pub planes: Vec<u32>,
}

impl OccluderMesh {
    /// The triangles of a scene: each surface as a fan.
    pub fn of_scene(scene: &Scene) -> Self {
        Self::of_surfaces(scene, |_| true)
    }

    /// Those of some surfaces alone, by their numbers in the scene; of a sheet both sides count as its first.
    pub fn of_surfaces(scene: &Scene, is_wanted: impl Fn(u32) -> bool) -> Self {
        let mut mesh = Self::default();
        for (id, surface) in scene.surfaces().iter().enumerate() {
            if surface.twin.is_some_and(|twin| twin.index() < id) || !is_wanted(id as u32) {
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

    /// Up to this distance from a triangle's plane an end of a segment counts as lying in it, in metres: 1e-12 of the diagonal of
    /// the box around the mesh, and 8 roundings of its largest coordinate.
    pub fn contact_tolerance(&self) -> f64 {
        contact_tolerance(&self.bounds())
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb::around(self.vertices.iter().map(|&vertex| DVec3::from(vertex)))
    }

    /// What every backend relies on.
    pub(super) fn validate(&self) -> Result<(), VisibilityError> {
        let bad = |reason: String| Err(VisibilityError::BadMesh(reason));

        let count = self.triangles.len();
        if self.surfaces.len() != count || self.planes.len() != count {
            return bad(format!(
                "{count} triangles need as many surfaces and planes, not {} and {}",
                self.surfaces.len(),
                self.planes.len()
            ));
        }
        if count >= 1 << 31 || self.vertices.len() >= 1 << 31 {
            return bad("more than 2^31 triangles or vertices".to_owned());
        }
        let in_range = |vertex: &[f64; 3]| vertex.iter().all(|x| x.abs() <= LARGEST_COORDINATE);
        if let Some(index) = self.vertices.iter().position(|vertex| !in_range(vertex)) {
            return bad(format!("vertex {index} is not finite or beyond {LARGEST_COORDINATE:e} m: {:?}", self.vertices[index]));
        }
        if let Some(index) = self.triangles.iter().position(|triangle| triangle.iter().any(|&v| v as usize >= self.vertices.len()))
        {
            let (triangle, vertices) = (self.triangles[index], self.vertices.len());
            return bad(format!("triangle {index} has vertices {triangle:?}, but there are only {vertices}"));
        }
        if let Some(index) = self.planes.iter().position(|&plane| plane == NO_PLANE) {
            return bad(format!("triangle {index} has the plane number that stands for no plane"));
        }
        Ok(())
    }
}

/// [`OccluderMesh::contact_tolerance`] of a mesh in a box.
pub(crate) fn contact_tolerance(bounds: &Aabb) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    CONTACT_OF_SIZE * bounds.diagonal() + CONTACT_ROUNDINGS * 0.5 * f64::EPSILON * largest
}
