//! What later stages rely on, for a hierarchy that was read from a file: what it tells is checked, and what follows from that and from the scene is
//! made anew.

use rayon::prelude::*;

use super::{Hierarchy, Node, NodeId};
use crate::geometry::{Aabb, Facet, Lobes};
use crate::scene::Scene;

impl Hierarchy {
    /// Makes anew what is not stored. Checks that ids are in range, parents come before children, children are consecutive and as many as splitting
    /// makes, every node is below the root, and surfaces are those of the scene.
    ///
    /// # Errors
    /// Says what is wrong, for a hierarchy that was read from a file.
    pub fn restore(&mut self, scene: &Scene) -> Result<(), String> {
        let clusters = self.nodes.iter().take_while(|node| node.surface == Node::NO_SURFACE).count();
        self.cluster_bounds = vec![Aabb::EMPTY; clusters];
        self.cluster_faces = vec![Lobes::default(); clusters];
        self.surfaces = scene.shared_surfaces();
        self.validate_tree(scene)?;
        self.find_surfaces(scene)?;
        self.measure_polygons()?;
        let bounds: Vec<Aabb> = scene.surfaces().par_iter().map(|surface| surface.polygon.bounds()).collect();
        self.measure_clusters(&bounds);
        Ok(())
    }

    /// Checks ids alone.
    fn validate_tree(&self, scene: &Scene) -> Result<(), String> {
        let (count, clusters, surfaces) = (self.nodes.len(), self.cluster_count(), scene.surfaces().len());
        if clusters == 0 {
            return Err("the hierarchy has no root".to_owned());
        }
        let mut children = 0;
        for (index, node) in self.nodes.iter().enumerate() {
            let fault = |what: &str| Err(format!("node {index}: {what}"));
            let is_cluster = index < clusters;
            if is_cluster != (node.surface == Node::NO_SURFACE) || (!is_cluster && node.surface as usize >= surfaces) {
                return fault("its surface does not exist");
            }
            let pieces = if is_cluster { Self::LEAF_SURFACES as u32 } else { node.vertex_count.max(4) };
            if node.child_count > pieces || (is_cluster && node.child_count == 0) {
                return fault("it has too many children, or too few");
            }
            let first = node.first_child.index();
            let end = first.saturating_add(node.child_count as usize);
            if node.child_count > 0 && (first <= index || end > count) {
                return fault("its children are out of range");
            }
            let below = if node.child_count > 0 { &self.nodes[first..end] } else { &[] };
            if below.iter().any(|child| child.parent.index() != index || (!is_cluster && child.surface != node.surface)) {
                return fault("its children belong to another node");
            }
            children += below.len();
        }
        // Each node has one parent, so that each is somebody's child if there are as many children as nodes below the root.
        if children != count - 1 || self.nodes[0].parent != NodeId::ROOT {
            return Err("a node is not below the root".to_owned());
        }
        Ok(())
    }

    /// Finds the node of each surface; ids must be right.
    fn find_surfaces(&mut self, scene: &Scene) -> Result<(), String> {
        let clusters = self.cluster_count();
        let (mut found, surfaces) = (0, scene.surfaces().len());
        self.surface_nodes = vec![NodeId::ROOT; surfaces];
        for (node, index) in self.nodes.iter().zip(0..).skip(clusters).filter(|(node, _)| node.parent.index() < clusters) {
            self.surface_nodes[node.surface as usize] = NodeId(index);
            found += 1;
        }
        if found != surfaces || self.surface_nodes.contains(&NodeId::ROOT) {
            return Err("a surface has no node, or several".to_owned());
        }
        Ok(())
    }

    /// Measures surfaces and elements, and checks that they are where they must be; ids must be right.
    fn measure_polygons(&mut self) -> Result<(), String> {
        let clusters = self.cluster_count();
        let Self { nodes, vertices, surfaces, .. } = self;
        nodes.par_iter_mut().enumerate().skip(clusters).try_for_each(|(index, node)| {
            let fault = |what: &str| Err(format!("node {index}: {what}"));
            let surface = surfaces[node.surface as usize].polygon.facet();
            let is_whole = node.parent.index() < clusters;
            if is_whole && (node.first_vertex, node.vertex_count) != (0, surface.vertices.len() as u32) {
                return fault("it is not the surface of the scene");
            }
            let end = (node.first_vertex as usize).saturating_add(node.vertex_count as usize);
            if !is_whole && (node.vertex_count < 3 || end > vertices.len()) {
                return fault("its vertices are out of range");
            }
            let vertices = if is_whole { surface.vertices } else { &vertices[node.first_vertex as usize..end] };
            // An element lies on its surface, but for rounding.
            let reach = surface.radius * (1.0 + 1e-9);
            if !vertices.iter().all(|vertex| vertex.distance(surface.centroid) <= reach) {
                return fault("it is not on its surface");
            }
            Facet { area: node.area, centroid: node.centroid, radius: node.radius, .. } = Facet::of_part(vertices, surface.normal);
            if node.area > 0.0 { Ok(()) } else { fault("it has no area") }
        })
    }
}
