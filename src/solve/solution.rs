//! The answer.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize};

use super::grouped_light::GroupedLight;
use super::interest::InitialImportance;
use super::options::{SolveOptions, Solver};
use super::transport::Transport;
use crate::bounds::RadiosityBounds;
use crate::cells::CellRadiosities;
use crate::direct::{Blockers, DirectLight, DirectScratch};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::mesh::LitMesh;
use crate::paths::{Brightness, LightPaths, Resolution, Spot, cell_count, place_at};
use crate::progress::Stop;
use crate::scene::{DistinctChannels, Scene, SurfacePoint};
use crate::sweep::{Adjoint, Closure, Exposure, Importance, LightIrradiance, Radiosity};
use crate::transmittance::Rays;
use crate::values::{ErrorBars, FinalGather, Gather, LinkGather, Over, RayBudget, Shading, ShadingMethod, tolerance};

/// The answer: scene, hierarchy, links, radiosities and the options they were found with.
///
/// What follows from the scene and the leaves is not serialized. Deserializing makes it anew, and fails where something does not fit that later stages rely on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    pub(crate) scene: Scene,
    pub(crate) options: SolveOptions,
    pub(crate) hierarchy: Hierarchy,
    pub(crate) links: LinkSet,
    pub(crate) exposure: Exposure,
    /// What lights bring to leaves.
    pub(crate) lights: LightIrradiance,
    pub(crate) radiosity: Radiosity,
    pub(crate) point_rays: u32,
    /// Rays to emitters from where a path goes on.
    pub(crate) vertex_rays: u32,
    /// How finely cell radiosities are found, and where more finely, and these, where values end in cells.
    pub(crate) resolution: Resolution,
    pub(crate) spots: Vec<Spot>,
    pub(crate) cell_radiosities: Option<CellRadiosities>,
    /// What is known of the errors of values.
    pub(crate) error_bars: Option<ErrorBars>,
    /// What is proved, if that was asked for.
    pub(crate) bounds: Option<RadiosityBounds>,
    /// The answer as a function, if that was asked for.
    pub(crate) mesh: Option<LitMesh>,
    /// The light of groups apart, if it was solved with any.
    pub(crate) groups: Option<GroupedLight>,
    /// What paths bring, if that was to be kept.
    #[serde(with = "shared")]
    pub(crate) transport: Option<Arc<Transport>>,
}

/// A solution as it is stored: nothing is checked yet, and [`Solution::restored`] must pass before it is used.
#[derive(Deserialize)]
#[serde(remote = "Solution")]
pub(crate) struct StoredSolution {
    scene: Scene,
    options: SolveOptions,
    hierarchy: Hierarchy,
    links: LinkSet,
    exposure: Exposure,
    lights: LightIrradiance,
    radiosity: Radiosity,
    point_rays: u32,
    vertex_rays: u32,
    resolution: Resolution,
    spots: Vec<Spot>,
    cell_radiosities: Option<CellRadiosities>,
    error_bars: Option<ErrorBars>,
    bounds: Option<RadiosityBounds>,
    mesh: Option<LitMesh>,
    groups: Option<GroupedLight>,
    #[serde(with = "shared")]
    transport: Option<Arc<Transport>>,
}

impl<'de> Deserialize<'de> for Solution {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        StoredSolution::deserialize(deserializer)?.restored().map_err(serde::de::Error::custom)
    }
}

/// What is shared is stored as if it were not.
mod shared {
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Transport;

    pub fn serialize<S: Serializer>(transport: &Option<Arc<Transport>>, serializer: S) -> Result<S::Ok, S::Error> {
        transport.as_deref().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Arc<Transport>>, D::Error> {
        Ok(Option::<Transport>::deserialize(deserializer)?.map(Arc::new))
    }
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

    /// The lit mesh: the answer as a function on the surfaces, if it was solved with [`SolveOptions::lit_mesh`].
    pub fn mesh(&self) -> Option<&LitMesh> {
        self.mesh.as_ref()
    }

    /// Visibility rays that a value at a point takes.
    pub fn point_rays(&self) -> u32 {
        self.point_rays
    }

    /// Which solver found it: over links or over cells.
    pub fn solver(&self) -> Solver {
        if self.cell_radiosities.is_some() { Solver::Cells } else { Solver::Links }
    }

    /// Importance over the links, as the solver swept radiosities over them.
    pub(crate) fn importance(&self, initial: &InitialImportance) -> Importance {
        let Self { scene, hierarchy, links, exposure, radiosity, .. } = self;
        let clusters = links.iter().any(|(receiver, link)| hierarchy.is_cluster(receiver) || hierarchy.is_cluster(link.source));
        let closure = Closure::needed(scene, hierarchy, links, exposure, clusters);
        let initial = initial.of_leaves(hierarchy, exposure, scene.channels());
        Adjoint { scene, hierarchy, links, exposure, closure: closure.as_ref(), radiosity }.importance(&initial)
    }

    /// How bright surfaces are, by the radiosities over the links as they were solved: cells are laid out by that.
    fn brightness(&self) -> Brightness {
        let Self { scene, hierarchy, radiosity, groups, transport, .. } = self;
        let brightness = match (transport, groups) {
            (Some(transport), _) => transport.brightness(scene),
            (None, Some(groups)) => Brightness::of_surfaces(scene, |surface| groups.reflected_as_solved(surface)),
            (None, None) => Brightness::of_surfaces(scene, |surface| radiosity.reflected(scene, hierarchy, surface)),
        };
        Brightness { spots: self.spots.clone(), ..brightness }
    }

    /// The light paths that values at points take, where these end in cells.
    pub(crate) fn light_paths<'a>(&'a self, rays: &'a Rays<'a>, stop: Stop<'_>) -> Option<LightPaths<'a>> {
        self.cell_radiosities.as_ref()?;
        Some(LightPaths::new(&self.scene, rays, &self.brightness(), self.resolution.size, stop))
    }

    /// Gathers values at points; `paths` are [`Solution::light_paths`].
    pub(crate) fn gather_at_points<'a>(&'a self, rays: &'a Rays<'a>, paths: Option<&'a LightPaths<'a>>) -> Gather<'a> {
        let Self { scene, hierarchy, links, radiosity, exposure, .. } = self;
        let over = match (&self.cell_radiosities, paths) {
            (Some(radiosities), Some(paths)) => {
                Over::Cells(FinalGather { paths, radiosities, bounces: 0, vertex_rays: self.vertex_rays })
            }
            _ => {
                // Direct light asks for the boxes of blockers: they are found meanwhile.
                let links = || LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays);
                let find_boxes = || (!scene.is_dark()).then(|| rays.sheets(scene));
                let (over, _) = rayon::join(|| LinkGather::with_direct_light(links()), find_boxes);
                Over::Links(over)
            }
        };
        let budget = RayBudget::of_values(self.point_rays, self.options.seed);
        Gather { scene, hierarchy, over, budget }
    }

    /// Radiosities at points by an older method over the links, by point and channel, in W/m^2; NaN where a point lies on no surface.
    pub(crate) fn shade(&self, rays: &Rays<'_>, points: &[SurfacePoint], method: ShadingMethod) -> Vec<f32> {
        let Self { scene, hierarchy, links, radiosity, .. } = self;
        let light = DirectLight { scene, rays, blockers: Blockers::of(scene, rays), emitters: &[] };
        let shading = Shading { scene, hierarchy, links, radiosity, light, method };
        let (channels, tolerance) = (scene.channels(), tolerance(scene));
        let mut values = vec![f32::NAN; points.len() * channels];
        values.par_chunks_mut(channels).zip(points).for_each_init(
            || (DirectScratch::default(), vec![0.0; channels]),
            |(scratch, radiosity), (values, point)| {
                let (position, normal) = (DVec3::from(point.position), DVec3::from(point.normal));
                let Some(surface) = hierarchy.surface_at(position, normal, tolerance) else { return };
                shading.radiosity_at(&place_at(position, surface, self.options.seed), scratch, radiosity);
                values.iter_mut().zip(&*radiosity).for_each(|(value, &b)| *value = b as f32);
            },
        );
        values
    }

    /// The same for all channels, from those that were solved.
    pub(super) fn expanded(self, channels: &DistinctChannels) -> Self {
        let radiosity = self.radiosity.expanded(channels);
        let cell_radiosities = self.cell_radiosities.map(|radiosities| radiosities.expanded(channels));
        let mesh = self.mesh.map(|mesh| mesh.expanded(channels));
        let groups = self.groups.map(|groups| groups.expanded(channels));
        let lights = self.lights.expanded(channels);
        Self { radiosity, lights, cell_radiosities, mesh, groups, ..self }
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

    /// Lower and upper radiosities of the leaves, in the order of [`Solution::for_each_leaf`], by leaf and channel in W/m^2, where they are proved.
    pub fn leaf_bounds(&self) -> Option<[Vec<f32>; 2]> {
        let bounds = self.bounds.as_ref()?;
        let leaves = || self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node));
        let lower = leaves().flat_map(|node| bounds.lower(node).iter().map(|&b| below(b))).collect();
        Some([lower, leaves().flat_map(|node| bounds.upper(node).iter().map(|&b| -below(-b))).collect()])
    }

    /// Bytes that hierarchy, links, radiosities and the lit mesh take.
    pub fn memory_bytes(&self) -> u64 {
        self.hierarchy.memory_bytes()
            + self.links.memory_bytes()
            + size_of_val(self.radiosity.values()) as u64
            + self.lights.memory_bytes()
            + self.cell_radiosities.as_ref().map_or(0, CellRadiosities::memory_bytes)
            + self.mesh.as_ref().map_or(0, LitMesh::memory_bytes)
            + self.groups.as_ref().map_or(0, GroupedLight::memory_bytes)
            + self.transport.as_ref().map_or(0, |transport| transport.memory_bytes())
    }

    /// The most irradiance that lights bring to a leaf, channels added, in W/m^2; 0 without lights.
    pub(crate) fn most_by_lights(&self) -> f64 {
        self.lights.values().chunks(self.scene.channels()).map(|of_node| of_node.iter().sum::<f64>()).fold(0.0, f64::max)
    }

    /// Checks everything that later stages rely on, as if it were stored and read again.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn validate(&self) -> Result<(), String> {
        let restored = self.clone().restored()?;
        if restored == *self { Ok(()) } else { Err("what follows from the scene and the leaves is out of date".to_owned()) }
    }

    /// Makes anew what is not stored, and checks everything that later stages rely on: ids in range, trees well formed, numbers finite.
    ///
    /// # Errors
    /// Says what is wrong.
    pub(crate) fn restored(mut self) -> Result<Self, String> {
        self.scene.validate()?;
        self.options.validate().map_err(|error| error.to_string())?;
        self.hierarchy.restore(&self.scene)?;
        self.links.validate(&self.hierarchy)?;
        let channels = self.scene.channels();
        if self.exposure.len() != self.hierarchy.len() || !self.exposure.is_valid() {
            return Err("the exposures do not fit the hierarchy".to_owned());
        }
        if !self.lights.is_valid(self.hierarchy.len(), channels, !self.scene.lights().is_empty()) {
            return Err("the irradiances by lights do not fit the scene".to_owned());
        }
        self.radiosity.restore(&self.hierarchy, &self.exposure, channels)?;
        if self.groups.as_ref().is_some_and(|groups| !groups.tells_brightness(&self.scene)) {
            return Err("the light of groups does not fit the scene".to_owned());
        }
        if self.transport.as_ref().is_some_and(|transport| !transport.tells_brightness(&self.scene)) {
            return Err("the stored transport does not fit the scene".to_owned());
        }
        if [self.point_rays, self.vertex_rays].iter().any(|rays| !(1..=1 << 20).contains(rays)) {
            return Err("the number of rays to a point, or from where paths go on, is out of range".to_owned());
        }
        let resolution = &self.resolution;
        if !resolution.is_valid(&self.scene) {
            return Err("the size of the cells is out of range".to_owned());
        }
        if !self.spots.iter().all(|spot| spot.is_valid(&self.scene)) {
            return Err("a bright spot lies on no surface".to_owned());
        }
        if let Some(radiosities) = &self.cell_radiosities {
            let cells = cell_count(&self.scene, &self.brightness(), resolution.size);
            if !cells.is_some_and(|cells| radiosities.is_valid(cells, channels)) {
                return Err("the cell radiosities do not fit the scene".to_owned());
            }
        }
        if let Some(transport) = &self.transport {
            let cells = self.cell_radiosities.as_ref().filter(|_| self.groups.is_none()).map(CellRadiosities::cells);
            if !cells.is_some_and(|cells| transport.is_valid(&self.scene, cells)) {
                return Err("the stored transport does not fit the cells".to_owned());
            }
        }
        if !self.error_bars.is_none_or(|error_bars| error_bars.is_valid()) {
            return Err("the error bars are negative or not finite".to_owned());
        }
        if let Some(bounds) = &mut self.bounds {
            bounds.restore(&self.scene, &self.hierarchy)?;
        }
        if let Some(mesh) = &self.mesh {
            mesh.validate(&self.scene)?;
        }
        self.validate_groups()?;
        Ok(self)
    }
}

/// The largest float that is not above a number: bounds stay bounds when they are rounded.
fn below(number: f64) -> f32 {
    let rounded = number as f32;
    if f64::from(rounded) > number { rounded.next_down() } else { rounded }
}
