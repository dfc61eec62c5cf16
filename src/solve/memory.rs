//! The ledger of memory: what a solve takes, by counts alone, so that the same budget allows the same on every machine.
//!
//! Sizes are those of what is kept, by type and number; the constants stand for what cannot be counted. The sum is meant to lie above what is
//! resident, by less than twice where scenes are large. Three things take turns, on top of what stays: sweeps, refinement, and solving for cells.

use crate::cells::CellRadiosities;
use crate::error::{ErrorSamples, REPLICATES};
use crate::geometry::Lobes;
use crate::hierarchy::Hierarchy;
use crate::links::LinkSet;
use crate::paths::LightPaths;
use crate::scene::{Scene, Surface};
use crate::visibility::{Backend, SurfaceBoxes};

/// The program, its libraries, and what threads reuse: 14 to 20 MB are resident when a dozen surfaces are solved.
const PROGRAM: u64 = 24_000_000;

/// What an allocation takes beside what was asked for: the header of the allocator, and rounding to 16 bytes.
const ALLOCATION: usize = 24;

/// What reading leaves behind in pieces too small to be given back, for each face. Measured: 160 bytes on 400 thousand triangles.
const READ: usize = 176;

/// Clusters for each surface, before the hierarchy is built: 0.55 to 0.71 in rooms and kitchens, 1 at most where each has a surface of its own.
const CLUSTERS: f64 = 0.75;

/// What each link and each pair that waits takes while refinement works: as a part of the solution, with its receiver, and as a pair of two waves
/// with what becomes of it; and once more with its receiver, for the holes that lists leave in the heap when they grow. Measured in furnished rooms:
/// with these 1.4 times as much as without.
pub(super) const LINK_AT_WORK: usize = 96;

/// What is never less: room for a thousand links.
const FIRST_LINKS: u64 = 1000 * LINK_AT_WORK as u64;

/// Numbers of a node by channel that stay (radiosity; emitted light of the closure; where there are lights, one more: what they bring), and that a sweep or a correction takes beside them
/// (irradiance, emission, reflected radiosity, values gathered anew, their change and its irradiance).
const KEPT_NUMBERS: usize = 2;
const SWEEP_NUMBERS: usize = 6;

/// Lobes of a cluster, by channel and once more: those of its radiosity, and those of two gathers.
const KEPT_LOBES: usize = 1;
const SWEEP_LOBES: usize = 2;

/// What there is between stages.
#[derive(Clone, Copy)]
pub(super) struct Holdings<'a> {
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    pub channels: usize,
}

/// Cells that are to be solved for.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellDemand {
    pub cells: usize,
    pub channels: usize,
    /// The most paths from each.
    pub rays: u32,
    /// Whether values end in them, beside replicates.
    pub are_of_values: bool,
    /// Points that judge values by them.
    pub error_points: usize,
}

impl CellDemand {
    /// What solving for them takes while it works, with what is judged by them; those that were known stay meanwhile.
    pub fn bytes(&self, scene: &Scene) -> u64 {
        let Self { cells, channels, rays, are_of_values, error_points } = *self;
        let solutions = (REPLICATES + usize::from(are_of_values)) as u64;
        let kept = solutions * CellRadiosities::bytes_of(cells, channels) + LightPaths::bytes_of(scene, cells);
        let samples = error_points as u64 * ErrorSamples::bytes_of_point(channels);
        2 * kept + samples + CellRadiosities::bytes_to_solve(cells, rays, channels)
    }
}

/// What a solve may take, in bytes, and what it takes whatever it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct MemoryLedger {
    /// Infinite where there is no budget.
    budget: u64,
    /// The program, the scene, what answers visibility, and boxes of surfaces.
    fixed: u64,
    has_lights: bool,
}

/// The least memory that a solve of a scene takes, in bytes, by the ledger: all that is there before the first link, and room for some.
pub(crate) fn least_bytes(scene: &Scene, backend: Backend) -> u64 {
    let surfaces = scene.surfaces().len();
    let clusters = (CLUSTERS * surfaces as f64) as usize;
    let ledger = MemoryLedger::new(scene, backend, None);
    let nodes: u64 = ledger.node_bytes(surfaces + clusters, clusters, scene.channels_with_groups()).iter().sum();
    ledger.fixed + Hierarchy::bytes_of(surfaces, clusters) + nodes + FIRST_LINKS
}

impl MemoryLedger {
    /// Of a scene; where it is solved in other channels, both have the same surfaces in memory.
    pub fn new(scene: &Scene, backend: Backend, budget: Option<u64>) -> Self {
        let boxes = (scene.surfaces().len() * SurfaceBoxes::BYTES_OF_SURFACE) as u64;
        let fixed = PROGRAM + scene_bytes(scene) + sheets(scene) * (READ as u64 + bytes_of_triangle(backend)) + boxes;
        Self { budget: budget.unwrap_or(u64::MAX), fixed, has_lights: !scene.lights().is_empty() }
    }

    /// What nodes take, and what sweeps take beside them, of which so many are clusters.
    fn node_bytes(&self, nodes: usize, clusters: usize, channels: usize) -> [u64; 2] {
        let numbers = |count: usize| count * channels * size_of::<f64>();
        let lobes = |count: usize| count * (1 + channels) * size_of::<Lobes>();
        // Exposure, the beginnings of links, factors of the closure.
        let once = 4 * size_of::<f32>() + size_of::<f64>();
        let kept = nodes * (numbers(KEPT_NUMBERS + usize::from(self.has_lights)) + once) + clusters * lobes(KEPT_LOBES);
        [kept, nodes * numbers(SWEEP_NUMBERS) + clusters * lobes(SWEEP_LOBES)].map(|bytes| bytes as u64)
    }

    /// Bytes for each new node while links are refined.
    pub fn bytes_of_new_node(&self, channels: usize) -> u64 {
        self.node_bytes(1, 0, channels).iter().sum()
    }

    /// What there is while links are refined beside nodes and links.
    pub fn beside_refinement(&self, of: Holdings<'_>) -> u64 {
        let of_clusters: u64 = self.node_bytes(0, of.hierarchy.cluster_count(), of.channels).iter().sum();
        self.fixed + of_clusters
    }

    /// What is left for nodes and links while others take `reserved`; infinite without a budget.
    pub fn left_for_refinement(&self, of: Holdings<'_>, reserved: u64) -> u64 {
        if self.budget == u64::MAX {
            u64::MAX
        } else {
            self.budget.saturating_sub(self.beside_refinement(of)).saturating_sub(reserved)
        }
    }

    /// What stays between stages.
    pub fn kept(&self, of: Holdings<'_>) -> u64 {
        let [kept, _] = self.node_bytes(of.hierarchy.len(), of.hierarchy.cluster_count(), of.channels);
        self.fixed + of.hierarchy.memory_bytes() + kept + of.links.memory_bytes()
    }

    /// What stays, and what a sweep takes beside it.
    pub fn with_sweeps(&self, of: Holdings<'_>) -> u64 {
        self.kept(of) + self.node_bytes(of.hierarchy.len(), of.hierarchy.cluster_count(), of.channels)[1]
    }

    /// Whether so much is within the budget.
    pub fn allows(&self, bytes: u64) -> bool {
        bytes <= self.budget
    }
}

/// Faces of a scene, those with two sides once.
fn sheets(scene: &Scene) -> u64 {
    let is_first = |(index, surface): &(usize, &Surface)| surface.twin.is_none_or(|twin| twin.index() > *index);
    scene.surfaces().iter().enumerate().filter(is_first).map(|(_, surface)| surface.polygon.facet().vertices.len() as u64 - 2).sum()
}

fn scene_bytes(scene: &Scene) -> u64 {
    let of_surface = |surface: &Surface| size_of::<Surface>() + size_of_val(surface.polygon.facet().vertices) + ALLOCATION;
    scene.surfaces().iter().map(|surface| of_surface(surface) as u64).sum()
}

/// What a backend takes for a triangle while it is built, with the mesh that it is built from. Measured on 400 thousand triangles: Embree 3.13 215
/// bytes, obvhs 370 while it builds, beside the mesh.
fn bytes_of_triangle(backend: Backend) -> u64 {
    const MESH: u64 = 3 * size_of::<[f64; 3]>() as u64 + size_of::<[u32; 5]>() as u64;
    let is_embree = match backend {
        Backend::Auto => Backend::Embree.is_built(),
        Backend::Embree | Backend::Embree4Sys => true,
        Backend::Obvhs | Backend::ObvhsBvh2 | Backend::BruteForce => false,
    };
    MESH + if is_embree { 240 } else { 400 }
}
