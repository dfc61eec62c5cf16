//! Light groups: emitters whose light is kept apart, so that it can be weighted after the solve.
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

use serde::{Deserialize, Serialize};

use super::{LightGroupError, Material, Scene, SceneError, SurfaceId};

/// The light groups of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightGroups {
    names: Vec<String>,
    /// By material, the number of its group; `None` of what emits nothing.
    of_material: Vec<Option<u32>>,
    /// By material and band: the exitance in W/m^2 where all weights are 1.
    exitance: Vec<Vec<f64>>,
    /// By group and band.
    weights: Vec<Vec<f64>>,
}

/// What a light group is weighted with: a number for all bands, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub struct LightWeight {
    /// The name of the group.
    pub group: String,
    /// Not negative; of what was solved it is 1.
    pub by_band: Vec<f64>,
}

impl LightGroups {
    /// Groups with these names, by material, all with the weight 1.
    pub(super) fn new(names: Vec<String>, of_material: Vec<Option<u32>>, scene: &Scene) -> Self {
        let exitance = scene.materials.iter().map(|material| material.exitance.clone()).collect();
        let weights = vec![vec![1.0; scene.channels]; names.len()];
        Self { names, of_material, exitance, weights }
    }

    /// The names of the groups.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The weights of a group, by band.
    pub fn weights_of(&self, group: usize) -> &[f64] {
        &self.weights[group]
    }

    /// The same, with other weights for groups that are named, the last one counting, and those that there were for others.
    pub(crate) fn weighted(&self, weights: &[LightWeight]) -> Result<Vec<Vec<f64>>, LightGroupError> {
        let mut all = self.weights.clone();
        for LightWeight { group, by_band } in weights {
            let number = self.names.iter().position(|name| name == group);
            let unknown = || LightGroupError::UnknownGroup { name: group.clone(), known: self.names.clone() };
            let own = &mut all[number.ok_or_else(unknown)?];
            if let Some(&weight) = by_band.iter().find(|weight| !(0.0..).contains(*weight) || !weight.is_finite()) {
                return Err(LightGroupError::BadWeight { name: group.clone(), weight });
            }
            match by_band[..] {
                [weight] => own.fill(weight),
                _ if by_band.len() == own.len() => own.copy_from_slice(by_band),
                _ => return Err(LightGroupError::Bands { name: group.clone(), given: by_band.len(), needed: own.len() }),
            }
        }
        Ok(all)
    }

    /// The same in some of the bands.
    pub(super) fn of_bands(&self, pick: &impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let [exitance, weights] = [&self.exitance, &self.weights].map(|of| of.iter().map(|values| pick(values)).collect());
        Self { exitance, weights, ..self.clone() }
    }

    /// Checks what a stored scene says of its groups.
    fn validate(&self, scene: &Scene) -> Result<(), String> {
        let Self { names, of_material, exitance, weights } = self;
        let (materials, bands) = (scene.materials.len(), scene.channels);
        let is_light = |values: &Vec<f64>| values.len() == bands && values.iter().all(|value| value.is_finite() && *value >= 0.0);
        let fit = of_material.len() == materials && exitance.len() == materials && weights.len() == names.len();
        if !fit || !exitance.iter().chain(weights).all(is_light) {
            return Err("the light groups do not fit the scene".to_owned());
        }
        let is_named = |number: usize| !names[number].is_empty() && !names[..number].contains(&names[number]);
        if names.is_empty() || !(0..names.len()).all(is_named) {
            return Err("light groups have no names of their own".to_owned());
        }
        for (material, (group, exitance)) in scene.materials.iter().zip(of_material.iter().zip(exitance)) {
            let weights = group.map(|group| weights.get(group as usize).ok_or("a light group does not exist")).transpose()?;
            if material.exitance != weighted_exitance(exitance, weights) {
                return Err(format!("material '{}': its exitance is not what its light group says", material.name));
            }
        }
        Ok(())
    }
}

/// The exitance by band of a material with these weights; what is in no group has none.
fn weighted_exitance(exitance: &[f64], weights: Option<&Vec<f64>>) -> Vec<f64> {
    let Some(weights) = weights else { return vec![0.0; exitance.len()] };
    exitance.iter().zip(weights).map(|(e, weight)| weight * e).collect()
}

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
        Cow::Owned(Self { channels: bands * (1 + count), carried: bands * count, materials, ..self.clone() })
    }

    /// The same with the exitance as it is now for all weights 1.
    pub(crate) fn as_solved(self) -> Self {
        let groups = self.light_groups.as_ref();
        let groups = groups.map(|groups| LightGroups::new(groups.names.clone(), groups.of_material.clone(), &self));
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
        let light_groups = Some(LightGroups { weights, ..groups.clone() });
        let scene = Self { materials, light_groups, ..self.clone() };
        scene.check_materials()?;
        Ok(scene)
    }

    /// The exitance of a surface by band where all weights are 1. Which emitters rays are aimed at hangs on that: cells leave their light out.
    pub(crate) fn exitance_as_solved(&self, surface: SurfaceId) -> &[f64] {
        let material = self.surface(surface).material as usize;
        self.light_groups.as_ref().map_or(&self.materials[material].exitance, |groups| &groups.exitance[material])
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
        self.light_groups.as_ref().map_or(Ok(()), |groups| groups.validate(self))
    }
}
