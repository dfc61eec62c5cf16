//! The progress function of the caller's.

use std::ffi::c_void;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, TryLockError};
use std::time::{Duration, Instant};

use patchlight::progress::{Observer, Progress, Stage};

use crate::float_state::FloatState;

/// What is being worked on. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_stage {
    /// Building the visibility backend and the hierarchy.
    PATCHLIGHT_STAGE_BUILD = 1,
    /// Deciding pairs of nodes and making links.
    PATCHLIGHT_STAGE_REFINE = 2,
    /// Gathering over links and push-pull.
    PATCHLIGHT_STAGE_GATHER = 3,
    /// Estimating the error of what has been found.
    PATCHLIGHT_STAGE_ERROR = 4,
    /// Evaluating values at points.
    PATCHLIGHT_STAGE_SAMPLE = 5,
    /// Rendering a picture.
    PATCHLIGHT_STAGE_RENDER = 6,
    /// Finding the radiosities of cells.
    PATCHLIGHT_STAGE_CELLS = 7,
    /// Reading a scene.
    PATCHLIGHT_STAGE_READ = 8,
    /// Making the lit mesh.
    PATCHLIGHT_STAGE_MESH = 9,
}

use patchlight_stage::*;

/// How far work is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_progress {
    /// `sizeof(patchlight_progress)` of the library: fields beyond it are not there.
    pub size: usize,
    /// A patchlight_stage.
    pub stage: u32,
    /// The round of refinement, from 1; 0 outside of rounds.
    pub round: u32,
    /// Links so far.
    pub links: u64,
    /// Elements so far.
    pub elements: u64,
    /// The part of the stage that is done, 0 to 1; below 0 where it is not known.
    pub fraction: f64,
    /// The last error estimate; below 0 where there is none.
    pub error: f64,
}

/// Hears how far work is, with its own data; not 0 to cancel. Called on worker threads, by one at a time.
pub type patchlight_progress_function =
    Option<unsafe extern "C" fn(user: *mut c_void, progress: *const patchlight_progress) -> i32>;

/// Hears, with its own data, how many bytes a solve would take now, before it takes more: not 0 to refuse them, which ends the solve as the
/// option `memory` does, with PATCHLIGHT_MEMORY_LIMIT and a solution. Bytes are counted as that option counts them, all that the solve holds
/// and the program itself. Called on worker threads, by one at a time for each solve.
pub type patchlight_memory_function = Option<unsafe extern "C" fn(user: *mut c_void, bytes: u64) -> i32>;

/// Who is asked about memory, with its data.
#[derive(Clone, Copy)]
pub struct MemoryMonitor {
    pub function: patchlight_memory_function,
    pub user: *mut c_void,
}

// SAFETY: The data are handed to the caller's function alone, of which the header says that it is called on worker threads.
unsafe impl Send for MemoryMonitor {}
// SAFETY: As above; what is shared is never changed.
unsafe impl Sync for MemoryMonitor {}

/// A function of the caller's with its data.
#[derive(Clone, Copy)]
pub struct Listener {
    pub function: patchlight_progress_function,
    pub user: *mut c_void,
}

// SAFETY: The data are handed to the caller's function alone, of which the header says that it is called on worker threads.
unsafe impl Send for Listener {}
// SAFETY: As above; what is shared is never changed.
unsafe impl Sync for Listener {}

impl Listener {
    /// Nobody.
    pub const NONE: Self = Self { function: None, user: std::ptr::null_mut() };
}

/// Without a report for so long, the listener is asked whether to cancel.
const PATIENCE: Duration = Duration::from_millis(50);

/// Hands on progress, one report at a time: those that come while one is handed on are left out.
pub struct Watcher<'a> {
    listener: Listener,
    last: Mutex<(Instant, Progress)>,
    cancelled: AtomicBool,
    memory: Option<MemoryMonitor>,
    /// Another reason to end.
    failed: &'a AtomicBool,
}

impl<'a> Watcher<'a> {
    pub fn new(listener: Listener, failed: &'a AtomicBool) -> Self {
        let nothing = Progress { stage: Stage::Build, round: 0, fraction: None, links: 0, elements: 0, error: None };
        Self { listener, last: Mutex::new((Instant::now(), nothing)), cancelled: AtomicBool::new(false), memory: None, failed }
    }

    /// Asks about memory, too.
    pub fn asking(self, memory: MemoryMonitor) -> Self {
        Self { memory: Some(memory), ..self }
    }

    /// Whether the listener has cancelled.
    pub fn was_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Tells the listener what is new, or what it knows already, if nobody else is at it.
    fn tell(&self, new: Option<&Progress>) {
        let Some(function) = self.listener.function else { return };
        if self.was_cancelled() {
            return;
        }
        let mut last = match self.last.try_lock() {
            Ok(last) => last,
            Err(TryLockError::Poisoned(last)) => last.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        match new {
            Some(progress) => last.1 = *progress,
            None if last.0.elapsed() < PATIENCE => return,
            None => {}
        }
        let report = report(&last.1);
        let state = FloatState::kept();
        // SAFETY: The caller's function with its own data and a report that lives until it returns; the lock keeps others away.
        let answer = unsafe { function(self.listener.user, &raw const report) };
        drop(state);
        if answer != 0 {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        last.0 = Instant::now();
    }
}

impl Observer for Watcher<'_> {
    fn progress(&self, progress: &Progress) {
        self.tell(Some(progress));
    }

    fn cancelled(&self) -> bool {
        if self.failed.load(Ordering::Relaxed) {
            return true;
        }
        self.tell(None);
        self.was_cancelled()
    }

    fn allows_memory(&self, bytes: u64) -> bool {
        let Some(MemoryMonitor { function: Some(function), user }) = self.memory else { return true };
        let _state = FloatState::kept();
        // SAFETY: The caller's function with its own data; a solve asks on the one thread that drives it.
        unsafe { function(user, bytes) == 0 }
    }
}

fn report(progress: &Progress) -> patchlight_progress {
    let Progress { stage, round, fraction, links, elements, error } = *progress;
    let stage = match stage {
        Stage::Build => PATCHLIGHT_STAGE_BUILD,
        Stage::Refine => PATCHLIGHT_STAGE_REFINE,
        Stage::Gather => PATCHLIGHT_STAGE_GATHER,
        Stage::Error => PATCHLIGHT_STAGE_ERROR,
        Stage::Sample => PATCHLIGHT_STAGE_SAMPLE,
        Stage::Render => PATCHLIGHT_STAGE_RENDER,
        Stage::Cells => PATCHLIGHT_STAGE_CELLS,
        Stage::Read => PATCHLIGHT_STAGE_READ,
        Stage::Mesh => PATCHLIGHT_STAGE_MESH,
    };
    let (fraction, error) = (fraction.unwrap_or(-1.0), error.unwrap_or(-1.0));
    patchlight_progress { size: size_of::<patchlight_progress>(), stage: stage as u32, round, links, elements, fraction, error }
}
