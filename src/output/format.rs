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
    /// Linear, with a common exponent.
    Hdr,
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
            Some("hdr") => Ok(Self::Hdr),
            _ => Err(UnknownExtension { path: path.to_owned(), known: &[".exr", ".png", ".hdr"] }),
        }
    }
}

/// Formats that solutions are exported to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Polygons with float radiosities.
    Ply,
    /// glTF for viewers, in colours, with float radiosities beside.
    Glb,
    /// PolyData of VTK, for ParaView.
    Vtp,
}

impl ExportFormat {
    /// By the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`UnknownExtension`].
    pub fn of_path(path: &Path) -> Result<Self, UnknownExtension> {
        match extension(path).as_deref() {
            Some("ply") => Ok(Self::Ply),
            Some("glb") => Ok(Self::Glb),
            Some("vtp") => Ok(Self::Vtp),
            _ => Err(UnknownExtension { path: path.to_owned(), known: &[".ply", ".glb", ".vtp"] }),
        }
    }
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
