//! Where the time of a solve goes.

use serde::Serialize;

/// Seconds of wall time by stage, as far as the library spends them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageTimes {
    /// Visibility structure and hierarchy.
    pub build: f64,
    /// Deciding pairs.
    pub refine: f64,
    /// The part of `refine` in which pairs of surfaces are linked, for strategies that do so.
    pub initial_linking: f64,
    /// Answering visibility, added over threads.
    pub visibility: f64,
    /// Looking for first hits, the part of `visibility` that `first_hit_rays` took.
    pub first_hits: f64,
    /// Form factors, added over threads.
    pub form_factor: f64,
    /// Gathering over links.
    pub gather: f64,
    /// Push-pull.
    pub push_pull: f64,
    /// Resolving radiosities by light paths.
    pub resolve: f64,
    /// Estimating the error.
    pub error: f64,
    /// Keeping what paths bring.
    pub transport: f64,
    /// Making the lit mesh.
    pub mesh: f64,
    /// Bounding it.
    pub bounds: f64,
}
