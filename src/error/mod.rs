//! How wrong values are: an estimate with a confidence, from light paths that share nothing with the values.
//!
//! Start with `estimate`: what is estimated. `points` says where, `replicates` by which rays, `residual` what replicates estimate
//! where values go over cells.

mod estimate;
mod points;
mod replicates;
mod residual;

pub(crate) use estimate::{
    CONFIDENCE, CONFIDENCE_SIGMAS, Doubts, ErrorEstimate, ErrorParts, ErrorSamples, Pilot, TWICE, claim, doubt_for_claim,
};
pub(crate) use replicates::{ReplicateGather, Replication};
pub(crate) use residual::ResidualGather;
