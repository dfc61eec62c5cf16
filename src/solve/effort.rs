//! The law of effort: how error falls with rays, positions, paths and tolerance, and what a requested error takes by that.
//!
//! Squares of errors add up, and each part falls as a power of what is spent on it. `cargo bench --bench effort` measures the powers over
//! many scenes and prints them; docs/full_tables.md shows their ranges. What must be known of a scene is what light meets in it
//! ([`Illumination`]); pilots measure the rest on the scene itself: how noisy values are, and what links leave wrong. Numbers of surfaces,
//! black things and far things are no part of it.
//!
//! Constants at 2% are what rooms and boxes need there, on average; a pilot or the next step corrects them.

use super::options::SolveOptions;
use crate::paths::Illumination;
use crate::values::NOISE_POWER;

/// The square of what cells make wrong falls with this power of the positions, and of the paths from each.
const CELLS_POWER: f64 = 0.55;

/// The square of what links leave wrong falls with this power of the tolerance, in scenes where few links do.
const TOLERANCE_POWER: f64 = 0.8;

/// The same in any scene: predicts what would be left if few links leave much.
const TOLERANCE_POWER_ANYWHERE: f64 = 0.57;

/// The number of links grows with this power of one over the tolerance.
const LINKS_POWER: f64 = 0.55;

/// The part of the requested error that is aimed at: the claim lies above what is measured.
pub(super) const AIM: f64 = 0.7;

/// The error at which the constants below hold.
const AT: f64 = 0.02;

/// The tolerance of links: the power that a pair may get wrong for the receiver's part of the area that is lit, as a part of the reflected
/// power. Above 0; the first refinement takes it, the next ones what the error found says.
const TOLERANCE_AT_2_PERCENT: f64 = 0.22;

/// The area of receivers for which tolerances are told, as a part of the lit area: any; the tolerance is in proportion to it.
pub(super) const REFERENCE_AREA: f64 = 1e-3;

/// Rays to a point: over links, and paths over the hemisphere. At least 16, at most 2^16.
const LINK_RAYS_AT_2_PERCENT: f64 = 210.0;
const PATHS_AT_2_PERCENT: f64 = 230.0;
const POINT_RAYS: (f64, f64) = (16.0, 8192.0);

/// Rays by which leaves are gathered anew. Their noise averages out over the sources of a point, so few do until the error is small.
const LEAF_RAYS_AT_2_PERCENT: f64 = 16.0;

/// Positions over the lit area: where values end in cells, and where only replicates do, whose noise their product cancels.
const POSITIONS_AT_2_PERCENT: f64 = 4_500.0;
const REPLICATE_POSITIONS_AT_2_PERCENT: f64 = 1_200.0;
const POSITIONS: (f64, f64) = (1024.0, 262_144.0);

/// Positions grow with this power of one over the error: more slowly than [`CELLS_POWER`] asks, because scenes differ by ten times in what
/// they need, and the next step adds where it shows.
const POSITIONS_POWER: f64 = 1.25;

/// Paths from each position, a power of two: the fewer, the more surfaces have a position of their own.
const POSITION_RAYS: f64 = 16.0;
const LEAST_POSITION_RAYS: u32 = 4;
const MOST_POSITION_RAYS: u32 = 256;

/// What is off in how much light elements and cells get from each other adds up from bounce to bounce: where light is reflected more often
/// than from this albedo, each bounce may be off by less in proportion, and positions and paths from each grow, up to so many times, since
/// no number would be enough at 1.
const FEW_BOUNCES_ALBEDO: f64 = 0.75;
const MOST_FOR_BOUNCES: f64 = 4.0;

/// Each replicate takes this part of the paths of each position; more, up to an eighth, where light is reflected often.
const REPLICATES_PART: f64 = 0.0625;
const MOST_REPLICATES_PART: f64 = 0.125;

/// Over links, where few positions serve replicates alone, so many times that part: by less noise of cells more is saved at points.
/// From 1 to 4 about as well.
const REPLICATES_PART_OVER_LINKS: f64 = 2.0;

/// Rays of a replicate at a point.
const REPLICATE_RAYS_AT_2_PERCENT: f64 = 33.0;
const REPLICATE_RAYS_POWER: f64 = 1.2;
const REPLICATE_RAYS: (f64, f64) = (16.0, 1024.0);

/// Values that a user takes at least, as far as choices of rays go. With more, rays to each are fewer at first, and positions are more, by
/// these powers of their number: the least work in all.
const LEAST_VALUES: f64 = 2048.0;
const RAYS_VALUES_POWER: f64 = -0.1;
const POSITIONS_VALUES_POWER: f64 = 0.4;

/// What a requested error takes in a scene.
#[derive(Clone, Debug)]
pub(super) struct Law {
    /// Relative; the error that is asked for, or a larger one to begin with.
    pub error: f64,
    pub illumination: Illumination,
    /// How many values the user takes, about.
    pub values: f64,
}

impl Law {
    /// What the error that is asked for takes.
    pub fn new(options: &SolveOptions, illumination: Illumination) -> Self {
        let values = options.expected_values.map_or(LEAST_VALUES, |values| LEAST_VALUES.max(values as f64));
        Self { error: options.error, illumination, values }
    }

    /// How many times what 2% take, where the square of the error falls with `power` of it.
    fn times(&self, power: f64) -> f64 {
        (AT / self.error).powf(2.0 / power)
    }

    fn for_values(&self, power: f64) -> f64 {
        (self.values / LEAST_VALUES).powf(power)
    }

    /// How many times the effort on cells light takes that is reflected often.
    fn for_bounces(&self) -> f64 {
        ((1.0 - FEW_BOUNCES_ALBEDO) / (1.0 - self.illumination.albedo())).clamp(1.0, MOST_FOR_BOUNCES)
    }

    /// The tolerance of links, in units of the reflected power.
    pub fn tolerance(&self) -> f64 {
        TOLERANCE_AT_2_PERCENT / self.times(TOLERANCE_POWER) * Self::tolerance_factor(1.0 / self.for_bounces())
    }

    /// So many times the tolerance leaves the error times `factor`.
    pub fn tolerance_factor(factor: f64) -> f64 {
        factor.powf(2.0 / TOLERANCE_POWER)
    }

    /// So many times the tolerance leaves so much of the square of what links leave wrong.
    pub fn left_by_links(tolerance_factor: f64) -> f64 {
        tolerance_factor.powf(TOLERANCE_POWER)
    }

    /// So many times the tolerance at which few links leave an error `left` leave `wanted`.
    pub fn tolerance_factor_of_pilot(left: f64, wanted: f64) -> f64 {
        (wanted / left.max(f64::MIN_POSITIVE)).powf(2.0 / TOLERANCE_POWER_ANYWHERE)
    }

    /// So many times the links belong to so many times the tolerance.
    pub fn links_factor(tolerance_factor: f64) -> f64 {
        tolerance_factor.powf(-LINKS_POWER)
    }

    /// So many times the positions, and paths from each, leave so much of the square of what cells make wrong.
    pub fn left_by_cells(more_positions: f64, more_rays: f64) -> f64 {
        (more_positions * more_rays).powf(-CELLS_POWER)
    }

    /// So many times the rays leave so much of the square of the noise.
    pub fn left_by_rays(more_rays: f64) -> f64 {
        more_rays.powf(-NOISE_POWER)
    }

    /// So many times the rays leave the square of the noise times `factor`.
    pub fn rays_factor(factor: f64) -> f64 {
        factor.powf(-1.0 / NOISE_POWER)
    }

    /// Rays to a point over links, or paths over the hemisphere.
    pub fn point_rays(&self, over_cells: bool) -> u32 {
        let rays = if over_cells { PATHS_AT_2_PERCENT } else { LINK_RAYS_AT_2_PERCENT };
        (rays * self.times(NOISE_POWER) * self.for_values(RAYS_VALUES_POWER)).clamp(POINT_RAYS.0, POINT_RAYS.1) as u32
    }

    /// The part by which the square of the noise of values may be larger, because the user takes so many: rays are fewer in proportion.
    pub fn noise_for_values(&self) -> f64 {
        self.for_values(-NOISE_POWER * RAYS_VALUES_POWER)
    }

    /// Rays by which a leaf is gathered anew.
    pub fn leaf_rays(&self) -> u32 {
        (LEAF_RAYS_AT_2_PERCENT * self.times(NOISE_POWER)).clamp(LEAF_RAYS_AT_2_PERCENT, POINT_RAYS.1) as u32
    }

    /// Positions over the lit area.
    pub fn positions(&self, over_cells: bool) -> f64 {
        let (at, for_values) = if over_cells {
            (POSITIONS_AT_2_PERCENT, self.for_values(POSITIONS_VALUES_POWER))
        } else {
            (REPLICATE_POSITIONS_AT_2_PERCENT, 1.0)
        };
        (at * (AT / self.error).powf(POSITIONS_POWER) * for_values * self.for_bounces()).clamp(POSITIONS.0, POSITIONS.1)
    }

    /// Paths from each position, of so many in a scene of so many surfaces.
    pub fn position_rays(&self, positions: f64, surfaces: usize) -> u32 {
        let share = positions / (positions + surfaces as f64);
        let rays = POSITION_RAYS * share * self.for_bounces();
        2_u32.pow(rays.log2().ceil().max(0.0) as u32).clamp(LEAST_POSITION_RAYS, MOST_POSITION_RAYS)
    }

    /// The part of the paths of a position that each replicate takes. Where values have no cells, replicates bear alone that positions grow
    /// more slowly than the square of what cells make wrong must fall.
    pub fn replicate_part(&self, over_cells: bool) -> f64 {
        let of_values = (REPLICATES_PART * self.for_bounces()).min(MOST_REPLICATES_PART);
        if over_cells {
            return of_values;
        }
        REPLICATES_PART_OVER_LINKS * of_values * (AT / self.error).powf(2.0 - POSITIONS_POWER).max(1.0)
    }

    /// Rays of a replicate at a point.
    pub fn replicate_rays(&self) -> u32 {
        let rays = REPLICATE_RAYS_AT_2_PERCENT * (AT / self.error).powf(REPLICATE_RAYS_POWER);
        rays.clamp(REPLICATE_RAYS.0, REPLICATE_RAYS.1) as u32
    }
}
