//! The light of groups apart, beside the solution of all of them together.

use serde::{Deserialize, Serialize};

use crate::cells::CellRadiosities;
use crate::error::GroupErrors;
use crate::mesh::MeshError;
use crate::scene::{DistinctChannels, Scene, SurfaceId};

/// What the emitters of each light group bring, with the weight 1: all that a solution holds of light. Noise may take it below 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct GroupedLight {
    /// Radiosity in W/m^2 by leaf in the order of their ids, group and band.
    pub(super) leaves: Vec<f64>,
    /// What lights bring to leaves, in W/m^2 by node, group and band.
    pub(super) lights: Vec<f64>,
    /// Where values end in cells: a channel for each group and band.
    pub(super) cells: Option<CellRadiosities>,
    /// Where there is a lit mesh: what is reflected, surface by surface, by node, group and band.
    pub(super) mesh: Option<Vec<Vec<f32>>>,
    /// What each surface reflected as it was solved, in its brightest channel: by that cells are laid out.
    pub(super) reflected: Vec<f64>,
    /// What is known of the errors; `None` where none was estimated.
    pub(super) errors: Option<GroupErrors>,
    /// What the lit mesh is off values, of all light and of each group.
    pub(super) mesh_errors: Vec<MeshError>,
}

impl GroupedLight {
    /// What is known of the errors of values, and what each surface reflects, before light is taken apart.
    pub fn judged(errors: GroupErrors, reflected: Vec<f64>) -> Self {
        Self { errors: Some(errors), reflected, ..Self::default() }
    }

    /// What a surface reflected as it was solved, in W/m^2 in its brightest channel.
    pub fn reflected_as_solved(&self, surface: SurfaceId) -> f64 {
        self.reflected[surface.index()]
    }

    /// Whether what surfaces reflected is told for all of a scene, in range.
    pub fn tells_brightness(&self, scene: &Scene) -> bool {
        let is_light = |reflected: &f64| (0.0..=f64::from(f32::MAX)).contains(reflected);
        self.reflected.len() == scene.surfaces().len() && self.reflected.iter().all(is_light)
    }

    /// The same for all channels, from those that were solved for.
    pub fn expanded(self, channels: &DistinctChannels) -> Self {
        Self { errors: self.errors.map(|errors| errors.expanded(channels)), ..self }
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        let of_mesh = self.mesh.iter().flatten().map(|reflected| size_of_val(&**reflected) as u64);
        size_of_val(&*self.leaves) as u64
            + size_of_val(&*self.lights) as u64
            + size_of_val(&*self.reflected) as u64
            + self.cells.as_ref().map_or(0, CellRadiosities::memory_bytes)
            + of_mesh.sum::<u64>()
    }
}
