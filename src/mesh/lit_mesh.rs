//! The lit mesh of a scene.

use glam::DVec3;

use super::locate::Locator;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::scene::{Scene, SurfaceId};

/// Radiosity as a function on the surfaces of a scene, and how far it is off the values that are gathered at points: in the local norm, over the
/// surfaces that reflect.
#[derive(Clone, Debug, PartialEq)]
pub struct LitMesh {
    /// By surface; `None` where nothing is reflected.
    pub(super) surfaces: Vec<Option<SurfaceMesh>>,
    /// The root mean square of the differences, measured at random points that had no part in making it.
    pub measured: f64,
    /// The upper confidence limit of that.
    pub claimed: f64,
}

/// The elements on one surface.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPart<'a> {
    /// The number of the surface.
    pub surface: u32,
    /// Nodes, in metres.
    pub nodes: Vec<[f64; 3]>,
    /// Radiosity by node and channel, in W/m^2, not negative.
    pub radiosity: Vec<f32>,
    /// Six nodes of each element: three corners, counter-clockwise from the front, then the middles of the edges from each corner to the next.
    pub elements: &'a [[u32; 6]],
}

impl LitMesh {
    /// The surfaces that have elements, in their order, of the scene that this is a mesh of.
    pub fn parts<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = MeshPart<'a>> {
        let part = |(number, mesh): (usize, &'a Option<SurfaceMesh>)| {
            let (mesh, surface) = (mesh.as_ref()?, number as u32);
            let (plane, exitance) = (Plane::of(scene, SurfaceId(surface)), &scene.material_of(SurfaceId(surface)).exitance);
            let nodes = mesh.nodes().iter().map(|&at| plane.to_space(at).to_array()).collect();
            let of_node = |node: usize| mesh.reflected(node as u32, exitance.len()).iter().zip(exitance);
            let radiosity = (0..mesh.nodes().len()).flat_map(of_node).map(|(&reflected, &e)| reflected.max(0.0) + e as f32);
            Some(MeshPart { surface, nodes, radiosity: radiosity.collect(), elements: mesh.triangles() })
        };
        self.surfaces.iter().enumerate().filter_map(part)
    }

    /// The nodes of all elements, part by part, where the nodes of all parts are numbered through.
    pub fn element_nodes(&self) -> impl Iterator<Item = [u32; 6]> {
        let with_first = self.surfaces.iter().flatten().scan(0, |next, mesh| {
            let first = *next;
            *next += mesh.nodes().len() as u32;
            Some((first, mesh))
        });
        with_first.flat_map(|(first, mesh)| mesh.triangles().iter().map(move |nodes| nodes.map(|node| first + node)))
    }

    /// Elements in all.
    pub fn elements(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.triangles().len()).sum()
    }

    /// Nodes in all.
    pub fn nodes(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.nodes().len()).sum()
    }

    /// Visits all elements: the number of the surface, the six nodes (three corners, counter-clockwise from the front, then the middles of the edges
    /// from each) and the radiosity there by node and channel, in W/m^2.
    pub fn for_each_element(&self, scene: &Scene, mut visit: impl FnMut(u32, [[f64; 3]; 6], &[f32])) {
        let mut radiosity = Vec::new();
        for (number, mesh) in self.surfaces.iter().enumerate() {
            let (Some(mesh), surface) = (mesh, SurfaceId(number as u32)) else { continue };
            let (plane, exitance) = (Plane::of(scene, surface), &scene.material_of(surface).exitance);
            for nodes in mesh.triangles() {
                radiosity.clear();
                for &node in nodes {
                    let reflected = mesh.reflected(node, exitance.len());
                    radiosity.extend(reflected.iter().zip(exitance).map(|(&reflected, &e)| reflected.max(0.0) + e as f32));
                }
                visit(number as u32, nodes.map(|node| plane.to_space(mesh.nodes()[node as usize]).to_array()), &radiosity);
            }
        }
    }
}

/// Reads a lit mesh at points.
pub(crate) struct MeshReader<'a> {
    scene: &'a Scene,
    by_surface: Vec<Option<(&'a SurfaceMesh, Plane, Locator)>>,
}

impl<'a> MeshReader<'a> {
    pub fn new(scene: &'a Scene, mesh: &'a LitMesh) -> Self {
        Self::of(scene, &mesh.surfaces)
    }

    /// Reads meshes, which are given by surface.
    pub(super) fn of(scene: &'a Scene, meshes: &'a [Option<SurfaceMesh>]) -> Self {
        let reader = |(number, mesh): (usize, &'a Option<SurfaceMesh>)| {
            let mesh = mesh.as_ref()?;
            Some((mesh, Plane::of(scene, SurfaceId(number as u32)), Locator::new(mesh)))
        };
        Self { scene, by_surface: meshes.iter().enumerate().map(reader).collect() }
    }

    /// The reflected radiosity at a point of a surface, by channel; 0 where there is no mesh.
    pub fn reflected_at(&self, point: DVec3, surface: SurfaceId, reflected: &mut [f64]) {
        reflected.fill(0.0);
        let Some((mesh, plane, locator)) = &self.by_surface[surface.index()] else { return };
        if let Some((triangle, at)) = locator.find(mesh, plane.to_plane(point)) {
            mesh.reflected_at(triangle, at, reflected);
        }
    }

    /// The radiosity at a point of a surface, by channel.
    pub fn radiosity_at(&self, point: DVec3, surface: SurfaceId, radiosity: &mut [f64]) {
        self.reflected_at(point, surface, radiosity);
        radiosity.iter_mut().zip(&self.scene.material_of(surface).exitance).for_each(|(b, e)| *b += e);
    }
}
