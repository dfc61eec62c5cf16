//! What is solved, and within which limits.

use std::time::{Duration, Instant};

use super::memory::MemoryLedger;
use super::{RunOptions, SolveOptions};
use crate::progress::Observer;
use crate::scene::Scene;
use crate::transmittance::Rays;

/// What is solved, and within which limits.
#[derive(Clone, Copy)]
pub(super) struct Job<'a> {
    pub scene: &'a Scene,
    /// How many channels the solution will have.
    pub kept_channels: usize,
    pub options: &'a SolveOptions,
    pub run: &'a RunOptions,
    deadline: Option<Instant>,
    pub memory: MemoryLedger,
    pub rays: &'a Rays<'a>,
    pub observer: &'a dyn Observer,
}

impl<'a> Job<'a> {
    /// Time counts from here.
    pub fn new(
        scene: &'a Scene,
        kept_channels: usize,
        options: &'a SolveOptions,
        run: &'a RunOptions,
        rays: &'a Rays<'a>,
        observer: &'a dyn Observer,
    ) -> Self {
        let deadline = run.deadline_from(Instant::now());
        let memory = MemoryLedger::new(scene, run.backend, run.memory_bytes);
        Self { scene, kept_channels, options, run, deadline, memory, rays, observer }
    }

    /// The part of the job that finds values at points where a function on the surfaces is made from them: it has half of the time.
    pub fn of_values(&self, options: &'a SolveOptions) -> Self {
        Self { options, deadline: self.half_time(), ..*self }
    }

    /// When all must be done, if there is a limit.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    pub fn is_over_time(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    pub fn is_cancelled(&self) -> bool {
        self.observer.cancelled()
    }

    /// [`Self::is_late`], for stages to ask.
    pub fn stop(&self) -> impl Fn() -> bool + Sync + use<'a> {
        let job = *self;
        move || job.is_late()
    }

    /// The middle of the time that is left, if there is a limit.
    pub fn half_time(&self) -> Option<Instant> {
        let now = Instant::now();
        self.deadline.map(|deadline| now + deadline.saturating_duration_since(now) / 2)
    }

    /// Whether what takes so long, or longer, would be over time.
    pub fn has_no_time_for(&self, duration: Duration) -> bool {
        self.deadline.is_some_and(|deadline| deadline.saturating_duration_since(Instant::now()) < duration)
    }

    /// Whether work is cancelled or over its time by now.
    pub fn is_late(&self) -> bool {
        self.is_cancelled() || self.is_over_time()
    }
}
