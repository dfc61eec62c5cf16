//! Reading scenes from files.

use std::path::Path;

use thiserror::Error;

use super::{Scene, Sides};

/// What the reader may decide.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Which sides of a face emit and receive.
    pub sides: Sides,
}

/// Why a file could not be read: fatal, exit code 3.
#[derive(Debug, Error)]
pub enum ImportError {
    /// Placeholder until the importer lands.
    #[error("not implemented")]
    Unfinished,
}

/// What was repaired or looks suspicious.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    /// One line each, with file, line and face.
    pub warnings: Vec<String>,
}

/// A scene and what was noted while reading it.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// What was repaired or looks suspicious.
    pub diagnostics: Diagnostics,
}

/// Reads the scene at `path`, by its extension.
///
/// # Errors
/// See [`ImportError`].
pub fn read_scene(_path: &Path, _options: &ImportOptions) -> Result<Imported, ImportError> {
    Err(ImportError::Unfinished)
}
