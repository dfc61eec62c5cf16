//! How wrong the answer can be: lower and upper radiosities that hold at every point, over the links that a solve has made.
//!
//! Three steps, each a file or two:
//!
//! - form factors: from every point of a receiver to a source, between which numbers (`pair`; what is in the way: `blockers`,
//!   `shadow`; unoccluded: `form_factor::bounds`);
//! - radiosities: two systems of inequalities, iterated from outside, so that every iterate holds (`system`; which receivers see
//!   nothing but fronts: `enclosure`);
//! - apart from these, what pairs without a link hold back at most, whatever else is known (`held_back`);
//! - what that says in all: errors in the usual norms, and on what kind of evidence the light travels (`radiosity_bounds`).
//!
//! The same systems bound importance (`importance_bounds`): it is the radiosity of what one wants to know.
//!
//! Beside them, for refinement: which links the gap comes from (`attribution`, `link_gaps`); and, for comparison, ranges that are
//! narrower and no bounds (`ranges`).
//!
//! What is proved is about polygons that are planar and do not overlap in one plane, with visibility as
//! [`visibility`](crate::visibility) defines it. Vertices of a polygon off its plane, by up to 1e-6 of its size, are not allowed
//! for.
//!
//! After Lischinski 1994, chapter 5, from which it departs: form factors are bounded by a theorem instead of samples, the upper
//! system is solved exactly under the condition that form factors add up to at most 1, and is approached from above.

mod attribution;
mod blockers;
mod bounded_pairs;
mod enclosure;
mod held_back;
mod importance_bounds;
mod link_gaps;
mod overlap;
mod pair;
mod picture;
mod point_bounds;
mod pouring;
mod radiosity_bounds;
mod ranges;
mod shadow;
mod system;
mod worst_first;

use serde::Serialize;

pub(crate) use held_back::bound_held_back;
pub use importance_bounds::ImportanceBounds;
pub(crate) use importance_bounds::bound_importance;
pub(crate) use link_gaps::{KnownPairs, LinkGap, LinkGaps, link_gaps};
pub use point_bounds::PointBounds;
pub(crate) use radiosity_bounds::{BoundsInput, bound_radiosities};
pub use radiosity_bounds::{BoundsReport, ChannelError, EvidenceShare, RadiosityBounds};
pub(crate) use ranges::estimate_ranges;
pub(crate) use worst_first::Light;

use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

/// How far bounds can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// Proved; rounding is allowed for.
    Guaranteed,
    /// Nobody proved it.
    Estimate,
}

/// What a pair's bounds rest on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// Nothing is in the way, or no light can pass at all.
    Sight,
    /// What is in the way throws shadows that are known.
    Shadows,
    /// Something may be in the way: from nothing to everything may arrive.
    Unproved,
    /// Boxes around clusters: from nothing to what they can exchange at most.
    Boxes,
    /// No link: from nothing to what the pair can exchange at most.
    Unlinked,
}

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

impl FormFactorBounds {
    fn guaranteed(lower: f64, upper: f64, evidence: Evidence) -> Self {
        Self { lower, upper, certainty: Certainty::Guaranteed, evidence }
    }
}

/// Bounds on the form factor from every point of `receiver` to `source`, nodes of a hierarchy over `scene`.
pub fn bound_pair(
    scene: &Scene,
    hierarchy: &Hierarchy,
    receiver: NodeId,
    source: NodeId,
    rule: FormFactorRule,
) -> FormFactorBounds {
    pair::PairBounds::new(scene, hierarchy, rule).bounds(receiver, source)
}
