//! What an oracle sees of a pair, and what it may decide.

use serde::{Deserialize, Serialize};

/// A pair of nodes about which an oracle decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Unoccluded form factor F_rs, an estimate.
    pub form_factor: f64,
    /// The part that gets through, where it is known already.
    pub transmittance: Option<f64>,
    /// `max_c rho_c B_c` in W/m^2, receiver's reflectance times source's radiosity.
    pub reflected_radiosity: f64,
    /// How much B varies over the source, relative to its mean: 0 for a lamp, an estimate elsewhere.
    pub source_variation: f64,
    /// In m^2.
    pub receiver_area: f64,
    /// Distance from centroid to farthest vertex, in metres.
    pub receiver_radius: f64,
    /// In m^2.
    pub source_area: f64,
    /// Distance from centroid to farthest vertex, in metres.
    pub source_radius: f64,
    /// Between the centroids, in metres.
    pub distance: f64,
    /// Whether one of the two at least is a cluster, which stands for its surfaces by their areas and directions alone.
    pub clusters: bool,
}

/// What becomes of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Decision {
    /// The receiver gathers from the source as they stand.
    Link,
    /// The children of the receiver, each with the source.
    SplitReceiver,
    /// The receiver with each child of the source.
    SplitSource,
}

/// Decides pairs. A pure function of the candidate.
pub trait RefinementOracle: Sync {
    /// What becomes of the pair.
    fn decide(&self, candidate: &Candidate) -> Decision;
}

impl Candidate {
    /// Splits the larger of the two.
    pub(super) fn split_larger(&self) -> Decision {
        if self.receiver_area >= self.source_area { Decision::SplitReceiver } else { Decision::SplitSource }
    }
}
