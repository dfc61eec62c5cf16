//! BF refinement (Hanrahan, Salzman, Aupperle 1991, section 4.2): a pair interacts if what it carries is little.

use super::decision::{Candidate, Decision, RefinementOracle};

/// Splits the larger of the two while `rho_r B_s F_rs` exceeds `tolerance` and it is larger than `min_area`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrightnessWeighted {
    /// In W/m^2.
    pub tolerance: f64,
    /// Nodes of this area or less are not split, in m^2: the paper's A_epsilon.
    pub min_area: f64,
}

impl RefinementOracle for BrightnessWeighted {
    fn decide(&self, candidate: &Candidate) -> Decision {
        let carried = candidate.reflected_radiosity * candidate.form_factor * candidate.transmittance.unwrap_or(1.0);
        let larger = candidate.receiver_area.max(candidate.source_area);
        if carried <= self.tolerance || larger <= self.min_area { Decision::Link } else { candidate.split_larger() }
    }
}
