//! Which file format a path asks for, by its extension.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// The extension names no format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: unknown extension; write a file that ends in {}", .path.display(), .known.join(" or "))]
pub struct UnknownExtension {
    /// What was given.
    pub path: PathBuf,
    /// Extensions that are known.
    pub known: &'static [&'static str],
}

/// Formats of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// Linear floats.
    Exr,
    /// 8-bit sRGB for display.
    Png,
}

impl ImageFormat {
    /// By the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`UnknownExtension`].
    pub fn of_path(path: &Path) -> Result<Self, UnknownExtension> {
        match extension(path).as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => Err(UnknownExtension { path: path.to_owned(), known: &[".exr", ".png"] }),
        }
    }
}

/// Formats that solutions are exported to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Polygons with float radiosities.
    Ply,
}

impl ExportFormat {
    /// By the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`UnknownExtension`].
    pub fn of_path(path: &Path) -> Result<Self, UnknownExtension> {
        match extension(path).as_deref() {
            Some("ply") => Ok(Self::Ply),
            _ => Err(UnknownExtension { path: path.to_owned(), known: &[".ply"] }),
        }
    }
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
