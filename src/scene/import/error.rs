//! Why a file cannot be read as a scene.

use std::path::PathBuf;

use thiserror::Error;

use super::options::ImportOptions;
use crate::scene::SceneError;

/// Why a file could not be read: fatal, exit code 3. Each names the file, and the line and face where there is one, and what to do.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ImportError {
    /// The observer cancelled.
    #[error("reading was cancelled")]
    Cancelled,
    /// The metres of a unit are out of range.
    #[error("a unit of {0} m is out of range: it must be from {least:e} to {most:e} m", least = ImportOptions::UNITS.start(), most = ImportOptions::UNITS.end())]
    BadUnit(f64),
    /// The format says itself what a unit is and where up is.
    #[error("{}: glTF is in metres, and y is up: take unit and up away", file.display())]
    KnowsUnits {
        /// The file.
        file: PathBuf,
    },
    /// The name ends in no extension that a reader is for.
    #[error("{}: unknown kind of file; a scene is an .obj, .gltf, .glb, .ply or .stl file", file.display())]
    UnknownExtension {
        /// The file.
        file: PathBuf,
    },
    /// The file is missing, not a regular file, or not allowed to be read.
    #[error("{}: cannot be read: {reason}; check the name and its permissions", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A material library cannot be read, and a face has a material that no other one defines.
    #[error(
        "{}: material library {} cannot be read ({reason}), and material '{material}' is defined nowhere else; \
         put the library beside the scene, or take its mtllib and usemtl out", place(file, *line, None), library.display()
    )]
    MissingLibrary {
        /// The file that names the library.
        file: PathBuf,
        /// Its line, from 1.
        line: u32,
        /// The library.
        library: PathBuf,
        /// Why it cannot be read.
        reason: String,
        /// The first material that is missing.
        material: String,
    },
    /// A statement, or a part of a file, is not what the format allows.
    #[error("{}: {reason}", place(file, *line, *face))]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Its line, from 1; 0 where none can be named.
        line: u32,
        /// The number of the face in the file, from 1.
        face: Option<u32>,
        /// What was found, what was expected.
        reason: String,
    },
    /// A face names a vertex that is not there. Vertices count from 1, or backwards from -1; 0 is none.
    #[error("{}: vertex {index} does not exist: {}", place(file, *line, Some(*face)), allowed(index, *vertices))]
    IndexOutOfRange {
        /// The file.
        file: PathBuf,
        /// Its line, from 1.
        line: u32,
        /// The number of the face in the file, from 1.
        face: u32,
        /// The index as written.
        index: String,
        /// How many vertices there are: before the face for a negative index, in the whole file otherwise.
        vertices: usize,
    },
    /// A coordinate, a reflectance or an emission is NaN, infinite or beyond `1e30`.
    #[error("{}: {what} is '{value}', not a number below 1e30; correct the line or export the scene again", place(file, *line, None))]
    NotFinite {
        /// The file.
        file: PathBuf,
        /// Its line, from 1.
        line: u32,
        /// What it is the value of, as in `a coordinate of vertex 12`.
        what: String,
        /// The value as written.
        value: String,
    },
    /// No face is left to light.
    #[error("{}: {}", file.display(), no_faces(*read, *dropped))]
    NoFaces {
        /// The file.
        file: PathBuf,
        /// How many faces the file has.
        read: usize,
        /// How many of them were dropped as degenerate or duplicate.
        dropped: usize,
    },
    /// The faces make no valid scene.
    #[error("{}: {source}", file.display())]
    Scene {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: SceneError,
    },
}

fn place(file: &std::path::Path, line: u32, face: Option<u32>) -> String {
    let mut place = file.display().to_string();
    if line > 0 {
        place += &format!(":{line}");
    }
    if let Some(face) = face {
        place += &format!(": face {face}");
    }
    place
}

fn allowed(index: &str, vertices: usize) -> String {
    match (index.starts_with('-'), vertices) {
        (_, 0) => "no vertex is defined".to_owned(),
        (true, _) => format!("{vertices} vertices are defined before this face, so the lowest index is -{vertices}"),
        (false, _) => format!("the file has {vertices} vertices, counted from 1"),
    }
}

fn no_faces(read: usize, dropped: usize) -> String {
    match read {
        0 => "has no face; a scene needs at least one".to_owned(),
        _ => {
            format!("no face is left of {read}, {dropped} were dropped as degenerate or duplicate; check the vertices and the unit")
        }
    }
}
