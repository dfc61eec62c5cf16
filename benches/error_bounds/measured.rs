//! What is measured of a scene, for tables and figures.

use super::configurations::Configuration;
use super::measure::Errors;

/// All that is measured of a scene.
pub struct Measured {
    pub configuration: Configuration,
    /// What half as many elements change in the reference, as a part of its mean.
    pub reference_error: f64,
    /// Mean radiosity of the floor, and its radiosities along the middle.
    pub mean: f64,
    pub profile: Vec<f64>,
    pub sizes: Vec<Size>,
    pub profiles: Vec<Profile>,
    pub ladders: Vec<Ladder>,
}

/// Elements of one size.
pub struct Size {
    pub per_side: u32,
    pub links: u64,
    pub measured: Errors,
    pub estimated: Errors,
    /// From guaranteed bounds, on average as if values were spread evenly between them.
    pub bound: Errors,
    /// Probes outside of the bounds.
    pub outside: usize,
}

/// Bounds of the middle of the floor, by probe.
pub struct Profile {
    pub links: u64,
    pub sweeps: u32,
    pub bounds: Vec<[f64; 2]>,
    pub outside: usize,
}

/// A way to refine, to finer and finer tolerances.
pub struct Ladder {
    pub name: &'static str,
    pub rungs: Vec<Rung>,
}

pub struct Rung {
    pub links: u64,
    pub l1: f64,
    /// What error-driven refinement says itself of all that it counts, as a part of what is reflected of it.
    pub estimated: Option<f64>,
    pub cpu_s: f64,
}
