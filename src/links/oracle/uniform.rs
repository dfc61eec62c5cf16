//! Every pair down to the same size of element: for convergence tests and comparisons.

use super::decision::{Candidate, Decision, RefinementOracle};

/// Splits both until neither is larger than `element_area`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform {
    /// The largest area of an element in m^2.
    pub element_area: f64,
}

impl RefinementOracle for Uniform {
    fn decide(&self, candidate: &Candidate) -> Decision {
        // A millionth more, so that rounding of areas does not split once too often.
        let limit = self.element_area * (1.0 + 1e-6);
        if candidate.receiver_area > limit {
            Decision::SplitReceiver
        } else if candidate.source_area > limit {
            Decision::SplitSource
        } else {
            Decision::Link
        }
    }
}
