//! Long work beside Python: without its lock, telling how far it is, and ended by Ctrl-C.
//!
//! The work has a thread of its own. The thread that called waits for it, and takes the lock every now and then, to look for signals and to
//! tell the progress function. So no worker ever needs Python, and functions are called where their author expects it: where the work asks for
//! memory, it waits for that thread to answer.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use patchlight::progress::{Observer, Progress};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::errors::Failure;
use crate::names::name_of;

/// How often signals are looked for and progress is told: well below the half second after which Ctrl-C feels dead.
const PATIENCE: Duration = Duration::from_millis(50);

thread_local! {
    /// Whether a worker waits for what a function answers on this thread.
    static IS_ANSWERING: Cell<bool> = const { Cell::new(false) };
}

/// Who hears how far it is, and is asked for memory.
pub struct Listener {
    function: Option<Py<PyAny>>,
    /// A bar of ours, which is closed at the end.
    is_bar: bool,
    memory: Option<Py<PyAny>>,
}

impl Listener {
    /// From what a caller gave as `progress`: a function, True for a bar, None or False for nothing.
    pub fn new(progress: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(progress) = progress else { return Ok(Self { function: None, is_bar: false, memory: None }) };
        if let Ok(flag) = progress.cast::<PyBool>() {
            let bar = || progress.py().import("patchlight._progress")?.getattr("bar")?.call0();
            let bar = if flag.is_true() { Some(bar()?).filter(|bar| !bar.is_none()) } else { None };
            return Ok(Self { is_bar: bar.is_some(), function: bar.map(Bound::unbind), memory: None });
        }
        if !progress.is_callable() {
            return Err(Failure::argument("progress must be True, or a function of stage and fraction").into());
        }
        Ok(Self { function: Some(progress.clone().unbind()), is_bar: false, memory: None })
    }

    /// Asks a function for memory, too: it is told bytes, and refuses them by True.
    pub fn asking(self, memory: Option<Py<PyAny>>) -> Self {
        Self { memory, ..self }
    }

    /// Whether so many bytes may be taken.
    fn allows(&self, py: Python<'_>, bytes: u64) -> PyResult<bool> {
        let Some(function) = &self.memory else { return Ok(true) };
        IS_ANSWERING.set(true);
        let answer = function.bind(py).call1((bytes,));
        IS_ANSWERING.set(false);
        Ok(!is_true(&answer?))
    }

    /// Tells the function; whether it wants an end.
    fn tell(&self, py: Python<'_>, progress: &Progress) -> PyResult<bool> {
        let Some(function) = &self.function else { return Ok(false) };
        let answer = function.bind(py).call1((name_of(&progress.stage), progress.fraction))?;
        Ok(is_true(&answer))
    }

    fn close(&self, py: Python<'_>) -> PyResult<()> {
        match &self.function {
            Some(bar) if self.is_bar => bar.bind(py).call_method0("close").map(drop),
            _ => Ok(()),
        }
    }
}

fn is_true(answer: &Bound<'_, PyAny>) -> bool {
    answer.cast::<PyBool>().is_ok_and(|flag| flag.is_true())
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

    /// Looks for signals and tells what is new, until the listener wants an end.
    fn look(&self, py: Python<'_>, listener: &Listener) -> PyResult<()> {
        py.check_signals()?;
        if !self.cancelled.load(Ordering::Relaxed)
            && let Some(news) = self.take_news()
            && listener.tell(py, &news)?
        {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

/// Whether the work may take so many bytes.
struct Question {
    bytes: u64,
    answer: Sender<bool>,
}

/// The watcher as the work sees it. What goes with the work is the other end of `questions`.
struct Worker<'a> {
    watcher: &'a Watcher,
    questions: Sender<Question>,
    asks: bool,
}

impl Observer for Worker<'_> {
    fn progress(&self, progress: &Progress) {
        *self.watcher.news.lock().unwrap_or_else(PoisonError::into_inner) = Some(*progress);
    }

    fn cancelled(&self) -> bool {
        self.watcher.cancelled.load(Ordering::Relaxed)
    }

    fn allows_memory(&self, bytes: u64) -> bool {
        if !self.asks {
            return true;
        }
        let (answer, answered) = channel();
        self.questions.send(Question { bytes, answer }).is_ok() && answered.recv().unwrap_or(false)
    }
}

/// Does `work` on another thread while Python goes on. If the listener wants an end, the work learns of it and its result is returned; if a
/// signal or the listener raises, the work ends soon, and that is raised.
pub fn watched<R: Send>(py: Python<'_>, listener: &Listener, work: impl FnOnce(&dyn Observer) -> R + Send) -> PyResult<R> {
    // Of the threads that would work, one may be the one that waits for the answer.
    if IS_ANSWERING.get() {
        return Err(Failure::argument("the function that is asked for memory must not solve or evaluate").into());
    }
    let watcher = Watcher::default();
    let result = py.detach(|| {
        thread::scope(|scope| {
            // The sender goes with the work, however that ends, and the channel tells so.
            let (questions, asked) = channel();
            let body = || work(&Worker { watcher: &watcher, questions, asks: listener.memory.is_some() });
            let worker = thread::Builder::new().name("patchlight".to_owned()).spawn_scoped(scope, body);
            let worker = worker.map_err(|error| Failure::resource(format_args!("cannot start a thread: {error}")))?;

            let (mut raised, mut looked) = (None, Instant::now());
            loop {
                let question: Option<Question> = match asked.recv_timeout(PATIENCE) {
                    Ok(question) => Some(question),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => break,
                };
                let mut answer = Ok(false);
                if raised.is_none() {
                    answer = Python::attach(|py| {
                        if looked.elapsed() >= PATIENCE {
                            watcher.look(py, listener)?;
                            looked = Instant::now();
                        }
                        question.as_ref().map_or(Ok(true), |question| listener.allows(py, question.bytes))
                    });
                }
                let is_allowed = answer.unwrap_or_else(|error| {
                    raised = Some(error);
                    watcher.cancelled.store(true, Ordering::Relaxed);
                    false
                });
                if let Some(question) = question {
                    // Who asked waits for it.
                    let _ = question.answer.send(is_allowed);
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
