//! How a run ends.

use std::fmt::Display;
use std::process::ExitCode;

use patchlight::output::DestinationError;
use patchlight::pipeline::PipelineError;
use patchlight::solve::StoppedBy;
use patchlight::visibility::VisibilityError;

/// The exit codes, as `--help` lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// What was asked for is done.
    Done = 0,
    /// The machine failed: a full disk, no threads, a native library.
    Failed = 1,
    /// The command line asks for something impossible.
    Usage = 2,
    /// An input file is bad.
    BadInput = 3,
    /// A limit ended the solve before the requested error was reached. Results are written.
    Limit = 4,
    /// Out of memory: the budget ended the solve, and results are written; or it was too small to begin, or the machine had no more.
    Memory = 5,
    /// Jobs of a batch failed, or are missing; the others are done.
    JobsFailed = 6,
    /// Interrupted. What there is, is written.
    Cancelled = 130,
}

impl Exit {
    /// How a solve ended that ran to its end.
    pub fn of_solve(stopped_by: StoppedBy, converged: bool) -> Self {
        match stopped_by {
            StoppedBy::Error => Self::Done,
            StoppedBy::Exhausted if converged => Self::Done,
            StoppedBy::MaxLinks | StoppedBy::Time | StoppedBy::Exhausted => Self::Limit,
            StoppedBy::Memory => Self::Memory,
            StoppedBy::Cancelled => Self::Cancelled,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a run ended early, and what to tell.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    /// What went wrong, and what to do about it.
    pub message: String,
}

impl Failure {
    /// The command line asks for something impossible.
    pub fn usage(message: impl Display) -> Self {
        Self { exit: Exit::Usage, message: message.to_string() }
    }

    /// An input file is bad.
    pub fn bad_input(message: impl Display) -> Self {
        Self { exit: Exit::BadInput, message: message.to_string() }
    }

    /// The machine failed.
    pub fn failed(message: impl Display) -> Self {
        Self { exit: Exit::Failed, message: message.to_string() }
    }
}

impl From<PipelineError> for Failure {
    fn from(error: PipelineError) -> Self {
        match error {
            PipelineError::Options(_)
            | PipelineError::Camera(_)
            | PipelineError::Interest(_)
            | PipelineError::LightGroups(_)
            | PipelineError::Lights
            | PipelineError::TeamTime
            | PipelineError::TeamDiffers => Self::usage(error),
            PipelineError::Visibility(VisibilityError::UnknownBackend(_) | VisibilityError::NotBuilt { .. }) => Self::usage(error),
            PipelineError::Memory { .. } => Self { exit: Exit::Memory, message: format!("--memory: {error}") },
            PipelineError::Visibility(VisibilityError::OutOfMemory { .. }) => {
                Self { exit: Exit::Memory, message: error.to_string() }
            }
            PipelineError::Visibility(VisibilityError::Native { .. } | VisibilityError::BadMesh(_))
            | PipelineError::Threads { .. } => Self::failed(error),
        }
    }
}

/// While writing: what could be checked beforehand was checked.
impl From<DestinationError> for Failure {
    fn from(error: DestinationError) -> Self {
        Self::failed(error)
    }
}
