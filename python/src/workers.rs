//! Threads that solves share, and which process they belong to.

use std::process;
use std::sync::{Mutex, PoisonError};

use patchlight::pipeline::Workers;

use crate::errors::Failure;

/// The process that something was made in. Threads do not live on in a process that is forked from theirs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Home(u32);

impl Home {
    /// This process.
    pub fn here() -> Self {
        Self(process::id())
    }

    /// Whether this is another process.
    pub fn is_elsewhere(self) -> bool {
        self != Self::here()
    }
}

/// One thread for each core, for all that asks for no number of its own.
static SHARED: Mutex<Option<(Home, Workers)>> = Mutex::new(None);

/// So many threads, or those that are shared.
pub fn workers(threads: Option<usize>) -> Result<Workers, Failure> {
    // Threads of one's own.
    if let Some(threads) = threads {
        let most = Workers::most();
        if !(1..=most).contains(&threads) {
            return Err(Failure::option(format_args!(
                "threads is {threads}, it must be from 1 to {most}, or None for one for each core"
            )));
        }
        return Ok(Workers::new(threads)?);
    }

    // The shared ones, made when they are needed first. Those of a process that this one was forked from are not there: what stands for them
    // must not be waited for, and is forgotten.
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((home, workers)) = shared.take() {
        if home.is_elsewhere() {
            std::mem::forget(workers);
        } else {
            *shared = Some((home, workers));
        }
    }
    let (_, workers) = match &mut *shared {
        Some(there) => there,
        empty => empty.insert((Home::here(), Workers::new(0)?)),
    };
    Ok(workers.clone())
}
