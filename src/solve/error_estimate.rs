//! How wrong the values are: an estimate from light paths that are independent of the values.
//!
//! At random points x the values B~(x) that a user would get are set against two independent looks at the truth T, by rays to lamps and
//! paths over the hemisphere. Where values go over links, a look takes all of the light:
//!
//! ```text
//! T(x) = E + rho (direct + mean of what paths find),        r(x) = B~(x) - T(x)
//! ```
//!
//! Where values go over the hemisphere themselves, most of what a look finds is what they find. There a look takes the difference alone,
//! what values have too much for believing cells, along paths of its own that take one bounce more ([`ExcessGather`]); what values lose
//! to noise of their gathers is seen by taking them twice at half of the points:
//!
//! ```text
//! e^2 = mean of r_1 r_2 + (B~_1 - B~_2)^2 / 2
//! ```
//!
//! The product of two looks has the square of the mean error as its mean, free of the noise of either; over links B~_1 = B~_2. Each look
//! has resolved radiosities of its own, from other positions and other paths, and its paths take one bounce more than those of values,
//! so that neither noise nor the size of the cells is shared. Looks take more rays where they are noisier, as a pilot finds that no
//! estimate sees: else a few points would make up most of the scatter.
//!
//! The result is an estimate with a confidence limit from its own scatter over the points. What it does not see: an error on so
//! small an area that no point falls on it, what all points share (noise of the cells' own, most where much is reflected), and what light
//! paths as such have wrong: leaks of the rays, and the size of the cells in its effect two bounces away.

use rayon::prelude::*;

use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::reconstruct::{Effort, ExcessGather, HemisphereGather, PathScratch, Place, Reconstruction, Scratch, Way};
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Radiosity;

/// What the samples say, relative to `||B - E||`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorEstimate {
    /// The error itself: unbiased in its square, 0 where the square came out negative.
    pub measured: f64,
    /// An upper limit, see [`claim`].
    pub claimed: f64,
    /// Standard deviations of the measured square: by what looks found, and by the noise of values where these are taken twice.
    pub doubts: Doubts,
    /// The part of the variance of what looks found that is noise of their rays, and shrinks with more of them; the rest is that of the
    /// error itself.
    pub look_scatter: f64,
    /// The part of the error that is noise of the gather at points, where values were taken twice.
    pub gather_noise: Option<f64>,
}

/// Standard deviations of the parts of a measured square.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Doubts {
    pub looks: f64,
    pub noise: f64,
}

impl Doubts {
    pub fn both(&self) -> f64 {
        self.looks.hypot(self.noise)
    }
}

/// What may be claimed of a square that was measured with a standard deviation: [`CONFIDENCE_SIGMAS`] of them and a factor [`UNSEEN`] above.
pub(super) fn claim(error_sq: f64, deviation: f64) -> f64 {
    UNSEEN * (error_sq.max(0.0) + CONFIDENCE_SIGMAS * deviation).sqrt() + LEFT_BY_SWEEPS
}

/// The claim lies so many standard deviations above the measured square.
pub(super) const CONFIDENCE_SIGMAS: f64 = 2.0;

/// The claim allows this factor for what scatter does not tell: errors on little area are missed by most sets of points.
/// Empirical: of 118 claims on scenes with a known solution 2 fail with it, 6 without.
const UNSEEN: f64 = 1.1;

/// Values and looks share what the sweeps over resolved radiosities leave undone, relative to the reflected light.
const LEFT_BY_SWEEPS: f64 = 2e-5;

/// The one-sided probability that belongs to [`CONFIDENCE_SIGMAS`], for normal scatter.
pub(crate) const CONFIDENCE: f64 = 0.977;

/// Where cells tell where it is bright, so many times the points are drawn of which some are kept.
const CANDIDATES: usize = 16;
/// A spot is much brighter than its leaf if it is of so many times the interest; less may be noise of the cells.
const MUCH_BRIGHTER: f64 = 4.0;

/// Looks at a point take this part and so many times the rays of others, at most.
const LEAST_SHARE: f64 = 0.25;
const MOST_SHARE: f64 = 32.0;

/// Values over the hemisphere are taken twice in one of so many points.
pub(super) const TWICE: usize = 2;

/// The noise of values over links is looked at in one of so many points, if it matters.
const AGAIN: usize = 4;

/// Sums over points.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    sum: f64,
    sum_sq: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.sum_sq += value * value;
    }

    /// The standard deviation of the sum, by the scatter of what was added.
    fn deviation_of_sum(&self) -> f64 {
        let scatter = (self.sum_sq - self.sum * self.sum / self.count).max(0.0);
        (scatter / (self.count - 1.0).max(1.0) * self.count).sqrt()
    }
}

/// A point, and what was found there by two independent looks.
struct Look {
    place: Place,
    /// The area in m^2 that the point stands for if it is the only one.
    stands_for: f64,
    /// What each look found, as [`LookGather`] says, in W/m^2 by channel.
    found: [Vec<f64>; 2],
    /// Rays of each look so far.
    rays: u32,
    /// How much the noise of a single ray matters here: its mean square times the area, in W^2/m^2.
    noisiness: f64,
}

impl Look {
    /// By channel the reflected radiosity of each value, in W/m^2, and what is too much of it.
    fn compared<'a>(
        &'a self,
        reconstruction: &'a Reconstruction<'_>,
        values: &'a [Vec<f64>; 2],
    ) -> impl Iterator<Item = [(f64, f64); 2]> + 'a {
        let material = reconstruction.scene.material_of(self.place.surface);
        let finds_excess = is_taken_twice(reconstruction);
        (0..reconstruction.scene.channels()).map(move |channel| {
            [0, 1].map(|half: usize| {
                let value = values[half][channel] - material.exitance[channel];
                let found = material.reflectance[channel] * self.found[half][channel];
                (value, if finds_excess { found } else { value - found })
            })
        })
    }
}

/// What a look finds at a point, as irradiance.
pub(crate) enum LookGather<'a> {
    /// The true light, where values go over links.
    Truth(HemisphereGather<'a>),
    /// What values over the hemisphere have too much.
    Excess(ExcessGather<'a>),
}

impl LookGather<'_> {
    /// The mean square of what a single ray finds, reflected, in W^2/m^4, by rays that no look takes; 0 where it makes no difference.
    fn sampled_noisiness(&self, place: Place, count: u32, scene: &Scene, scratch: &mut PathScratch) -> f64 {
        let Self::Excess(gather) = self else { return 0.0 };
        let channels = scene.channels();
        let rays: Vec<Place> =
            (0..u64::from(count)).map(|ray| Place { seed: sampling::hash(place.seed, 1 << 40 | ray), ..place }).collect();
        let mut found = vec![0.0; rays.len() * channels];
        gather.sampled_excess(&rays, 1, scratch, &mut found);
        let reflectance = scene.material_of(place.surface).reflectance.iter().cycle();
        found.iter().zip(reflectance).map(|(found, rho)| (rho * found).powi(2)).sum::<f64>() / f64::from(count)
    }

    fn sample(&self, place: Place, rays: u32, scratch: &mut PathScratch, found: &mut [f64]) {
        match self {
            Self::Truth(gather) => gather.sampled_irradiance(&[place], rays, scratch, found),
            Self::Excess(gather) => gather.sampled_excess(&[place], rays, scratch, found),
        }
    }
}

/// Who gets more rays of looks than others.
///
/// The variance of a product of two looks goes with the square of `noisiness / rays`; for a given number of rays in all, that of their
/// sum is least with `rays` in proportion to the power 2/3 of noisiness.
struct RayShares {
    mean_power: f64,
}

impl RayShares {
    fn new(looks: &[Look]) -> Self {
        Self { mean_power: looks.iter().map(|look| look.noisiness.cbrt().powi(2)).sum::<f64>() / looks.len().max(1) as f64 }
    }

    /// So many times the mean number of rays.
    fn of(&self, look: &Look) -> f64 {
        let share = if self.mean_power > 0.0 { look.noisiness.cbrt().powi(2) / self.mean_power } else { 1.0 };
        share.clamp(LEAST_SHARE, MOST_SHARE)
    }
}

/// How noisy values and looks will be, relative to `||B - E||^2`.
pub(crate) struct Pilot {
    /// The noise of values of as many rays as were tried.
    pub noise_sq: f64,
    /// The standard deviation of what is measured by looks of one ray in the mean; with more it falls like their number.
    pub look_doubt: f64,
}

/// What looks are taken with.
pub(crate) struct Looking<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    /// Of the leaves: more points lie where it is bright.
    pub radiosity: &'a Radiosity,
    pub gathers: [LookGather<'a>; 2],
    pub seed: u64,
}

/// Samples of the error: looks at the truth are kept while values change, and more are added when it takes more to see the error.
#[derive(Default)]
pub(crate) struct ErrorSamples {
    looks: Vec<Look>,
    /// The radiosities that a user gets at the points of the first looks, by channel: twice, by other rays, over the hemisphere.
    values: Vec<[Vec<f64>; 2]>,
}

impl ErrorSamples {
    pub fn is_empty(&self) -> bool {
        self.looks.is_empty()
    }

    /// Forgets the values, because they have changed.
    pub fn forget_values(&mut self) {
        self.values.clear();
    }

    /// Spreads more points until there are `points`, and finds how noisy looks will be there. `false` if `cancelled` says so before it is
    /// done.
    pub fn spread(&mut self, points: usize, pilot_rays: u32, with: &Looking<'_>, cancelled: &(dyn Fn() -> bool + Sync)) -> bool {
        let (first, channels) = (self.looks.len(), with.scene.channels());
        let places = with.spread_places(points.saturating_sub(first), sampling::hash(with.seed, first as u64));
        let unseen = |Spread { place, stands_for, .. }| Look {
            place,
            stands_for,
            found: [0, 1].map(|_| vec![0.0; channels]),
            rays: 0,
            noisiness: 0.0,
        };
        self.looks.extend(places.into_iter().map(unseen));
        self.looks[first..].par_iter_mut().for_each_init(PathScratch::default, |scratch, look| {
            if !cancelled() {
                look.noisiness = look.stands_for * with.gathers[0].sampled_noisiness(look.place, pilot_rays, with.scene, scratch);
            }
        });
        !cancelled()
    }

    /// Tells before any look is taken how noisy values and looks will be, by values of few rays; `None` if `cancelled` says so, or in the
    /// dark.
    pub fn pilot(&self, reconstruction: &Reconstruction<'_>, cancelled: &(dyn Fn() -> bool + Sync)) -> Option<Pilot> {
        let looks = || self.looks.iter().step_by(TWICE);
        let places: Vec<Place> = looks().map(|look| look.place).collect();
        let effort = reconstruction.effort;
        let values = [effort, by_other_rays(effort)].map(|effort| values_at(&places, reconstruction, effort, cancelled));
        let [Some(values), Some(again)] = values else { return None };
        let (mut norm_sq, mut noise_sq) = (0.0, 0.0);
        for (look, (values, again)) in looks().zip(values.iter().zip(&again)) {
            let weight = look.stands_for / places.len() as f64;
            let exitance = &reconstruction.scene.material_of(look.place.surface).exitance;
            for ((value, again), exitance) in values.iter().zip(again).zip(exitance) {
                norm_sq += weight * (value - exitance) * (again - exitance);
                noise_sq += weight * 0.5 * (value - again).powi(2);
            }
        }
        let shares = RayShares::new(&self.looks);
        let variance_of = |look: &Look| look.noisiness / shares.of(look) / self.looks.len() as f64;
        let look_doubt = self.looks.iter().map(|look| variance_of(look).powi(2)).sum::<f64>().sqrt();
        (norm_sq > 0.0).then(|| Pilot { noise_sq: noise_sq / norm_sq, look_doubt: look_doubt / norm_sq })
    }

    /// Looks with more rays until each look has `rays` in the mean. `false` if `cancelled` says so before it is done.
    pub fn look(&mut self, rays: u32, with: &Looking<'_>, cancelled: &(dyn Fn() -> bool + Sync)) -> bool {
        let channels = with.scene.channels();
        let shares = RayShares::new(&self.looks);
        self.looks.par_iter_mut().for_each_init(
            || (PathScratch::default(), vec![0.0; channels]),
            |(scratch, found), look| {
                let more = ((f64::from(rays) * shares.of(look)).ceil() as u32).saturating_sub(look.rays);
                if more == 0 || cancelled() {
                    return;
                }
                let share = f64::from(more) / f64::from(look.rays + more);
                for ((half, known), gather) in look.found.iter_mut().enumerate().zip(&with.gathers) {
                    let seed = sampling::hash(look.place.seed, (u64::from(look.rays) << 8) | (10 + half as u64));
                    gather.sample(Place { seed, ..look.place }, more, scratch, found);
                    known.iter_mut().zip(found.iter()).for_each(|(known, found)| *known += share * (found - *known));
                }
                look.rays += more;
            },
        );
        !cancelled()
    }

    /// Estimates the error of the values that `reconstruction` gives: 0 if nothing reflects any light, infinite if nothing can be
    /// said; `None` if `cancelled` says so.
    pub fn estimate(
        &mut self,
        reconstruction: &Reconstruction<'_>,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Option<ErrorEstimate> {
        self.take_values(reconstruction, cancelled)?;

        // Products of the two looks, point by point, and what values differ by.
        let count = self.looks.len() as f64;
        let norm_sq = self.norm_sq(reconstruction);
        let (mut looks, mut noise, mut both) = (Moments::default(), Moments::default(), Moments::default());
        let mut look_variance = 0.0;
        for (look, values) in self.looks.iter().zip(&self.values) {
            let weight = look.stands_for / count;
            let (mut product, mut apart, mut value_apart) = (0.0, 0.0, 0.0);
            for [(value, excess), (again, excess_again)] in look.compared(reconstruction, values) {
                product += weight * excess * excess_again;
                apart += weight * 0.5 * (excess - excess_again).powi(2);
                value_apart += weight * TWICE as f64 * 0.5 * (value - again).powi(2);
            }
            looks.add(product);
            noise.add(value_apart);
            both.add(product + value_apart);
            // For normal noise the product of the looks has the variance s^4 + 2 s^2 e^2, whose mean this is.
            look_variance += apart * apart + 2.0 * product * apart;
        }
        let error_sq = both.sum;
        if error_sq == 0.0 && norm_sq == 0.0 {
            return Some(ErrorEstimate::default());
        }
        if error_sq.is_nan() || norm_sq.is_nan() || norm_sq <= 0.0 {
            return Some(ErrorEstimate { measured: f64::INFINITY, claimed: f64::INFINITY, ..ErrorEstimate::default() });
        }

        // The scatter of the points gives the confidence limit.
        let [of_looks, of_noise, of_both] = [looks, noise, both].map(|moments| moments.deviation_of_sum() / norm_sq);
        let variance_of_looks = looks.deviation_of_sum().powi(2);
        Some(ErrorEstimate {
            measured: (error_sq.max(0.0) / norm_sq).sqrt(),
            claimed: claim(error_sq / norm_sq, of_both),
            doubts: Doubts { looks: of_looks, noise: of_noise },
            look_scatter: if variance_of_looks > 0.0 { (look_variance / variance_of_looks).clamp(0.0, 1.0) } else { 0.0 },
            gather_noise: is_taken_twice(reconstruction).then(|| (noise.sum / norm_sq).sqrt()),
        })
    }

    /// The part of the error that is noise of the gather at points, and shrinks with more rays to each: values at some of the points
    /// are taken again by other rays. 0 if `cancelled` says so.
    pub fn sampled_gather_noise(&self, reconstruction: &Reconstruction<'_>, cancelled: &(dyn Fn() -> bool + Sync)) -> f64 {
        let looks = || self.looks.iter().step_by(AGAIN);
        let places: Vec<Place> = looks().map(|look| look.place).collect();
        let Some(again) = values_at(&places, reconstruction, by_other_rays(reconstruction.effort), cancelled) else { return 0.0 };
        let sample = |(look, ([value, _], again)): (&Look, (&[Vec<f64>; 2], &Vec<f64>))| {
            let difference_sq: f64 = value.iter().zip(again).map(|(value, again)| (value - again).powi(2)).sum();
            look.stands_for / places.len() as f64 * 0.5 * difference_sq
        };
        let noise_sq: f64 = looks().zip(self.values.iter().step_by(AGAIN).zip(&again)).map(sample).sum();
        (noise_sq / self.norm_sq(reconstruction)).sqrt()
    }

    /// `||B - E||^2`, in W^2/m^2: looks are independent, so their product has no noise in its mean.
    fn norm_sq(&self, reconstruction: &Reconstruction<'_>) -> f64 {
        let of_look = |(look, values): (&Look, &[Vec<f64>; 2])| {
            let product = |[(value, excess), (again, excess_again)]: [(f64, f64); 2]| (value - excess) * (again - excess_again);
            look.stands_for / self.looks.len() as f64 * look.compared(reconstruction, values).map(product).sum::<f64>()
        };
        self.looks.iter().zip(&self.values).map(of_look).sum()
    }

    /// Takes the values that are not known yet.
    fn take_values(&mut self, reconstruction: &Reconstruction<'_>, cancelled: &(dyn Fn() -> bool + Sync)) -> Option<()> {
        let first = self.values.len();
        let places: Vec<Place> = self.looks[first..].iter().map(|look| look.place).collect();
        let effort = reconstruction.effort;
        let taken = values_at(&places, reconstruction, effort, cancelled)?;
        self.values.extend(taken.into_iter().map(|value| [value.clone(), value]));
        if is_taken_twice(reconstruction) {
            let indices: Vec<usize> = (first..self.looks.len()).filter(|index| index % TWICE == 0).collect();
            let places: Vec<Place> = indices.iter().map(|&index| self.looks[index].place).collect();
            let again = values_at(&places, reconstruction, by_other_rays(effort), cancelled)?;
            indices.into_iter().zip(again).for_each(|(index, again)| self.values[index][1] = again);
        }
        Some(())
    }
}

/// Whether values are taken twice at every point.
fn is_taken_twice(reconstruction: &Reconstruction<'_>) -> bool {
    matches!(reconstruction.way, Way::Hemisphere(_))
}

/// The same effort with other random numbers.
fn by_other_rays(effort: Effort) -> Effort {
    Effort { seed: sampling::hash(effort.seed, 1), ..effort }
}

/// The radiosities at `places`, by channel, that `reconstruction` gives with `effort`; `None` if `cancelled` says so.
fn values_at(
    places: &[Place],
    reconstruction: &Reconstruction<'_>,
    effort: Effort,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Vec<f64>>> {
    let value = |scratch: &mut Scratch, place: &Place| {
        let mut value = vec![0.0; reconstruction.scene.channels()];
        reconstruction.radiosities_at([(place.point, place.surface)].into_iter(), effort, scratch, &mut value);
        (!cancelled()).then_some(value)
    };
    places.par_iter().map_init(Scratch::default, value).collect()
}

impl Looking<'_> {
    /// Points on leaves that reflect; neighbours in the tree come one after the other.
    ///
    /// Where it is bright much of the error may be on little area, and must be seen: leaves are drawn by their [`interest`]. Where values
    /// take cells, these may know of spots that are much brighter than their leaf: more points are drawn first than are needed, and few of
    /// them kept, more of those in such spots.
    fn spread_places(&self, count: usize, seed: u64) -> Vec<Spread> {
        let LookGather::Excess(gather) = &self.gathers[0] else { return self.spread_over_leaves(count, seed) };
        let candidates = self.spread_over_leaves(CANDIDATES * count, seed);
        let mean = self.radiosity.reflected_rms(self.scene, self.hierarchy);
        let brighter = |of: &Spread| interest(gather.estimate_reflected(&of.place), mean) / of.interest;
        let chances: Vec<f64> = candidates.iter().map(|of| (brighter(of) / MUCH_BRIGHTER).max(1.0)).collect();
        let all: f64 = chances.iter().sum();

        let drawn = candidates.len() as f64;
        let mut picks = Picks { count, seed, total: all, ..Picks::default() };
        let mut places = Vec::with_capacity(count);
        for (of, chance) in candidates.into_iter().zip(chances) {
            picks.step(chance, |draw| {
                let stands_for = of.stands_for * all / drawn / chance;
                places.push(Spread { place: Place { seed: draw, ..of.place }, stands_for, ..of });
            });
        }
        places
    }

    /// Points drawn by the radiosities of leaves, one in each of `count` strata.
    fn spread_over_leaves(&self, count: usize, seed: u64) -> Vec<Spread> {
        let Self { scene, hierarchy, radiosity, .. } = *self;
        let surface_of = |leaf: NodeId| SurfaceId(hierarchy.node(leaf).surface);
        let mean = radiosity.reflected_rms(scene, hierarchy);
        let interest = |leaf: NodeId| {
            let exitance = &scene.material_of(surface_of(leaf)).exitance;
            interest(radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e).fold(0.0, f64::max), mean)
        };
        let reflects = |leaf: NodeId| scene.material_of(surface_of(leaf)).reflectance.iter().any(|&rho| rho > 0.0);
        let leaves: Vec<NodeId> = hierarchy.leaves_in_order().into_iter().filter(|&leaf| reflects(leaf)).collect();
        let total: f64 = leaves.iter().map(|&leaf| hierarchy.area(leaf) * interest(leaf)).sum();

        let mut picks = Picks { count, seed, total, ..Picks::default() };
        let mut places = Vec::with_capacity(count);
        for leaf in leaves {
            let interest = interest(leaf);
            picks.step(hierarchy.area(leaf) * interest, |draw| {
                let (u, v) = (sampling::unit(sampling::hash(draw, 1)), sampling::unit(sampling::hash(draw, 2)));
                let place = Place { point: hierarchy.facet(leaf).point_at(u, v), surface: surface_of(leaf), seed: draw };
                places.push(Spread { place, stands_for: total / interest, interest });
            });
        }
        places
    }
}

/// A point that was drawn.
#[derive(Clone, Copy)]
struct Spread {
    place: Place,
    /// The area in m^2 that it would stand for alone.
    stands_for: f64,
    /// Of the leaf where it lies.
    interest: f64,
}

/// Picks from a sequence by weight, once in each of `count` strata of their sum.
#[derive(Default)]
struct Picks {
    count: usize,
    seed: u64,
    /// Of all weights.
    total: f64,
    above: f64,
    picked: u64,
}

impl Picks {
    /// Goes on to what has `weight`, and tells how often it is picked, each time with a random number.
    fn step(&mut self, weight: f64, mut pick: impl FnMut(u64)) {
        self.above += weight;
        while (self.picked as usize) < self.count {
            let draw = sampling::hash(self.seed, self.picked);
            if (self.picked as f64 + sampling::unit(draw)) / self.count as f64 * self.total >= self.above {
                break;
            }
            self.picked += 1;
            pick(draw);
        }
    }
}

/// How densely points lie where so much is reflected, in W/m^2: in proportion to the square of the error if that is a part of what is
/// reflected, but nowhere less than `mean`.
fn interest(reflected: f64, mean: f64) -> f64 {
    if mean > 0.0 { mean + reflected * reflected / mean } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::reconstruct::{LightPaths, Resolution, Resolved};
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::sweep::Exposure;
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// However unevenly points lie, they stand for all of the area that reflects; and they crowd in a spot that only cells know to be bright.
    #[test]
    fn points_stand_for_all_area_and_crowd_where_cells_are_bright() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let hierarchy = Hierarchy::new(&scene);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &rays, 0);

        // Leaves are all as dim as each other; cells know the light.
        let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let surfaces = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let reflects = |surface: &SurfaceId| scene.material_of(*surface).reflectance.iter().any(|&rho| rho > 0.0);
        for surface in surfaces() {
            let exitance = &scene.material_of(surface).exitance;
            radiosity.of_mut(hierarchy.node_of(surface)).iter_mut().zip(exitance).for_each(|(b, exitance)| *b = exitance + 0.02);
        }
        let resolution = Resolution::of_positions(&scene, 2000, 16);
        let paths = LightPaths::new(&scene, &rays, &hierarchy, &radiosity, resolution.side);
        let resolved = [1, 2].map(|seed| Resolved::solve(&paths, &resolution, seed));
        let gathers =
            [0, 1].map(|_| LookGather::Excess(ExcessGather { paths: &paths, believed: &resolved[0], onward: &resolved[1] }));
        let with = Looking { scene: &scene, hierarchy: &hierarchy, radiosity: &radiosity, gathers, seed: 7 };

        let area: f64 = surfaces().filter(reflects).map(|surface| scene.surface(surface).polygon.area()).sum();
        let (count, seeds) = (4096, 16);
        let mean_over = |spreads: &[Vec<Spread>], of: &dyn Fn(&Spread) -> f64| {
            spreads.iter().flatten().map(of).sum::<f64>() / (count * seeds as usize) as f64
        };
        let by_leaves: Vec<_> = (0..seeds).map(|seed| with.spread_over_leaves(count, seed)).collect();
        let by_cells: Vec<_> = (0..seeds).map(|seed| with.spread_places(count, seed)).collect();
        // By cells it scatters by 3% from seed to seed.
        for (spreads, tolerance) in [(&by_leaves, 1e-12), (&by_cells, 0.02)] {
            let found = mean_over(spreads, &|of| of.stands_for);
            assert!((found / area - 1.0).abs() < tolerance, "{found} for {area}");
        }
        let LookGather::Excess(gather) = &with.gathers[0] else { unreachable!() };
        let [dim, bright] = [&by_leaves, &by_cells].map(|spreads| mean_over(spreads, &|of| gather.estimate_reflected(&of.place)));
        assert!(bright > 1.5 * dim, "{bright} and {dim}");
    }

    #[test]
    fn noisy_points_take_more_rays_within_limits() {
        let look = |noisiness: f64| Look {
            place: Place { point: glam::DVec3::ZERO, surface: SurfaceId(0), seed: 0 },
            stands_for: 1.0,
            found: [vec![], vec![]],
            rays: 0,
            noisiness,
        };
        let looks: Vec<Look> = [1.0, 8.0, 0.0, 1e9].map(look).into();
        let shares = RayShares::new(&looks[..2]);
        assert!((shares.of(&looks[1]) / shares.of(&looks[0]) - 4.0).abs() < 1e-12);
        assert!((shares.of(&looks[0]) + shares.of(&looks[1]) - 2.0).abs() < 1e-12);
        assert_eq!((shares.of(&looks[2]), shares.of(&looks[3])), (LEAST_SHARE, MOST_SHARE));
        assert_eq!(RayShares::new(&looks[2..3]).of(&looks[2]), 1.0);
    }
}
