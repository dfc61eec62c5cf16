//! Which emitters make up which light group.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::light_groups::LightGroups;
use super::{MOST_CHANNELS, Scene, SceneError, Surface};

/// How emitters are grouped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LightGrouping {
    /// A group for each material that emits, by its name.
    Materials,
    /// A group for each object that has emitters, by its name.
    Objects,
    /// Groups by name, each with what is in it.
    Named(Vec<(String, Vec<Lights>)>),
}

/// Emitters of one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Lights {
    /// Those of a material.
    Material(String),
    /// Those of an object.
    Object(String),
}

impl Lights {
    /// How it is written.
    pub const FORM: &'static str = "'material NAME' or 'object NAME'";
}

impl FromStr for Lights {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(' ').map(|(kind, name)| (kind, name.trim())) {
            Some(("material", name)) if !name.is_empty() => Ok(Self::Material(name.to_owned())),
            Some(("object", name)) if !name.is_empty() => Ok(Self::Object(name.to_owned())),
            _ => Err(format!("'{text}' names no lights, write {}", Self::FORM)),
        }
    }
}

impl fmt::Display for Lights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material(name) => write!(f, "material {name}"),
            Self::Object(name) => write!(f, "object {name}"),
        }
    }
}

/// Why lights cannot be grouped or weighted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LightGroupError {
    /// Nothing emits.
    #[error("light groups: nothing in the scene emits light")]
    NoLight,
    /// A face that emits lies in no object.
    #[error("light groups: face {face} emits light and lies in no object; group by material, or name groups in a file")]
    NoObject {
        /// Its number in the input, from 1.
        face: u32,
    },
    /// A group has nothing in it that emits.
    #[error("light groups: '{lights}' in group '{group}' emits no light in this scene")]
    NothingEmits {
        /// The group.
        group: String,
        /// What stands in it.
        lights: Lights,
    },
    /// A face that emits is in no group.
    #[error("light groups: face {face} of material '{material}'{} emits light and is in no group; add it to one", of_object(.object))]
    InNoGroup {
        /// Its number in the input, from 1.
        face: u32,
        /// Its material.
        material: String,
        /// Its object.
        object: Option<String>,
    },
    /// A face that emits is in two groups.
    #[error("light groups: face {face} of material '{material}' is in the groups '{}' and '{}'; take it out of one", .groups[0], .groups[1])]
    InTwoGroups {
        /// Its number in the input, from 1.
        face: u32,
        /// Its material.
        material: String,
        /// Two groups that it is in.
        groups: [String; 2],
    },
    /// Two groups have one name, or one has none.
    #[error("light groups: '{0}' must be the name of one group, and not empty")]
    BadName(String),
    /// More channels than there may be.
    #[error("light groups: {groups} groups of {bands} channels are more than {MOST_CHANNELS} channels with those of their sum")]
    TooMany {
        /// How many groups there are.
        groups: usize,
        /// Channels of the scene.
        bands: usize,
    },
    /// It was solved without light groups.
    #[error("light groups: this was solved without any; solve the scene with --light-groups")]
    NoGroups,
    /// Bounds are proved, and strategies of papers refine, for the light as it is.
    #[error("light groups: they need the strategy default, and no bounds")]
    Options,
    /// There is no such group.
    #[error("light groups: there is no group '{name}', there are: {}", .known.join(", "))]
    UnknownGroup {
        /// What was asked for.
        name: String,
        /// The groups that there are.
        known: Vec<String>,
    },
    /// A weight is negative or not finite.
    #[error("light groups: the weight {weight} of group '{name}' must be a number from 0 on")]
    BadWeight {
        /// The group.
        name: String,
        /// The weight.
        weight: f64,
    },
    /// Neither one weight nor one for each channel.
    #[error("light groups: group '{name}' has {given} weights, it must have one, or {needed}")]
    Bands {
        /// The group.
        name: String,
        /// How many there are.
        given: usize,
        /// Channels of the scene.
        needed: usize,
    },
    /// With these weights radiosities are too large to be told.
    #[error("light groups: with these weights radiosities are more than can be stored; take smaller ones")]
    TooBright,
    /// With these weights the scene is too bright or too dim.
    #[error("light groups: {0}")]
    Scene(#[from] SceneError),
}

fn of_object(object: &Option<String>) -> String {
    object.as_ref().map_or(String::new(), |name| format!(" in object '{name}'"))
}

impl Scene {
    /// The same with light groups. Materials that are in several of them are told apart.
    ///
    /// # Errors
    /// See [`LightGroupError`]: every surface that emits must be in one group.
    pub fn with_light_groups(&self, grouping: &LightGrouping) -> Result<Self, LightGroupError> {
        let emits = |surface: &&Surface| self.materials[surface.material as usize].emits();
        if !self.surfaces.iter().any(|surface| emits(&surface)) {
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
        let mut scene = Self { light_groups: None, ..self.clone() };
        let mut of_material = vec![None; self.materials.len()];
        let mut copies: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (index, surface) in self.surfaces.iter().enumerate().filter(|(_, surface)| emits(surface)) {
            let name = self.light_group_of(surface, grouping)?;
            let known = names.iter().position(|known| known == name);
            let group = known.unwrap_or_else(|| {
                names.push(name.to_owned());
                names.len() - 1
            }) as u32;

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
            scene.surfaces[index].material = material;
        }
        if names.len() >= MOST_CHANNELS / self.channels {
            return Err(LightGroupError::TooMany { groups: names.len(), bands: self.channels });
        }

        // A material that no surface has emits nothing.
        for (material, _) in scene.materials.iter_mut().zip(&of_material).filter(|(_, group)| group.is_none()) {
            material.exitance.fill(0.0);
        }
        scene.light_groups = Some(LightGroups::new(names, of_material, &scene));
        Ok(scene)
    }

    /// Every group must have a name of its own, and all that stands in it must emit.
    fn check_named(&self, groups: &[(String, Vec<Lights>)]) -> Result<(), LightGroupError> {
        for (number, (name, lights)) in groups.iter().enumerate() {
            if name.is_empty() || groups[..number].iter().any(|(before, _)| before == name) {
                return Err(LightGroupError::BadName(name.clone()));
            }
            let emits = |lights: &Lights| {
                let emitting = self.surfaces.iter().filter(|surface| self.materials[surface.material as usize].emits());
                emitting.into_iter().any(|surface| self.is_of(surface, lights))
            };
            if let Some(lights) = lights.iter().find(|lights| !emits(lights)) {
                return Err(LightGroupError::NothingEmits { group: name.clone(), lights: lights.clone() });
            }
        }
        Ok(())
    }

    fn is_of(&self, surface: &Surface, lights: &Lights) -> bool {
        match lights {
            Lights::Material(name) => self.materials[surface.material as usize].name == *name,
            Lights::Object(name) => self.objects.name_of(surface.face) == Some(name),
        }
    }

    /// The name of the group of a surface that emits.
    fn light_group_of<'a>(&'a self, surface: &Surface, grouping: &'a LightGrouping) -> Result<&'a str, LightGroupError> {
        let (face, material) = (surface.face + 1, &self.materials[surface.material as usize].name);
        match grouping {
            LightGrouping::Materials => Ok(material),
            LightGrouping::Objects => self.objects.name_of(surface.face).ok_or(LightGroupError::NoObject { face }),
            LightGrouping::Named(groups) => {
                let is_in = |(_, lights): &&(String, Vec<Lights>)| lights.iter().any(|lights| self.is_of(surface, lights));
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
