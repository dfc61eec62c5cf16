//! Takes the light of groups, which is carried as channels, apart from that of all together; and checks what is read of it.

use super::grouped_light::GroupedLight;
use super::solution::Solution;
use crate::mesh::{LitMesh, MeshError};
use crate::scene::{Scene, SurfaceId};
use crate::sweep::LightIrradiance;

/// The numbers of some bands in each item of so many channels: of a run of channels from `first` on.
fn of_run<T: Copy>(values: &[T], channels: usize, first: usize, count: usize) -> Vec<T> {
    values.chunks(channels).flat_map(|item| &item[first..first + count]).copied().collect()
}

impl Solution {
    /// The solution of the scene that was to be solved: takes the light of its groups, which channels carry behind those of all light, apart.
    pub(super) fn with_groups_apart(self, scene: Scene) -> Self {
        let Some(count) = scene.light_groups().map(|groups| groups.names().len()) else { return Self { scene, ..self } };
        let (bands, carried) = (scene.channels(), scene.channels() * count);
        let all = bands + carried;

        // All light together is what a solve without groups finds.
        let radiosity = self.radiosity.of_channels(0..bands);
        let lights = LightIrradiance::of_values(of_run(self.lights.values(), all, 0, bands));
        let mut mesh = self.mesh.as_ref().map(|mesh| mesh.with_reflected(|_, reflected| of_run(reflected, all, 0, bands)));
        let cell_radiosities = self.cell_radiosities.as_ref().map(|cells| cells.of_channels(0..bands));

        // The light of each group.
        let leaves = self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node));
        let surfaces = (0..scene.surfaces().len() as u32).map(SurfaceId);
        let of_mesh = |mesh: &LitMesh| mesh.reflected().map(|reflected| of_run(reflected, all, bands, carried)).collect();
        let groups = GroupedLight {
            lights: of_run(self.lights.values(), all, bands, carried),
            leaves: leaves.flat_map(|leaf| &self.radiosity.of(leaf)[bands..]).copied().collect(),
            cells: self.cell_radiosities.as_ref().map(|cells| cells.of_channels(bands..all)),
            mesh: self.mesh.as_ref().map(of_mesh),
            reflected: surfaces.map(|surface| radiosity.reflected(&scene, &self.hierarchy, surface)).collect(),
            errors: self.groups.and_then(|groups| groups.errors),
            mesh_errors: mesh.as_mut().map_or_else(Vec::new, |mesh| std::mem::take(&mut mesh.by_group)),
        };
        Self { scene, radiosity, lights, cell_radiosities, mesh, groups: Some(groups), ..self }
    }

    /// Checks what was read of groups.
    pub(super) fn validate_groups(&self) -> Result<(), String> {
        let (Some(groups), Some(light)) = (self.scene.light_groups(), &self.groups) else {
            let both_or_none = self.scene.light_groups().is_some() == self.groups.is_some();
            return if both_or_none { Ok(()) } else { Err("the light of groups is missing, or of none".to_owned()) };
        };
        let (count, bands) = (groups.names().len(), self.scene.channels());
        let leaves = self.hierarchy.ids().filter(|&node| self.hierarchy.is_leaf(node)).count();
        let is_number = |value: &f64| value.abs() <= f64::from(f32::MAX);
        let fits = light.leaves.len() == leaves * count * bands
            && light.leaves.iter().all(is_number)
            && light.lights.len() == self.lights.values().len() * count
            && light.lights.iter().all(is_number)
            && light.errors.as_ref().is_none_or(|errors| errors.is_valid(count, bands));
        let of_cells = match (&self.cell_radiosities, &light.cells) {
            (Some(all), Some(apart)) => apart.is_valid(all.cells(), count * bands),
            (all, apart) => all.is_none() && apart.is_none(),
        };
        let of_mesh = match (&self.mesh, &light.mesh) {
            (Some(all), Some(apart)) => {
                let mut pairs = all.reflected().zip(apart);
                let is_error = |error: &MeshError| error.measured >= 0.0 && error.claimed >= 0.0;
                all.reflected().count() == apart.len()
                    && pairs.all(|(all, apart)| apart.len() == all.len() * count && LitMesh::are_in_range(apart))
                    && (light.mesh_errors.is_empty() || light.mesh_errors.len() == 1 + count)
                    && light.mesh_errors.iter().all(is_error)
            }
            (all, apart) => all.is_none() && apart.is_none() && light.mesh_errors.is_empty(),
        };
        if fits && of_cells && of_mesh { Ok(()) } else { Err("the light of groups does not fit the scene".to_owned()) }
    }
}
