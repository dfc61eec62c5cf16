//! What the next step takes: tolerance, rays, positions and points, as the law of effort says at first, then as pilots and errors say.

mod of_links;

use super::effort::Law;
use super::options::{SolveOptions, Strategy};
use super::scale::Scale;
use super::step::{Choice, NextStep};
use super::worthwhile_cells::Areas;
use crate::error::{ErrorEstimate, Pilot, doubt_for_claim};
use crate::paths::{CellSize, Resolution};
use crate::scene::{Light, Scene};

/// What the next step takes.
#[derive(Clone)]
pub(super) struct Plan {
    pub options: SolveOptions,
    pub law: Law,
    pub scale: Scale,
    /// Whether values end in cells.
    pub over_cells: bool,
    tolerance: f64,
    pub point_rays: u32,
    vertex_rays: u32,
    pub resolution: Resolution,
    pub error_points: usize,
    pub replicate_rays: u32,
    /// The noise of values as they are, once it is known.
    value_noise: Option<f64>,
    /// The square of the error that is left without that noise, and as it was before cells were found anew for as many rays.
    other_sq: f64,
    other_sq_before: Option<f64>,
    /// Whether cells were found anew since values changed otherwise.
    has_found_cells: bool,
    /// Whether rays were fitted to the scene.
    is_fitted: bool,
    /// Times that links were refined, or cells found anew.
    refinements: u32,
    /// Times that an error was not good enough.
    estimates: u32,
}

/// The tolerance of the one coarse pass over links where values end in cells, in units of the reflected power: links need to tell no more
/// than where it is bright.
pub(super) const COARSE_TOLERANCE: f64 = 16.0;

/// The tolerance of the strategies of the papers at an error of 2%, in units of their scale, and the power of the error that it follows.
const TOLERANCE_OF_PAPERS: f64 = 0.22;
const TOLERANCE_OF_PAPERS_POWER: f64 = 1.75;

/// The parts of the square of the requested error that may be noise of values, and that cells may make wrong. What these leave of what may be
/// claimed goes to the doubt by noise of replicates, at least some of it.
const NOISE_PART: f64 = 0.4;
const CELLS_PART: f64 = 0.2;
const LEAST_DOUBT: f64 = 0.08;

/// A pilot takes this part of the rays, within these limits.
const PILOT_PART: u32 = 8;
const LEAST_PILOT_RAYS: u32 = 12;
const MOST_PILOT_RAYS: u32 = 48;

/// Where a part of the rays is guided fewer would leave out most of the directions around which they are: then noise is more than the law tells.
const LEAST_GUIDED_PILOT_RAYS: u32 = 32;

/// By what a pilot finds, rays become so many times fewer or more than the law says, at most.
const FEWER: f64 = 2.0;
const MORE: f64 = 4.0;

/// Below this error replicates over links must not end in the cells where their first rays arrive: the size of cells would show.
const CELLS_SHOW_BELOW: f64 = 0.0075;

/// Points at which the error is estimated at first, and at most.
const ERROR_POINTS: std::ops::RangeInclusive<usize> = 512..=32_768;

/// The most rays of a replicate, and to a point.
const MAX_REPLICATE_RAYS: u32 = 1 << 14;
const MAX_POINT_RAYS: u32 = 1 << 16;

/// Rounds after which refining once more would not help either.
const MAX_REFINEMENTS: u32 = 8;

/// Times that cells are found more finely.
const MAX_CELLS: u32 = 6;

/// Estimates after which more points would not tell more.
pub(super) const MAX_ESTIMATES: u32 = 16;

/// Cells of unresolved surfaces may make up this part of the square of the error that is asked for. Without them values are noisier, by as much in furnished rooms.
const UNRESOLVED_PART: f64 = 0.1;

/// Values may take so many times the rays in one step.
pub(super) const MOST_RAYS_FACTOR: f64 = 8.0;

/// Where cell radiosities are found too noisy or too coarse, so many times the positions, and paths from each.
pub(super) const MORE_POSITIONS: f64 = 1.25;
pub(super) const MORE_POSITION_RAYS: u32 = 2;

/// Cells found once more leave so much of the square of what they make wrong.
pub(super) fn left_by_finer_cells() -> f64 {
    Law::left_by_cells(MORE_POSITIONS, f64::from(MORE_POSITION_RAYS))
}

impl Plan {
    /// As fine as a law says, which may begin with a larger error than is asked for.
    pub fn new(scene: &Scene, areas: &Areas, options: &SolveOptions, law: Law, over_cells: bool) -> Self {
        let scale = match options.strategy {
            Strategy::Default => Scale::of_illumination(&law.illumination),
            // No material tells of lights.
            _ if scene.lights().iter().any(Light::is_on) => Scale::of_illumination(&law.illumination),
            _ => Scale::of_materials(scene),
        };
        let tolerance = match options.strategy {
            Strategy::Default => law.tolerance().min(COARSE_TOLERANCE),
            _ => TOLERANCE_OF_PAPERS * (options.error / 0.02).powf(TOLERANCE_OF_PAPERS_POWER),
        };
        let positions = options.cells.positions.map_or_else(|| law.positions(over_cells), |positions| positions as f64);
        let side = (law.illumination.lit_area / positions).sqrt();
        let mut plan = Self {
            options: options.clone(),
            scale,
            over_cells,
            tolerance: options.links.tolerance.unwrap_or(tolerance),
            vertex_rays: 1,
            point_rays: options.point_rays.unwrap_or_else(|| law.point_rays(over_cells)),
            resolution: Resolution {
                size: CellSize { side, past_unresolved: false, most_surfaces: 0 },
                rays: law.position_rays(positions, 0),
            },
            error_points: *ERROR_POINTS.start(),
            replicate_rays: law.replicate_rays(),
            value_noise: None,
            other_sq: 0.0,
            other_sq_before: None,
            has_found_cells: false,
            is_fitted: false,
            refinements: 0,
            estimates: 0,
            law,
        };
        plan.resolution.size.most_surfaces = areas.worthwhile(&plan.traffic());
        plan.resolution.rays =
            options.cells.position_rays.unwrap_or_else(|| plan.law.position_rays(positions, plan.resolution.size.most_surfaces));
        plan
    }

    /// Visibility rays to a point.
    pub fn point_rays(&self) -> u32 {
        self.point_rays
    }

    /// How finely cell radiosities are found for values.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// How finely they are found for replicates.
    pub fn replicate_resolution(&self) -> Resolution {
        let rays = self.law.replicate_part(self.over_cells) * f64::from(self.resolution.rays);
        Resolution { rays: rays.ceil() as u32, ..self.resolution }
    }

    /// Points at which the error is estimated.
    pub fn error_points(&self) -> usize {
        self.error_points
    }

    /// Rays of a replicate at a point: its noise must not be much larger than the error that is asked for.
    pub fn replicate_rays(&self) -> u32 {
        self.replicate_rays
    }

    /// Rays of values that tell how noisy those with more will be.
    pub fn pilot_rays(&self) -> u32 {
        let least = if self.is_guided() { LEAST_GUIDED_PILOT_RAYS } else { LEAST_PILOT_RAYS };
        (self.point_rays / PILOT_PART).max(least)
    }

    /// Rays of each point that tell how many replicates should take there.
    pub fn replicate_pilot_rays(&self) -> u32 {
        (self.replicate_rays / PILOT_PART).clamp(LEAST_PILOT_RAYS, MOST_PILOT_RAYS)
    }

    /// The noise that is left to values.
    fn allowed_noise_sq(&self) -> f64 {
        NOISE_PART * self.law.noise_for_values() * self.law.error.powi(2)
    }

    /// Fits rays to points to the noise that so many of them were found to leave.
    pub fn fit_point_rays(&mut self, noise_sq: f64, tried: u32) {
        if self.may_take_more_rays() && !self.is_fitted {
            let wanted = f64::from(tried) * Law::rays_factor(self.allowed_noise_sq() / noise_sq);
            let planned = f64::from(self.point_rays);
            let least = if self.is_guided() { f64::from(tried) } else { planned / FEWER };
            self.point_rays = wanted.min(planned * MORE).max(least).min(f64::from(MAX_POINT_RAYS)) as u32;
            self.is_fitted = true;
        }
    }

    /// Rays of values from a point, and to emitters from where paths go on.
    pub fn rays(&self) -> [u32; 2] {
        [self.point_rays, self.vertex_rays]
    }

    /// The paths that a value takes, where `next_event_sq` comes to the noise that a pilot found: without limits.
    pub fn rays_for(&self, pilot: &Pilot, next_event_sq: f64) -> f64 {
        let allowed = self.allowed_noise_sq();
        f64::from(self.pilot_rays()) * (Law::rays_factor(allowed / pilot.noise_sq) + next_event_sq / allowed)
    }

    /// Whether emitters may be looked for exactly from where paths go on: where values are much noisier than was foreseen. What paths bring is stored as
    /// next-event rays find it.
    pub fn may_see_exactly(&self, pilot: &Pilot) -> bool {
        !self.options.keep_transport && self.rays_for(pilot, 0.0) > FEWER * f64::from(self.point_rays)
    }

    /// Looks for emitters exactly from where paths go on, as far as that costs no more than so many rays.
    pub fn see_exactly(&mut self, vertex_rays: u32) {
        self.vertex_rays = vertex_rays;
    }

    /// Whether emitters are looked for exactly from where paths go on, and rays are guided by what is seen of them.
    fn is_guided(&self) -> bool {
        self.vertex_rays > 1
    }

    /// Whether a pilot is wanted: of values over cells, before there is an estimate of the error, which tells more.
    pub fn wants_pilot(&self) -> bool {
        self.over_cells && self.is_first()
    }

    /// Fits rays to points and of replicates to what a pilot found with [`Self::pilot_rays`].
    pub fn fit_rays(&mut self, pilot: &Pilot) {
        let tried = self.pilot_rays();
        self.fit_point_rays(pilot.noise_sq, tried);

        // Replicates may leave the more doubt, the less noise values have.
        let requested_sq = self.law.error.powi(2);
        let noise_left = Law::left_by_rays(f64::from(self.point_rays) / f64::from(tried));
        let noise_part = pilot.noise_sq * noise_left / requested_sq;
        let allowed = doubt_for_claim(noise_part + CELLS_PART).max(LEAST_DOUBT) * requested_sq;
        let planned = f64::from(self.replicate_rays);
        let wanted = (pilot.replicate_doubt / allowed).clamp(planned / FEWER, planned * MORE);
        self.replicate_rays = wanted.clamp(f64::from(LEAST_PILOT_RAYS), f64::from(MAX_REPLICATE_RAYS)) as u32;
    }

    /// Whether no error was judged yet.
    pub fn is_first(&self) -> bool {
        self.estimates == 0
    }

    /// Limits rays to points to so many.
    pub fn limit_point_rays(&mut self, most: u32) {
        if self.options.point_rays.is_none() {
            self.point_rays = self.point_rays.min(most.max(LEAST_PILOT_RAYS));
        }
    }

    pub fn may_take_more_rays(&self) -> bool {
        self.options.point_rays.is_none() && self.point_rays < MAX_POINT_RAYS
    }

    /// Bounces that the paths of replicates take at least: one where values take the radiosities of cells too, so that the size of these is
    /// not shared, and where so little is asked for that it would show.
    pub fn replicate_bounces(&self) -> u32 {
        u32::from(self.over_cells || self.options.error < CELLS_SHOW_BELOW)
    }

    /// Counts an error that is not good enough, and tells the noise of values as they are: known with the error, or `sampled` for so many rays.
    pub fn begin_step(&mut self, error: &ErrorEstimate, sampled: impl FnOnce([u32; 2]) -> f64) -> f64 {
        if error.claimed <= self.requested() {
            return 0.0;
        }
        self.estimates += 1;
        if self.has_estimated_enough() {
            return 0.0;
        }
        let rays = self.rays();
        let noise = *self.value_noise.get_or_insert_with(|| error.value_noise.unwrap_or_else(|| sampled(rays)));
        self.other_sq = (error.measured.powi(2) - noise.powi(2)).max(0.0);
        noise
    }

    /// Whether cells were found anew, and values did not change otherwise since.
    pub fn has_found_cells(&self) -> bool {
        self.has_found_cells
    }

    /// Whether finer cells took less than half of what the law says: then rays make the error that are so rare that values have hardly met them, and their
    /// noise does not show.
    pub fn has_found_cells_in_vain(&self) -> bool {
        self.other_sq_before.is_some_and(|before| self.other_sq > 0.5 * (1.0 + left_by_finer_cells()) * before)
    }

    /// The error that is asked for.
    pub fn requested(&self) -> f64 {
        self.options.error
    }

    /// The most rays that a value may take, times the square of the error that is asked for.
    pub fn most_paths_for_error(&self) -> f64 {
        f64::from(MAX_POINT_RAYS) * self.requested().powi(2)
    }

    /// Whether cells may be found more finely: those of values, or of replicates alone.
    pub fn may_find_cells(&self) -> bool {
        self.refinements < MAX_CELLS
    }

    /// Whether paths of values are to go on from unresolved surfaces, whose cells make values wrong by so much.
    pub fn should_pass_unresolved(&self, by_unresolved: f64) -> bool {
        self.over_cells
            && !self.resolution.size.past_unresolved
            && by_unresolved.powi(2) > UNRESOLVED_PART * self.requested().powi(2)
    }

    pub fn may_refine(&self) -> bool {
        let given = self.options.links.tolerance.is_some() || self.options.strategy == Strategy::Uniform;
        !given && !self.options.strategy.links_surfaces() && self.refinements + 1 < MAX_REFINEMENTS
    }

    /// Whether no more estimates will make the error known better.
    pub fn has_estimated_enough(&self) -> bool {
        self.estimates > MAX_ESTIMATES
    }

    /// Whether replicates may be as many.
    pub fn may_know_closer(&self, closer: &Choice) -> bool {
        let (most_points, most_rays) = self.most_replicates();
        closer.points <= most_points && closer.replicate_rays <= most_rays && self.estimates < MAX_ESTIMATES / 2
    }

    /// So many times the points, and so many times the rays of each replicate, are the most that there may be.
    pub fn most_replicates(&self) -> (f64, f64) {
        let most_points = (*ERROR_POINTS.end() as f64 / self.error_points as f64).max(1.0);
        let most_rays = (f64::from(MAX_REPLICATE_RAYS) / f64::from(self.replicate_rays)).max(1.0);
        (most_points, most_rays)
    }

    /// Plans a step.
    pub fn apply(&mut self, step: NextStep) {
        if step.changes_values() {
            self.value_noise = None;
            self.has_found_cells = matches!(step, NextStep::FindCells(_));
            self.other_sq_before = (step == NextStep::FindCells(1.0)).then_some(self.other_sq);
        }
        match step {
            NextStep::GoodEnough | NextStep::Exhausted | NextStep::TakeCells => {}
            NextStep::MoreReplicateRays => self.replicate_rays = (2 * self.replicate_rays).min(MAX_REPLICATE_RAYS),
            NextStep::MorePoints => self.error_points += self.error_points / 2,
            NextStep::MoreRays(factor) => self.add_rays(factor),
            NextStep::FindCells(factor) => {
                self.add_rays(factor);
                self.refinements += 1;
                self.resolution.size.side /= MORE_POSITIONS.sqrt();
                self.resolution.rays *= MORE_POSITION_RAYS;
            }
            NextStep::PassUnresolved => self.resolution.size.past_unresolved = true,
            NextStep::Refine(factor) => {
                self.refinements += 1;
                self.tolerance *= factor;
            }
        }
    }

    fn add_rays(&mut self, factor: f64) {
        if factor > 1.0 && self.may_take_more_rays() {
            self.point_rays = (f64::from(self.point_rays) * factor).min(f64::from(MAX_POINT_RAYS)) as u32;
        }
    }
}
