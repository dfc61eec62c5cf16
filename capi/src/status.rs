//! How a call ends, and what is told about it.

use std::cell::RefCell;
use std::ffi::{CStr, CString};
use std::fmt::Display;

use patchlight::output::{DestinationError, SolutionFileError, UnknownExtension};
use patchlight::picture::CameraError;
use patchlight::pipeline::PipelineError;
use patchlight::solve::OptionsError;
use patchlight::visibility::VisibilityError;

/// How a call ended. Values may be added within these ranges: 0 is success; 1 to 99: it ended early, and what there is can be read; 100
/// and above: it failed, and nothing has changed. Negative values are never used.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_status {
    /// Done.
    PATCHLIGHT_OK = 0,
    /// A limit on time or links ended the solve before the requested error was reached, or nothing more could be gained. There is a
    /// solution; or, where a mesh was made, a mesh.
    PATCHLIGHT_LIMIT = 1,
    /// The memory budget ended the solve before the requested error was reached. There is a solution.
    PATCHLIGHT_MEMORY_LIMIT = 2,
    /// The progress function cancelled. Of a solve there is a solution, of values, meshes and pictures nothing.
    PATCHLIGHT_CANCELLED = 3,
    /// An argument is NULL where it must not be, not finite, not UTF-8, or does not fit the others.
    PATCHLIGHT_INVALID_ARGUMENT = 100,
    /// A handle is NULL, was released, or is of another kind.
    PATCHLIGHT_INVALID_HANDLE = 101,
    /// No option has this key.
    PATCHLIGHT_UNKNOWN_OPTION = 102,
    /// A value is out of range, or options contradict each other.
    PATCHLIGHT_OUT_OF_RANGE = 103,
    /// The scene cannot be used; its diagnostics say why.
    PATCHLIGHT_INVALID_SCENE = 104,
    /// The scene is committed and cannot be changed, or not committed and cannot be used.
    PATCHLIGHT_WRONG_STATE = 105,
    /// The buffer is too small; the count says how large it must be.
    PATCHLIGHT_BUFFER_TOO_SMALL = 106,
    /// There is nothing of that, as bounds in a solution without bounds.
    PATCHLIGHT_NOT_AVAILABLE = 107,
    /// A file cannot be read or written.
    PATCHLIGHT_FILE_ERROR = 108,
    /// The visibility backend is unknown, not built in, or failed.
    PATCHLIGHT_BACKEND_ERROR = 109,
    /// The system has no threads or no memory for this.
    PATCHLIGHT_OUT_OF_RESOURCES = 110,
    /// A function of the caller's failed, or gave an answer that cannot be.
    PATCHLIGHT_CALLBACK_ERROR = 111,
    /// A mistake in the library; please report it.
    PATCHLIGHT_INTERNAL_ERROR = 199,
}

pub use patchlight_status::*;

/// Why a call did not end with [`PATCHLIGHT_OK`], and what to tell.
#[derive(Debug)]
pub struct Ending {
    /// What the caller gets.
    pub status: patchlight_status,
    /// For people.
    pub message: String,
}

/// How the body of a function ends.
pub type Outcome<T = ()> = Result<T, Ending>;

impl Ending {
    /// With this status and message.
    pub fn new(status: patchlight_status, message: impl Display) -> Self {
        Self { status, message: message.to_string() }
    }

    /// An argument cannot be used.
    pub fn argument(message: impl Display) -> Self {
        Self::new(PATCHLIGHT_INVALID_ARGUMENT, message)
    }
}

impl From<OptionsError> for Ending {
    fn from(error: OptionsError) -> Self {
        let status = match &error {
            OptionsError::UnknownKey { .. } => PATCHLIGHT_UNKNOWN_OPTION,
            OptionsError::OutOfRange { .. } => PATCHLIGHT_OUT_OF_RANGE,
        };
        Self::new(status, error)
    }
}

impl From<PipelineError> for Ending {
    fn from(error: PipelineError) -> Self {
        let status = match error {
            PipelineError::Options(error) => return error.into(),
            PipelineError::Visibility(error) => return error.into(),
            PipelineError::Camera(_) => PATCHLIGHT_INVALID_ARGUMENT,
            PipelineError::Interest(_)
            | PipelineError::LightGroups(_)
            | PipelineError::Lights
            | PipelineError::Memory { .. }
            | PipelineError::TeamTime
            | PipelineError::TeamDiffers => PATCHLIGHT_OUT_OF_RANGE,
            PipelineError::Threads { .. } => PATCHLIGHT_OUT_OF_RESOURCES,
        };
        Self::new(status, error)
    }
}

impl From<VisibilityError> for Ending {
    fn from(error: VisibilityError) -> Self {
        let status = match error {
            VisibilityError::OutOfMemory { .. } => PATCHLIGHT_OUT_OF_RESOURCES,
            _ => PATCHLIGHT_BACKEND_ERROR,
        };
        Self::new(status, error)
    }
}

impl From<CameraError> for Ending {
    fn from(error: CameraError) -> Self {
        Self::argument(error)
    }
}

impl From<DestinationError> for Ending {
    fn from(error: DestinationError) -> Self {
        Self::new(PATCHLIGHT_FILE_ERROR, error)
    }
}

impl From<SolutionFileError> for Ending {
    fn from(error: SolutionFileError) -> Self {
        Self::new(PATCHLIGHT_FILE_ERROR, error)
    }
}

impl From<UnknownExtension> for Ending {
    fn from(error: UnknownExtension) -> Self {
        Self::argument(error)
    }
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Keeps a message for [`last_message`].
pub fn set_message(message: &str) {
    // A name that somebody gave may hold a zero.
    let message = CString::new(message.replace('\0', "\u{fffd}")).unwrap_or_default();
    // A thread that is about to end has nobody to tell.
    let _ = MESSAGE.try_with(|last| *last.borrow_mut() = message);
}

/// The message of the last call on this thread; it stays where it is until the next [`set_message`].
pub fn last_message() -> *const std::ffi::c_char {
    const NONE: &CStr = c"";
    MESSAGE.try_with(|last| last.borrow().as_ptr()).unwrap_or(NONE.as_ptr())
}
