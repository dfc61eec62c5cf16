//! The threads that work is done on.

use std::sync::Arc;

use super::error::PipelineError;
use crate::team::{Alone, Share, Team};

/// Worker threads. Clones are the same threads: several solves may share them, at once as well. They end with the last clone.
#[derive(Clone)]
pub struct Workers {
    pool: Arc<rayon::ThreadPool>,
    /// The processes that work with this one.
    team: Arc<dyn Team>,
}

impl Workers {
    /// Starts so many threads; 0 takes one per core.
    ///
    /// # Errors
    /// [`PipelineError::Threads`] if the system has none.
    pub fn new(threads: usize) -> Result<Self, PipelineError> {
        let failed = |error: rayon::ThreadPoolBuildError| PipelineError::Threads { threads, message: error.to_string() };
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map(|pool| Self { pool: Arc::new(pool), team: Arc::new(Alone) })
            .map_err(failed)
    }

    /// The same threads, which do their process's share of what is solved and looked at on them.
    pub fn in_team(self, team: Arc<dyn Team>) -> Self {
        Self { team, ..self }
    }

    /// Which batches of long loops this process does.
    pub(super) fn share(&self) -> Share<'_> {
        Share::of(&*self.team)
    }

    /// More threads than this only wait for each other: four for each core, but 256 everywhere.
    pub fn most() -> usize {
        const MANY: usize = 256;
        const OF_A_CORE: usize = 4;
        MANY.max(OF_A_CORE * std::thread::available_parallelism().map_or(1, usize::from))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// CPU seconds that these threads have used since they were started, where the system tells. Waits until they have no other work.
    pub fn cpu_seconds(&self) -> Option<f64> {
        self.pool.broadcast(|_| of_this_thread()).into_iter().sum()
    }

    /// Does `work` on these threads, where it is shared out, as by [`read_scene`](crate::scene::import::read_scene), which is done on one thread elsewhere.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }
}

/// CPU seconds of the calling thread so far.
fn of_this_thread() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn time_is_that_of_these_threads_alone() {
        let [busy, idle] = [2, 2].map(|threads| Workers::new(threads).unwrap());
        let spin_until = |seconds: f64| while of_this_thread().unwrap() < seconds {};
        busy.pool.broadcast(|_| spin_until(0.05));
        assert!(busy.cpu_seconds().unwrap() >= 0.1);
        assert!(idle.cpu_seconds().unwrap() < 0.05, "what others do is not counted");
    }
}
