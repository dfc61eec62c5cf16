//! How wrong values are: an estimate with a confidence, from light paths that share nothing with the values.
//!
//! Start with `estimate`: what is estimated; `norm` says relative to what, `dark` where light may be that no one found. `points` says where, `replicates` by which rays, `residual` what
//! replicates estimate where values go over cells. `pairs` combines them, `moments` tells how their sums scatter, `common` what replicates have in common
//! at all points, and `claim` the confidence limit.
//! `stored_samples` keeps all of it for other materials.

mod claim;
mod common;
mod compared;
mod dark;
mod error_bars;
mod estimate;
mod groups;
mod moments;
mod norm;
mod pairs;
mod pilot;
mod points;
mod replicates;
mod residual;
mod stored_samples;

pub(crate) use claim::{CONFIDENCE, Doubts, SIGMAS, claim, doubt_for_claim, largest_sq_for_claim, upper_limit};
pub(crate) use estimate::{ErrorEstimate, ErrorFigure, ErrorParts, ErrorSamples, TWICE};
pub(crate) use groups::{GroupErrors, KnownErrors};
pub(crate) use moments::Moments;
#[cfg(test)]
pub(crate) use moments::Scatter;
pub(crate) use norm::ErrorNorm;
pub(crate) use pilot::Pilot;
pub(crate) use replicates::{REPLICATES, ReplicateGather, Replication};
pub(crate) use residual::ResidualGather;
pub(crate) use stored_samples::{SampleRecorder, StoredSamples};
