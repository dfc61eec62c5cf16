//! Reading scenes from files, and faces from memory: what is fatal, what is repaired, and where.
//!
//! Fatal are files that cannot be read, among them material libraries whose materials are used and defined nowhere else, broken syntax,
//! indices out of range, numbers that are not finite, and a scene without a face. Everything else is repaired as [`DiagnosticKind`] tells, and each repair is a [`Diagnostic`] with file, line and face.
//! Reading costs O(n log n) for n corners, but for single concave faces of very many corners.

mod arrays;
mod assemble;
mod changed_faces;
mod cut;
mod diagnostics;
mod draft;
mod error;
mod faces;
mod gltf;
mod join;
mod lights;
mod maps;
mod mtl;
mod names;
mod obj;
mod options;
mod ply;
mod statements;
mod stl;
mod structure;
mod text;
mod texture_coordinates;
mod textured;
mod textures;

use std::path::{Path, PathBuf};

pub use arrays::{ArrayFace, ArraysError, polygons_of_arrays};
pub use changed_faces::{ChangedFaces, DroppedFace};
pub use diagnostics::{Diagnostic, DiagnosticKind, Diagnostics, Severity};
pub use draft::{Draft, DraftError, Mistake, MistakeKind};
pub use error::ImportError;
pub use lights::{ImportedLights, read_lights};
pub use options::{ImportOptions, Textures};

use self::faces::FaceFile;
use super::{FileUv, Scene};
use crate::progress::{Observer, Progress, Silent, Stage};

/// A scene and what was noted while reading it.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// What was repaired or looks suspicious.
    pub diagnostics: Diagnostics,
    /// The faces that were dropped or flattened. Those of fewer than three corners are told by diagnostics alone.
    pub changed: ChangedFaces,
    /// The file that it was read from.
    pub file: PathBuf,
    /// The other files that were read: material libraries, buffers, images, lights.
    pub libraries: Vec<PathBuf>,
    /// The line of each face in the file, dropped ones too, from 1; 0 where the format has no lines. [`Surface::face`](super::Surface::face) is an
    /// index into it.
    pub lines: Vec<u32>,
    /// How many vertices the file has.
    pub vertices: usize,
    /// The coordinates that it has for lightmaps; empty if they were not to be kept.
    pub uv: FileUv,
}

/// Reads the scene at `path`, by its extension: `.obj` with its material libraries, `.gltf` and `.glb`, or
/// `.ply` and `.stl` without materials; always with three channels (linear
/// Rec.709 RGB).
///
/// Of OBJ `Kd` is the reflectance and `pi Ke` the exitance, times the mean of `map_Kd` and `map_Ke` over the face; of glTF the base colour, and `pi` times factor and strength of the emission, which count as a
/// radiance in W/m^2/sr. Polygons that are not convex and planar are cut; all pieces bear the number of their face. Triangles
/// of a glTF primitive that lie in one plane are joined. glTF is in metres with y up; of other formats [`ImportOptions`] tells unit and up. Lights that are no surfaces come from glTF files and from [`ImportOptions::lights`].
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
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();

    if let Some(unit) = options.unit.filter(|unit| !ImportOptions::UNITS.contains(unit)) {
        return Err(ImportError::BadUnit(unit));
    }
    if matches!(extension.as_str(), "gltf" | "glb") && (options.unit.is_some() || options.up.is_some()) {
        return Err(ImportError::KnowsUnits { file: file() });
    }
    let mut diagnostics = Diagnostics::default();
    observer.progress(&Progress { stage: Stage::Read, round: 0, fraction: None, links: 0, elements: 0, error: None });
    let stop = || observer.cancelled();
    let read = match extension.as_str() {
        "obj" => obj::read(path, options, &mut diagnostics, &stop)?,
        "gltf" | "glb" => gltf::read(path, options, &mut diagnostics, &stop)?,
        "ply" => ply::read(path, &mut diagnostics, &stop)?,
        "stl" => stl::read(path, &mut diagnostics, &stop)?,
        _ => return Err(ImportError::UnknownExtension { file: file() }),
    };
    if stop() {
        return Err(ImportError::Cancelled);
    }
    let read = match options.unit {
        Some(metres) => read.scaled(metres),
        None => read,
    };
    let FaceFile { lines, vertices, faces, corners, materials, mut libraries, objects, groups, mut lights, uv } = read;
    let in_file = assemble::Faces { faces: &faces, corners: &corners, source: Some((path, &lines)), objects: &objects };
    let assembled = assemble::assemble(&in_file, &mut diagnostics, &stop).ok_or(ImportError::Cancelled)?;
    if assembled.polygons.is_empty() {
        // Faces of fewer than three corners never came as far as the assembly.
        let dropped = assembled.changed.dropped.len() + lines.len().saturating_sub(faces.len());
        return Err(ImportError::NoFaces { file: file(), read: lines.len(), dropped });
    }

    if stop() {
        return Err(ImportError::Cancelled);
    }
    if let Some(path) = &options.lights {
        let read = lights::read_lights_of(path, 3, options)?;
        lights.extend(read.lights);
        diagnostics.items.extend(read.diagnostics.items);
        libraries.extend(read.files);
    }
    let scene = Scene::new(3, materials, assembled.polygons, options.sides)
        .and_then(|scene| scene.with_lights(lights))
        .map_err(|source| ImportError::Scene { file: file(), source })?
        .with_names(objects, groups)
        .with_up(options.up);
    if scene.is_dark() {
        let text = "no light: no face has a material that emits, and there are no lights, so everything is black";
        diagnostics.push(Diagnostic::new(DiagnosticKind::NoLight, text).at(path, 0));
    }
    Ok(Imported { scene, diagnostics, changed: assembled.changed, file: file(), libraries, lines, vertices, uv })
}
