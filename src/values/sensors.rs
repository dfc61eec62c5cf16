//! Sensors: irradiance anywhere in space, at a point with a normal.
//!
//! ```text
//! H(x, n) = direct light + what rays over the hemisphere around n bring
//! ```
//!
//! A sensor gathers as a point on a surface does, but nothing lies below it: there is no plane that hides nothing from it, no link above it, and
//! nothing is reflected. On a surface that faces as it does it takes that surface's plane, so that it measures what arrives there.
//!
//! # Error bars
//! A sensor's gather is done [`REPLICATES`] times, with rays of their own. The mean is the value, and how they scatter tells its noise,
//! wherever the sensor is:
//!
//! ```text
//! se^2 = sum over replicates of (H_k - H)^2 / (R (R - 1)) + bias^2 * (sum over sources of b^2)
//! ```
//!
//! with what links or cells are off by as for values on surfaces ([`ErrorBars`]).

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::budget::{NOISE_POWER, RayBudget};
use super::error_bars::ErrorBars;
use super::final_gather::FinalGather;
use super::gather::{Gather, Over, Scratch};
use super::over_links::LinkGather;
use super::sample::tolerance;
use crate::direct::Receiver;
use crate::geometry::{sampling, streams};
use crate::paths::BatchSums;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfacePoint;
use crate::visibility::NO_PLANE;

/// Independent gathers of a sensor: eight tell a standard error to a quarter, `1 / sqrt(2 (R - 1))`.
const REPLICATES: usize = 8;

/// Sensors that are measured together; progress is reported, and cancelling asked for, once in so many.
const BATCH: usize = 32;

/// What sensors measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Irradiances {
    /// Channels of each.
    pub channels: usize,
    /// `channels` irradiances for each sensor in W/m^2, sensor after sensor; NaN at those that were not measured.
    pub irradiance: Vec<f32>,
    /// The standard error of each, in W/m^2: noise, and what is known of bias. NaN in solutions whose error was not estimated.
    pub standard_error: Vec<f32>,
}

impl Irradiances {
    /// How many sensors were not measured.
    pub fn missing(&self) -> usize {
        self.irradiance.chunks(self.channels.max(1)).filter(|of_sensor| of_sensor[0].is_nan()).count()
    }

    /// Bytes that so many take, with all that is needed to take them.
    pub fn bytes_of(sensors: usize, channels: usize) -> u64 {
        (sensors * (size_of::<Receiver>() + 2 * channels * size_of::<[f32; 2]>())) as u64
    }
}

/// The irradiance at `sensors`, in their order. An irradiance does not depend on the other sensors. Once the observer cancels, no more are measured.
pub(crate) fn irradiances_at(
    gather: &Gather<'_>,
    error_bars: Option<ErrorBars>,
    sensors: &[SurfacePoint],
    observer: &dyn Observer,
) -> Irradiances {
    let channels = gather.scene.channels();
    let mut numbers = vec![[f32::NAN; 2]; channels * sensors.len()];
    let (done, total, share) = (AtomicUsize::new(0), sensors.len(), gather.share());
    numbers.par_chunks_mut(channels * BATCH).zip(sensors.par_chunks(BATCH)).enumerate().for_each_init(
        Scratch::default,
        |scratch, (batch, (numbers, sensors))| {
            if observer.cancelled() || !share.has(batch) {
                return;
            }
            measure(gather, error_bars, sensors, scratch, numbers);

            let done = done.fetch_add(sensors.len(), Ordering::Relaxed) + sensors.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    share.exchange_chunks(&mut numbers, channels * BATCH);
    let (irradiance, standard_error) = numbers.into_iter().map(|[irradiance, error]| (irradiance, error)).unzip();
    Irradiances { channels, irradiance, standard_error }
}

/// Fills in the irradiance of some sensors and its standard error, by sensor and channel.
fn measure(
    gather: &Gather<'_>,
    error_bars: Option<ErrorBars>,
    sensors: &[SurfacePoint],
    scratch: &mut Scratch,
    numbers: &mut [[f32; 2]],
) {
    // R gathers of n rays have together the noise of one of N if n = N R^(-1/p): noise falls with the power p of the rays.
    let rays = f64::from(gather.budget.rays) * (REPLICATES as f64).powf(-1.0 / NOISE_POWER);
    let budget = RayBudget { rays: (rays.ceil() as u32).max(1), ..gather.budget };
    let receivers: Vec<Receiver> = sensors.iter().flat_map(|sensor| replicates(gather, sensor)).collect();
    let channels = gather.scene.channels();
    let (mut irradiance, mut by_sources_sq) = (vec![0.0; receivers.len() * channels], vec![0.0; receivers.len() * channels]);
    match &gather.over {
        Over::Links(links) => over_links(links, &receivers, budget, scratch, &mut irradiance, &mut by_sources_sq),
        Over::Cells(cells) => over_cells(cells, &receivers, budget, scratch, &mut irradiance, &mut by_sources_sq),
    }

    let of_sensor = REPLICATES * channels;
    let found = irradiance.chunks(of_sensor).zip(by_sources_sq.chunks(of_sensor)).zip(numbers.chunks_mut(channels));
    for ((irradiance, by_sources_sq), numbers) in found {
        for (channel, number) in numbers.iter_mut().enumerate() {
            let of_channel = |all: &[f64]| all.iter().skip(channel).step_by(channels).copied().collect::<Vec<f64>>();
            let (of_replicates, count) = (of_channel(irradiance), REPLICATES as f64);
            let mean = of_replicates.iter().sum::<f64>() / count;
            let scatter: f64 = of_replicates.iter().map(|h| (h - mean).powi(2)).sum();
            let by_sources_sq = of_channel(by_sources_sq).iter().sum::<f64>() / count;
            let bias = error_bars.map_or(f64::NAN, |error_bars| error_bars.bias);
            let variance = scatter / (count * (count - 1.0)) + bias.powi(2) * by_sources_sq;
            *number = [mean as f32, variance.sqrt() as f32];
        }
    }
}

/// A sensor as so many receivers, each with random numbers of its own.
fn replicates(gather: &Gather<'_>, sensor: &SurfacePoint) -> impl Iterator<Item = Receiver> + use<> {
    let (point, normal) = (DVec3::from(sensor.position), DVec3::from(sensor.normal));
    let below = gather.hierarchy.surface_at(point, normal, tolerance(gather.scene));
    let plane = below.map_or(NO_PLANE, |surface| gather.scene.surface(surface).plane());
    let seed = gather.budget.seed;
    (0..REPLICATES as u64).map(move |replicate| {
        let seed = sampling::seed_at(point, sampling::hash(seed, streams::SENSORS + replicate));
        Receiver { point, normal, plane, seed }
    })
}

/// The irradiance at each receiver over links, by receiver and channel, and the sum of the squares of what each source brings.
fn over_links(
    gather: &LinkGather<'_>,
    receivers: &[Receiver],
    budget: RayBudget,
    scratch: &mut Scratch,
    irradiance: &mut [f64],
    by_sources_sq: &mut [f64],
) {
    let channels = irradiance.len() / receivers.len().max(1);
    let found = irradiance.chunks_mut(channels).zip(by_sources_sq.chunks_mut(channels));
    for (receiver, (irradiance, by_sources_sq)) in receivers.iter().zip(found) {
        gather.irradiance_in_space(receiver, budget, &mut scratch.links, irradiance);
        by_sources_sq.copy_from_slice(&scratch.links.by_sources_sq);
    }
}

/// The same over cells.
fn over_cells(
    gather: &FinalGather<'_>,
    receivers: &[Receiver],
    budget: RayBudget,
    scratch: &mut Scratch,
    irradiance: &mut [f64],
    by_sources_sq: &mut [f64],
) {
    let channels = irradiance.len() / receivers.len().max(1);
    let mut sums = BatchSums::new(channels, 1, irradiance, by_sources_sq);
    gather.add_sampled_indirect(receivers, budget.rays, &mut scratch.paths, &mut sums);
    gather.add_sampled_direct(receivers, budget.rays, &mut scratch.paths, &mut sums);
    // Noise may take the light below zero where all is dark.
    irradiance.iter_mut().for_each(|h| *h = h.max(0.0));
}
