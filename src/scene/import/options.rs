//! What a reader of scenes may decide.

use std::path::PathBuf;

use crate::scene::Sides;

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
    /// Whether to keep the coordinates that the file has for lightmaps: the second set (`TEXCOORD_1`) of glTF, the only one (`vt`) of OBJ.
    pub keep_uv: bool,
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
