//! Bounds over elements that were made for them, and what they say about the nodes of another hierarchy over the same scene.

use serde::{Deserialize, Serialize};

use super::system::Iterate;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// A hierarchy with lower and upper radiosities of its nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ElementBounds {
    hierarchy: Hierarchy,
    channels: usize,
    /// By node and channel, in W/m^2.
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl ElementBounds {
    pub fn new(hierarchy: Hierarchy, channels: usize, lower: Vec<f64>, upper: Vec<f64>) -> Self {
        Self { hierarchy, channels, lower, upper }
    }

    /// The bounds alone.
    pub fn iterate(&self) -> Iterate {
        Iterate { lower: self.lower.clone(), upper: self.upper.clone() }
    }

    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The lower radiosities of a node, by channel.
    pub fn lower(&self, node: NodeId) -> &[f64] {
        &self.lower[node.index() * self.channels..][..self.channels]
    }

    /// The upper ones.
    pub fn upper(&self, node: NodeId) -> &[f64] {
        &self.upper[node.index() * self.channels..][..self.channels]
    }

    /// How far apart the bounds of leaves below each node are in the mean over their area, by node and channel.
    pub fn mean_widths(&self) -> Vec<f64> {
        let hierarchy = &self.hierarchy;
        let mut widths = vec![0.0; self.lower.len()];
        for node in hierarchy.ids().rev() {
            let at = node.index() * self.channels;
            for channel in 0..self.channels {
                if hierarchy.is_leaf(node) {
                    widths[at + channel] = self.upper[at + channel] - self.lower[at + channel];
                }
                if let Some(parent) = hierarchy.parent(node) {
                    let share = hierarchy.area(node) / hierarchy.area(parent);
                    widths[parent.index() * self.channels + channel] += share * widths[at + channel];
                }
            }
        }
        widths
    }

    /// Lower and upper radiosities of the nodes of another hierarchy over the same scene. Both split polygons in the same way, so of two
    /// nodes that overlap one is a part of the other: a part has the bounds of the whole, a whole the extremes of its parts.
    pub fn of_nodes(&self, hierarchy: &Hierarchy) -> [Vec<f64>; 2] {
        let mut found = [vec![f64::INFINITY; hierarchy.len() * self.channels], vec![0.0; hierarchy.len() * self.channels]];
        let surfaces = hierarchy.ids().filter_map(|node| Some((node, hierarchy.surface_of(node)?)));
        let mut same: Vec<(NodeId, NodeId)> = surfaces
            .filter(|&(node, surface)| hierarchy.node_of(surface) == node)
            .map(|(node, surface)| (node, self.hierarchy.node_of(surface)))
            .collect();
        while let Some((node, own)) = same.pop() {
            for (values, own_values) in found.iter_mut().zip([self.lower(own), self.upper(own)]) {
                values[node.index() * self.channels..][..self.channels].copy_from_slice(own_values);
            }
            let children = hierarchy.children(node);
            if self.hierarchy.is_leaf(own) {
                same.extend(children.map(|child| (child, own)));
            } else {
                same.extend(children.zip(self.hierarchy.children(own)));
            }
        }

        // Clusters have the extremes of what is below them.
        for node in hierarchy.ids().rev() {
            let Some(parent) = hierarchy.parent(node).filter(|&parent| hierarchy.is_cluster(parent)) else { continue };
            for channel in 0..self.channels {
                let (at, above) = (node.index() * self.channels + channel, parent.index() * self.channels + channel);
                found[0][above] = found[0][above].min(found[0][at]);
                found[1][above] = found[1][above].max(found[1][at]);
            }
        }
        found
    }

    /// Makes anew what is not stored, and checks what was read from a file, whoever wrote it.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn restore(&mut self, scene: &Scene) -> Result<(), String> {
        self.hierarchy.restore(scene)?;
        let fits = |values: &[f64]| values.len() == self.hierarchy.len() * scene.channels();
        if self.channels != scene.channels() || !fits(&self.lower) || !fits(&self.upper) {
            return Err("the bounds do not fit their elements".to_owned());
        }
        are_bounds(&self.lower, &self.upper)
    }

    /// The leaf of a surface that a point lies on.
    pub fn leaf_at(&self, surface: SurfaceId, point: glam::DVec3) -> NodeId {
        self.hierarchy.leaf_at(surface, point)
    }
}

/// Whether these can be lower and upper radiosities.
///
/// # Errors
/// Says that they cannot.
pub(super) fn are_bounds(lower: &[f64], upper: &[f64]) -> Result<(), String> {
    let are_in_order = lower.iter().zip(upper).all(|(&lower, &upper)| 0.0 <= lower && lower <= upper && upper.is_finite());
    if are_in_order { Ok(()) } else { Err("bounds are negative, not finite or in the wrong order".to_owned()) }
}
