//! Why surfaces and materials make no scene.

use thiserror::Error;

/// Why a scene cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// There is nothing to light.
    #[error("the scene has no surface")]
    Empty,
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
    /// A material has a wrong number of channels, a reflectance outside [0, 1) or an exitance that is negative or not finite.
    #[error("material '{name}': {reason}")]
    BadMaterial {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// More than 2^31 surfaces.
    #[error("too many surfaces")]
    TooLarge,
}
