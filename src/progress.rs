//! How long work tells its progress and is cancelled. The library itself prints nothing and installs no signal handler.

use serde::Serialize;

/// What is being worked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Reading a scene.
    Read,
    /// Building the visibility backend and the hierarchy.
    Build,
    /// Deciding pairs of nodes and making links.
    Refine,
    /// Gathering over links and push-pull.
    Gather,
    /// Finding the radiosities of cells.
    Cells,
    /// Estimating the error of what has been found.
    Error,
    /// Making the lit mesh.
    Mesh,
    /// Evaluating values at points.
    Sample,
    /// Rendering a picture.
    Render,
}

/// A report from inside a stage.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Progress {
    /// The stage that reports.
    pub stage: Stage,
    /// The round of refinement, counted from 1; 0 outside of rounds.
    pub round: u32,
    /// The part of the stage that is done, 0 to 1, where it is known.
    pub fraction: Option<f64>,
    /// Links so far.
    pub links: u64,
    /// Elements so far.
    pub elements: u64,
    /// The last error estimate in the norm of `--error`, where there is one.
    pub error: Option<f64>,
}

/// Receives progress and says when to stop. Called from worker threads, often: return quickly.
pub trait Observer: Sync {
    /// Called every now and then while work goes on.
    fn progress(&self, _progress: &Progress) {}

    /// Asked every now and then; once it says `true` the work ends soon and says so in its result.
    fn cancelled(&self) -> bool {
        false
    }

    /// Asked before a solve takes more memory, with what it would take in bytes by the ledger that `memory_bytes` of the run's options limits:
    /// once it says `false` the solve ends soon, as if that limit were reached.
    fn allows_memory(&self, _bytes: u64) -> bool {
        true
    }
}

/// Asked every now and then while work goes on: once it says `true`, as when the observer cancels or the time is over, it keeps saying so, and
/// the work ends as soon as it can.
pub(crate) type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Observes nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}
