//! The lit scene as polygons with radiosities at their corners: what exporters write that know nothing of quadratic elements.

use crate::bake::VertexLight;
use crate::mesh::LitMesh;
use crate::scene::Scene;
use crate::solve::Solution;

/// Each quadratic element as four flat triangles, by its six nodes.
const FLAT: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];

/// Polygons of a lit scene.
pub(super) struct Patches<'a> {
    pub scene: &'a Scene,
    /// In metres. No vertex belongs to two surfaces.
    pub vertices: Vec<[f64; 3]>,
    /// By vertex and channel, in W/m^2.
    pub radiosity: Vec<f32>,
    /// Indices of vertices, patch after patch, counter-clockwise from the front.
    pub corners: Vec<u32>,
    /// Where each patch ends in `corners`, and the number of its surface.
    pub ends: Vec<(usize, u32)>,
    /// By patch, the standard error of what is shown, all channels together, in W/m^2, 0 of what is known and NaN where nothing is; empty where it is
    /// not told by patch.
    pub standard_errors: Vec<f32>,
    /// Whether each patch has one radiosity.
    pub is_flat: bool,
}

impl<'a> Patches<'a> {
    fn none(scene: &'a Scene, is_flat: bool) -> Self {
        let (vertices, radiosity, corners, ends, standard_errors) = Default::default();
        Self { scene, vertices, radiosity, corners, ends, standard_errors, is_flat }
    }

    /// Of a lit mesh; surfaces that reflect nothing, which it leaves out, are as bright as they emit.
    pub fn of_mesh(scene: &'a Scene, mesh: &LitMesh) -> Self {
        let mut patches = Self::none(scene, false);
        let mut has_mesh = vec![false; scene.surfaces().len()];
        for part in mesh.parts(scene) {
            has_mesh[part.surface as usize] = true;
            let first = patches.vertices.len() as u32;
            patches.vertices.extend(&part.nodes);
            patches.radiosity.extend(&part.radiosity);
            for triangle in part.elements.iter().flat_map(|element| FLAT.map(|corners| corners.map(|k| first + element[k]))) {
                patches.push(triangle, part.surface);
            }
            patches.standard_errors.extend(part.standard_errors.iter().flat_map(|&error| FLAT.map(|_| error)));
        }
        for (number, surface) in scene.surfaces().iter().enumerate().filter(|(number, _)| !has_mesh[*number]) {
            let exitance: Vec<f32> = scene.materials()[surface.material as usize].exitance.iter().map(|&e| e as f32).collect();
            let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
            patches.push_flat(&corners, number as u32, &exitance);
            patches.standard_errors.push(0.0);
        }
        patches
    }

    /// Of the elements of a solution, each with its own vertices and one radiosity.
    pub fn of_elements(solution: &'a Solution) -> Self {
        let mut patches = Self::none(solution.scene(), true);
        solution.for_each_leaf(|corners, surface, radiosity| patches.push_flat(corners, surface, radiosity));
        patches
    }

    /// Of light at the vertices of surfaces.
    pub fn of_vertices(scene: &'a Scene, light: &VertexLight) -> Self {
        let mut patches = Self::none(scene, false);
        for &surface in &light.surfaces {
            let first = patches.vertices.len() as u32;
            patches.vertices.extend(scene.surfaces()[surface as usize].polygon.vertices());
            patches.push(first..patches.vertices.len() as u32, surface);
        }
        patches.radiosity.extend(&light.radiosity);
        patches
    }

    fn push(&mut self, corners: impl IntoIterator<Item = u32>, surface: u32) {
        self.corners.extend(corners);
        self.ends.push((self.corners.len(), surface));
    }

    /// A patch of one radiosity.
    fn push_flat(&mut self, corners: &[[f64; 3]], surface: u32, radiosity: &[f32]) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        corners.iter().for_each(|_| self.radiosity.extend(radiosity));
        self.push(first..first + corners.len() as u32, surface);
    }

    /// The patches: the number of the surface, and indices of vertices.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &[u32])> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|&(end, _)| end));
        starts.zip(&self.ends).map(|(start, &(end, surface))| (surface, &self.corners[start..end]))
    }

    /// The radiosity at a vertex.
    pub fn radiosity_at(&self, vertex: u32) -> &[f32] {
        let channels = self.scene.channels();
        &self.radiosity[vertex as usize * channels..][..channels]
    }

    /// The irradiance at a vertex of a surface by channel, in W/m^2: what is reflected over the reflectance, 0 where nothing is reflected.
    pub fn irradiance_at(&self, vertex: u32, surface: u32) -> impl Iterator<Item = f32> {
        let material = &self.scene.materials()[self.scene.surfaces()[surface as usize].material as usize];
        self.radiosity_at(vertex)
            .iter()
            .zip(material.reflectance.iter().zip(&material.exitance))
            .map(|(&b, (&rho, &e))| if rho > 0.0 { ((f64::from(b) - e).max(0.0) / rho) as f32 } else { 0.0 })
    }
}
