//! What is in each cluster that can block light: polygons, how many, and how large they are.

use std::ops::Range;

use glam::DVec3;

use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// The occluding surfaces of all clusters, by cluster. Of a sheet with two sides only the first counts.
pub(super) struct Contents {
    /// Depth first, so that those of a cluster are in a row.
    surfaces: Vec<NodeId>,
    clusters: Vec<Content>,
}

/// Those of one cluster.
#[derive(Clone, Debug, Default)]
struct Content {
    surfaces: Range<u32>,
    area: f64,
    area_sq: f64,
    largest: f64,
}

impl Contents {
    pub fn of(scene: &Scene, hierarchy: &Hierarchy) -> Self {
        let mut contents = Self { surfaces: Vec::new(), clusters: vec![Content::default(); hierarchy.cluster_count()] };
        contents.add(scene, hierarchy, NodeId::ROOT);
        contents
    }

    fn add(&mut self, scene: &Scene, hierarchy: &Hierarchy, cluster: NodeId) {
        let (start, mut content) = (self.surfaces.len() as u32, Content::default());
        for child in hierarchy.children(cluster) {
            if hierarchy.is_cluster(child) {
                self.add(scene, hierarchy, child);
                let Content { area, area_sq, largest, .. } = self.clusters[child.index()];
                content.include(area, area_sq, largest);
            } else if is_first_side(scene, hierarchy, child) {
                self.surfaces.push(child);
                let area = hierarchy.area(child);
                content.include(area, area * area, area);
            }
        }
        content.surfaces = start..self.surfaces.len() as u32;
        self.clusters[cluster.index()] = content;
    }

    /// How many surfaces of a cluster can block light.
    pub fn count(&self, cluster: NodeId) -> usize {
        self.clusters[cluster.index()].surfaces.len()
    }

    /// The area of a surface in a cluster, mean over the area: the patch that a line is blocked or not blocked together with, in m^2.
    pub fn patch(&self, cluster: NodeId) -> f64 {
        let Content { area, area_sq, .. } = self.clusters[cluster.index()];
        if area > 0.0 { area_sq / area } else { 0.0 }
    }

    /// The area of the largest surface in a cluster, in m^2.
    pub fn largest(&self, cluster: NodeId) -> f64 {
        self.clusters[cluster.index()].largest
    }

    /// The polygons of a cluster.
    pub fn polygons<'h>(&'h self, hierarchy: &'h Hierarchy, cluster: NodeId) -> impl Iterator<Item = &'h [DVec3]> {
        let Range { start, end } = self.clusters[cluster.index()].surfaces;
        self.surfaces[start as usize..end as usize].iter().map(|&surface| hierarchy.facet(surface).vertices)
    }

    /// Bytes of the memory that it takes.
    pub fn memory_bytes(&self) -> u64 {
        (size_of_val(&self.surfaces[..]) + size_of_val(&self.clusters[..])) as u64
    }
}

impl Content {
    /// Adds surfaces with this sum of areas, of their squares, and the largest.
    fn include(&mut self, area: f64, area_sq: f64, largest: f64) {
        self.area += area;
        self.area_sq += area_sq;
        self.largest = self.largest.max(largest);
    }
}

/// Whether a surface is not the second side of a sheet, by which the first is in the way already.
pub(super) fn is_first_side(scene: &Scene, hierarchy: &Hierarchy, surface: NodeId) -> bool {
    let surface = hierarchy.node(surface).surface;
    scene.surface(SurfaceId(surface)).twin.is_none_or(|SurfaceId(twin)| twin > surface)
}
