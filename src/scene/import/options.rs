//! What a reader of scenes may decide.

use std::path::PathBuf;

use crate::scene::{Sides, Up};

/// What the reader may decide.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Which sides of a face emit and receive.
    pub sides: Sides,
    /// Whether a scene may name any file: a material library, a buffer, an image. Else these lie beside the scene or below that folder: a scene
    /// by somebody else reads nothing of what lies elsewhere.
    pub allow_any_path: bool,
    /// What becomes of textures.
    pub textures: Textures,
    /// A TOML file of lights that are no surfaces, see [`read_lights`](super::read_lights), beside those of the scene's own file.
    pub lights: Option<PathBuf>,
    /// How many metres a unit of the file's coordinates is, if that is not one: the scene that is read is in metres. For formats that know no unit: OBJ, PLY
    /// and STL.
    pub unit: Option<f64>,
    /// Which axis points up, for the same formats; coordinates stay as they are. The file of lights, if it does not say it itself, takes y if this is not
    /// given.
    pub up: Option<Up>,
    /// Whether to keep the coordinates that the file has for lightmaps: the second set (`TEXCOORD_1`) of glTF, the only one (`vt`) of OBJ.
    pub keep_uv: bool,
}

impl ImportOptions {
    /// The range of [`ImportOptions::unit`]: from a nanometre to a million kilometres.
    pub const UNITS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
}

/// What becomes of textures: materials have one colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Textures {
    /// Each face has the mean colour of its texture over it.
    #[default]
    Face,
    /// A scene that has some is not read.
    Reject,
}
