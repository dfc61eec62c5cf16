//! What a solve tells about itself.

use serde::Serialize;

use super::error_driven::LinkErrorReport;
use crate::bounds::BoundsReport;
use crate::hierarchy::Hierarchy;
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::{self, Exposure, Radiosity};

/// Why refinement ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StoppedBy {
    /// The claimed error is at most the requested one.
    #[default]
    Error,
    /// `max_links` was reached.
    MaxLinks,
    /// The memory budget was reached.
    Memory,
    /// The time limit was reached.
    Time,
    /// The observer cancelled.
    Cancelled,
    /// Refinement ends here: nothing more can be gained.
    Exhausted,
}

/// How much of everything there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Surfaces of the scene.
    pub surfaces: u64,
    /// Occluding triangles.
    pub triangles: u64,
    /// Clusters of surfaces.
    pub clusters: u64,
    /// Elements, surfaces that were not split included.
    pub elements: u64,
    /// Links.
    pub links: u64,
    /// Dormant pairs.
    pub dormant: u64,
    /// Visibility rays of every kind.
    pub rays: u64,
    /// Those of them that look for the first hit, where others ask whether anything lies on a segment.
    pub first_hit_rays: u64,
    /// Sweeps of gather and push-pull.
    pub iterations: u64,
    /// Rounds of refinement.
    pub rounds: u64,
}

/// The error that is claimed, in the norm of [`SolveOptions::error`](super::SolveOptions::error).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorReport {
    /// What was asked for.
    pub requested: f64,
    /// The claim: an upper confidence limit of the measured error; infinite where nothing was, or can be, estimated.
    pub estimate: f64,
    /// The probability with which the claim holds, as far as the estimate's own statistics tell.
    pub confidence: f64,
    /// The measured error itself, without the allowance for its noise.
    pub measured: f64,
}

/// Where the power goes, in W, all channels added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Emitted by all surfaces.
    pub emitted: f64,
    /// Absorbed by all surfaces.
    pub absorbed: f64,
    /// Left through openings: what no form factor accounts for.
    pub escaped: f64,
    /// What the last iteration still changed.
    pub residual: f64,
}

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
    /// Bounding it.
    pub bounds: f64,
}

/// What there is after an iteration of a strategy that lets light travel once in each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct IterationReport {
    /// Links, each direction counted.
    pub links: u64,
    /// Elements, surfaces that were not split included.
    pub elements: u64,
    /// Visibility rays for links so far.
    pub link_rays: u64,
    /// Links between surfaces that were made so far.
    pub top_level_links: u64,
    /// Of these, links that carried more than the tolerance at some time.
    pub top_level_exceeding: u64,
    /// Links that are marked as not to be refined.
    pub reduced_links: u64,
    /// `sum of |1 - F_p| B_p A_p` over surfaces in W, all channels added (Holzschuch, Sillion, Drettakis 1994, equation 1).
    pub incorrect_energy: f64,
    /// `sum of B_p A_p` in W (equation 2).
    pub total_energy: f64,
}

/// What pairs of surfaces without a link hold back, in W, all channels added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergyBalance {
    /// What surfaces reflect, the ambient term included.
    pub reflected: f64,
    /// At most this is missing of what surfaces reflect, before the ambient term: a bound as far as form factors are exact and the
    /// iterations have converged.
    pub held_back: f64,
    /// What the ambient term adds.
    pub ambient: f64,
}

/// What a solve tells about itself: everything that is not the answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SolveReport {
    /// Name and version of the backend that answered.
    pub backend: String,
    /// Seconds by stage.
    pub time_s: StageTimes,
    /// How much of everything there is.
    pub counts: Counts,
    /// The claimed error.
    pub error: ErrorReport,
    /// What is proved about the answer, if that was asked for.
    pub bounds: Option<BoundsReport>,
    /// How wrong radiosities may be by the links, for error-driven refinement.
    pub link_error: Option<LinkErrorReport>,
    /// Where the power goes.
    pub energy: Energy,
    /// What there was after each iteration, for strategies that have a fixed number of them.
    pub bounces: Vec<IterationReport>,
    /// What pairs without a link hold back, for strategies that leave some.
    pub energy_balance: Option<EnergyBalance>,
    /// Bytes of the solution: hierarchy, links, radiosities.
    pub memory_bytes: u64,
    /// Work that was not done, with its count, in words.
    pub skipped: Vec<(String, u64)>,
    /// Whether the requested error is reached.
    pub converged: bool,
    /// Why refinement ended.
    pub stopped_by: StoppedBy,
}

/// Where the power goes, by the links: what arrives nowhere has escaped.
pub(super) fn energy(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure, radiosity: &Radiosity) -> Energy {
    let channels = scene.channels();
    let irradiance = sweep::push(hierarchy, sweep::gather(hierarchy, links, exposure, radiosity), channels);
    let mut energy = Energy::default();
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let material = scene.material_of(SurfaceId(hierarchy.node(leaf).surface));
        let exposed = hierarchy.area(leaf) * exposure.of(leaf);
        for channel in 0..channels {
            let arrived = exposed * irradiance[leaf.index() * channels + channel];
            energy.emitted += exposed * material.exitance[channel];
            energy.absorbed += (1.0 - material.reflectance[channel]) * arrived;
            energy.escaped += exposed * radiosity.of(leaf)[channel] - arrived;
        }
    }
    energy
}
