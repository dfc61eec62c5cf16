//! Solutions.

pub mod files;
pub mod picture;
pub mod read;
pub mod relight;
pub mod values;

use std::ffi::c_void;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use patchlight::pipeline::Evaluator;
use patchlight::solve::{ErrorFigure, ErrorReport, SolveReport};

use crate::context::Context;
use crate::entry::enter;
use crate::handles::{self, Handle};
use crate::memory::Out;
use crate::observer::{Listener, patchlight_progress_function};
use crate::status::{Ending, Outcome, PATCHLIGHT_CANCELLED, PATCHLIGHT_NOT_AVAILABLE, patchlight_status};

/// The answer: radiosities of everything, and what values at points and pictures are made from. Unchangeable; may be read by many threads.
pub struct patchlight_solution {
    _private: [u8; 0],
}

impl Handle for patchlight_solution {
    type Target = Solution;
    const NAME: &'static str = "solution";
}

/// Behind a handle.
pub struct Solution {
    /// Kept for its threads.
    context: Arc<Context>,
    pub evaluator: Evaluator,
    known: Known,
    listener: Mutex<Listener>,
    /// Set by visibility functions of the caller's.
    pub failed: Arc<AtomicBool>,
}

/// What is known of how it came to be.
pub enum Known {
    /// It was solved.
    Solved(Box<Report>),
    /// Solved again for other materials, with this error.
    Estimated(ErrorReport),
    /// Light groups were weighted, with this error by energy.
    Weighted(ErrorFigure),
    /// It was read from a file.
    Nothing,
}

/// What the solve told.
pub struct Report {
    pub solve: SolveReport,
    pub json: String,
    pub status: patchlight_status,
}

impl Solution {
    pub fn new(context: Arc<Context>, evaluator: Evaluator, known: Known, failed: Arc<AtomicBool>) -> Self {
        Self { context, evaluator, known, listener: Mutex::new(Listener::NONE), failed }
    }

    fn report(&self) -> Outcome<&Report> {
        let message = "a solution that was read from a file, or follows from another, has no report";
        match &self.known {
            Known::Solved(report) => Ok(report),
            _ => Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, message)),
        }
    }

    pub fn listener(&self) -> Listener {
        *self.listener.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn set_listener(&self, listener: Listener) {
        *self.listener.lock().unwrap_or_else(PoisonError::into_inner) = listener;
    }
}

/// Values, a mesh or a picture were cancelled.
pub fn cancelled() -> Ending {
    Ending::new(PATCHLIGHT_CANCELLED, "the progress function cancelled; nothing was written")
}

/// One more patchlight_solution_release is needed.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_solution_retain(solution: *mut patchlight_solution) -> patchlight_status {
    enter(|| handles::retain(solution))
}

/// Lets a solution go. NULL is let go by.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_solution_release(solution: *mut patchlight_solution) -> patchlight_status {
    enter(|| handles::release(solution))
}

/// Sets who hears how far values at points, meshes and pictures are, and may cancel them; NULL for nobody, as at first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_set_progress(
    solution: *mut patchlight_solution,
    progress: patchlight_progress_function,
    user: *mut c_void,
) -> patchlight_status {
    enter(|| {
        handles::get(solution)?.set_listener(Listener { function: progress, user });
        Ok(())
    })
}

/// How the solve ended, as patchlight_solve said. PATCHLIGHT_NOT_AVAILABLE for one that was read from a file or follows from another.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_status(
    solution: *mut patchlight_solution,
    status: *mut patchlight_status,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        unsafe { Out::new(status, "status")? }.set(solution.report()?.status)
    })
}
