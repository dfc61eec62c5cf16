//! The answer.

use serde::{Deserialize, Serialize};

use super::{Gather, InitialImportance, SolveOptions};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::reconstruct::{
    Effort, HemisphereGather, Lattice, LightPaths, LinkGather, Reconstruction, Resolution, Resolved, Way, reflectors,
};
use crate::scene::Scene;
use crate::sweep::{Adjoint, Closure, Exposure, Importance, Radiosity};
use crate::transmittance::Rays;

/// The answer: scene, hierarchy, links, radiosities and the options they were found with.
///
/// Deserializing trusts nothing: [`Solution::validate`] must pass before it is used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    pub(crate) scene: Scene,
    pub(crate) options: SolveOptions,
    pub(crate) hierarchy: Hierarchy,
    pub(crate) links: LinkSet,
    pub(crate) exposure: Exposure,
    pub(crate) radiosity: Radiosity,
    pub(crate) point_rays: u32,
    /// How finely radiosities are resolved, and these, where values are gathered over the hemisphere.
    pub(crate) resolution: Resolution,
    pub(crate) resolved: Option<Resolved>,
}

impl Solution {
    /// The scene that was solved.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The options it was solved with.
    pub fn options(&self) -> &SolveOptions {
        &self.options
    }

    /// Clusters, surfaces and elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The links between them.
    pub fn links(&self) -> &LinkSet {
        &self.links
    }

    /// The radiosity of every node.
    pub fn radiosity(&self) -> &Radiosity {
        &self.radiosity
    }

    /// Visibility rays that a value at a point takes.
    pub fn point_rays(&self) -> u32 {
        self.point_rays
    }

    /// How values at points are gathered: over links or over the hemisphere.
    pub fn gather(&self) -> Gather {
        if self.resolved.is_some() { Gather::Hemisphere } else { Gather::Links }
    }

    /// Importance over the links, as the solver swept radiosities over them.
    pub(crate) fn importance(&self, initial: &InitialImportance) -> Importance {
        let Self { scene, hierarchy, links, exposure, radiosity, .. } = self;
        let clusters = links.iter().any(|(receiver, link)| hierarchy.is_cluster(receiver) || hierarchy.is_cluster(link.source));
        let closure = Closure::needed(scene, hierarchy, links, exposure, clusters);
        let initial = initial.of_leaves(hierarchy, exposure, scene.channels());
        Adjoint { scene, hierarchy, links, exposure, closure: closure.as_ref(), radiosity }.importance(&initial)
    }

    /// The light paths that the values at points may take.
    pub(crate) fn light_paths<'a>(&'a self, rays: &'a Rays<'a>) -> LightPaths<'a> {
        LightPaths::new(&self.scene, rays, &self.hierarchy, &self.radiosity, self.resolution.side)
    }

    /// Takes values at points; `paths` are [`Solution::light_paths`].
    pub(crate) fn reconstruction<'a>(&'a self, rays: &'a Rays<'a>, paths: &'a LightPaths<'a>) -> Reconstruction<'a> {
        let Self { scene, hierarchy, links, radiosity, exposure, .. } = self;
        let way = match &self.resolved {
            Some(resolved) => Way::Hemisphere(HemisphereGather { paths, resolved, bounces: 0 }),
            None => Way::Links(LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays)),
        };
        let effort = Effort::of_values(self.point_rays, self.options.seed);
        Reconstruction { scene, hierarchy, way, effort }
    }

    /// Visits the leaves of the hierarchy: polygon (counter-clockwise), surface index, radiosity per channel in W/m^2.
    pub fn for_each_leaf(&self, mut visit: impl FnMut(&[[f64; 3]], u32, &[f32])) {
        let is_leaf = |node: &NodeId| self.hierarchy.is_leaf(*node);
        for node in self.hierarchy.ids().filter(is_leaf) {
            let vertices: Vec<[f64; 3]> = self.hierarchy.facet(node).vertices.iter().map(|vertex| vertex.to_array()).collect();
            let radiosity: Vec<f32> = self.radiosity.of(node).iter().map(|&b| b as f32).collect();
            visit(&vertices, self.hierarchy.node(node).surface, &radiosity);
        }
    }

    /// Bytes that hierarchy, links and radiosities take.
    pub fn memory_bytes(&self) -> u64 {
        self.hierarchy.memory_bytes()
            + self.links.memory_bytes()
            + size_of_val(self.radiosity.values()) as u64
            + self.resolved.as_ref().map_or(0, Resolved::memory_bytes)
    }

    /// Checks everything that later stages rely on: ids in range, trees well formed, numbers finite.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn validate(&self) -> Result<(), String> {
        self.scene.validate()?;
        self.options.validate().map_err(|error| error.to_string())?;
        self.hierarchy.validate(&self.scene)?;
        self.links.validate(&self.hierarchy)?;
        let channels = self.scene.channels();
        if self.radiosity.channels() != channels || self.radiosity.values().len() != channels * self.hierarchy.len() {
            return Err("the radiosities do not fit the hierarchy".to_owned());
        }
        if self.exposure.len() != self.hierarchy.len() || !self.exposure.is_valid() {
            return Err("the exposures do not fit the hierarchy".to_owned());
        }
        if self.radiosity.values().iter().any(|b| !b.is_finite() || *b < 0.0) {
            return Err("a radiosity is negative or not finite".to_owned());
        }
        if self.point_rays == 0 || self.point_rays > 1 << 20 {
            return Err("the number of rays to a point is out of range".to_owned());
        }
        let resolution = &self.resolution;
        if !resolution.is_valid() {
            return Err("the size of the cells is out of range".to_owned());
        }
        if let Some(resolved) = &self.resolved {
            let cells =
                Lattice::new(&self.scene, &reflectors(&self.scene, &self.hierarchy, &self.radiosity), resolution.side).count();
            if !cells.is_some_and(|cells| resolved.is_valid(cells, channels)) {
                return Err("the resolved radiosities do not fit the scene".to_owned());
            }
        }
        Ok(())
    }
}
