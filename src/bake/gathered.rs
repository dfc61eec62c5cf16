//! Texels by gathers: at the nodes of the lattice, and wherever it says so; and how far the others are off.

use glam::DVec3;
use rayon::prelude::*;

use super::lattice::{Cell, Misfit, Notes, first_cells};
use super::texels::Texels;
use crate::discontinuities::Discontinuities;
use crate::error::ErrorNorm;
use crate::geometry::{sampling, streams};
use crate::paths::Place;
use crate::scene::Scene;
use crate::values::{Values, ValuesError};

/// Interpolated texels that are held against gathers of their own: a mean square is known to some four percent, as far as they are alike.
const CONTROLS: usize = 1024;

/// What is told of an error is so many standard deviations above what was found.
const CONFIDENCE_SIGMAS: f64 = 2.0;

/// Takes values at places; `None` if it is cancelled.
pub(crate) type Ask<'a> = &'a dyn Fn(&[Place]) -> Option<Values>;

/// How good interpolated texels have to be, and where random numbers come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// Relative, in the norm.
    pub error: f64,
    pub norm: ErrorNorm,
    pub seed: u64,
}

/// How texels were found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found {
    /// Texels that were gathered.
    pub gathered: u64,
    /// How wrong these are.
    pub error: Option<ValuesError>,
    /// How far the interpolated ones are off, relative in the norm; `None` if there are none.
    pub interpolated: Option<f64>,
}

/// A texel: the number of its chart, and its index there.
type Texel = (usize, usize);

/// Finds the values of all texels that have none. `None` if cancelled.
pub(crate) fn gather(
    scene: &Scene,
    texels: &mut [Texels<'_>],
    lines: &Discontinuities,
    aim: Aim,
    ask: Ask<'_>,
) -> Option<Found> {
    let mut notes: Vec<Notes> = texels.par_iter().map(|texels| notes_of(texels, lines)).collect();
    let reflecting = (0..texels.len()).filter(|&chart| texels[chart].material.reflects());
    let mut cells: Vec<Cell> = reflecting.flat_map(|chart| first_cells(chart, texels[chart].chart.size())).collect();
    let (mut plain, mut squares) = (Vec::new(), Vec::new());

    // Nodes are gathered, then cells are kept or quartered.
    while !cells.is_empty() {
        let mut wanted: Vec<Texel> = (cells.iter())
            .flat_map(|cell| cell.nodes(texels[cell.chart].columns()).map(|index| (cell.chart, index)))
            .filter(|&(chart, index)| texels[chart].is_wanted(index))
            .collect();
        wanted.par_sort_unstable();
        wanted.dedup();
        take(scene, (texels, &mut notes), &wanted, (aim.seed, ask), &mut squares)?;
        let scale_sq = scale_sq(&squares, aim.norm);
        let is_good = |cell: &Cell| {
            let (texels, notes) = (&texels[cell.chart], &notes[cell.chart]);
            cell.is_plain(texels, notes) && is_close(&cell.misfit(texels, notes), scale_sq, aim)
        };
        let (good, rest): (Vec<Cell>, Vec<Cell>) = cells.into_par_iter().partition(is_good);
        plain.extend(good);
        cells = rest.into_iter().flat_map(Cell::quarters).collect();
    }

    // Interpolate, and hold some of that against gathers.
    let mut filled: Vec<Texel> = Vec::new();
    for cell in plain {
        filled.extend(cell.interpolate(&mut texels[cell.chart]).into_iter().map(|index| (cell.chart, index)));
    }
    let interpolated = hold_against_gathers(scene, texels, &filled, (scale_sq(&squares, aim.norm), aim), ask)?;
    let error = if squares.iter().all(|[_, noise_sq]| noise_sq.is_finite()) { ValuesError::of(&squares) } else { None };
    Some(Found { gathered: squares.len() as u64, error, interpolated })
}

/// The lines that the scene's shape makes on a chart.
fn notes_of(texels: &Texels<'_>, lines: &Discontinuities) -> Notes {
    let chart = texels.chart;
    let on_chart = chart.surfaces.iter().flat_map(|&surface| lines.of(surface));
    Notes::new(texels, on_chart.map(|segment| segment.ends.map(|end| chart.to_texels(DVec3::from(end)))))
}

/// Gathers texels, and adds the squares of the light that they reflect and of their standard errors.
fn take(
    scene: &Scene,
    (texels, notes): (&mut [Texels<'_>], &mut [Notes]),
    wanted: &[Texel],
    (seed, ask): (u64, Ask<'_>),
    squares: &mut Vec<[f64; 2]>,
) -> Option<()> {
    let places: Vec<Place> = wanted.par_iter().map(|&(chart, index)| texels[chart].place(scene, index, seed)).collect();
    let values = ask(&places)?;
    let found = values.radiosity.chunks(values.channels).zip(values.standard_error.chunks(values.channels));
    for (&(chart, index), (radiosity, errors)) in wanted.iter().zip(found) {
        texels[chart].set(index, radiosity);
        let noise_sq: f32 = errors.iter().map(|error| error * error).sum();
        notes[chart].noise_sq[index] = if noise_sq.is_finite() { noise_sq } else { 0.0 };
        squares.push([light_sq(&texels[chart], radiosity), f64::from(noise_sq)]);
    }
    Some(())
}

/// The square of the light that a texel reflects, channels added.
fn light_sq(texels: &Texels<'_>, radiosity: &[f32]) -> f64 {
    radiosity.iter().zip(&texels.material.exitance).map(|(&b, e)| (f64::from(b) - e).powi(2)).sum()
}

/// What errors are relative to, squared: the least of all places in the local norm, the same for all by energy.
fn scale_sq(squares: &[[f64; 2]], norm: ErrorNorm) -> f64 {
    match norm {
        ErrorNorm::Energy => squares.iter().map(|[light_sq, _]| light_sq).sum::<f64>() / squares.len().max(1) as f64,
        ErrorNorm::Local => {
            let mut lit: Vec<f64> = squares.iter().map(|[light_sq, _]| *light_sq).filter(|light_sq| *light_sq > 0.0).collect();
            lit.sort_by(f64::total_cmp);
            lit.get(lit.len() / 2).copied().unwrap_or(0.0)
        }
    }
}

/// What the error at a place with so much light is relative to, squared.
fn relative_to(light_sq: f64, scale_sq: f64, norm: ErrorNorm) -> f64 {
    match norm {
        ErrorNorm::Energy => scale_sq,
        ErrorNorm::Local => light_sq.max(scale_sq),
    }
}

/// Whether what the middles of a cell are off, beyond noise, is no more than the error that values may have.
fn is_close(misfit: &Misfit, scale_sq: f64, aim: Aim) -> bool {
    misfit.off_sq - misfit.noise_sq <= aim.error.powi(2) * relative_to(misfit.light_sq, scale_sq, aim.norm)
}

/// How far interpolated texels are off, relative in the norm: a root mean square over some of them, free of the noise of the gathers that they are held
/// against. `Some(None)` if there are none.
fn hold_against_gathers(
    scene: &Scene,
    texels: &[Texels<'_>],
    filled: &[Texel],
    (scale_sq, aim): (f64, Aim),
    ask: Ask<'_>,
) -> Option<Option<f64>> {
    // One of each of as many strata.
    let count = CONTROLS.min(filled.len());
    let drawn = (0..count).map(|number| {
        let random = sampling::unit(sampling::hash(aim.seed, streams::BAKE_CONTROLS + number as u64));
        filled[((number as f64 + random) / count as f64 * filled.len() as f64) as usize]
    });
    let drawn: Vec<Texel> = drawn.collect();
    if drawn.is_empty() {
        return Some(None);
    }
    let places: Vec<Place> = drawn.iter().map(|&(chart, index)| texels[chart].place(scene, index, aim.seed)).collect();
    let values = ask(&places)?;

    let found = values.radiosity.chunks(values.channels).zip(values.standard_error.chunks(values.channels));
    let off_sq = |(&(chart, index), (radiosity, errors)): (&Texel, (&[f32], &[f32]))| {
        let of_channel = |((&own, &told), &error): ((&f32, &f32), &f32)| {
            let noise_sq = if error.is_finite() { f64::from(error).powi(2) } else { 0.0 };
            f64::from(own - told).powi(2) - noise_sq
        };
        let off_sq: f64 = radiosity.iter().zip(texels[chart].radiosity_of(index)).zip(errors).map(of_channel).sum();
        off_sq / relative_to(light_sq(&texels[chart], radiosity), scale_sq, aim.norm).max(f64::MIN_POSITIVE)
    };
    let all: Vec<f64> = drawn.iter().zip(found).map(off_sq).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let variance = all.iter().map(|off_sq| (off_sq - mean).powi(2)).sum::<f64>() / (all.len() as f64).powi(2);
    Some(Some((mean + CONFIDENCE_SIGMAS * variance.sqrt()).max(0.0).sqrt()))
}
