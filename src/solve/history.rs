//! How the error fell in the course of a solve.

use serde::Serialize;

/// What was judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgedPart {
    /// Values at points, over links.
    #[default]
    OverLinks,
    /// Values at points, over cells.
    OverCells,
    /// The lit mesh, with the values that it is made from.
    LitMesh,
}

/// The error as it was estimated at one time, in the norm of [`SolveOptions::error`](super::SolveOptions::error).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Judgement {
    /// Wall seconds since the solve began, visibility and hierarchy being built by then.
    pub time_s: f64,
    /// What was judged.
    pub of: JudgedPart,
    /// The claim: an upper confidence limit of the measured error; infinite where nothing could be said.
    pub claimed: f64,
    /// The measured error itself; infinite where nothing could be said.
    pub measured: f64,
    /// Rays that a value at a point took; `None` of the lit mesh.
    pub rays_per_point: Option<u32>,
    /// Visibility rays of every kind until then.
    pub rays: u64,
}
