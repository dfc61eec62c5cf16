//! How a run goes.

use std::time::{Duration, Instant};

use super::error::OptionsError;
use crate::visibility::Backend;

/// How the run goes; none of it changes the answer, except that limits may end it early, and a time that is short for what is asked makes it begin coarsely.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Worker threads; 0 takes one per core.
    pub threads: usize,
    /// Which code answers visibility queries.
    pub backend: Backend,
    /// Stop after this many seconds of wall time. A solve that would take longer begins with a larger error than it is asked for, so that there is a result
    /// that was judged.
    pub time_s: Option<f64>,
    /// Values at points for which that time is to be enough as well, gathered one by one: by the time that judged values took. They are left half of
    /// the time at most.
    pub values_in_time: u64,
    /// Stop when the process would take more than this many bytes, by a count that is the same on every machine: scene, visibility, nodes,
    /// links, cells and what is needed while they are made. What is taken afterwards, for values and pictures, is the caller's to leave room for.
    pub memory_bytes: Option<u64>,
}

impl RunOptions {
    /// When the time is over that began at `start`; `None` if there is no limit, or one beyond what the clock of the machine can tell.
    pub fn deadline_from(&self, start: Instant) -> Option<Instant> {
        let time = Duration::try_from_secs_f64(self.time_s?.max(0.0)).ok()?;
        start.checked_add(time)
    }

    /// Rejects values outside their range; never clamps.
    ///
    /// # Errors
    /// [`OptionsError::OutOfRange`] for a time limit that is negative, not a number or longer than a million years.
    pub fn validate(&self) -> Result<(), OptionsError> {
        const MILLION_YEARS_S: f64 = 3.2e13;
        match self.time_s {
            Some(seconds) if !(0.0..MILLION_YEARS_S).contains(&seconds) => Err(OptionsError::OutOfRange {
                option: "time",
                value: format!("{seconds:?}"),
                range: "seconds, not negative, below 3.2e13".to_owned(),
            }),
            _ => Ok(()),
        }
    }
}
