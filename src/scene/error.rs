//! Why surfaces and materials make no scene.

use thiserror::Error;

/// Why a scene cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// There is nothing to light.
    #[error("the scene has no surface")]
    Empty,
    /// The number of channels is not from 1 to 1024.
    #[error("the scene has {0} channels, it must have 1 to 1024")]
    Channels(usize),
    /// A surface names a material that is not there.
    #[error("surface {surface} has material {material}, but there are only {count}")]
    NoSuchMaterial {
        /// Index of the surface.
        surface: usize,
        /// The material it names.
        material: u32,
        /// How many there are.
        count: usize,
    },
    /// A material has a wrong number of channels, a reflectance outside [0, 1), an exitance that is negative or not finite, or one with
    /// which radiosities might exceed [`Material::MOST_RADIOSITY`](super::Material::MOST_RADIOSITY).
    #[error("material '{name}': {reason}")]
    BadMaterial {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A light has a wrong number of channels, or a number that is out of range.
    #[error("light '{name}': {reason}")]
    BadLight {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Other materials than the scene has surfaces of.
    #[error("there are {given} materials for a scene that has {needed}")]
    Materials {
        /// How many are given.
        given: usize,
        /// How many there must be.
        needed: usize,
    },
    /// More than 2^31 surfaces.
    #[error("too many surfaces")]
    TooLarge,
}
