//! What ends the refinement of a function before it is as good as asked for.

use std::sync::OnceLock;
use std::time::Instant;

/// Elements are not refined beyond so many, and no lines are followed that would take more: about a gigabyte.
pub(super) const MOST_ELEMENTS: usize = 1 << 20;

/// A round of refinement makes so many of an element, at most.
const FOUR: usize = 4;

/// What ends the refinement of a function before it is as good as asked for. What there is then is judged as it is.
pub(crate) struct MeshLimits<'a> {
    /// Whether there may be so many elements.
    allows: &'a (dyn Fn(usize) -> bool + Sync),
    /// When all must be done, judging included.
    deadline: Option<Instant>,
    reached: OnceLock<MeshLimit>,
}

/// Why elements were not refined further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshLimit {
    Memory,
    Time,
}

/// The rounds in which one function is refined.
pub(super) struct Rounds<'a> {
    limits: &'a MeshLimits<'a>,
    until: Option<Instant>,
    begun: Instant,
}

impl<'a> MeshLimits<'a> {
    pub fn new(allows: &'a (dyn Fn(usize) -> bool + Sync), deadline: Option<Instant>) -> Self {
        Self { allows, deadline, reached: OnceLock::new() }
    }

    /// No limits but the most elements that there ever are.
    pub fn none() -> Self {
        Self::new(&|_| true, None)
    }

    /// The limit that ended refinement, if one did.
    pub fn reached(&self) -> Option<MeshLimit> {
        self.reached.get().copied()
    }

    /// Whether there may be so many elements.
    pub(super) fn allow(&self, elements: usize) -> bool {
        let is_allowed = (self.allows)(elements);
        if !is_allowed {
            self.reached.get_or_init(|| MeshLimit::Memory);
        }
        is_allowed
    }

    /// Whether all must be done by some time.
    pub(super) fn has_deadline(&self) -> bool {
        self.deadline.is_some()
    }

    /// The part of some work for which there is time, where all of it takes so many seconds: half of what is left is for it.
    pub(super) fn affordable_part(&self, work_s: f64) -> f64 {
        let Some(deadline) = self.deadline else { return 1.0 };
        let left_s = deadline.saturating_duration_since(Instant::now()).as_secs_f64() / 2.0;
        if left_s >= work_s {
            return 1.0;
        }
        self.reached.get_or_init(|| MeshLimit::Time);
        left_s / work_s
    }

    /// Begins to refine a function. Half of the time that is left is for it; the rest is for judging, and for what comes after it.
    pub(super) fn begin(&'a self) -> Rounds<'a> {
        let now = Instant::now();
        let half = |deadline: Instant| now + deadline.saturating_duration_since(now) / 2;
        Rounds { limits: self, until: self.deadline.map(half), begun: now }
    }
}

impl Rounds<'_> {
    /// Whether so many elements may be refined once more: a round takes as long as the one before, or longer.
    pub fn may_go_on(&mut self, elements: usize) -> bool {
        let now = Instant::now();
        let round = now - self.begun;
        self.begun = now;
        if self.until.is_some_and(|until| now + round > until) {
            self.limits.reached.get_or_init(|| MeshLimit::Time);
            return false;
        }
        elements < MOST_ELEMENTS && self.limits.allow(FOUR * elements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn work_for_which_there_is_no_time_is_done_in_part() {
        let hour = 3600.0;
        assert_eq!(MeshLimits::none().affordable_part(hour), 1.0);
        let limits = MeshLimits::new(&|_| true, Some(Instant::now() + Duration::from_secs_f64(hour)));
        assert_eq!((limits.affordable_part(hour / 3.0), limits.reached()), (1.0, None));
        assert!((limits.affordable_part(2.0 * hour) - 0.25).abs() < 1e-3);
        assert_eq!(limits.reached(), Some(MeshLimit::Time));
        assert_eq!(MeshLimits::new(&|_| true, Some(Instant::now())).affordable_part(hour), 0.0);
    }

    #[test]
    fn rounds_end_with_elements_and_with_half_of_the_time() {
        let limits = MeshLimits::none();
        let mut all = limits.begin();
        assert!(all.may_go_on(MOST_ELEMENTS - 1) && !all.may_go_on(MOST_ELEMENTS));
        assert_eq!(limits.reached(), None);

        let limits = MeshLimits::new(&|elements| elements <= 400, None);
        let mut few = limits.begin();
        assert!(few.may_go_on(100) && !few.may_go_on(101));
        assert_eq!(limits.reached(), Some(MeshLimit::Memory));

        // A round that took as long as is left of the half is the last.
        let limits = MeshLimits::new(&|_| true, Some(Instant::now() + Duration::from_secs(3600)));
        let mut rounds = limits.begin();
        assert!(rounds.may_go_on(1));
        rounds.begun -= Duration::from_secs(1801);
        assert!(!rounds.may_go_on(1));
        assert_eq!(limits.reached(), Some(MeshLimit::Time));
    }
}
