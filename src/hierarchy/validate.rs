//! What later stages rely on, for a hierarchy that was read from a file.
//!
//! What a hierarchy repeats of the scene, and what follows from its vertices, is made anew and must be the same to the bit: so nothing of it
//! can be out of range.

use super::{Hierarchy, Node, NodeId};
use crate::geometry::{Aabb, Facet};
use crate::scene::{Scene, SurfaceId};

impl Hierarchy {
    /// Checks that ids are in range, parents come before children, children are consecutive and as many as splitting makes, every node is
    /// below the root, surfaces are those of the scene, and sizes are those of the vertices.
    ///
    /// # Errors
    /// Says what is wrong, for a hierarchy that was read from a file.
    pub fn validate(&self, scene: &Scene) -> Result<(), String> {
        self.validate_tree(scene)?;
        self.validate_polygons(scene)?;
        let bounds: Vec<Aabb> = scene.surfaces().iter().map(|surface| surface.polygon.bounds()).collect();
        for index in 0..self.cluster_count() {
            let (node, around, faces) = self.measured_cluster(NodeId(index as u32), &bounds);
            if node != self.nodes[index] || around != self.cluster_bounds[index] || faces != self.cluster_faces[index] {
                return Err(format!("node {index}: its size is not that of its surfaces"));
            }
        }
        Ok(())
    }

    /// Checks ids alone.
    fn validate_tree(&self, scene: &Scene) -> Result<(), String> {
        let (count, clusters, surfaces) = (self.nodes.len(), self.cluster_bounds.len(), scene.surfaces().len());
        let by_surface = self.normals.len() == surfaces && self.surface_nodes.len() == surfaces;
        if count == 0 || clusters == 0 || clusters > count || self.cluster_faces.len() != clusters || !by_surface {
            return Err("the hierarchy does not fit the scene".to_owned());
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
        let misplaced = |(surface, node): (usize, &NodeId)| {
            let own = self.nodes.get(node.index()).filter(|own| own.surface as usize == surface);
            own.is_none_or(|own| own.parent.index() >= clusters)
        };
        let above = self.nodes[clusters..].iter().filter(|node| node.parent.index() < clusters).count();
        if above != surfaces || self.surface_nodes.iter().enumerate().any(misplaced) {
            return Err("a surface has no node, or several".to_owned());
        }
        Ok(())
    }

    /// Checks the polygons of surfaces and elements; ids must be right.
    fn validate_polygons(&self, scene: &Scene) -> Result<(), String> {
        for (index, node) in self.nodes.iter().enumerate().skip(self.cluster_count()) {
            let fault = |what: &str| Err(format!("node {index}: {what}"));
            let end = (node.first_vertex as usize).saturating_add(node.vertex_count as usize);
            if node.vertex_count < 3 || end > self.vertices.len() {
                return fault("its vertices are out of range");
            }
            let vertices = &self.vertices[node.first_vertex as usize..end];
            let surface = scene.surface(SurfaceId(node.surface)).polygon.facet();
            let is_surface = self.surface_nodes[node.surface as usize].index() == index;
            if self.normals[node.surface as usize] != surface.normal || (is_surface && vertices != surface.vertices) {
                return fault("it is not the surface of the scene");
            }
            // An element lies on its surface, but for rounding.
            let reach = surface.radius * (1.0 + 1e-9);
            if !vertices.iter().all(|vertex| vertex.distance(surface.centroid) <= reach) {
                return fault("it is not on its surface");
            }
            let Facet { area, centroid, radius, .. } = Facet::of_part(vertices, surface.normal);
            if (area, centroid, radius) != (node.area, node.centroid, node.radius) || area <= 0.0 {
                return fault("its size is not that of its vertices");
            }
        }
        Ok(())
    }
}
