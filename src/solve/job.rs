//! What is solved, and within which limits.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::memory::MemoryLedger;
use super::{RunOptions, SolveOptions, StoppedBy};
use crate::error::ErrorEstimate;
use crate::links::RefineEnd;
use crate::progress::Observer;
use crate::scene::Scene;
use crate::transmittance::Rays;

/// Values after a solve are left this part of the time at most: where they crowd they take less than what they take one by one. The first that are
/// judged have rays for half of that, since judging takes time as well.
const MOST_TIME_OF_VALUES: f64 = 0.5;
const FIRST_TIME_OF_VALUES: f64 = 0.25;

/// The time that a solve leaves to the values that are asked for at its end.
#[derive(Default)]
pub(super) struct TimeOfValues {
    nanoseconds: AtomicU64,
}

/// What is solved, and within which limits.
#[derive(Clone, Copy)]
pub(super) struct Job<'a> {
    pub scene: &'a Scene,
    /// How many channels the solution will have.
    pub kept_channels: usize,
    pub options: &'a SolveOptions,
    pub run: &'a RunOptions,
    began: Instant,
    deadline: Option<Instant>,
    time_s: Option<f64>,
    of_values: &'a TimeOfValues,
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
        (run, of_values): (&'a RunOptions, &'a TimeOfValues),
        rays: &'a Rays<'a>,
        observer: &'a dyn Observer,
    ) -> Self {
        let began = Instant::now();
        let deadline = run.deadline_from(began);
        let memory = MemoryLedger::new(scene, run.backend, run.memory_bytes);
        Self { scene, kept_channels, options, run, began, deadline, time_s: run.time_s, of_values, memory, rays, observer }
    }

    /// The part of the job that finds values at points where a function on the surfaces is made from them: it has half of the time.
    pub fn of_values(&self, options: &'a SolveOptions) -> Self {
        Self { options, deadline: self.half_time(), time_s: self.time_s.map(|seconds| seconds / 2.0), ..*self }
    }

    /// Wall seconds since time counts.
    pub fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// Seconds for all of it, if there is a limit.
    pub fn time_s(&self) -> Option<f64> {
        self.time_s
    }

    /// When all must be done, if there is a limit.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Whether values are to be taken within the time. A lit mesh is read instead.
    pub fn leaves_time_to_values(&self) -> bool {
        self.time_s.is_some() && self.run.values_in_time > 0 && !self.options.lit_mesh
    }

    /// The most rays that the first values may have to be taken within the time, if a ray takes so many seconds on all threads.
    pub fn most_rays_in_time(&self, seconds: f64) -> Option<u32> {
        let time_s = self.time_s.filter(|_| self.leaves_time_to_values())?;
        Some((FIRST_TIME_OF_VALUES * time_s / (seconds * self.run.values_in_time as f64)) as u32)
    }

    /// Leaves time to the values that are to be taken within it, if one takes so many seconds on all threads.
    pub fn leave_time_for_values(&self, seconds: f64) {
        let Some(time_s) = self.time_s.filter(|_| self.leaves_time_to_values()) else { return };
        let needed = (seconds * self.run.values_in_time as f64).min(MOST_TIME_OF_VALUES * time_s);
        self.of_values.nanoseconds.store((1e9 * needed) as u64, Ordering::Relaxed);
    }

    /// The time that is left to those values.
    pub fn time_of_values(&self) -> Duration {
        Duration::from_nanos(self.of_values.nanoseconds.load(Ordering::Relaxed))
    }

    pub fn is_over_time(&self) -> bool {
        self.has_no_time_for(Duration::ZERO)
    }

    pub fn is_cancelled(&self) -> bool {
        self.observer.cancelled()
    }

    /// The limit that ends the solve now, if there is one and the error is still too large.
    pub fn limit(&self, error: Option<ErrorEstimate>, ended: RefineEnd) -> Option<StoppedBy> {
        if self.is_cancelled() {
            return Some(StoppedBy::Cancelled);
        }
        if error.is_some_and(|error| error.claimed_of_all() <= self.options.error) {
            return None;
        }
        match ended {
            RefineEnd::MaxLinks => Some(StoppedBy::MaxLinks),
            RefineEnd::Memory => Some(StoppedBy::Memory),
            RefineEnd::Stopped => Some(StoppedBy::Time),
            RefineEnd::Content => self.is_over_time().then_some(StoppedBy::Time),
        }
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

    /// Whether what takes so long, or longer, would leave too little time to values.
    pub fn has_no_time_for(&self, duration: Duration) -> bool {
        let needed = duration.saturating_add(self.time_of_values());
        self.deadline.is_some_and(|deadline| deadline.saturating_duration_since(Instant::now()) <= needed)
    }

    /// Whether work is cancelled or over its time by now.
    pub fn is_late(&self) -> bool {
        self.is_cancelled() || self.is_over_time()
    }
}
