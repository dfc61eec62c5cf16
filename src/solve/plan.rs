//! How hard to try for a requested error: what is planned (here), and what to do when it is not reached (`verdict`, `remedy`).

mod remedy;
mod verdict;

pub(super) use verdict::Verdict;

use super::error_estimate::Pilot;
use super::{Gather, SolveOptions, Strategy};
use crate::links::oracle::{AreaWeighted, BrightnessWeighted, RefinementOracle, Uniform};
use crate::reconstruct::Resolution;
use crate::scene::{Scene, SurfaceId};

/// Tolerance and rays of the next round.
pub(super) struct Plan {
    options: SolveOptions,
    surfaces: usize,
    total_area: f64,
    /// Values that the user takes.
    values: f64,
    /// What the reflected radiosity may be on average, in W/m^2: sets the scale of tolerances.
    expected_radiosity: f64,
    tolerance: f64,
    point_rays: u32,
    gather: Gather,
    resolution: Resolution,
    /// Looks take this part of the rays of each position.
    look_part: f64,
    error_points: usize,
    look_rays: u32,
    /// The work of the first looks, see [`Self::look_work`].
    first_look_work: f64,
    /// The noise of values as they are, once it is known.
    gather_noise: Option<f64>,
    /// Whether rays to points were fitted to the scene.
    is_fitted: bool,
    refinements: u32,
    looks: u32,
}

/// The first steps of the first round take tolerances 16 and 4 times as large.
const FIRST_STEPS: [f64; 3] = [16.0, 4.0, 1.0];

/// The part of the square of the requested error that may be noise of values, and the part of what that leaves, at least some of it, which
/// may be a standard deviation by noise of looks.
const NOISE_PART: f64 = 0.4;
const LOOK_PART: f64 = 0.11;
const LEAST_DOUBTED: f64 = 0.3;

/// A pilot takes this part of the rays; the square of the noise falls with this power of their number.
const PILOT_PART: u32 = 8;
const LEAST_PILOT_RAYS: u32 = 12;
const MOST_PILOT_RAYS: u32 = 48;
const NOISE_POWER: f64 = 1.25;

/// By what a pilot finds rays of looks become so many times fewer, and all rays so many times more than planned, at most.
const FEWER: f64 = 2.0;
const MORE: f64 = 4.0;

/// Values that a user takes at least, as far as choices of rays go.
const LEAST_VALUES: f64 = 2048.0;

/// With more values, rays to each are fewer at first, and positions are more, by these powers of their number.
const RAYS_VALUES_POWER: f64 = -0.1;
const POSITIONS_VALUES_POWER: f64 = 0.4;

/// Below this error looks must not share the size of cells: on a Cornell box it makes some 0.3%.
const CELLS_SHOW_BELOW: f64 = 0.0075;

/// Points at which the error is sampled at first, and at most.
const ERROR_POINTS: std::ops::RangeInclusive<usize> = 512..=32_768;

/// The fewest and the most rays of a look at a point.
const LEAST_LOOK_RAYS: f64 = 64.0;
const MAX_LOOK_RAYS: u32 = 4096;

/// How tolerance and rays follow from the error: a power law through what the Cornell box needs for 0.7 times 2% and 1%. Rays are a third
/// more than it needs: there they make the square of the error fall by more than time rises.
const TOLERANCE_AT_2_PERCENT: f64 = 0.22;
const TOLERANCE_POWER: f64 = 1.75;
const COARSE_TOLERANCE_POWER: f64 = 1.7;
const RAYS_AT_2_PERCENT: f64 = 210.0;
const RAYS_POWER: f64 = 1.45;

/// Rays with which leaves are gathered anew. Their noise sums over a point's links, so few do until the error is small.
const LEAF_RAYS_AT_2_PERCENT: f64 = 16.0;
const LEAF_RAYS_POWER: f64 = 1.5;

/// From so many surfaces on clusters are worth their trouble.
const CLUSTERED_SURFACES: usize = 64;

/// The same for paths over the hemisphere, from an office: few of them gain more by being spread evenly than many.
const HEMISPHERE_RAYS_AT_2_PERCENT: f64 = 230.0;
const FEW_HEMISPHERE_RAYS_POWER: f64 = 1.6;
const MANY_HEMISPHERE_RAYS_POWER: f64 = 2.0;

/// Positions at which radiosities are resolved: so many for 2%, within these limits.
const POSITIONS_AT_2_PERCENT: f64 = 8_500.0;
const POSITIONS_POWER: f64 = 1.25;
const LEAST_POSITIONS: f64 = 2048.0;
const MOST_POSITIONS: f64 = 262_144.0;
/// The same where only looks need them: on a Cornell box 5000 at 2% took a tenth more time and left claims as they were.
const LOOKS_POSITIONS_AT_2_PERCENT: f64 = 2000.0;
const LOOKS_POSITIONS_POWER: f64 = 1.0;
const LEAST_LOOKS_POSITIONS: f64 = 1024.0;

/// Paths and rays to lamps from each position, powers of two: the fewer, the more surfaces have a position of their own.
///
/// At 1% the square of what values are off by for believing cells made up 18% of what is allowed with 33,000 positions and 8 of each in a
/// room, 20% in a dining room, 32% in a game level; with 0.7 times the positions and 16 of each 6, 13 and 27%, with 0.35 times and 32
/// 35, 20 and 37%.
const POSITION_RAYS: std::ops::RangeInclusive<u32> = 4..=16;

/// The same where lamps are so many: in a game level at 1% with 16 what values are off by for believing cells made up 17% of what is
/// allowed, with 8 of them 21%, for a quarter less time.
const MANY_LAMPS: usize = 17;
const POSITION_RAYS_FOR_MANY_LAMPS: std::ops::RangeInclusive<u32> = 4..=8;

/// What is off in how much light cells get from each other adds up from bounce to bounce: where less than this is absorbed on average,
/// positions and paths from each are more in proportion, these up to the next power of two. (In two white rooms that absorb 0.13 values
/// scattered by a factor common to all of 0.8% with 12,700 positions of 16 paths, and of 0.3% as this plans for 2%.)
const LITTLE_ABSORPTION: f64 = 0.25;
const MOST_POSITION_RAYS: u32 = 256;
/// No more than so many times as many: no number would be enough where next to nothing is absorbed (a cube of reflectance 0.999 took 36 s).
const MOST_FOR_BOUNCES: f64 = 4.0;

/// Looks take this part of the paths and rays of each position, where little is absorbed more. (With half of them six rooms took a tenth
/// more time, and claims were the same. In two white rooms with a quarter 7 of 14 claims at 5% and 2% were wrong.)
const LOOKS_PART: f64 = 0.25;
const MOST_LOOKS_PART: f64 = 0.5;

/// Up to so many surfaces that reflect, values are gathered over links: a link costs a form factor and a ray at least, at every
/// point, while paths over the hemisphere cost what the requested error asks for.
const FEW_SURFACES: usize = 64;

/// Where so much is reflected on average, the same: what links are off by adds up from bounce to bounce.
const VERY_BRIGHT: f64 = 0.75;

/// The tolerance of the one refinement where values do without links.
const COARSE_TOLERANCE: f64 = 10.0;

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
            Gather::Auto if options.strategy == Strategy::Default && (reflecting > FEW_SURFACES || reflectance > VERY_BRIGHT) => {
                Gather::Hemisphere
            }
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
        let values = options.expected_values.map_or(LEAST_VALUES, |values| LEAST_VALUES.max(values as f64));
        let for_values = |power: f64| (values / LEAST_VALUES).powf(power);
        let positions_for_values = if gather == Gather::Hemisphere { for_values(POSITIONS_VALUES_POWER) } else { 1.0 };
        let for_bounces = (LITTLE_ABSORPTION / (1.0 - reflectance)).clamp(1.0, MOST_FOR_BOUNCES);
        let positions = positions_at_2_percent * (0.02 / options.error).powf(positions_power) * positions_for_values * for_bounces;
        let positions = positions.clamp(least_positions, MOST_POSITIONS);
        let emitting = surfaces().filter(|(_, material)| material.emits()).count();
        let (least, most) = if emitting < MANY_LAMPS { POSITION_RAYS } else { POSITION_RAYS_FOR_MANY_LAMPS }.into_inner();
        let share = positions / (positions + scene.surfaces().len() as f64);
        let rays =
            2_u32.pow((f64::from(most) * share * for_bounces).log2().ceil().max(0.0) as u32).clamp(least, MOST_POSITION_RAYS);
        let resolution = Resolution::of_positions(scene, positions as usize, rays);
        let mut plan = Self {
            options: options.clone(),
            surfaces: scene.surfaces().len(),
            total_area,
            values,
            expected_radiosity: exitance * reflectance / (1.0 - reflectance),
            tolerance: options.tolerance.unwrap_or(TOLERANCE_AT_2_PERCENT * (options.error / 0.02).powf(tolerance_power)),
            point_rays: options.point_rays.unwrap_or(
                (rays_at_2_percent * (0.02 / options.error).powf(rays_power) * for_values(RAYS_VALUES_POWER)).clamp(16.0, 8192.0)
                    as u32,
            ),
            error_points: *ERROR_POINTS.start(),
            look_rays: (1.2 / options.error.powf(1.2)).clamp(LEAST_LOOK_RAYS, f64::from(MAX_LOOK_RAYS)) as u32,
            gather,
            resolution,
            look_part: (LOOKS_PART * for_bounces).min(MOST_LOOKS_PART),
            first_look_work: 0.0,
            gather_noise: None,
            is_fitted: false,
            refinements: 0,
            looks: 0,
        };
        plan.first_look_work = plan.look_work();
        plan
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

    /// Whether clusters gather and emit: not in the strategies that have none, nor where surfaces are few.
    pub fn clusters(&self) -> bool {
        self.options.strategy == Strategy::Default && self.surfaces >= CLUSTERED_SURFACES
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

    /// How finely radiosities are resolved, for values.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// How finely they are resolved for looks.
    pub fn look_resolution(&self) -> Resolution {
        Resolution { rays: (self.look_part * f64::from(self.resolution.rays)).ceil() as u32, ..self.resolution }
    }

    /// Points at which the error is looked at.
    pub fn error_points(&self) -> usize {
        self.error_points
    }

    /// Rays of a look at a point: its noise must not be much larger than the error that is asked for.
    pub fn look_rays(&self) -> u32 {
        self.look_rays
    }

    /// The work of all looks so far, in rays: each bounce takes one more, and one to a lamp.
    fn look_work(&self) -> f64 {
        let paths = 2.0 * self.error_points as f64 * f64::from(self.look_rays);
        paths * f64::from(1 + 2 * self.look_bounces())
    }

    /// Rays of values that tell how noisy those with more will be.
    pub fn pilot_rays(&self) -> u32 {
        (self.point_rays / PILOT_PART).max(LEAST_PILOT_RAYS)
    }

    /// Rays of each point that tell how many looks should take there.
    pub fn look_pilot_rays(&self) -> u32 {
        (self.look_rays / PILOT_PART).clamp(LEAST_PILOT_RAYS, MOST_PILOT_RAYS)
    }

    /// Chooses rays to points and of looks by what a pilot found with [`Self::pilot_rays`].
    pub fn fit_rays(&mut self, pilot: &Pilot) {
        let requested_sq = self.options.error.powi(2);
        let (tried, planned) = (f64::from(self.pilot_rays()), f64::from(self.point_rays));
        if self.may_take_more_rays() && !self.is_fitted {
            let allowed = NOISE_PART * (self.values / LEAST_VALUES).powf(-NOISE_POWER * RAYS_VALUES_POWER) * requested_sq;
            let wanted = tried * (pilot.noise_sq / allowed).powf(1.0 / NOISE_POWER);
            self.point_rays = wanted.clamp(planned, planned * MORE).min(f64::from(MAX_POINT_RAYS)) as u32;
            self.is_fitted = true;
        }

        // Looks may leave the more doubt, the less noise values have.
        let noise_part = pilot.noise_sq * (tried / f64::from(self.point_rays)).powf(NOISE_POWER) / requested_sq;
        let allowed = LOOK_PART * (1.0 - noise_part).max(LEAST_DOUBTED) * requested_sq;
        let planned = f64::from(self.look_rays);
        let wanted = (pilot.look_doubt / allowed).clamp(planned / FEWER, planned * MORE);
        self.look_rays = wanted.clamp(LEAST_LOOK_RAYS, f64::from(MAX_LOOK_RAYS)) as u32;
    }

    fn may_take_more_rays(&self) -> bool {
        self.options.point_rays.is_none() && self.point_rays < MAX_POINT_RAYS
    }

    /// Bounces that the paths of looks take at least: one where values take the radiosities of cells too, so that the size of these is
    /// not shared, and where so little is asked for that it would show.
    pub fn look_bounces(&self) -> u32 {
        u32::from(self.gather == Gather::Hemisphere || self.options.error < CELLS_SHOW_BELOW)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::error_estimate::{Doubts, ErrorEstimate};
    use super::verdict::MAX_LOOKS;
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    /// What is found where both noise and looks may be at fault.
    const DOUBTFUL: ErrorEstimate = ErrorEstimate {
        measured: 0.016,
        claimed: 0.023,
        doubts: Doubts { looks: 9e-5, noise: 0.0 },
        look_scatter: 0.2,
        gather_noise: Some(0.0155),
    };

    fn plan(expected_values: Option<u64>) -> Plan {
        let quad = |z: f64, u: DVec3| {
            let corner = DVec3::new(0.0, 0.0, z);
            Polygon::from_vertices(vec![corner, corner + u, corner + DVec3::X + DVec3::Y, corner + DVec3::X + DVec3::Y - u])
                .unwrap()
        };
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
        let faces = vec![(quad(0.0, DVec3::X), 0, 0), (quad(1.0, DVec3::Y), 0, 1)];
        let scene = Scene::new(1, vec![material], faces, Sides::Front).unwrap();
        Plan::new(&scene, &SolveOptions { gather: Gather::Hemisphere, expected_values, ..SolveOptions::default() })
    }

    #[test]
    fn the_more_values_there_will_be_the_more_is_spent_to_spare_rays() {
        let (few, many) = (plan(None), plan(Some(1_000_000)));
        assert!(many.point_rays() < few.point_rays(), "{} and {}", many.point_rays(), few.point_rays());
        assert!(many.resolution().side < few.resolution().side);
        assert_eq!(plan(Some(10)).point_rays(), few.point_rays());

        // What may be small enough is looked at more closely until it is known, before rays are added to a million points.
        let looks = |mut plan: Plan| (0..MAX_LOOKS).take_while(|_| plan.judge(&DOUBTFUL, || 0.0155) == Verdict::LookCloser).count();
        let (few, many) = (looks(few), looks(many));
        assert!(few < many, "{few} and {many}");
    }

    #[test]
    fn what_may_be_chance_is_looked_at_before_radiosities_are_resolved_anew() {
        // 2% are requested, and too much is found that is not noise of values: within two standard deviations of nothing, or beyond.
        let error = |looks| ErrorEstimate { measured: 0.025, claimed: 0.04, doubts: Doubts { looks, noise: 0.0 }, ..DOUBTFUL };
        assert_eq!(plan(None).judge(&error(4e-4), || 0.005), Verdict::LookCloser);
        assert_eq!(plan(None).judge(&error(1e-4), || 0.005), Verdict::Resolve);
    }
}
