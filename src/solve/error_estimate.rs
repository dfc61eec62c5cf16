//! How wrong the values are: an estimate from light paths that are independent of the links.
//!
//! At random points x the value B~(x) that a user would get is set against two independent looks at the truth, each a one-bounce gather by
//! rays to lamps and over the hemisphere:
//!
//! ```text
//! T(x) = E + rho (direct + mean of B_leaf + d_leaf at the hits),        r(x) = B~(x) - T(x)
//! ```
//!
//! The product of the two, r_1 r_2, has the square of the error as its mean, free of the noise of either. The correction d is what the leaf
//! values themselves have wrong: their residual, sampled by rays on every leaf, carried on through the links by sweeps, which sum the
//! Neumann series of `(I - rho K)^-1`, and once more of what remains. Each look has a correction from samples of its own. Leaves are split further for it, so that
//! light which varies over a leaf is seen too.
//!
//! The result is an estimate with a confidence limit from its own scatter over the points. What it does not see: an error on so small an
//! area that no point falls on it, and variation over less than a piece of a leaf, in its effect on other leaves.

use rayon::prelude::*;

use super::light_paths::{LightPaths, Place};
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::reconstruct::{GatherScratch, PointGather};
use crate::scene::SurfaceId;
use crate::sweep::{self, Closure, Emission, Exposure, Radiosity};

/// How much effort an estimate takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorEffort {
    /// Points at which the error is sampled.
    pub points: usize,
    /// Rays over the hemisphere in each half, at each point.
    pub hemisphere_rays: u32,
    /// Rays to lamps in each half, at each point.
    pub lamp_rays: u32,
    /// Samples of the residual that all leaves share, in each half.
    pub residual_samples: usize,
}

/// What the samples say, relative to `||B - E||`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorEstimate {
    /// The error itself: unbiased in its square, 0 where the square came out negative.
    pub measured: f64,
    /// An upper limit, [`CONFIDENCE_SIGMAS`] standard deviations and a factor [`UNSEEN`] above.
    pub claimed: f64,
    /// The part that is noise of the gather at points: it shrinks with more rays a point.
    pub gather_noise: f64,
}

/// The claim lies so many standard deviations above the measured square.
const CONFIDENCE_SIGMAS: f64 = 2.0;

/// The claim allows this factor for what the samples do not see: the values at the ends of the looks are constant over a piece of a leaf.
/// Empirical: on the Cornell box, where the truth is known, the samples found 5 to 15% less than it.
const UNSEEN: f64 = 1.1;

/// The one-sided probability that belongs to [`CONFIDENCE_SIGMAS`], for normal scatter.
pub(crate) const CONFIDENCE: f64 = 0.977;

/// The noise of the values is looked at in one of so many points.
const AGAIN: usize = 4;

/// Leaves are split for the correction if there are at most so many: once, twice, three times.
const MAX_SPLIT_LEAVES: [usize; 3] = [1 << 10, 1 << 10, 1 << 9];

/// Samples of the residual of one leaf, at least and at most.
const RESIDUAL_SAMPLES_PER_LEAF: std::ops::RangeInclusive<usize> = 1..=1024;

/// Samples of the residual whose rays are cast together.
const RESIDUAL_BATCH: usize = 512;

/// Links are too coarse for what a residual does close by; a second residual, of the corrected leaves, takes that in.
const CORRECTION_PASSES: u64 = 2;

/// The correction is swept until all changes still to come are less than this part of it, and at most so often.
const CORRECTION_TOLERANCE: f64 = 0.02;
const MAX_CORRECTION_SWEEPS: u32 = 2000;

/// What is known at one point.
struct Sample {
    place: Place,
    /// The area in m^2 that the point stands for.
    weight: f64,
    /// The value that a user gets.
    value: Vec<f64>,
    /// At some points another one by other rays, which shows the noise of both.
    again: Option<Vec<f64>>,
    /// Two looks at the irradiance.
    looks: [Vec<f64>; 2],
}

/// Samples the error of the values that a gather gives.
pub(crate) struct ErrorSampler<'a> {
    gather: PointGather<'a>,
    paths: LightPaths<'a>,
    /// The hierarchy with its leaves split further.
    hierarchy: Hierarchy,
    /// Corrected radiosities, one for each look.
    corrected: [Radiosity; 2],
    effort: ErrorEffort,
    seed: u64,
}

impl<'a> ErrorSampler<'a> {
    pub fn new(gather: PointGather<'a>, exposure: &Exposure, closure: Option<&Closure>, effort: ErrorEffort, seed: u64) -> Self {
        // Split the leaves; what is new takes after its parent.
        let (mut hierarchy, mut exposure, mut radiosity) = (gather.hierarchy.clone(), exposure.clone(), gather.radiosity.clone());
        for most in MAX_SPLIT_LEAVES {
            let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
            if leaves.len() <= most {
                for leaf in leaves {
                    hierarchy.split(leaf);
                }
            }
        }
        exposure.inherit(&hierarchy);
        let mut closure = closure.cloned();
        closure.iter_mut().for_each(|closure| closure.inherit(&hierarchy));
        radiosity.grow(&hierarchy);

        let paths = LightPaths::new(gather.scene, gather.rays);
        let corrected = [0, 1].map(|half| {
            let mut corrected = radiosity.clone();
            for pass in 0..CORRECTION_PASSES {
                let seed = sampling::hash(seed, 2 * pass + half);
                let residual = sampled_residual(&gather, &paths, &hierarchy, &exposure, &corrected, effort.residual_samples, seed);
                corrected.add(&correction(&gather, &hierarchy, &exposure, closure.as_ref(), &residual));
            }
            corrected
        });
        Self { gather, paths, hierarchy, corrected, effort, seed }
    }

    /// Estimates the error of the values that the gather gives: 0 if nothing reflects any light, infinite if nothing can be said.
    pub fn estimate(&self) -> ErrorEstimate {
        let (effort, seed) = (self.effort, self.seed);
        let channels = self.gather.scene.channels();
        let samples: Vec<Sample> = self
            .spread_places(effort.points, seed)
            .into_par_iter()
            .enumerate()
            .map_init(GatherScratch::default, |scratch, (index, (place, weight))| {
                let seed = sampling::hash(seed, index as u64);
                let mut value = vec![0.0; channels];
                self.gather.radiosity_at(place.point, place.surface, scratch, &mut value);
                let again = (index % AGAIN == 0).then(|| {
                    let mut value = vec![0.0; channels];
                    let gather = PointGather { seed: sampling::hash(self.gather.seed, 1), ..self.gather };
                    gather.radiosity_at(place.point, place.surface, scratch, &mut value);
                    value
                });
                let looks = [0, 1].map(|half| {
                    let leaves = (&self.hierarchy, &self.corrected[half]);
                    let rays = (effort.lamp_rays, effort.hemisphere_rays);
                    let place = Place { seed: sampling::hash(seed, half as u64), ..place };
                    self.paths.sampled_irradiance(&[place], leaves, rays).0
                });
                Sample { place, weight, value, again, looks }
            })
            .collect();

        // Products of the two looks, point by point.
        let (mut error_sq, mut noise_sq, mut norm_sq) = (0.0, 0.0, 0.0);
        let mut by_point = Vec::with_capacity(samples.len());
        for Sample { place, weight, value, again, looks } in &samples {
            let material = self.gather.scene.material_of(place.surface);
            let mut product = 0.0;
            for channel in 0..channels {
                let (exitance, rho) = (material.exitance[channel], material.reflectance[channel]);
                let reflected = [0, 1].map(|half: usize| rho * looks[half][channel]);
                let found = value[channel] - exitance;
                product += weight * (found - reflected[0]) * (found - reflected[1]);
                norm_sq += weight * reflected[0] * reflected[1];
                if let Some(again) = again {
                    noise_sq += AGAIN as f64 * weight * 0.5 * (value[channel] - again[channel]).powi(2);
                }
            }
            error_sq += product;
            by_point.push(product);
        }
        if error_sq == 0.0 && norm_sq == 0.0 {
            return ErrorEstimate::default();
        }
        if norm_sq.is_nan() || norm_sq <= 0.0 {
            return ErrorEstimate { measured: f64::INFINITY, claimed: f64::INFINITY, gather_noise: 0.0 };
        }

        // The scatter of the points gives the confidence limit.
        let count = by_point.len() as f64;
        let mean = error_sq / count;
        let variance = by_point.iter().map(|product| (product - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        let deviation = (variance * count).sqrt();
        let relative = |square: f64| (square.max(0.0) / norm_sq).sqrt();
        ErrorEstimate {
            measured: relative(error_sq),
            claimed: UNSEEN * relative(error_sq.max(0.0) + CONFIDENCE_SIGMAS * deviation),
            gather_noise: relative(noise_sq),
        }
    }

    /// Points on leaves that reflect, with the area that each stands for; neighbours in the tree come one after the other.
    ///
    /// One point in each of `count` strata. A leaf is drawn by its area times the sum of its own and the mean reflected radiosity: where
    /// it is bright much of the error may be on little area, and must be seen.
    fn spread_places(&self, count: usize, seed: u64) -> Vec<(Place, f64)> {
        let PointGather { scene, hierarchy, radiosity, .. } = self.gather;
        let surface_of = |leaf: NodeId| SurfaceId(hierarchy.node(leaf).surface);
        let mean = radiosity.reflected_rms(scene, hierarchy);
        let brightness = |leaf: NodeId| {
            let exitance = &scene.material_of(surface_of(leaf)).exitance;
            let reflected = radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e).fold(0.0, f64::max);
            if mean > 0.0 { mean + reflected } else { 1.0 }
        };
        let reflects = |leaf: NodeId| scene.material_of(surface_of(leaf)).reflectance.iter().any(|&rho| rho > 0.0);
        let leaves: Vec<NodeId> = hierarchy.leaves_in_order().into_iter().filter(|&leaf| reflects(leaf)).collect();
        let total: f64 = leaves.iter().map(|&leaf| hierarchy.area(leaf) * brightness(leaf)).sum();

        let mut places = Vec::with_capacity(count);
        let mut above = 0.0;
        for leaf in leaves {
            let brightness = brightness(leaf);
            above += hierarchy.area(leaf) * brightness;
            while places.len() < count {
                let draw = sampling::hash(seed, places.len() as u64);
                if (places.len() as f64 + sampling::unit(draw)) / count as f64 * total >= above {
                    break;
                }
                let (u, v) = (sampling::unit(sampling::hash(draw, 1)), sampling::unit(sampling::hash(draw, 2)));
                let place = Place { point: hierarchy.facet(leaf).point_at(u, v), surface: surface_of(leaf), seed: draw };
                places.push((place, total / (brightness * count as f64)));
            }
        }
        places
    }
}

/// What a residual of the leaves amounts to once light has carried it on: `(I - rho K)^-1` of it, by sweeps over the links.
fn correction(
    gather: &PointGather<'_>,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    closure: Option<&Closure>,
    residual: &[f64],
) -> Radiosity {
    let mut correction = Radiosity::dark(gather.scene, hierarchy);
    let mut previous = f64::INFINITY;
    for _ in 0..MAX_CORRECTION_SWEEPS {
        let irradiance = sweep::gather(hierarchy, gather.links, exposure, &correction);
        let emission = Emission::Residual(residual);
        let change = sweep::push_pull(gather.scene, hierarchy, exposure, emission, closure, irradiance, &mut correction);
        let to_come = change.estimate_to_come(previous);
        previous = change.largest;
        if to_come <= CORRECTION_TOLERANCE * change.brightest {
            break;
        }
    }
    correction
}

/// The residual `E + rho K B - B` of every leaf, by channel, from a few samples each: one lamp ray and one ray over the hemisphere.
fn sampled_residual(
    gather: &PointGather<'_>,
    paths: &LightPaths<'_>,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    radiosity: &Radiosity,
    samples: usize,
    seed: u64,
) -> Vec<f64> {
    let (scene, channels) = (gather.scene, gather.scene.channels());
    let leaves = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).count();
    let (least, most) = RESIDUAL_SAMPLES_PER_LEAF.into_inner();
    let count = (samples / leaves.max(1)).clamp(least, most);
    let mut residual = vec![0.0; channels * hierarchy.len()];
    let per_batch = (RESIDUAL_BATCH / count).max(1);
    residual.par_chunks_mut(channels * per_batch).enumerate().for_each(|(batch, residual)| {
        // Lay the samples of a batch of nodes, of those that are leaves and reflect.
        let first = batch * per_batch;
        let samples_of = |node: usize| {
            let leaf = NodeId(node as u32);
            let surface = hierarchy.surface_of(leaf).filter(|&surface| {
                let reflects = scene.material_of(surface).reflectance.iter().any(|&rho| rho > 0.0);
                hierarchy.is_leaf(leaf) && exposure.of(leaf) > 0.0 && reflects
            });
            let seed = sampling::hash(seed, node as u64);
            surface.into_iter().flat_map(move |surface| {
                (0..count).map(move |sample| {
                    let [u, v, ..] = sampling::sobol_4d(sample as u32, seed);
                    let point = hierarchy.facet(leaf).point_at(u, v);
                    (node, Place { point, surface, seed: sampling::hash(seed, sample as u64) })
                })
            })
        };
        let (nodes, places): (Vec<usize>, Vec<Place>) = (first..first + residual.len() / channels).flat_map(samples_of).unzip();
        let (irradiance, backs) = paths.sampled_irradiance(&places, (hierarchy, radiosity), (1, 1));

        // The mean over the exposed samples of each leaf.
        for (nodes, (irradiance, backs)) in nodes.chunks(count).zip(irradiance.chunks(count * channels).zip(backs.chunks(count))) {
            let leaf = NodeId(nodes[0] as u32);
            let exposed = backs.iter().filter(|&&backs| backs == 0.0).count() as f64;
            let material = hierarchy.surface_of(leaf).map(|surface| scene.material_of(surface));
            let Some(material) = material.filter(|_| exposed > 0.0) else { continue };
            for (channel, residual) in residual[(nodes[0] - first) * channels..][..channels].iter_mut().enumerate() {
                let of_exposed = irradiance.chunks(channels).zip(backs).filter(|(_, backs)| **backs == 0.0);
                let sum: f64 = of_exposed.map(|(irradiance, _)| irradiance[channel]).sum();
                let reflected = material.reflectance[channel] * sum / exposed;
                *residual = material.exitance[channel] + reflected - radiosity.of(leaf)[channel];
            }
        }
    });
    residual
}
