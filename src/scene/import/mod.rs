//! Reading scenes from files, and faces from memory: what is fatal, what is repaired, and where.
//!
//! Fatal are files that cannot be read, among them material libraries whose materials are used and defined nowhere else, broken syntax,
//! indices out of range, numbers that are not finite, and a scene without a face. Everything else is repaired as [`DiagnosticKind`] tells, and each repair is a [`Diagnostic`] with file, line and face.
//! Reading costs O(n log n) for n corners, but for single concave faces of very many corners.

mod arrays;
mod assemble;
mod cut;
mod diagnostics;
mod draft;
mod error;
mod mtl;
mod names;
mod obj;
mod statements;
mod structure;
mod text;

use std::path::{Path, PathBuf};

pub use arrays::{ArrayFace, ArraysError, polygons_of_arrays};
pub use diagnostics::{Diagnostic, DiagnosticKind, Diagnostics, Severity};
pub use draft::{Draft, DraftError, Mistake, MistakeKind};
pub use error::ImportError;

use super::{Scene, Sides};
use crate::progress::{Observer, Progress, Silent, Stage};

/// What the reader may decide.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Which sides of a face emit and receive.
    pub sides: Sides,
    /// Whether `mtllib` may name any file. Else a library lies beside the scene or below that folder: a scene by somebody else reads nothing
    /// of what lies elsewhere.
    pub allow_any_path: bool,
}

/// A scene and what was noted while reading it.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// What was repaired or looks suspicious.
    pub diagnostics: Diagnostics,
    /// The file that it was read from.
    pub file: PathBuf,
    /// The material libraries that were read.
    pub libraries: Vec<PathBuf>,
    /// The line of each face in the file, dropped ones too, from 1. [`Surface::face`](super::Surface::face) is an index into it.
    pub lines: Vec<u32>,
    /// How many vertices the file has.
    pub vertices: usize,
}

/// Reads the scene at `path`, by its extension: `.obj` with its material libraries, always with three channels (linear Rec.709 RGB).
///
/// `Kd` is the reflectance and `pi Ke` the exitance. Polygons that are not convex and planar are cut; all pieces bear the number of
/// their face.
///
/// # Errors
/// See [`ImportError`].
pub fn read_scene(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    read_scene_observed(path, options, &Silent)
}

/// Like [`read_scene`], but tells `observer` that it reads, and ends with [`ImportError::Cancelled`] soon after that says so.
///
/// # Errors
/// See [`ImportError`].
pub fn read_scene_observed(path: &Path, options: &ImportOptions, observer: &dyn Observer) -> Result<Imported, ImportError> {
    let file = || path.to_owned();
    let is_obj = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
    if !is_obj {
        return Err(ImportError::UnknownExtension { file: file() });
    }

    let mut diagnostics = Diagnostics::default();
    observer.progress(&Progress { stage: Stage::Read, round: 0, fraction: None, links: 0, elements: 0, error: None });
    let stop = || observer.cancelled();
    let mut obj = obj::read(path, options.allow_any_path, &mut diagnostics, &stop)?;
    let faces =
        assemble::Faces { faces: &obj.faces, corners: &obj.corners, vertices: obj.vertices, source: Some((path, &obj.lines)) };
    let assembled = assemble::assemble(&faces, &mut diagnostics, &stop).ok_or(ImportError::Cancelled)?;
    if assembled.polygons.is_empty() {
        // Faces of fewer than three corners never came as far as the assembly.
        let dropped = assembled.dropped + obj.lines.len() - obj.faces.len();
        return Err(ImportError::NoFaces { file: file(), read: obj.lines.len(), dropped });
    }

    if stop() {
        return Err(ImportError::Cancelled);
    }
    let materials = std::mem::take(&mut obj.materials);
    let [objects, groups] = std::mem::take(&mut obj.names);
    let scene = Scene::new(3, materials, assembled.polygons, options.sides)
        .map_err(|source| ImportError::Scene { file: file(), source })?
        .with_names(objects, groups);
    if !scene.surfaces().iter().any(|surface| scene.materials()[surface.material as usize].emits()) {
        let text = "no light: no face has a material that emits (Ke), so everything is black";
        diagnostics.push(Diagnostic::new(DiagnosticKind::NoLight, text).at(path, 0));
    }
    Ok(Imported { scene, diagnostics, file: file(), libraries: obj.libraries, lines: obj.lines, vertices: obj.vertices })
}
