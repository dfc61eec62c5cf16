//! What a solve tells about itself.

use serde::Serialize;

use super::history::Judgement;
use super::stage_times::StageTimes;
use crate::bounds::{BoundsReport, Certainty};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::{self, Closure, Exposure, LightIrradiance, Radiosity};
use crate::transmittance::Rays;

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

/// An error in one norm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorFigure {
    /// An upper confidence limit of the measured error; infinite where nothing was, or can be, estimated.
    pub estimate: f64,
    /// The measured error itself.
    pub measured: f64,
}

impl Default for ErrorFigure {
    fn default() -> Self {
        Self { estimate: f64::INFINITY, measured: f64::INFINITY }
    }
}

/// The error that is claimed, in the norm of [`SolveOptions::error`](super::SolveOptions::error).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorReport {
    /// What was asked for.
    pub requested: f64,
    /// The claim for values at points: an upper confidence limit of the measured error; infinite where nothing was, or can be, estimated.
    pub estimate: f64,
    /// The probability with which the claim holds, as far as the estimate's own statistics tell.
    pub confidence: f64,
    /// The measured error itself, without the allowance for its noise.
    pub measured: f64,
    /// Both in the norm by energy; one of the norms is what was asked for.
    pub energy: ErrorFigure,
    /// Both in the local norm.
    pub local: ErrorFigure,
    /// The part of the area of reflecting surfaces, 0 to 1, where light was found, by values, replicates or, where it is rare, by a search of
    /// its own: the local norm is over it. What one in a hundred thousand paths brings may be missed.
    pub lit: f64,
    /// Both where light was found, if it comes to more area by paths too rare to tell how much: of all of it nothing is claimed then.
    pub where_found: Option<ErrorFigure>,
    /// [`Energy::held_back`] as a part of the power that the elements reflect; 0 where that is not known.
    pub skipped: f64,
}

/// Where the power goes, in W, all channels added, by the links and the radiosities of the elements, which over cells are those of a coarse
/// pass: `emitted = absorbed + escaped + unaccounted`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Emitted by all surfaces, and brought by lights where it arrives.
    pub emitted: f64,
    /// What of that lights bring.
    pub of_lights: f64,
    /// Absorbed by all surfaces.
    pub absorbed: f64,
    /// Left through openings: what arrives nowhere; 0 if rays from all surfaces find that nothing leaves the scene.
    pub escaped: f64,
    /// What the elements lose, or make if negative, because form factors are estimates and pairs sleep.
    pub unaccounted: f64,
    /// What the last iteration still changed at most, in W/m^2.
    pub residual: f64,
    /// Sent by all surfaces: emitted and reflected.
    pub sent: f64,
    /// In a closed scene, where all that is sent arrives: the part of it that a sweep over the links loses, or makes if negative; values
    /// over the hemisphere do without these. `None` where rays leave the scene.
    pub imbalance: Option<f64>,
    /// At most so much more would be reflected if all dormant pairs were links, interreflection included; proved, for the light that the
    /// links carry.
    pub held_back: f64,
    /// The same for pairs that were dropped because no ray arrived.
    pub held_back_unseen: f64,
}

impl Energy {
    /// Of so many channels like these.
    pub(super) fn times(self, copies: f64) -> Self {
        let Self { emitted, of_lights, absorbed, escaped, unaccounted, residual, sent, imbalance, held_back, held_back_unseen } =
            self;
        Self {
            emitted: copies * emitted,
            of_lights: copies * of_lights,
            absorbed: copies * absorbed,
            escaped: copies * escaped,
            unaccounted: copies * unaccounted,
            residual,
            sent: copies * sent,
            imbalance,
            held_back: copies * held_back,
            held_back_unseen: copies * held_back_unseen,
        }
    }
}

/// Work that was not done.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SkippedWork {
    /// What, in words.
    pub what: String,
    /// How much of it.
    pub count: u64,
    /// Visibility rays that it would have taken: those of one link for each pair, which might have been refined further.
    pub estimate_saved_rays: u64,
    /// What these would have taken, at the rate of this solve, in seconds added over threads.
    pub estimate_saved_s: f64,
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

/// How wrong radiosities may be by the links of error-driven refinement, in W, channels added, weighted by importance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LinkErrorReport {
    /// How far that can be trusted.
    pub certainty: Certainty,
    /// `<R, upper - lower>`: what all links, and pairs without one, leave open.
    pub gap: f64,
    /// The L1 error that is to be expected if radiosities are spread evenly between their bounds: a quarter of the gap (Lischinski
    /// 1994, equation 5.7).
    pub estimated_error: f64,
    /// `<R, B - E>`: what is reflected of it.
    pub reflected: f64,
    /// The part of the gap, 0 to 1, of pairs without a link.
    pub unlinked_share: f64,
    /// How often links were split.
    pub splits: u64,
}

/// What pairs of surfaces without a link hold back, in W, all channels added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergyBalance {
    /// What surfaces reflect, the ambient term included.
    pub reflected: f64,
    /// At most this is missing of what surfaces reflect, before the ambient term: [`Energy::held_back`].
    pub held_back: f64,
    /// What the ambient term adds.
    pub ambient: f64,
}

/// The lit mesh, and how wrong it is in the norm of [`SolveOptions::error`](super::SolveOptions::error).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LitMeshReport {
    /// Elements, six nodes each.
    pub elements: u64,
    /// Nodes; elements that are joined share them.
    pub nodes: u64,
    /// What it was allowed to be off the values at points.
    pub requested: f64,
    /// What it is off them.
    pub off_values: ErrorFigure,
    /// The error of the function: the root of the squares of what it is off the values, and of their error.
    pub whole: ErrorFigure,
}

/// What is known of light groups, with the weights that they have.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LightGroupsReport {
    /// The error of values at points of all light, by energy; with other weights than were solved for, bounded by what is known of groups.
    pub error: ErrorFigure,
    /// The error of the lit mesh, if there is one: what it is off values, and what these are off.
    pub lit_mesh: Option<ErrorFigure>,
    /// Group by group, each as if it were alone with the weight 1.
    pub groups: Vec<LightGroupReport>,
}

/// What is known of one light group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightGroupReport {
    /// Its name.
    pub name: String,
    /// Its weights, by channel.
    pub weights: Vec<f64>,
    /// The root mean square of what is reflected of its light, over the area of the surfaces that reflect, channels added, in W/m^2.
    pub light: f64,
    /// The error of values at points, by energy, relative to this light.
    pub error: ErrorFigure,
    /// The error of the lit mesh, if there is one.
    pub lit_mesh: Option<ErrorFigure>,
}

/// What is stored to solve again for other materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TransportReport {
    /// Cells of values; replicates have as many each.
    pub cells: u64,
    /// Terms of all paths: a weight, a product of reflectances, and a radiosity or an emission.
    pub terms: u64,
    /// Products of reflectances that differ.
    pub products: u64,
    /// Bytes in memory; files are smaller.
    pub bytes: u64,
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
    /// The error each time that it was estimated.
    pub history: Vec<Judgement>,
    /// The lit mesh, if that was asked for and there is one.
    pub lit_mesh: Option<LitMeshReport>,
    /// What is known of light groups, if the scene has any.
    pub light_groups: Option<LightGroupsReport>,
    /// What is stored to solve again for other materials, if that was asked for and there is some.
    pub transport: Option<TransportReport>,
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
    /// The most that the solve takes at one time by its own count, in bytes: scene, visibility and all; what
    /// [`RunOptions::memory_bytes`](super::RunOptions::memory_bytes) limits.
    pub accounted_bytes: u64,
    /// Work that was not done.
    pub skipped: Vec<SkippedWork>,
    /// Whether the requested error is reached; by the lit mesh, where one is wanted.
    pub converged: bool,
    /// Why refinement ended; of the lit mesh, where that did not reach it.
    pub stopped_by: StoppedBy,
}

impl SolveReport {
    /// The error that is claimed for what was asked for: of the lit mesh where there is one, else of values at points.
    pub fn claimed(&self) -> f64 {
        self.lit_mesh.map_or(self.error.estimate, |mesh| mesh.whole.estimate)
    }

    /// Counts the rays that were asked so far, and the time that they took in this process.
    pub(super) fn count_rays(&mut self, rays: &Rays<'_>) {
        let (segments, first_hits) = (rays.segments(), rays.first_hit_rays());
        self.time_s.visibility = segments.seconds() + first_hits.seconds();
        self.time_s.first_hits = first_hits.seconds();
        let [segments, first_hits] = rays.cast_by_all();
        self.counts.rays = segments + first_hits;
        self.counts.first_hit_rays = first_hits;
    }
}

/// What is told about the power that travels over the links of a solution.
pub(super) struct Powers<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    pub exposure: &'a Exposure,
    pub closure: Option<&'a Closure>,
    pub lights: &'a LightIrradiance,
    pub radiosity: &'a Radiosity,
}

impl Powers<'_> {
    /// Visits all leaves with their exposed areas and the irradiance there in one more gather over the links, by channel.
    pub fn for_each_leaf(&self, mut visit: impl FnMut(NodeId, f64, &[f64])) {
        let Self { scene, hierarchy, links, exposure, closure, radiosity, .. } = *self;
        let channels = scene.channels();
        let mut irradiance = if links.is_empty() {
            vec![0.0; channels * hierarchy.len()]
        } else {
            sweep::push(hierarchy, sweep::gather(hierarchy, links, exposure, radiosity), channels)
        };
        for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
            let arriving = &mut irradiance[leaf.index() * channels..][..channels];
            if let Some(closure) = closure {
                closure.close(leaf, arriving);
            }
            visit(leaf, hierarchy.area(leaf) * exposure.of(leaf), arriving);
        }
    }

    /// Where the power goes in one more gather, as sweeps close it: what arrives nowhere has escaped, if anything can.
    pub fn energy(&self) -> Energy {
        let Self { scene, hierarchy, exposure, radiosity, .. } = *self;
        let (mut energy, mut arrived) = (Energy::default(), 0.0);
        self.for_each_leaf(|leaf, exposed, arriving| {
            let material = scene.material_of(SurfaceId(hierarchy.node(leaf).surface));
            let arriving = &arriving[..scene.deciding()];
            let of_lights = self.lights.of(leaf, scene.channels());
            for (channel, arriving) in arriving.iter().enumerate() {
                // Light that surfaces do not send is emitted where it arrives.
                let of_lights = of_lights.map_or(0.0, |lights| lights[channel]);
                energy.emitted += exposed * (material.exitance[channel] + of_lights);
                energy.of_lights += exposed * of_lights;
                energy.absorbed += (1.0 - material.reflectance[channel]) * exposed * (arriving + of_lights);
                energy.sent += exposed * radiosity.of(leaf)[channel];
            }
            arrived += exposed * arriving.iter().sum::<f64>();
        });
        energy.escaped = if exposure.is_closed() { 0.0 } else { (energy.sent - arrived).max(0.0) };
        energy.unaccounted = energy.emitted - energy.absorbed - energy.escaped;
        energy.imbalance = (exposure.is_closed() && energy.sent > 0.0).then(|| 1.0 - arrived / energy.sent);
        energy
    }
}
