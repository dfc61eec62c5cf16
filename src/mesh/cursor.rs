//! Reads of a lit mesh one after the other, as along a row of pixels: the next point lies mostly in the element that was read last.

use glam::{DVec2, DVec3};

use super::element;
use super::lit_mesh::MeshReader;
use super::plane::Plane;
use crate::scene::SurfaceId;

/// Reads a lit mesh at points of which neighbours follow each other.
pub(crate) struct MeshCursor<'a> {
    reader: &'a MeshReader<'a>,
    last: Option<Read>,
    /// Reflected radiosities at the nodes of that element, by channel.
    nodes: Vec<[f64; 6]>,
}

/// The element that was read last.
struct Read {
    surface: SurfaceId,
    plane: Plane,
    corners: [DVec2; 3],
    /// Its standard error, all channels together.
    error: f64,
}

impl<'a> MeshCursor<'a> {
    pub fn new(reader: &'a MeshReader<'a>) -> Self {
        Self { reader, last: None, nodes: Vec::new() }
    }

    /// The radiosity at a point of a surface, by channel, in W/m^2: what the reader says there, but where elements meet.
    pub fn radiosity_at(&mut self, point: DVec3, surface: SurfaceId, radiosity: &mut [f64]) {
        let weights =
            self.coordinates(point, surface).or_else(|| self.move_to(point, surface, radiosity.len())).map(element::weights);
        for (channel, sum) in radiosity.iter_mut().enumerate() {
            *sum = weights.map_or(0.0, |weights| element::value(self.nodes[channel], weights));
        }
        self.reader.complete(surface, radiosity);
    }

    /// The radiosity at a point of a surface, and its standard error, each by channel, in W/m^2.
    pub fn radiosity_and_error_at(&mut self, point: DVec3, surface: SurfaceId, radiosity: &mut [f64], errors: &mut [f64]) {
        self.radiosity_at(point, surface, radiosity);
        let error = self.last.as_ref().filter(|last| last.surface == surface).map_or(0.0, |last| last.error);
        self.reader.share_out(error, surface, radiosity, errors);
    }

    /// Barycentric coordinates of a point in the element that was read last, if it lies in that.
    fn coordinates(&self, point: DVec3, surface: SurfaceId) -> Option<[f64; 3]> {
        let Read { plane, corners, .. } = self.last.as_ref().filter(|last| last.surface == surface)?;
        let at = element::barycentric(*corners, plane.to_plane(point));
        at.iter().all(|&l| l >= 0.0).then_some(at)
    }

    /// Goes to the element that a point lies in, and returns its coordinates there; `None` where there is no mesh.
    fn move_to(&mut self, point: DVec3, surface: SurfaceId, channels: usize) -> Option<[f64; 3]> {
        self.last = None;
        let (mesh, plane, triangle, at) = self.reader.find(point, surface)?;
        self.last = Some(Read { surface, plane, corners: mesh.corners(triangle), error: f64::from(mesh.error(triangle)) });
        self.nodes.clear();
        self.nodes.extend((0..channels).map(|channel| mesh.reflected_in(triangle, channel, channels)));
        Some(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polygon, sampling};
    use crate::mesh::bends::Bends;
    use crate::mesh::surface_mesh::SurfaceMesh;
    use crate::mesh::triangulation::triangulate;
    use crate::scene::{Material, Scene, Sides};

    #[test]
    fn along_rows_it_reads_what_the_reader_reads() {
        let square = |z: f64| Polygon::new(&[[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5; 2], exitance: vec![0.0, 0.25] };
        let faces = (0..3).map(|z| (square(f64::from(z)), 0, 0)).collect();
        let scene = Scene::new(2, vec![material], faces, Sides::Front).unwrap();

        // Two surfaces with light that has bends, and one that has no mesh.
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| DVec2::new(x, y));
        let mesh_of = |seed: u64| {
            let mut triangles = triangulate(&corners, &[], 0.02, 0.0);
            (0..100).for_each(|step| triangles.bisect(step * 7 % triangles.triangles.len() as u32, &mut Bends::unknown()));
            let random = |number: u64| (sampling::unit(sampling::hash(seed, number)) - 0.1) as f32;
            let reflected = (0..2 * triangles.nodes.len() as u64).map(random).collect();
            let errors = (0..triangles.triangles.len() as u64).map(|number| random(number + 7).abs()).collect();
            Some(SurfaceMesh::new(&triangles, reflected).with_errors(errors))
        };
        let meshes = [mesh_of(1), mesh_of(2), None];
        let reader = MeshReader::of(&scene, &meshes);

        let mut cursor = MeshCursor::new(&reader);
        let (mut read, mut expected, mut errors, mut expected_errors, mut stayed) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2], 0);
        for number in 0..9000_u32 {
            let [row, column] = [number / 300, number % 300].map(f64::from);
            let (surface, height) = (SurfaceId(number / 100 % 3), f64::from(number / 100 % 3));
            let point = DVec3::new((column + 0.37) / 300.0, (row + 0.41) / 30.0, height);
            stayed += u32::from(cursor.coordinates(point, surface).is_some());
            cursor.radiosity_and_error_at(point, surface, &mut read, &mut errors);
            reader.radiosity_at(point, surface, &mut expected);
            reader.standard_errors_at(point, surface, &expected, &mut expected_errors);
            let pairs = read.iter().chain(&errors).zip(expected.iter().chain(&expected_errors));
            pairs.for_each(|(read, expected)| assert!((read - expected).abs() < 1e-12, "{point}: {read} for {expected}"));
        }
        // Most of the 6000 that lie on meshes are in the element before.
        assert!((4000..6000).contains(&stayed), "{stayed}");
    }
}
