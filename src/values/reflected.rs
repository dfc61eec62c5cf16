//! Reflected light at places in two parts: what emitters and bright reflectors send, which may vary sharply, and all other, which is smooth and dear.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::error_bars::ErrorBars;
use super::gather::{Gather, Gathered, Part, Scratch};
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage};

/// Reflected radiosities at places, and their standard errors, by place and channel in W/m^2; these are not numbers where they are not known.
pub(crate) struct Reflected {
    pub radiosity: Vec<f32>,
    pub standard_error: Vec<f32>,
    /// What of the radiosities emitters sent straight.
    pub straight: Vec<f32>,
}

/// Progress is reported, and cancelling asked for, once in so many places.
const BATCH: usize = 256;

/// A part of the reflected light at places, each by itself. `None` if the observer cancels.
pub(crate) fn reflected_at(
    gather: &Gather<'_>,
    error_bars: Option<ErrorBars>,
    places: &[Place],
    part: Part,
    observer: &dyn Observer,
) -> Option<Reflected> {
    let channels = gather.scene.channels();
    let mut numbers = vec![[f32::NAN; 3]; channels * places.len()];
    let (done, total) = (AtomicUsize::new(0), places.len());
    numbers.par_chunks_mut(channels * BATCH).zip(places.par_chunks(BATCH)).for_each_init(
        || (Scratch::default(), Gathered::default()),
        |(scratch, gathered), (numbers, places)| {
            if observer.cancelled() {
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
    let of = |kind: usize| numbers.iter().map(|numbers| numbers[kind]).collect();
    (!observer.cancelled()).then(|| Reflected { radiosity: of(0), standard_error: of(1), straight: of(2) })
}
