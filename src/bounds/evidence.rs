//! How far bounds can be trusted, and what they rest on.

use serde::Serialize;

/// How far bounds can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// Proved; rounding is allowed for.
    Guaranteed,
    /// Not proved.
    Estimate,
}

/// What the bounds of a pair's form factor rest on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// Nothing is in the way, or no light can pass at all.
    Sight,
    /// The shadows of all that is in the way are known.
    Shadows,
    /// Something may be in the way: from nothing to everything may arrive.
    Unproved,
    /// Boxes around clusters: from nothing to what they can exchange at most.
    Boxes,
    /// No link: from nothing to what the pair can exchange at most.
    Unlinked,
}
