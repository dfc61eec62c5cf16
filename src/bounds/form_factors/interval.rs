//! The range of a form factor over its receiver, and how it was found.

use crate::bounds::evidence::{Certainty, Evidence};
use crate::hierarchy::NodeId;

/// How form factors are bounded where nothing is in between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FormFactorRule {
    /// By the theorem that form factors are quasi-concave over the receiver: guaranteed.
    #[default]
    QuasiConcave,
    /// The least and the largest of centre and vertices (Lischinski 1994, section 5.2): an estimate, for comparison.
    CentreAndVertices,
}

/// The least and the largest form factor from points of a receiver to a source, with what is in the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormFactorBounds {
    /// No point of the receiver has less.
    pub lower: f64,
    /// No point of the receiver has more.
    pub upper: f64,
    /// How far that can be trusted.
    pub certainty: Certainty,
    /// What it rests on.
    pub evidence: Evidence,
}

/// A receiver, a source, and the range of the form factor between them.
pub(in crate::bounds) type BoundedPair = (NodeId, NodeId, FormFactorBounds);

impl FormFactorBounds {
    pub(in crate::bounds) fn guaranteed(lower: f64, upper: f64, evidence: Evidence) -> Self {
        Self { lower, upper, certainty: Certainty::Guaranteed, evidence }
    }

    /// What is known of any pair.
    pub(in crate::bounds) const ANYTHING: Self =
        Self { lower: 0.0, upper: 1.0, certainty: Certainty::Guaranteed, evidence: Evidence::Unproved };

    /// What holds for a part of the source.
    pub(in crate::bounds) fn of_part(self) -> Self {
        Self { lower: 0.0, ..self }
    }

    /// What holds if `other` holds as well.
    pub(in crate::bounds) fn and(self, other: Self) -> Self {
        let lower = self.lower.max(other.lower);
        Self { lower, upper: self.upper.min(other.upper).max(lower), ..self }
    }
}
