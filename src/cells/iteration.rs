//! How the equations of cell radiosities are solved: steps of sweeps, with Aitken extrapolation.
//!
//! Changes that fall by a steady ratio are a geometric series, whose rest is added at once; else a reflectance of 0.999 would take some ten
//! thousand sweeps.

use rayon::prelude::*;

use crate::progress::Stop;

/// Steps end once all changes still to come are estimated below this part of the brightest radiosity, or after so many of them.
const TOLERANCE: f64 = 1e-5;
pub(super) const MAX_STEPS: u32 = 2500;

/// What steps have led to.
pub(super) struct Iterated {
    /// By cell and channel.
    pub values: Vec<f64>,
    /// Whether changes still to come are small, and it was not the number of steps that ended it.
    pub is_settled: bool,
}

/// The ratio of successive changes is steady if the rest of their geometric series is known to this part.
const STEADY: f64 = 0.02;

/// That ratio is taken to be at most this: rows sum to less than 1, so sweeps converge. Terms of Russian roulette may be negative, but each is
/// at most a quarter of its path.
const MAX_RATIO: f64 = 0.9999;

/// Cells whose changes are compared together.
const COMPARED: usize = 2048;

/// The values that a step leaves as they are, after at most so many of them, or until changes have grown by the factor `growth`; the first `deciding` of
/// the channels tell when it is enough. A step finds new values from old ones. `None` if stopped before.
pub(super) fn iterated(
    mut values: Vec<f64>,
    ([channels, deciding], steps, growth): ([usize; 2], u32, f64),
    mut step: impl FnMut(&[f64], &mut [f64]),
    stop: Stop<'_>,
) -> Option<Iterated> {
    let mut next = vec![0.0; values.len()];
    let (mut previous, mut previous_ratio) = (f64::INFINITY, f64::INFINITY);
    let (mut slowest, mut smallest): (f64, f64) = (0.0, f64::INFINITY);
    let mut before_extrapolation: Option<(f64, Vec<f64>)> = None;
    for _ in 0..steps {
        if stop() {
            return None;
        }

        // A step, and how much it changes.
        step(&values, &mut next);
        let (change, brightest) = change(&next, &values, [channels, deciding]);

        // An extrapolation after which changes are larger is taken back.
        if let Some((change_before, values_before)) = before_extrapolation.take()
            && change > change_before
        {
            values = values_before;
            (previous, previous_ratio) = (f64::INFINITY, f64::INFINITY);
            continue;
        }

        // Light that grows from step to step never stands still.
        smallest = smallest.min(change);
        if change > growth * smallest {
            break;
        }

        // Done once the rest of the series is small. After an extrapolation fast changes hide the slow ones, so the slowest
        // ratio counts.
        std::mem::swap(&mut values, &mut next);
        let ratio = if previous.is_finite() { (change / previous).min(MAX_RATIO) } else { MAX_RATIO };
        let slow = ratio.max(slowest);
        if change * slow <= TOLERANCE * brightest * (1.0 - slow) {
            return Some(Iterated { values, is_settled: true });
        }

        // Extrapolate a steady series.
        if (ratio - previous_ratio).abs() <= STEADY * (1.0 - ratio) {
            slowest = slowest.max(ratio);
            before_extrapolation = Some((change, values.clone()));
            let to_come = ratio / (1.0 - ratio);
            values.par_iter_mut().zip(&next).with_min_len(1024).for_each(|(new, old)| *new += to_come * (*new - old));
            (previous, previous_ratio) = (f64::INFINITY, f64::INFINITY);
        } else {
            (previous, previous_ratio) = (change, ratio);
        }
    }
    Some(Iterated { values, is_settled: false })
}

/// The largest change of a value, and the largest value, in the first `deciding` of the channels.
fn change(new: &[f64], old: &[f64], [channels, deciding]: [usize; 2]) -> (f64, f64) {
    let larger = |a: (f64, f64), b: (f64, f64)| (if b.0 > a.0 { b.0 } else { a.0 }, if b.1 > a.1 { b.1 } else { a.1 });
    let of_values = |most, (new, old): (&[f64], &[f64])| {
        new.iter().zip(old).fold(most, |most, (&new, &old)| larger(most, ((new - old).abs(), new)))
    };
    let of_cells = |(new, old): (&[f64], &[f64])| {
        if deciding == channels {
            return of_values((0.0, 0.0), (new, old));
        }
        let cells = new.chunks_exact(channels).zip(old.chunks_exact(channels));
        cells.fold((0.0, 0.0), |most, (new, old)| of_values(most, (&new[..deciding], &old[..deciding])))
    };
    let chunks = new.par_chunks(COMPARED * channels).zip(old.par_chunks(COMPARED * channels));
    chunks.map(of_cells).reduce(|| (0.0, 0.0), larger)
}
