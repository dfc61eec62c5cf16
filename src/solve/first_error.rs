//! The error that a solve begins with: the one that is asked for, or a larger one where that would take longer than there is time. So what the time
//! leaves was judged; the next steps go on from there.

use super::job::Job;

/// Work that is done in a second, in rays: about what two slow cores trace in a large scene. The same on all machines, so that what is begun with is.
const WORK_PER_SECOND: f64 = 2e6;

/// What is begun with takes this part of the time, by its predicted work: that may be off by twice, and is to be judged in time.
const FIRST_PART_OF_TIME: f64 = 0.25;

/// Errors that are begun with are so many times as large as the next, and at most so large.
const NEXT_ERROR: f64 = 1.25;
const LARGEST_ERROR: f64 = 0.5;

/// The error that is asked for, or the least whose work fits into the time.
pub(super) fn error_to_begin_with(job: &Job<'_>, work: impl Fn(f64) -> f64) -> f64 {
    let requested = job.options.error;
    let Some(time_s) = job.time_s() else { return requested };
    let allowed = FIRST_PART_OF_TIME * time_s * WORK_PER_SECOND;
    let mut errors = std::iter::successors(Some(requested), |error| Some(NEXT_ERROR * error));
    let fits = |error: &f64| NEXT_ERROR * error > LARGEST_ERROR || work(*error) <= allowed;
    errors.find(fits).unwrap_or(requested)
}
