//! Exceptions. Their classes are Python's, in `patchlight/_errors.py`, since most have two bases.

use std::fmt::Display;

use patchlight::output::{DestinationError, SolutionFileError, UnknownExtension};
use patchlight::picture::CameraError;
use patchlight::pipeline::PipelineError;
use patchlight::scene::LightGroupError;
use patchlight::scene::import::{DraftError, ImportError};
use patchlight::solve::{OptionsError, OtherMaterialsError};
use patchlight::visibility::VisibilityError;
use pyo3::prelude::*;

use crate::diagnostic::Diagnostic;

/// What will be an exception; made without Python.
#[derive(Debug)]
pub struct Failure {
    class: &'static str,
    message: String,
    diagnostics: Vec<Diagnostic>,
}

impl Failure {
    fn new(class: &'static str, message: impl Display) -> Self {
        Self { class, message: message.to_string(), diagnostics: Vec::new() }
    }

    /// An argument is not what it must be.
    pub fn argument(message: impl Display) -> Self {
        Self::new("ArgumentError", message)
    }

    /// An option is unknown or out of range.
    pub fn option(message: impl Display) -> Self {
        Self::new("OptionError", message)
    }

    /// The system has no threads for this, or they belong to another process.
    pub fn resource(message: impl Display) -> Self {
        Self::new("ResourceError", message)
    }

    /// The progress function ended what is worth nothing before its end.
    pub fn cancelled() -> Self {
        Self::new("Cancelled", "the progress function ended it")
    }

    /// A mistake of ours.
    pub fn internal(message: impl Display) -> Self {
        Self::new("InternalError", format_args!("a mistake in the library, please report it: {message}"))
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        let Failure { class, message, diagnostics } = failure;
        Python::attach(|py| {
            let class = class_of(py, class)?;
            let error = if diagnostics.is_empty() { class.call1((message,)) } else { class.call1((message, diagnostics)) };
            error.map(PyErr::from_value)
        })
        .unwrap_or_else(|error| error)
    }
}

/// A class of `patchlight/_errors.py`.
pub fn class_of<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("patchlight._errors")?.getattr(name)
}

/// Warns that something ended before the error that was asked for was reached.
pub fn warn_of_limit(py: Python<'_>, message: &str) -> PyResult<()> {
    let warn = py.import("warnings")?.getattr("warn")?;
    warn.call1((message, class_of(py, "LimitWarning")?)).map(drop)
}

impl From<OptionsError> for Failure {
    fn from(error: OptionsError) -> Self {
        Self::option(error)
    }
}

impl From<PipelineError> for Failure {
    fn from(error: PipelineError) -> Self {
        let class = match error {
            PipelineError::Options(_)
            | PipelineError::Interest(_)
            | PipelineError::LightGroups(_)
            | PipelineError::Lights
            | PipelineError::TeamTime
            | PipelineError::TeamDiffers
            | PipelineError::Memory { .. } => "OptionError",
            PipelineError::Visibility(VisibilityError::OutOfMemory { .. }) => "ResourceError",
            PipelineError::Visibility(_) => "BackendError",
            PipelineError::Camera(_) => "ArgumentError",
            PipelineError::Threads { .. } => "ResourceError",
        };
        Self::new(class, error)
    }
}

impl From<LightGroupError> for Failure {
    fn from(error: LightGroupError) -> Self {
        Self::argument(error)
    }
}

impl From<OtherMaterialsError> for Failure {
    fn from(error: OtherMaterialsError) -> Self {
        Self::argument(error)
    }
}

impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        Self::argument(error)
    }
}

impl From<UnknownExtension> for Failure {
    fn from(error: UnknownExtension) -> Self {
        Self::argument(error)
    }
}

impl From<DestinationError> for Failure {
    fn from(error: DestinationError) -> Self {
        Self::new("FileError", error)
    }
}

impl From<SolutionFileError> for Failure {
    fn from(error: SolutionFileError) -> Self {
        Self::new("FileError", error)
    }
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        let class = if matches!(error, ImportError::Unreadable { .. }) { "FileError" } else { "SceneError" };
        let diagnostics = if class == "SceneError" { vec![Diagnostic::of_import(&error)] } else { Vec::new() };
        Self { diagnostics, ..Self::new(class, error) }
    }
}

impl From<DraftError> for Failure {
    fn from(error: DraftError) -> Self {
        let noted = error.diagnostics.items.iter().map(Diagnostic::of);
        let diagnostics = noted.chain(error.mistakes.iter().map(Diagnostic::of_mistake)).collect();
        Self { diagnostics, ..Self::new("SceneError", error) }
    }
}
