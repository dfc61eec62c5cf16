//! Light groups: emitters whose light is kept apart, so that it can be weighted after the solve.

use serde::{Deserialize, Serialize};

use super::{Light, LightGroupError, Material};

/// The light groups of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightGroups {
    pub(super) names: Vec<String>,
    /// By material, the number of its group; `None` of what emits nothing.
    pub(super) of_material: Vec<Option<u32>>,
    /// By material and band: the exitance in W/m^2 where all weights are 1.
    pub(super) exitance: Vec<Vec<f64>>,
    /// By light, the number of its group, and its strength by band where all weights are 1.
    pub(super) of_light: Vec<u32>,
    pub(super) strength: Vec<Vec<f64>>,
    /// By group and band.
    pub(super) weights: Vec<Vec<f64>>,
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
    /// Groups with these names, by material and by light of a scene, all with the weight 1.
    pub(super) fn new(
        names: Vec<String>,
        of_material: Vec<Option<u32>>,
        of_light: Vec<u32>,
        (materials, lights): (&[Material], &[Light]),
    ) -> Self {
        let exitance = materials.iter().map(|material| material.exitance.clone()).collect();
        let strength = lights.iter().map(|light| light.strength.clone()).collect();
        let weights = vec![vec![1.0; materials[0].exitance.len()]; names.len()];
        Self { names, of_material, exitance, of_light, strength, weights }
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
        let pick_all = |of: &Vec<Vec<f64>>| of.iter().map(|values| pick(values)).collect();
        let [exitance, strength, weights] = [&self.exitance, &self.strength, &self.weights].map(pick_all);
        Self { exitance, strength, weights, ..self.clone() }
    }

    /// Checks what a stored scene says of its groups.
    pub(super) fn validate(&self, all: &[Material], lights: &[Light], bands: usize) -> Result<(), String> {
        let Self { names, of_material, exitance, of_light, strength, weights } = self;
        let is_light = |values: &Vec<f64>| values.len() == bands && values.iter().all(|value| value.is_finite() && *value >= 0.0);
        let fit = [of_material.len(), exitance.len()] == [all.len(); 2] && [of_light.len(), strength.len()] == [lights.len(); 2];
        if !fit || weights.len() != names.len() || !exitance.iter().chain(strength).chain(weights).all(is_light) {
            return Err("the light groups do not fit the scene".to_owned());
        }
        let is_named = |number: usize| !names[number].is_empty() && !names[..number].contains(&names[number]);
        if names.is_empty() || !(0..names.len()).all(is_named) {
            return Err("light groups have no names of their own".to_owned());
        }
        for (material, (group, exitance)) in all.iter().zip(of_material.iter().zip(exitance)) {
            let weights = group.map(|group| weights.get(group as usize).ok_or("a light group does not exist")).transpose()?;
            if material.exitance != weighted_exitance(exitance, weights) {
                return Err(format!("material '{}': its exitance is not what its light group says", material.name));
            }
        }
        for (light, (&group, strength)) in lights.iter().zip(of_light.iter().zip(strength)) {
            let weights = weights.get(group as usize).ok_or("a light group does not exist")?;
            if light.strength != weighted_exitance(strength, Some(weights)) {
                return Err(format!("light '{}': its strength is not what its light group says", light.name));
            }
        }
        Ok(())
    }
}

/// The exitance by band of a material, or the strength of a light, with these weights; what is in no group has none.
pub(super) fn weighted_exitance(exitance: &[f64], weights: Option<&Vec<f64>>) -> Vec<f64> {
    let Some(weights) = weights else { return vec![0.0; exitance.len()] };
    exitance.iter().zip(weights).map(|(e, weight)| weight * e).collect()
}
