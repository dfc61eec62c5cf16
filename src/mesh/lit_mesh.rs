//! The lit mesh of a scene.

use std::borrow::Cow;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::fit;
use super::judged::MeshError;
use super::locate::Locator;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::scene::{DistinctChannels, Scene, SurfaceId};

/// Nodes for each element: two where many are joined, more on small surfaces.
const NODES: usize = 3;

/// What an element takes beside that while it is refined.
const REFINED: usize = 700;

/// Radiosity as a function on the surfaces of a scene, and how far it is off the values that are gathered at points: in the norm that was asked
/// for, over the surfaces that reflect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LitMesh {
    /// By surface; `None` where nothing is reflected.
    pub(super) surfaces: Vec<Option<SurfaceMesh>>,
    /// The root mean square of the differences, measured at random points that had no part in making it.
    pub measured: f64,
    /// The upper confidence limit of that; infinite where nothing can be said, which may be with other weights of light groups.
    pub claimed: f64,
    /// What it is off by energy, of all light and of each light group; empty where there are none.
    pub(crate) by_group: Vec<MeshError>,
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
    /// By element, the standard error of what is read there, in W/m^2: the root of the sum over channels of their squares, in the mean over the element.
    /// NaN where it is not known, as with other weights of light groups.
    pub standard_errors: Vec<f32>,
}

impl LitMesh {
    /// Elements in all.
    pub fn elements(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.triangles().len()).sum()
    }

    /// Nodes in all.
    pub fn nodes(&self) -> usize {
        self.surfaces.iter().flatten().map(|mesh| mesh.nodes().len()).sum()
    }

    /// Bytes that it takes to make one of so many elements: those of indirect light, as they stay, and those of all light, as they are refined:
    /// with what was found at nodes, and what is fitted to that and how.
    pub(crate) fn bytes_to_make(elements: usize, channels: usize) -> u64 {
        let kept = size_of::<[u32; 6]>() + NODES * (size_of::<DVec2>() + channels * size_of::<f32>());
        let fitted = 2 * channels * size_of::<[f32; 2]>() + fit::bytes_of_node(channels);
        (elements * (2 * kept + REFINED + NODES * fitted)) as u64
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        self.surfaces.iter().flatten().map(SurfaceMesh::memory_bytes).sum()
    }

    /// The surfaces that have elements, in their order, of the scene that this is a mesh of.
    pub fn parts<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = MeshPart<'a>> {
        let part = |(number, mesh): (usize, &'a Option<SurfaceMesh>)| {
            let (mesh, surface) = (mesh.as_ref()?, number as u32);
            let (plane, exitance) = (Plane::of(scene, SurfaceId(surface)), &scene.material_of(SurfaceId(surface)).exitance);
            let nodes = mesh.nodes().iter().map(|&at| plane.to_space(at).to_array()).collect();
            let of_node = |node: usize| mesh.reflected(node as u32, exitance.len()).iter().zip(exitance);
            let radiosity = (0..mesh.nodes().len()).flat_map(of_node).map(|(&reflected, &e)| reflected.max(0.0) + e as f32);
            let elements = mesh.triangles();
            let standard_errors = (0..elements.len()).map(|element| mesh.error(element)).collect();
            Some(MeshPart { surface, nodes, radiosity: radiosity.collect(), elements, standard_errors })
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

    /// Visits all elements: the number of the surface, the six nodes as in [`MeshPart::elements`], and the radiosity there by node and channel, in
    /// W/m^2.
    pub fn for_each_element(&self, scene: &Scene, mut visit: impl FnMut(u32, [[f64; 3]; 6], &[f32])) {
        let (channels, mut radiosity) = (scene.channels(), Vec::new());
        for part in self.parts(scene) {
            for element in part.elements {
                let of_node = |&node: &u32| &part.radiosity[node as usize * channels..][..channels];
                radiosity.clear();
                element.iter().for_each(|node| radiosity.extend_from_slice(of_node(node)));
                visit(part.surface, element.map(|node| part.nodes[node as usize]), &radiosity);
            }
        }
    }

    /// The same with other radiosities at the nodes: what those of each surface become, by node and channel.
    pub(crate) fn with_reflected(&self, mut of_surface: impl FnMut(usize, &[f32]) -> Vec<f32>) -> Self {
        let with = |(number, mesh): (usize, &Option<SurfaceMesh>)| {
            let mesh = mesh.as_ref()?;
            Some(mesh.with_reflected(of_surface(number, mesh.all_reflected())))
        };
        Self { surfaces: self.surfaces.iter().enumerate().map(with).collect(), ..self.clone() }
    }

    /// The same without standard errors.
    pub(crate) fn without_errors(self) -> Self {
        let without = |mesh: Option<SurfaceMesh>| mesh.map(|mesh| mesh.with_errors(Vec::new()));
        Self { surfaces: self.surfaces.into_iter().map(without).collect(), ..self }
    }

    /// The reflected radiosities at nodes, surface by surface, by node and channel.
    pub(crate) fn reflected(&self) -> impl Iterator<Item = &[f32]> {
        self.surfaces.iter().map(|mesh| mesh.as_ref().map_or(&[][..], SurfaceMesh::all_reflected))
    }

    /// The same for all channels, from those that were solved for.
    pub(crate) fn expanded(&self, channels: &DistinctChannels) -> Self {
        let expanded = |mesh: &Option<SurfaceMesh>| mesh.as_ref().map(|mesh| mesh.expanded(channels));
        let by_group = self.by_group.iter().map(|error| error.of_copies(channels.copies)).collect();
        Self { surfaces: self.surfaces.iter().map(expanded).collect(), by_group, ..*self }
    }
}

/// Where the elements of each surface lie: what it takes to find a point in them.
#[derive(Clone)]
pub(crate) struct MeshIndex(Vec<Option<(Plane, Locator)>>);

/// Reads a lit mesh at points.
pub(crate) struct MeshReader<'a> {
    scene: &'a Scene,
    meshes: &'a [Option<SurfaceMesh>],
    index: Cow<'a, MeshIndex>,
}

impl MeshIndex {
    pub fn new(scene: &Scene, mesh: &LitMesh) -> Self {
        Self::of(scene, &mesh.surfaces)
    }

    fn of(scene: &Scene, meshes: &[Option<SurfaceMesh>]) -> Self {
        let of_surface = |(number, mesh): (usize, &Option<SurfaceMesh>)| {
            let mesh = mesh.as_ref()?;
            Some((Plane::of(scene, SurfaceId(number as u32)), Locator::new(mesh)))
        };
        Self(meshes.iter().enumerate().map(of_surface).collect())
    }
}

impl<'a> MeshReader<'a> {
    /// Reads a lit mesh by its index.
    pub fn new(scene: &'a Scene, mesh: &'a LitMesh, index: Cow<'a, MeshIndex>) -> Self {
        Self { scene, meshes: &mesh.surfaces, index }
    }

    /// Reads meshes, which are given by surface.
    pub(super) fn of(scene: &'a Scene, meshes: &'a [Option<SurfaceMesh>]) -> Self {
        Self { scene, meshes, index: Cow::Owned(MeshIndex::of(scene, meshes)) }
    }

    /// The mesh of a surface and its plane, the triangle that a point lies in, and its barycentric coordinates there; `None` where there is no mesh.
    pub(super) fn find(&self, point: DVec3, surface: SurfaceId) -> Option<(&SurfaceMesh, Plane, usize, [f64; 3])> {
        let MeshIndex(index) = &*self.index;
        let (mesh, (plane, locator)) = (self.meshes[surface.index()].as_ref()?, index[surface.index()].as_ref()?);
        let (triangle, at) = locator.find(mesh, plane.to_plane(point))?;
        Some((mesh, *plane, triangle, at))
    }

    /// The reflected radiosity at a point of a surface, by channel; 0 where there is no mesh.
    pub fn reflected_at(&self, point: DVec3, surface: SurfaceId, reflected: &mut [f64]) {
        reflected.fill(0.0);
        if let Some((mesh, _, triangle, at)) = self.find(point, surface) {
            mesh.reflected_at(triangle, at, reflected);
            self.scene.clear_dark(reflected);
        }
    }

    /// The standard errors of what is read at a point of a surface, whose radiosity is given, by channel: of what is known of all channels together each
    /// has its part of the light. 0 where there is no mesh, and NaN where they are not known.
    pub fn standard_errors_at(&self, point: DVec3, surface: SurfaceId, radiosity: &[f64], errors: &mut [f64]) {
        let error = self.find(point, surface).map_or(0.0, |(mesh, _, triangle, _)| mesh.error(triangle));
        self.share_out(f64::from(error), surface, radiosity, errors);
    }

    /// Whether standard errors are known.
    pub fn knows_errors(&self) -> bool {
        self.meshes.iter().flatten().any(|mesh| !mesh.errors().is_empty())
    }

    /// Shares out a standard error of all channels together by the light that a surface reflects, whose radiosity is given.
    pub(super) fn share_out(&self, whole: f64, surface: SurfaceId, radiosity: &[f64], errors: &mut [f64]) {
        let exitance = &self.scene.material_of(surface).exitance;
        errors.iter_mut().zip(radiosity.iter().zip(exitance)).for_each(|(error, (b, e))| *error = (b - e).max(0.0));
        let light = errors.iter().map(|reflected| reflected.powi(2)).sum::<f64>().sqrt();
        let alike = 1.0 / (errors.len() as f64).sqrt();
        errors.iter_mut().for_each(|error| *error = whole * if light > 0.0 { *error / light } else { alike });
    }

    /// Makes the radiosity of a surface of what elements say that it reflects, by channel.
    pub(super) fn complete(&self, surface: SurfaceId, reflected: &mut [f64]) {
        self.scene.clear_dark(reflected);
        reflected.iter_mut().zip(&self.scene.material_of(surface).exitance).for_each(|(b, e)| *b += e);
    }

    /// The radiosity at a point of a surface, by channel.
    pub fn radiosity_at(&self, point: DVec3, surface: SurfaceId, radiosity: &mut [f64]) {
        self.reflected_at(point, surface, radiosity);
        self.complete(surface, radiosity);
    }
}
