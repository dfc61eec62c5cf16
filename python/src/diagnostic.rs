//! What was noted about a scene.

use std::path::PathBuf;

use patchlight::scene::import::{self, ImportError, Mistake, MistakeKind};
use pyo3::prelude::*;

use crate::names::name_of;

/// Something that was noted about a scene: an error, a repair, a suspicion, or a note.
#[pyclass(frozen, module = "patchlight")]
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// What it is about, as in "degenerate_face".
    #[pyo3(get)]
    pub kind: String,
    /// "error": the scene cannot be used; "repair": what is solved is not exactly what was given; "suspicion": it may not be what was
    /// meant; "note": nothing is wrong.
    #[pyo3(get)]
    severity: String,
    /// The file, or None.
    #[pyo3(get)]
    file: Option<PathBuf>,
    /// The line in the file, from 1, or None.
    #[pyo3(get)]
    line: Option<u32>,
    /// The index of the face in the arrays or in the file, from 0, or None. Texts count faces from 1.
    #[pyo3(get)]
    face: Option<u64>,
    /// What was found, with its place.
    #[pyo3(get)]
    text: String,
}

#[pymethods]
impl Diagnostic {
    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<patchlight.Diagnostic {} ({}): {}>", self.severity, self.kind, self.text)
    }
}

impl Diagnostic {
    pub fn of(noted: &import::Diagnostic) -> Self {
        Self {
            kind: name_of(&noted.kind),
            severity: name_of(&noted.severity()),
            file: noted.file.clone(),
            line: noted.line,
            face: noted.face.map(|face| u64::from(face) - 1),
            text: noted.to_string(),
        }
    }

    pub fn of_mistake(mistake: &Mistake) -> Self {
        let kind = match mistake.kind {
            MistakeKind::BadIndex => "bad_index",
            MistakeKind::BadVertex => "bad_vertex",
            MistakeKind::BadMaterial => "bad_material",
            MistakeKind::BadScene => "bad_scene",
        };
        Self { file: None, line: None, face: mistake.face, text: mistake.text.clone(), ..Self::error(kind) }
    }

    /// Why a file could not be read.
    pub fn of_import(error: &ImportError) -> Self {
        let (kind, file, line, face) = match error {
            ImportError::Cancelled => ("cancelled", None, 0, None),
            ImportError::BadUnit(_) => ("bad_unit", None, 0, None),
            ImportError::KnowsUnits { file } => ("knows_units", Some(file), 0, None),
            ImportError::UnknownExtension { file } => ("unknown_extension", Some(file), 0, None),
            ImportError::Unreadable { file, .. } => ("unreadable", Some(file), 0, None),
            ImportError::MissingLibrary { file, line, .. } => ("missing_library", Some(file), *line, None),
            ImportError::Syntax { file, line, face, .. } => ("syntax", Some(file), *line, *face),
            ImportError::IndexOutOfRange { file, line, face, .. } => ("bad_index", Some(file), *line, Some(*face)),
            ImportError::NotFinite { file, line, .. } => ("not_finite", Some(file), *line, None),
            ImportError::NoFaces { file, .. } => ("bad_scene", Some(file), 0, None),
            ImportError::Scene { file, .. } => ("bad_scene", Some(file), 0, None),
        };
        Self {
            file: file.cloned(),
            line: (line > 0).then_some(line),
            face: face.map(|face| u64::from(face) - 1),
            text: error.to_string(),
            ..Self::error(kind)
        }
    }

    fn error(kind: &str) -> Self {
        Self { kind: kind.to_owned(), severity: "error".to_owned(), file: None, line: None, face: None, text: String::new() }
    }
}
