//! Brightness-weighted refinement in which the receiver's area counts, and only the error that a link can make.
//!
//! A link carries `rho_r B_s F_rs`. What it gets wrong is the part by which the kernel varies over the receiver, `r_r / D`, and over a
//! source that is not equally bright, `3 (r_s / D) delta_s`; values at points repair the rest, because they take the form factor
//! at the point and ask visibility again. An error on a small receiver is worth less: without the receiver's area the links pour into
//! penumbrae. The constants are empirical.

use super::decision::{Candidate, Decision, RefinementOracle};

/// Links a pair when its weighted error is at most `tolerance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaWeighted {
    /// In W/m^2, for a receiver of `reference_area`.
    pub tolerance: f64,
    /// In m^2.
    pub reference_area: f64,
    /// Nodes of this area or less are not split, in m^2.
    pub min_area: f64,
}

impl AreaWeighted {
    /// What variation over the source weighs against variation over the receiver.
    const SOURCE_WEIGHT: f64 = 3.0;
    /// What partial visibility weighs: the spread of a visibility V is at most sqrt(V (1 - V)).
    const VISIBILITY_WEIGHT: f64 = 0.5;
    /// What clusters weigh against polygons: their form factor is an estimate, and they look like one thing.
    const CLUSTER_WEIGHT: f64 = 2.0;
    /// What a pair weighs of which no ray saw anything: a few rays are no proof that nothing gets through.
    const UNSEEN_WEIGHT: f64 = 0.15;
}

impl RefinementOracle for AreaWeighted {
    fn decide(&self, candidate: &Candidate) -> Decision {
        let carried = candidate.reflected_radiosity * candidate.form_factor * (candidate.receiver_area / self.reference_area);
        let transmittance = candidate.transmittance.unwrap_or(1.0);

        // Where the two nearly touch, the kernel varies by no more than itself.
        let reach = candidate.distance.max(candidate.receiver_radius + candidate.source_radius);
        let (receiver_angle, source_angle) = (candidate.receiver_radius / reach, candidate.source_radius / reach);
        let (mut over_receiver, mut over_source) =
            (receiver_angle, Self::SOURCE_WEIGHT * source_angle * candidate.source_variation);
        if candidate.clusters {
            over_receiver *= Self::CLUSTER_WEIGHT;
            over_source = Self::CLUSTER_WEIGHT * over_source.max(source_angle);
        }
        let of_visibility = match candidate.transmittance {
            Some(0.0) => Self::UNSEEN_WEIGHT,
            _ => Self::VISIBILITY_WEIGHT * (transmittance * (1.0 - transmittance)).sqrt(),
        };

        // Split what makes the larger error; partial visibility splits the larger node.
        let splittable_receiver = candidate.receiver_area > self.min_area;
        let splittable_source = candidate.source_area > self.min_area;
        if carried * (transmittance * (over_receiver + over_source) + of_visibility) <= self.tolerance {
            return Decision::Link;
        }
        let wanted = if of_visibility > over_receiver + over_source {
            candidate.split_larger()
        } else if over_receiver >= over_source {
            Decision::SplitReceiver
        } else {
            Decision::SplitSource
        };
        match wanted {
            Decision::SplitReceiver if splittable_receiver => Decision::SplitReceiver,
            _ if splittable_source && over_source > 0.0 => Decision::SplitSource,
            _ if splittable_receiver => Decision::SplitReceiver,
            _ => Decision::Link,
        }
    }
}
