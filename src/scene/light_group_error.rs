//! Why lights cannot be grouped or weighted.

use thiserror::Error;

use super::{EmitterName, SceneError};

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
        lights: EmitterName,
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
    /// A light that is no surface is in no group, or in several.
    #[error("light groups: light '{name}' is in {}; it must be in one", in_groups(.groups))]
    Light {
        /// Its name.
        name: String,
        /// The groups that it is in.
        groups: Vec<String>,
    },
    /// Two groups have one name, or one has none.
    #[error("light groups: '{0}' must be the name of one group, and not empty")]
    BadName(String),
    /// More channels than there may be.
    #[error("light groups: {groups} groups of {bands} channels are more than {most} channels with those of their sum")]
    TooMany {
        /// How many groups there are.
        groups: usize,
        /// Channels of the scene.
        bands: usize,
        /// How many channels there may be.
        most: usize,
    },
    /// It was solved without light groups.
    #[error("light groups: this was solved without any; solve the scene with --light-groups")]
    NoGroups,
    /// Bounds are proved, and strategies of papers refine, for the light as it is.
    #[error("light groups: they need the strategy default, no bounds, and no stored transport")]
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

fn in_groups(groups: &[String]) -> String {
    if groups.is_empty() { "no group".to_owned() } else { format!("the groups {}", groups.join(", ")) }
}
