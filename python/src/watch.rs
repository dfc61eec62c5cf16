//! Long work beside Python: without its lock, telling how far it is, and ended by Ctrl-C.
//!
//! The work has a thread of its own. The thread that called waits for it, and takes the lock every now and then, to look for signals and to
//! tell the progress function. So no worker ever needs Python, and the function is called where its author expects it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use patchlight::progress::{Observer, Progress};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::errors::Failure;
use crate::names::name_of;

/// How often signals are looked for and progress is told: well below the half second after which Ctrl-C feels dead.
const PATIENCE: Duration = Duration::from_millis(50);

/// Who hears how far it is.
pub struct Listener {
    function: Option<Py<PyAny>>,
    /// A bar of ours, which is closed at the end.
    is_bar: bool,
}

impl Listener {
    /// From what a caller gave as `progress`: a function, True for a bar, None or False for nothing.
    pub fn new(progress: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(progress) = progress else { return Ok(Self { function: None, is_bar: false }) };
        if let Ok(flag) = progress.cast::<PyBool>() {
            let bar = || progress.py().import("patchlight._progress")?.getattr("bar")?.call0();
            let bar = if flag.is_true() { Some(bar()?).filter(|bar| !bar.is_none()) } else { None };
            return Ok(Self { is_bar: bar.is_some(), function: bar.map(Bound::unbind) });
        }
        if !progress.is_callable() {
            return Err(Failure::argument("progress must be True, or a function of stage and fraction").into());
        }
        Ok(Self { function: Some(progress.clone().unbind()), is_bar: false })
    }

    /// Tells the function; whether it wants an end.
    fn tell(&self, py: Python<'_>, progress: &Progress) -> PyResult<bool> {
        let Some(function) = &self.function else { return Ok(false) };
        let answer = function.bind(py).call1((name_of(&progress.stage), progress.fraction))?;
        Ok(answer.cast::<PyBool>().is_ok_and(|flag| flag.is_true()))
    }

    fn close(&self, py: Python<'_>) -> PyResult<()> {
        match &self.function {
            Some(bar) if self.is_bar => bar.bind(py).call_method0("close").map(drop),
            _ => Ok(()),
        }
    }
}

/// Between the work and the thread that waits for it.
#[derive(Default)]
struct Watcher {
    /// What has not been told yet.
    news: Mutex<Option<Progress>>,
    cancelled: AtomicBool,
}

impl Watcher {
    fn take_news(&self) -> Option<Progress> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Looks for signals and tells what is new.
    fn look(&self, py: Python<'_>, listener: &Listener) -> PyResult<()> {
        py.check_signals()?;
        if let Some(news) = self.take_news()
            && listener.tell(py, &news)?
        {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

impl Observer for Watcher {
    fn progress(&self, progress: &Progress) {
        *self.news.lock().unwrap_or_else(PoisonError::into_inner) = Some(*progress);
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Does `work` on another thread while Python goes on. If the listener wants an end, the work learns of it and its result is returned; if a
/// signal or the listener raises, the work ends soon, and that is raised.
pub fn watched<R: Send>(py: Python<'_>, listener: &Listener, work: impl FnOnce(&dyn Observer) -> R + Send) -> PyResult<R> {
    let watcher = Watcher::default();
    let result = py.detach(|| {
        thread::scope(|scope| {
            // `done` goes with the work, however that ends, and the channel tells so.
            let (done, end) = channel::<()>();
            let body = || {
                let _done = done;
                work(&watcher)
            };
            let worker = thread::Builder::new().name("patchlight".to_owned()).spawn_scoped(scope, body);
            let worker = worker.map_err(|error| Failure::resource(format_args!("cannot start a thread: {error}")))?;

            let mut raised = None;
            while end.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                if raised.is_none() {
                    raised = Python::attach(|py| watcher.look(py, listener)).err();
                    watcher.cancelled.fetch_or(raised.is_some(), Ordering::Relaxed);
                }
            }
            let result = worker.join().map_err(|panic| Failure::internal(told(&*panic)))?;
            raised.map_or(Ok(result), Err)
        })
    });
    let closed = listener.close(py);
    let result = result?;
    closed.map(|()| result)
}

/// What a panic says.
fn told(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message")
}
