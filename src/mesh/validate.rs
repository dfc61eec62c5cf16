//! What a lit mesh must be that was read from a file: values and pictures rely on it.

use glam::DVec2;

use super::lit_mesh::LitMesh;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::scene::{Scene, SurfaceId};
use crate::values;

/// Middles of edges lie where they should within this part of the polygon's size: more than rounding, less than is seen.
const CLOSE: f64 = 1e-5;

/// Lines where surfaces touch end within so many tolerances of contacts: both faces are off, and places along a line are welded.
const CONTACTS: f64 = 8.0;

/// Elements are not flatter: twice the area, as a part of the square of the longest edge. Triangulation leaves none below 1e-10.
const FLATTEST: f64 = 1e-12;

/// No radiosity is larger: sums of those of six nodes and what is emitted are told in f32.
const MOST: f32 = f32::MAX / 16.0;

impl LitMesh {
    /// Whether reflected radiosities at nodes are finite, and sums of some can be told in f32.
    pub(crate) fn are_in_range(reflected: &[f32]) -> bool {
        reflected.iter().all(|b| b.abs() <= MOST)
    }

    /// Checks what was read from a file: that elements fill the surfaces that reflect, each once as far as areas tell, and that all numbers are finite.
    ///
    /// # Errors
    /// Says what is wrong.
    pub(crate) fn validate(&self, scene: &Scene) -> Result<(), String> {
        // Infinite where nothing can be said, as of light groups with other weights.
        if !(self.measured >= 0.0 && self.claimed >= 0.0) {
            return Err("the error of the lit mesh is negative, or no number".to_owned());
        }
        if self.surfaces.len() != scene.surfaces().len() {
            return Err("the lit mesh does not fit the scene".to_owned());
        }
        let tolerance = values::tolerance(scene).max(CONTACTS * scene.contact_tolerance());
        for (number, mesh) in self.surfaces.iter().enumerate() {
            let surface = SurfaceId(number as u32);
            if let Some(mesh) = mesh {
                if !scene.material_of(surface).reflects() {
                    return Err(format!("there is a lit mesh of surface {number}, which reflects nothing"));
                }
                Checked::new(scene, surface, mesh, tolerance).check().map_err(|what| format!("{what} of surface {number}"))?;
            }
        }
        Ok(())
    }
}

/// A mesh and the polygon that it lies in.
struct Checked<'a> {
    mesh: &'a SurfaceMesh,
    channels: usize,
    /// Counter-clockwise.
    corners: Vec<DVec2>,
    area: f64,
    size: f64,
    perimeter: f64,
    /// Nodes lie in the polygon within so many metres, since lines where surfaces touch are found with some tolerance; and elements fill it but for a
    /// strip of that width.
    tolerance: f64,
}

impl<'a> Checked<'a> {
    fn new(scene: &Scene, surface: SurfaceId, mesh: &'a SurfaceMesh, tolerance: f64) -> Self {
        let (plane, facet) = (Plane::of(scene, surface), scene.surface(surface).polygon.facet());
        let corners: Vec<DVec2> = facet.vertices.iter().map(|&corner| plane.to_plane(corner)).collect();
        let perimeter = (0..corners.len()).map(|corner| corners[corner].distance(corners[(corner + 1) % corners.len()])).sum();
        Self { mesh, channels: scene.channels(), corners, area: facet.area, size: facet.radius, perimeter, tolerance }
    }

    fn check(&self) -> Result<(), String> {
        let (nodes, reflected) = (self.mesh.nodes(), self.mesh.all_reflected());
        if reflected.len() != nodes.len() * self.channels {
            return Err("there are too many or too few radiosities at the nodes".to_owned());
        }
        // Noise may take it below 0 in the dark.
        if !LitMesh::are_in_range(reflected) {
            return Err("a radiosity is not finite at a node".to_owned());
        }
        if !nodes.iter().all(|&at| self.is_inside(at)) {
            return Err("a node lies outside of the polygon".to_owned());
        }
        let mut filled = 0.0;
        for element in self.mesh.triangles() {
            filled += self.area_of(element).ok_or("an element is none")?;
        }
        if (filled - self.area).abs() > self.perimeter * self.tolerance {
            return Err("elements do not fill the polygon".to_owned());
        }
        let errors = self.mesh.errors();
        if !errors.is_empty() && errors.len() != self.mesh.triangles().len() {
            return Err("there are too many or too few standard errors of elements".to_owned());
        }
        if !errors.iter().all(|error| error.is_finite() && *error >= 0.0) {
            return Err("a standard error is negative, or not finite, in an element".to_owned());
        }
        Ok(())
    }

    /// Whether a point lies in the polygon, or close to it.
    fn is_inside(&self, at: DVec2) -> bool {
        let count = self.corners.len();
        (0..count).all(|corner| {
            let (from, to) = (self.corners[corner], self.corners[(corner + 1) % count]);
            (to - from).perp_dot(at - from) >= -self.tolerance * from.distance(to)
        })
    }

    /// The area of an element; `None` if its nodes are not there, not counter-clockwise, or not in the middle of edges.
    fn area_of(&self, element: &[u32; 6]) -> Option<f64> {
        let node = |number: u32| self.mesh.nodes().get(number as usize).copied();
        let mut at = [DVec2::ZERO; 6];
        for (at, &number) in at.iter_mut().zip(element) {
            *at = node(number)?;
        }
        let edges = [(at[0], at[1], at[3]), (at[1], at[2], at[4]), (at[2], at[0], at[5])];
        let are_middles = edges.iter().all(|&(from, to, middle)| middle.distance(0.5 * (from + to)) <= CLOSE * self.size);
        let longest_sq = edges.iter().map(|&(from, to, _)| from.distance_squared(to)).fold(0.0, f64::max);
        let twice_area = (at[1] - at[0]).perp_dot(at[2] - at[0]);
        let is_element = are_middles && longest_sq.is_normal() && twice_area >= FLATTEST * longest_sq;
        is_element.then_some(0.5 * twice_area)
    }
}
