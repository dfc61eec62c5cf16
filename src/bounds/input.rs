//! What is bounded: a scene with the links of a solve.

use super::form_factors::FormFactorRule;
use crate::hierarchy::Hierarchy;
use crate::links::LinkSet;
use crate::progress::Stop;
use crate::scene::Scene;

/// What is bounded.
pub(crate) struct BoundsInput<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    /// `scene.channels()` radiosities per node in W/m^2, as the links carry them: they say which pairs are bounded more closely.
    pub radiosity: &'a [f64],
    pub rule: FormFactorRule,
    /// See [`SolveOptions::bounds_work`](crate::solve::SolveOptions::bounds_work).
    pub work: Option<u64>,
    /// The error that was asked for: bounds that are no farther apart, relative to what is reflected, are close enough.
    pub error: f64,
    /// From when it returns true, pairs are bounded in the cheapest way.
    pub stop: Stop<'a>,
}
