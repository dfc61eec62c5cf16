//! Scenes that carry the light of their groups as channels, or have other weights for them.
//!
//! Radiosity is linear in exitance: `B = sum over groups g of w_g B_g`, with B_g the light of the emitters of group g alone. Form factors,
//! visibility and paths do not hang on exitance, so one solve finds all of them. For that a scene carries its groups as channels:
//!
//! ```text
//! the bands of all groups together | the bands of group 0 | the bands of group 1 | ...
//! ```
//!
//! By the first of them, the deciding ones, all is decided: what is refined, where rays go, when it is enough. The others are carried along. So
//! the light of all groups is what a solve without groups finds, to the bit.

use std::borrow::Cow;

use super::light_groups::{LightGroups, weighted_exitance};
use super::{Light, Material, Scene, SceneError, SurfaceId};

impl Scene {
    /// The light groups, if the scene has any.
    pub fn light_groups(&self) -> Option<&LightGroups> {
        self.light_groups.as_ref()
    }

    /// How many channels decide, which are the first ones. All of them, but where light groups are carried.
    pub(crate) fn deciding(&self) -> usize {
        self.channels - self.carried
    }

    /// How many channels there are with those of light groups.
    pub(crate) fn channels_with_groups(&self) -> usize {
        self.channels * (1 + self.light_groups.as_ref().map_or(0, |groups| groups.names.len()))
    }

    /// The same with a channel for each band of each light group behind its own, as the exitance is now; itself if it has no groups.
    pub(crate) fn carrying_light_groups(&self) -> Cow<'_, Self> {
        let Some(groups) = &self.light_groups else { return Cow::Borrowed(self) };
        let (count, bands) = (groups.names.len(), self.channels);
        let carrying = |(material, own): (&Material, &Option<u32>)| {
            let mut exitance = material.exitance.clone();
            (0..count).for_each(|group| {
                let is_own = *own == Some(group as u32);
                exitance.extend(material.exitance.iter().map(|&e| if is_own { e } else { 0.0 }));
            });
            Material { name: material.name.clone(), reflectance: material.reflectance.repeat(1 + count), exitance }
        };
        let materials = self.materials.iter().zip(&groups.of_material).map(carrying).collect();
        let light = |(light, &own): (&Light, &u32)| {
            let of_group = |group: u32| light.strength.iter().map(move |&strength| if group == own { strength } else { 0.0 });
            let apart = (0..count as u32).flat_map(of_group);
            Light { strength: light.strength.iter().copied().chain(apart).collect(), ..light.clone() }
        };
        let lights = self.lights.iter().zip(&groups.of_light).map(light).collect();
        Cow::Owned(Self { channels: bands * (1 + count), carried: bands * count, materials, lights, ..self.clone() })
    }

    /// The same where all weights are 1, the exitance being as it is.
    pub(crate) fn with_weights_of_one(self) -> Self {
        let groups = self.light_groups.as_ref();
        let of_scene = |groups: &LightGroups| {
            LightGroups::new(
                groups.names.clone(),
                groups.of_material.clone(),
                groups.of_light.clone(),
                (&self.materials, &self.lights),
            )
        };
        let groups = groups.map(of_scene);
        Self { light_groups: groups, ..self }
    }

    /// The same with other weights, by group and band; itself if it has no groups.
    ///
    /// # Errors
    /// [`SceneError::BadMaterial`] if it would be too bright, or so dim that squares vanish.
    pub(crate) fn relit(&self, weights: Vec<Vec<f64>>) -> Result<Self, SceneError> {
        let Some(groups) = &self.light_groups else { return Ok(self.clone()) };
        let relit = |(material, (group, exitance)): (&Material, (&Option<u32>, &Vec<f64>))| Material {
            exitance: weighted_exitance(exitance, group.map(|group| &weights[group as usize])),
            ..material.clone()
        };
        let materials = self.materials.iter().zip(groups.of_material.iter().zip(&groups.exitance)).map(relit).collect();
        let light = |(light, (&group, strength)): (&Light, (&u32, &Vec<f64>))| Light {
            strength: weighted_exitance(strength, Some(&weights[group as usize])),
            ..light.clone()
        };
        let lights = self.lights.iter().zip(groups.of_light.iter().zip(&groups.strength)).map(light).collect();
        let light_groups = Some(LightGroups { weights, ..groups.clone() });
        let scene = Self { materials, lights, light_groups, ..self.clone() };
        scene.check_materials()?;
        scene.check_lights()?;
        Ok(scene)
    }

    /// The exitance of a surface by band as it was solved: where all weights are 1, and materials are not changed yet. Which emitters rays are aimed
    /// at hangs on that: cells leave their light out.
    pub(crate) fn exitance_as_solved(&self, surface: SurfaceId) -> &[f64] {
        let material = self.surface(surface).material as usize;
        let solved = self.light_groups.as_ref().map(|groups| &groups.exitance).or(self.solved_exitance.as_ref());
        solved.map_or(&self.materials[material].exitance, |exitance| &exitance[material])
    }

    /// Whether a material emitted as it was solved.
    pub(crate) fn emitted_as_solved(&self, material: usize) -> bool {
        let exitance = self.solved_exitance.as_ref().map_or(&self.materials[material].exitance, |solved| &solved[material]);
        exitance.iter().any(|&e| e > 0.0)
    }

    /// Takes away what noise leaves of light in the dark, by channel: where all groups together have none, none has any.
    pub(crate) fn clear_dark(&self, light: &mut [f64]) {
        let (deciding, carried) = light.split_at_mut(self.deciding());
        deciding.iter_mut().for_each(|light| *light = light.max(0.0));
        for group in carried.chunks_mut(deciding.len()) {
            group.iter_mut().zip(&*deciding).filter(|(_, all)| **all <= 0.0).for_each(|(light, _)| *light = 0.0);
        }
    }

    pub(super) fn check_light_groups(&self) -> Result<(), String> {
        self.light_groups.as_ref().map_or(Ok(()), |groups| groups.validate(&self.materials, &self.lights, self.channels))
    }
}
