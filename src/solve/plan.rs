//! How hard to try for a requested error, and what to do when it is not reached.

use super::error_estimate::ErrorEstimate;
use super::{Bounds, Gather, SolveOptions, Strategy};
use crate::links::oracle::{AreaWeighted, BrightnessWeighted, RefinementOracle, Uniform};
use crate::reconstruct::Resolution;
use crate::scene::{Scene, SurfaceId};

/// What a round left to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The claimed error is at most the requested one.
    GoodEnough,
    /// The error may well be small enough, but the estimate is too noisy to claim it: look at more points.
    LookCloser,
    /// Values at points are too noisy: more rays to each.
    MoreRays,
    /// Radiosities at the ends of paths are too noisy or too coarse: resolve them more finely.
    Resolve,
    /// Another round of refinement, to a finer tolerance.
    Refine,
    /// More effort would not help, or is not allowed.
    Exhausted,
}

/// Tolerance and rays of the next round.
pub(super) struct Plan {
    options: SolveOptions,
    surfaces: usize,
    total_area: f64,
    /// What the reflected radiosity may be on average, in W/m^2: sets the scale of tolerances.
    expected_radiosity: f64,
    tolerance: f64,
    point_rays: u32,
    gather: Gather,
    resolution: Resolution,
    error_points: usize,
    look_rays: u32,
    refinements: u32,
    looks: u32,
}

/// The first steps of the first round take tolerances 16 and 4 times as large.
const FIRST_STEPS: [f64; 3] = [16.0, 4.0, 1.0];

/// Rounds after which refining once more would not help either.
const MAX_REFINEMENTS: u32 = 8;

/// Times that radiosities are resolved more finely.
const MAX_RESOLVES: u32 = 6;

/// Looks at more points after which the estimate will not get better.
const MAX_LOOKS: u32 = 16;

/// The part of the requested error that is aimed at: the claim lies above what is measured.
const AIM: f64 = 0.7;

/// A look closer is worth it if it takes at most so many times as many points as the first.
const FEW_TIMES: f64 = 4.0;

/// More rays to a look are worth it if its noise makes up this part of the scatter.
const NOISY: f64 = 0.75;

/// Below this error looks must not share the size of cells: on a Cornell box it makes some 0.3%.
const CELLS_SHOW_BELOW: f64 = 0.0075;

/// Points at which the error is sampled at first, and at most.
const ERROR_POINTS: std::ops::RangeInclusive<usize> = 512..=32_768;

/// The most rays of a look at a point.
const MAX_LOOK_RAYS: u32 = 4096;

/// How tolerance and rays follow from the error: a power law through what the Cornell box needs for [`AIM`] times 2% and 1%.
const TOLERANCE_AT_2_PERCENT: f64 = 0.15;
const TOLERANCE_POWER: f64 = 2.2;
const COARSE_TOLERANCE_POWER: f64 = 1.8;
const RAYS_AT_2_PERCENT: f64 = 160.0;
const RAYS_POWER: f64 = 1.6;

/// Rays with which leaves are gathered anew. Their noise sums over a point's links, so few do until the error is small.
const LEAF_RAYS_AT_2_PERCENT: f64 = 16.0;
const LEAF_RAYS_POWER: f64 = 1.5;

/// From so many surfaces on clusters are worth their trouble.
const CLUSTERED_SURFACES: usize = 64;

/// The same for paths over the hemisphere, from an office: few of them gain more by being spread evenly than many.
const HEMISPHERE_RAYS_AT_2_PERCENT: f64 = 230.0;
const FEW_HEMISPHERE_RAYS_POWER: f64 = 1.6;
const MANY_HEMISPHERE_RAYS_POWER: f64 = 2.0;

/// Positions at which radiosities are resolved: so many for 2%, within these limits, times so much where they are found too few.
/// Their noise averages out over the ends of many paths: on an office 16,384 did nearly as well as 65,536.
const POSITIONS_AT_2_PERCENT: f64 = 20_000.0;
const POSITIONS_POWER: f64 = 1.5;
const LEAST_POSITIONS: f64 = 8192.0;
const MOST_POSITIONS: f64 = 262_144.0;
/// The same where only looks need them.
const LOOKS_POSITIONS_AT_2_PERCENT: f64 = 10_000.0;
const LOOKS_POSITIONS_POWER: f64 = 1.0;
const LEAST_LOOKS_POSITIONS: f64 = 4096.0;
const MORE_POSITIONS: f64 = 3.0;

/// Paths and rays to lamps from each position.
const POSITION_PATHS: u32 = 4;
const POSITION_LAMP_RAYS: u32 = 4;

/// Up to so many surfaces that reflect, values are gathered over links: a link costs a form factor and a ray at least, at every
/// point, while paths over the hemisphere cost what the requested error asks for.
const FEW_SURFACES: usize = 64;

/// The tolerance of the one refinement where values do without links.
const COARSE_TOLERANCE: f64 = 2.4;

/// The most rays to a point.
const MAX_POINT_RAYS: u32 = 1 << 16;

impl Plan {
    pub fn new(scene: &Scene, options: &SolveOptions) -> Self {
        let surfaces =
            || (0..scene.surfaces().len() as u32).map(|id| (scene.surface(SurfaceId(id)), scene.material_of(SurfaceId(id))));
        let total_area: f64 = surfaces().map(|(surface, _)| surface.polygon.area()).sum();
        let mean_over_area = |value: &dyn Fn(usize) -> f64| {
            surfaces().enumerate().map(|(index, (surface, _))| surface.polygon.area() * value(index)).sum::<f64>() / total_area
        };
        let of = |index: usize| scene.material_of(SurfaceId(index as u32));
        let exitance = mean_over_area(&|index| of(index).exitance.iter().copied().fold(0.0, f64::max));
        let reflectance = mean_over_area(&|index| of(index).reflectance.iter().copied().fold(0.0, f64::max)).min(0.999);
        let reflecting = surfaces().filter(|(_, material)| material.reflectance.iter().any(|&rho| rho > 0.0)).count();
        let gather = match options.gather {
            Gather::Auto if options.bounds == Bounds::Guaranteed => Gather::Links,
            Gather::Auto if options.strategy == Strategy::Default && reflecting > FEW_SURFACES => Gather::Hemisphere,
            Gather::Auto => Gather::Links,
            chosen => chosen,
        };
        let (rays_at_2_percent, rays_power) = match gather {
            Gather::Hemisphere if options.error > 0.02 => (HEMISPHERE_RAYS_AT_2_PERCENT, FEW_HEMISPHERE_RAYS_POWER),
            Gather::Hemisphere => (HEMISPHERE_RAYS_AT_2_PERCENT, MANY_HEMISPHERE_RAYS_POWER),
            _ => (RAYS_AT_2_PERCENT, RAYS_POWER),
        };
        let tolerance_power = if options.error > 0.02 { COARSE_TOLERANCE_POWER } else { TOLERANCE_POWER };
        let (positions_at_2_percent, positions_power, least_positions) = match gather {
            Gather::Hemisphere => (POSITIONS_AT_2_PERCENT, POSITIONS_POWER, LEAST_POSITIONS),
            _ => (LOOKS_POSITIONS_AT_2_PERCENT, LOOKS_POSITIONS_POWER, LEAST_LOOKS_POSITIONS),
        };
        let positions =
            (positions_at_2_percent * (0.02 / options.error).powf(positions_power)).clamp(least_positions, MOST_POSITIONS);
        let resolution = Resolution::of_positions(scene, positions as usize, POSITION_PATHS, POSITION_LAMP_RAYS);
        Self {
            options: options.clone(),
            surfaces: scene.surfaces().len(),
            total_area,
            expected_radiosity: exitance * reflectance / (1.0 - reflectance),
            tolerance: options.tolerance.unwrap_or(TOLERANCE_AT_2_PERCENT * (options.error / 0.02).powf(tolerance_power)),
            point_rays: options
                .point_rays
                .unwrap_or((rays_at_2_percent * (0.02 / options.error).powf(rays_power)).clamp(16.0, 8192.0) as u32),
            error_points: *ERROR_POINTS.start(),
            look_rays: (1.2 / options.error.powf(1.2)).clamp(64.0, f64::from(MAX_LOOK_RAYS)) as u32,
            gather,
            resolution,
            refinements: 0,
            looks: 0,
        }
    }

    /// The tolerances of this round's steps, falling.
    pub fn tolerances(&self) -> Vec<f64> {
        if self.gather == Gather::Hemisphere {
            vec![self.options.tolerance.unwrap_or(COARSE_TOLERANCE)]
        } else if self.refinements == 0 && self.options.strategy != Strategy::Uniform {
            FIRST_STEPS.iter().map(|factor| factor * self.tolerance).collect()
        } else {
            vec![self.tolerance]
        }
    }

    /// The oracle of the chosen strategy at `tolerance`.
    pub fn oracle(&self, tolerance: f64) -> Box<dyn RefinementOracle> {
        let min_area = self.min_area();
        match self.options.strategy {
            Strategy::Default => Box::new(AreaWeighted {
                tolerance: tolerance * self.expected_radiosity,
                reference_area: 1e-3 * self.total_area,
                min_area,
            }),
            Strategy::Uniform => Box::new(Uniform { element_area: self.options.element_area.unwrap_or(self.total_area) }),
            _ => Box::new(BrightnessWeighted { tolerance: tolerance * self.expected_radiosity, min_area }),
        }
    }

    /// Whether clusters gather and emit: not in the strategies that have none, nor where surfaces are few or bounds are asked for,
    /// because little can be proved of clusters.
    pub fn clusters(&self) -> bool {
        self.options.strategy == Strategy::Default
            && self.options.bounds != Bounds::Guaranteed
            && self.surfaces >= CLUSTERED_SURFACES
    }

    /// The irradiance that a link may carry unrefined in the strategies of 1994, in W/m^2: eps_refine.
    pub fn irradiance_tolerance(&self) -> f64 {
        self.tolerance * self.expected_radiosity
    }

    /// Nodes of this area or less are not split, in m^2.
    pub fn min_area(&self) -> f64 {
        self.options.min_element * self.total_area
    }

    /// Visibility rays to a point.
    pub fn point_rays(&self) -> u32 {
        self.point_rays
    }

    /// Visibility rays with which the radiosity of a leaf is taken anew; 0 leaves it alone.
    pub fn leaf_rays(&self) -> u32 {
        let wanted = LEAF_RAYS_AT_2_PERCENT * (0.02 / self.options.error).powf(LEAF_RAYS_POWER);
        self.options.leaf_rays.unwrap_or(wanted.clamp(LEAF_RAYS_AT_2_PERCENT, f64::from(MAX_POINT_RAYS)) as u32)
    }

    /// How values at points are gathered; never [`Gather::Auto`].
    pub fn gather(&self) -> Gather {
        self.gather
    }

    /// How finely radiosities are resolved.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Points at which the error is looked at.
    pub fn error_points(&self) -> usize {
        self.error_points
    }

    /// Rays of a look at a point: its noise must not be much larger than the error that is asked for.
    pub fn look_rays(&self) -> u32 {
        self.look_rays
    }

    /// Points for which a claim is waited for rather than made easier by better values: more, the more was done for these.
    fn worthwhile_points(&self) -> f64 {
        FEW_TIMES * (*ERROR_POINTS.start() as f64) * 2_f64.powi(self.refinements as i32)
    }

    /// Bounces that the paths of looks take at least: one where values take the radiosities of cells too, so that the size of these is
    /// not shared, and where so little is asked for that it would show.
    pub fn look_bounces(&self) -> u32 {
        u32::from(self.gather == Gather::Hemisphere || self.options.error < CELLS_SHOW_BELOW)
    }

    /// Looks at the error that was reached, and sees to what is worst: noise of the estimate, noise at the points, or the links.
    /// `gather_noise` tells the part of the error that is noise at the points; that costs values, so it is asked only where it may decide.
    pub fn judge(&mut self, error: &ErrorEstimate, gather_noise: impl FnOnce() -> f64) -> Verdict {
        let requested = self.options.error;
        if error.claimed <= requested {
            return Verdict::GoodEnough;
        }
        self.looks += 1;
        if self.looks > MAX_LOOKS {
            return Verdict::Exhausted;
        }
        // As far below what is measured as the claim lies above it, the error may still be.
        let may_be_sq = 2.0 * error.measured.powi(2) - error.claimed.powi(2);
        let is_promising = error.measured < AIM * requested
            || error.estimate_more_points(requested) * (self.error_points as f64) < self.worthwhile_points()
            || may_be_sq < (0.5 * requested).powi(2);
        if is_promising && self.error_points < *ERROR_POINTS.end() {
            // Twice the rays cost what twice the points do, and take away more than half of the noise alone.
            if error.look_scatter > NOISY && self.look_rays < MAX_LOOK_RAYS {
                self.look_rays = (2 * self.look_rays).min(MAX_LOOK_RAYS);
            } else {
                self.error_points += self.error_points / 2;
            }
            return Verdict::LookCloser;
        }
        let excess = error.measured.max(0.5 * error.claimed) / (AIM * requested);
        let may_take_more_rays = self.options.point_rays.is_none() && self.point_rays < MAX_POINT_RAYS;
        let gather_noise = gather_noise();
        if gather_noise >= requested && !may_take_more_rays {
            // Whatever else is made better, this noise is left.
            return Verdict::Exhausted;
        }
        if gather_noise > 0.7 * error.measured && may_take_more_rays {
            let factor = excess.powf(RAYS_POWER).clamp(1.25, 8.0);
            self.point_rays = (f64::from(self.point_rays) * factor).min(f64::from(MAX_POINT_RAYS)) as u32;
            return Verdict::MoreRays;
        }
        if self.gather == Gather::Hemisphere {
            // More positions: each then stands for less area, and a path finds another one more often.
            if self.refinements >= MAX_RESOLVES {
                return Verdict::Exhausted;
            }
            self.refinements += 1;
            self.resolution.side /= MORE_POSITIONS.sqrt();
            return Verdict::Resolve;
        }
        self.refinements += 1;
        if self.options.strategy.links_surfaces() {
            return Verdict::Exhausted;
        }
        if self.options.tolerance.is_some() || self.options.strategy == Strategy::Uniform || self.refinements >= MAX_REFINEMENTS {
            return Verdict::Exhausted;
        }
        self.tolerance *= excess.powf(-TOLERANCE_POWER).clamp(0.1, 0.6);
        Verdict::Refine
    }
}
