//! Contexts: worker threads, and who hears what happens.

use std::ffi::{CString, c_char, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use patchlight::pipeline::Workers;

use crate::entry::enter;
use crate::float_state::FloatState;
use crate::handles::{self, Handle};
use crate::memory::Out;
use crate::status::{Ending, Outcome, PATCHLIGHT_OUT_OF_RANGE, patchlight_status};

/// Worker threads, and who hears what happens. Scenes, solves and solutions of a context use its threads.
pub struct patchlight_context {
    _private: [u8; 0],
}

impl Handle for patchlight_context {
    type Target = Context;
    const NAME: &'static str = "context";
}

/// What a line of the log is. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_log_level {
    /// What was repaired in a scene, or is suspicious.
    PATCHLIGHT_LOG_WARNING = 1,
    /// Key figures.
    PATCHLIGHT_LOG_INFO = 2,
}

pub use patchlight_log_level::*;

/// Hears lines of the log: its own data, a patchlight_log_level, and a line that is gone when it returns. Called on the thread that called
/// the library, during that call.
pub type patchlight_log_function = Option<unsafe extern "C" fn(user: *mut c_void, level: u32, line: *const c_char)>;

/// Behind a handle.
pub struct Context {
    pub workers: Workers,
    log: Mutex<Log>,
}

#[derive(Clone, Copy)]
struct Log {
    function: patchlight_log_function,
    user: *mut c_void,
}

// SAFETY: The data are handed to the caller's function alone, which the header says is called on any thread that calls the library.
unsafe impl Send for Log {}

impl Context {
    fn new(workers: Workers) -> Arc<Self> {
        Arc::new(Self { workers, log: Mutex::new(Log { function: None, user: std::ptr::null_mut() }) })
    }

    /// Tells whoever listens.
    pub fn log(&self, level: patchlight_log_level, line: &str) {
        // Not while the lock is held: the function may call the library.
        let log = *self.log.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(function) = log.function else { return };
        let Ok(line) = CString::new(line.replace('\0', "\u{fffd}")) else { return };
        let _state = FloatState::kept();
        // SAFETY: The caller's function with its own data and a line that lives until it returns.
        unsafe { function(log.user, level as u32, line.as_ptr()) };
    }
}

/// Makes a context with so many worker threads; 0 takes one for each core. The number never changes an answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_context_create(threads: u32, context: *mut *mut patchlight_context) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(context, "context")? };
        let most = Workers::most();
        if threads as usize > most {
            let message = format!("threads is {threads}, it must be from 1 to {most}, or 0 for one for each core");
            return Err(Ending::new(PATCHLIGHT_OUT_OF_RANGE, message));
        }
        out.set(handles::create(Context::new(Workers::new(threads as usize)?)))
    })
}

/// Makes a context that uses the worker threads of another.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_context_create_sharing(
    other: *mut patchlight_context,
    context: *mut *mut patchlight_context,
) -> patchlight_status {
    enter(|| {
        let other = handles::get(other)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(context, "context")? };
        out.set(handles::create(Context::new(other.workers.clone())))
    })
}

/// One more patchlight_context_release is needed.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_context_retain(context: *mut patchlight_context) -> patchlight_status {
    enter(|| handles::retain(context))
}

/// Lets a context go. What was made with it keeps what it needs. NULL is let go by.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_context_release(context: *mut patchlight_context) -> patchlight_status {
    enter(|| handles::release(context))
}

/// How many worker threads a context has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_context_threads(context: *mut patchlight_context, threads: *mut u32) -> patchlight_status {
    enter(|| {
        let context = handles::get(context)?;
        // SAFETY: The contract of the header.
        unsafe { Out::new(threads, "threads")? }.set(context.workers.count() as u32)
    })
}

/// Sets who hears the log of a context; NULL for nobody, as at first. `user` is handed to the function as it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_context_set_log(
    context: *mut patchlight_context,
    function: patchlight_log_function,
    user: *mut c_void,
) -> patchlight_status {
    enter(|| {
        let context = handles::get(context)?;
        *context.log.lock().unwrap_or_else(PoisonError::into_inner) = Log { function, user };
        Outcome::Ok(())
    })
}
