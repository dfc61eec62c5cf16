//! Reflected light at places in two parts: what emitters and bright reflectors send, which may vary sharply, and all other, which is smooth and dear.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::error_bars::ErrorBars;
use super::gather::{Gather, Gathered, Part, Scratch};
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage, Stop};

/// Reflected radiosities at places, and their standard errors, by place and channel in W/m^2; not numbers where they are not known.
pub(crate) struct Reflected {
    pub radiosity: Vec<f32>,
    pub standard_error: Vec<f32>,
    /// What of the radiosities emitters sent straight.
    pub straight: Vec<f32>,
}

/// Progress is reported, and stopping asked for, once in so many rays, but after so many places at most.
const RAYS: usize = 1 << 14;
const BATCH: usize = 256;

/// A part of the reflected light at places, each by itself. Once it is stopped, no more are gathered.
pub(crate) fn reflected_at(
    gather: &Gather<'_>,
    error_bars: Option<ErrorBars>,
    places: &[Place],
    part: Part,
    (observer, stop): (&dyn Observer, Stop<'_>),
) -> Reflected {
    let channels = gather.scene.channels();
    let together = (RAYS / gather.budget.rays.max(1) as usize).clamp(1, BATCH);
    let mut numbers = vec![[f32::NAN; 3]; channels * places.len()];
    let (done, total, share) = (AtomicUsize::new(0), places.len(), gather.share());
    numbers.par_chunks_mut(channels * together).zip(places.par_chunks(together)).enumerate().for_each_init(
        || (Scratch::default(), Gathered::default()),
        |(scratch, gathered), (batch, (numbers, places))| {
            if stop() || !share.has(batch) {
                return;
            }
            gather.reflected_at(places, part, scratch, gathered);
            for (value, number) in numbers.iter_mut().enumerate() {
                let error = error_bars.map_or(f64::NAN, |error_bars| error_bars.standard_error(gathered, value));
                *number = [gathered.radiosity[value], error, gathered.straight[value]].map(|number| number as f32);
            }

            let done = done.fetch_add(places.len(), Ordering::Relaxed) + places.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    share.exchange_chunks(&mut numbers, channels * together);
    let of = |kind: usize| numbers.iter().map(|numbers| numbers[kind]).collect();
    Reflected { radiosity: of(0), standard_error: of(1), straight: of(2) }
}
