//! Where work on a scene is done.

/// Does `work` on the threads of the pool that it is called in; outside of any on one thread: the pool of the process belongs to the host.
pub(in crate::scene) fn on_threads_of_caller<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    if rayon::current_thread_index().is_some() {
        return work();
    }
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        // Without a thread there is but the pool of the process.
        Err(_) => work(),
    }
}
