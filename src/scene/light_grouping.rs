//! Which emitters make up which light group.

use std::collections::BTreeMap;

use super::light_groups::LightGroups;
use super::{EmitterName, Light, LightGroupError, MOST_CHANNELS, Scene, Surface};

/// How emitters are grouped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LightGrouping {
    /// A group for each material that emits, by its name; and for each light, by its name.
    Materials,
    /// A group for each object that has emitters, by its name; and for each light, by its name.
    Objects,
    /// Groups by name, each with what is in it.
    Named(Vec<(String, Vec<EmitterName>)>),
}

impl Scene {
    /// The same with light groups. Materials that are in several of them are told apart.
    ///
    /// # Errors
    /// See [`LightGroupError`]: every surface that emits, and every light, must be in one group.
    pub fn with_light_groups(&self, grouping: &LightGrouping) -> Result<Self, LightGroupError> {
        let emits = |surface: &&Surface| self.materials[surface.material as usize].emits();
        if !self.surfaces.iter().any(|surface| emits(&surface)) && !self.lights.iter().any(Light::is_on) {
            return Err(LightGroupError::NoLight);
        }
        if let LightGrouping::Named(groups) = grouping {
            self.check_named(groups)?;
        }

        // The groups, by name in the order of the file or else of their first surfaces, and that of each surface.
        let mut names: Vec<String> = match grouping {
            LightGrouping::Named(groups) => groups.iter().map(|(name, _)| name.clone()).collect(),
            LightGrouping::Materials | LightGrouping::Objects => Vec::new(),
        };
        let mut number_of = |name: &str| {
            let known = names.iter().position(|known| known == name);
            known.unwrap_or_else(|| {
                names.push(name.to_owned());
                names.len() - 1
            }) as u32
        };
        let mut scene = Self { light_groups: None, ..self.clone() };
        let surfaces = scene.surfaces.but_polygons_mut();
        let mut of_material = vec![None; self.materials.len()];
        let mut copies: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (index, surface) in self.surfaces.iter().enumerate().filter(|(_, surface)| emits(surface)) {
            let group = number_of(self.light_group_of(surface, grouping)?);

            // A material is in one group; its copies are in the others.
            let material = *copies.entry((surface.material, group)).or_insert_with(|| {
                let is_free = of_material[surface.material as usize].is_none();
                if !is_free {
                    scene.materials.push(self.materials[surface.material as usize].clone());
                    of_material.push(Some(group));
                    return of_material.len() as u32 - 1;
                }
                of_material[surface.material as usize] = Some(group);
                surface.material
            });
            surfaces[index].material = material;
        }
        let of_light = self.lights.iter().map(|light| Ok(number_of(group_of_light(light, grouping)?)));
        let of_light: Vec<u32> = of_light.collect::<Result<_, LightGroupError>>()?;
        if names.len() >= MOST_CHANNELS / self.channels {
            return Err(LightGroupError::TooMany { groups: names.len(), bands: self.channels, most: MOST_CHANNELS });
        }

        // A material that no surface has emits nothing.
        for (material, _) in scene.materials.iter_mut().zip(&of_material).filter(|(_, group)| group.is_none()) {
            material.exitance.fill(0.0);
        }
        let groups = LightGroups::new(names, of_material, of_light, (&scene.materials, &scene.lights));
        scene.light_groups = Some(groups);
        Ok(scene)
    }

    /// Every group must have a name of its own, and all that stands in it must emit.
    fn check_named(&self, groups: &[(String, Vec<EmitterName>)]) -> Result<(), LightGroupError> {
        for (number, (name, lights)) in groups.iter().enumerate() {
            if name.is_empty() || groups[..number].iter().any(|(before, _)| before == name) {
                return Err(LightGroupError::BadName(name.clone()));
            }
            let emits = |lights: &EmitterName| {
                let emitting = self.surfaces.iter().filter(|surface| self.materials[surface.material as usize].emits());
                let is_light = |light: &Light| light.is_on() && *lights == EmitterName::Light(light.name.clone());
                emitting.into_iter().any(|surface| self.is_of(surface, lights)) || self.lights.iter().any(is_light)
            };
            if let Some(lights) = lights.iter().find(|lights| !emits(lights)) {
                return Err(LightGroupError::NothingEmits { group: name.clone(), lights: lights.clone() });
            }
        }
        Ok(())
    }

    fn is_of(&self, surface: &Surface, lights: &EmitterName) -> bool {
        match lights {
            EmitterName::Material(name) => self.materials[surface.material as usize].name == *name,
            EmitterName::Object(name) => self.objects.name_of(surface.face) == Some(name),
            EmitterName::Light(_) => false,
        }
    }

    /// The name of the group of a surface that emits.
    fn light_group_of<'a>(&'a self, surface: &Surface, grouping: &'a LightGrouping) -> Result<&'a str, LightGroupError> {
        let (face, material) = (surface.face + 1, &self.materials[surface.material as usize].name);
        match grouping {
            LightGrouping::Materials => Ok(material),
            LightGrouping::Objects => self.objects.name_of(surface.face).ok_or(LightGroupError::NoObject { face }),
            LightGrouping::Named(groups) => {
                let is_in = |(_, lights): &&(String, Vec<EmitterName>)| lights.iter().any(|lights| self.is_of(surface, lights));
                let mut own = groups.iter().filter(is_in).map(|(name, _)| name);
                match (own.next(), own.next()) {
                    (Some(name), None) => Ok(name),
                    (Some(first), Some(second)) => {
                        let groups = [first, second].map(String::clone);
                        Err(LightGroupError::InTwoGroups { face, material: material.clone(), groups })
                    }
                    (None, _) => {
                        let object = self.objects.name_of(surface.face).map(str::to_owned);
                        Err(LightGroupError::InNoGroup { face, material: material.clone(), object })
                    }
                }
            }
        }
    }
}

/// The name of the group of a light.
fn group_of_light<'a>(light: &'a Light, grouping: &'a LightGrouping) -> Result<&'a str, LightGroupError> {
    let LightGrouping::Named(groups) = grouping else { return Ok(&light.name) };
    let is_own = |named: &EmitterName| matches!(named, EmitterName::Light(name) if *name == light.name);
    let own: Vec<&String> = groups.iter().filter(|(_, lights)| lights.iter().any(is_own)).map(|(name, _)| name).collect();
    match own[..] {
        [group] => Ok(group),
        _ => Err(LightGroupError::Light { name: light.name.clone(), groups: own.into_iter().cloned().collect() }),
    }
}
