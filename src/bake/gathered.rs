//! Texels by gathers: at the nodes of the lattice, and wherever it says so; and how far the others are off.
//!
//! Direct light first, which is sharp and cheap, then indirect light, which is smooth and dear: each on a lattice of its own. They share the squared
//! error that interpolation may have.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::change::{self, Change};
use super::cut_short::{Coarse, NotFound, complete};
use super::lattice::{Cell, Misfit, Notes, first_cells, first_side};
use super::record::{BakeRecord, Base, Terms};
use super::texels::Texels;
use crate::discontinuities::Discontinuities;
use crate::error::ErrorNorm;
use crate::geometry::{sampling, streams};
use crate::paths::Place;
use crate::progress::{Observer, Stop};
use crate::scene::Scene;
use crate::values::{self, ErrorBars, Gather, Part, Reflected};

/// Interpolated texels that are held against gathers of their own: a mean square is known to some four percent, as far as they are alike.
const CONTROLS: usize = 1024;

/// What is told of an error is so many standard deviations above what was found.
const CONFIDENCE_SIGMAS: f64 = 2.0;

/// The parts of the light, in their order.
const PARTS: [Part; 2] = [Part::Sharp, Part::Smooth];

/// Gathers light at places, and says when to stop.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub gather: &'a Gather<'a>,
    pub error_bars: Option<ErrorBars>,
    /// Once it cancels, nothing is found.
    pub observer: &'a dyn Observer,
    /// When the time is over, if there is a limit: what there is then has to do.
    pub until: Option<Instant>,
    /// What has to do where there is nothing.
    pub coarse: Coarse<'a>,
    /// On which terms a later bake may take from this one; `None` if none will.
    pub keep: Option<Terms>,
}

/// Until when the part with this number may be gathered: each has the same share of the time that the ones before left.
fn until_of_part(number: usize, until: Instant) -> Instant {
    let now = Instant::now();
    now + until.saturating_duration_since(now) / (PARTS.len() - number) as u32
}

/// How good interpolated texels have to be, and where random numbers come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// Relative, in the norm.
    pub error: f64,
    pub norm: ErrorNorm,
    pub seed: u64,
}

/// How texels were found. Errors are root mean squares relative to the light, in the norm.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Found {
    /// Texels that were gathered, by part.
    pub gathered: [u64; 2],
    /// How wrong these are; `None` where nothing is known.
    pub error: Option<f64>,
    /// How far all are off gathers because some are interpolated, or kept from an earlier bake.
    pub interpolated: f64,
    /// What was kept, by part.
    pub kept: [Kept; 2],
    /// What a later bake can take; `None` if that is not wanted, or not all was found.
    pub record: Option<BakeRecord>,
    /// Texels that a limit kept from being found, where parts differ the more of them.
    pub not_found: NotFound,
}

/// What of a part of the light was taken from an earlier bake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Kept {
    /// Texels whose light is the earlier one, with what it changed by.
    pub texels: u64,
    /// How far these are off gathers, relative in the norm, at two standard deviations.
    pub off: f64,
    /// Whether that was more than gathers are off: then all were found anew.
    pub is_refused: bool,
}

/// A texel: the number of its chart, and its index there.
type Texel = (usize, usize);

/// A part of the light of a scene while it is found.
struct PartOfLight<'a> {
    scene: &'a Scene,
    part: Part,
    /// Its place among the parts.
    number: usize,
    aim: Aim,
    asked: Asked<'a>,
    until: Option<Instant>,
    /// Of each gathered texel: its square of light, and of its standard error.
    squares: Vec<[f64; 2]>,
}

/// Finds the values of all texels that have none. `None` if cancelled. An earlier bake gives a base for charts, or none where it has nothing.
pub(crate) fn gather(
    scene: &Scene,
    texels: &mut [Texels<'_>],
    lines: &Discontinuities,
    bases: &[Option<Base<'_>>],
    (aim, asked): (Aim, Asked<'_>),
) -> Option<Found> {
    let mut notes: Vec<Notes> = texels.par_iter().map(|texels| notes_of(texels, lines)).collect();
    let (mut found, mut wrong_sq, mut off_sq) = (Found::default(), 0.0, 0.0);
    for (number, part) in PARTS.into_iter().enumerate() {
        if number > 0 {
            texels.iter_mut().for_each(Texels::begin_next_part);
        }
        let until = asked.until.map(|until| until_of_part(number, until));
        let mut light = PartOfLight { scene, part, number, aim, asked, until, squares: Vec::new() };
        let (kept, cells) = light.keep(texels, &mut notes, bases)?;
        let filled = light.find(texels, &mut notes, cells)?;
        let all = (kept.texels + (filled.len() + light.squares.len()) as u64).max(1) as f64;
        off_sq += filled.len() as f64 / all * light.off_gathers_sq(texels, &filled)?;
        if kept.texels > 0 {
            off_sq += kept.texels as f64 / all * kept.off.powi(2);
        }
        wrong_sq += light.wrong_sq();
        found.gathered[number] = light.squares.len() as u64;
        found.kept[number] = kept;
    }
    found.not_found = NotFound::of(texels);
    let is_whole = found.not_found == NotFound::default();
    found.record = asked.keep.filter(|_| is_whole).map(|terms| BakeRecord::of(scene, texels, &notes, terms));
    texels.iter_mut().for_each(Texels::join_parts);
    let is_known = wrong_sq > 0.0 && wrong_sq.is_finite() && found.not_found == NotFound::default();
    Some(Found { error: is_known.then(|| wrong_sq.sqrt()), interpolated: off_sq.sqrt(), ..found })
}

/// The lines that the scene's shape makes on a chart.
fn notes_of(texels: &Texels<'_>, lines: &Discontinuities) -> Notes {
    let chart = texels.chart;
    let on_chart = chart.surfaces.iter().flat_map(|&surface| lines.of(surface));
    Notes::new(texels, on_chart.map(|segment| segment.ends.map(|end| chart.to_texels(end))))
}

/// The middle one of the texels of each chart, and the others; they are sorted.
fn one_of_each_chart(texels: Vec<Texel>) -> (Vec<Texel>, Vec<Texel>) {
    let first: Vec<Texel> = texels.chunk_by(|a, b| a.0 == b.0).map(|of_chart| of_chart[of_chart.len() / 2]).collect();
    let rest = texels.into_iter().filter(|texel| first.binary_search(texel).is_err()).collect();
    (first, rest)
}

fn is_known(numbers: &[f32]) -> bool {
    !numbers[0].is_nan()
}

impl PartOfLight<'_> {
    /// Keeps the earlier light of cells where it changed by a linear function, unless what is kept turns out to be further off than what is found anew.
    /// Returns the cells that are to be found.
    fn keep(&mut self, texels: &mut [Texels<'_>], notes: &mut [Notes], bases: &[Option<Base<'_>>]) -> Option<(Kept, Vec<Cell>)> {
        let reflecting = (0..texels.len()).filter(|&chart| texels[chart].material.reflects());
        let side = first_side(texels);
        let cells: Vec<Cell> = reflecting.flat_map(|chart| first_cells(chart, texels[chart].chart.size(), side)).collect();
        if bases.is_empty() {
            return Some((Kept::default(), cells));
        }

        // What the light of each cell has changed by.
        let probes_of = |cell: &Cell| {
            let base = bases[cell.chart].as_ref();
            base.map_or(Vec::new(), |base| change::probes(*cell, &texels[cell.chart], &notes[cell.chart], base))
        };
        let probes: Vec<Vec<usize>> = cells.par_iter().map(probes_of).collect();
        let chart_of =
            |(cell, probes): (&Cell, &Vec<usize>)| probes.iter().map(|&index| (cell.chart, index)).collect::<Vec<Texel>>();
        let mut wanted: Vec<Texel> = cells.iter().zip(&probes).flat_map(chart_of).collect();
        wanted.par_sort_unstable();
        wanted.dedup();
        self.take(texels, notes, &wanted)?;

        // Keep those where it is linear.
        let scale_sq = self.scale_sq();
        let (mut kept, mut rest) = (Vec::new(), Vec::new());
        for (cell, probes) in cells.iter().zip(&probes) {
            let base = bases[cell.chart].as_ref().map(|base| (base, self.number));
            let change = base.and_then(|base| Change::of(&texels[cell.chart], &notes[cell.chart], base, probes));
            match (
                base,
                change.filter(|change| self.is_small(change.misfit.off_sq - change.misfit.noise_sq, &change.misfit, scale_sq)),
            ) {
                (Some(base), Some(change)) => {
                    let indices = change.apply(*cell, &mut texels[cell.chart], base);
                    kept.extend(indices.into_iter().map(|index| (cell.chart, index)));
                }
                _ => rest.push(*cell),
            }
        }

        // They may be as far off as gathers and interpolation are together.
        let off_sq = self.off_gathers_sq(texels, &kept)?;
        let is_refused = off_sq > self.allowed_sq() + self.wrong_sq();
        let count = kept.len() as u64;
        if is_refused {
            kept.iter().for_each(|&(chart, index)| texels[chart].forget(std::iter::once(index)));
        }
        let found = Kept { texels: if is_refused { 0 } else { count }, off: off_sq.sqrt(), is_refused };
        Some((found, if is_refused { cells } else { rest }))
    }

    /// Finds this part for all other texels: nodes are gathered, then cells are kept or quartered. Returns the texels that were interpolated.
    fn find(&mut self, texels: &mut [Texels<'_>], notes: &mut [Notes], mut cells: Vec<Cell>) -> Option<Vec<Texel>> {
        let mut plain = Vec::new();
        while !cells.is_empty() {
            let mut wanted: Vec<Texel> = (cells.iter())
                .flat_map(|cell| cell.nodes(texels[cell.chart].columns()).map(|index| (cell.chart, index)))
                .filter(|&(chart, index)| texels[chart].is_wanted(index))
                .collect();
            wanted.par_sort_unstable();
            wanted.dedup();
            // One of each chart before others: if time is over soon, the fewest are left without any.
            let (first, rest) = one_of_each_chart(wanted);
            self.take(texels, notes, &first)?;
            self.take(texels, notes, &rest)?;
            if self.is_over() {
                break;
            }

            let scale_sq = self.scale_sq();
            let is_good = |cell: &Cell| {
                let (texels, notes) = (&texels[cell.chart], &notes[cell.chart]);
                let is_close = |misfit: Misfit| self.is_small(misfit.true_sq(), &misfit, scale_sq);
                cell.is_plain(texels, notes) && is_close(cell.misfit(texels, notes))
            };
            let (good, rest): (Vec<Cell>, Vec<Cell>) = cells.into_par_iter().partition(is_good);
            plain.extend(good);
            cells = rest.into_iter().flat_map(Cell::quarters).collect();
        }

        let mut filled: Vec<Texel> = Vec::new();
        for cell in plain {
            filled.extend(cell.interpolate(&mut texels[cell.chart]).into_iter().map(|index| (cell.chart, index)));
        }
        self.cut_short(texels, &cells);
        Some(filled)
    }

    /// Gives texels a value that are not known yet: those of cells that nobody has judged from their nodes, others from what is beside them.
    fn cut_short(&self, texels: &mut [Texels<'_>], cells: &[Cell]) {
        let mut between = vec![0; texels.len()];
        cells.iter().for_each(|cell| between[cell.chart] += cell.interpolate_known(&mut texels[cell.chart]) as u64);
        complete(self.scene, texels, &between, self.asked.coarse);
    }

    /// Whether the time of this part is over.
    fn is_over(&self) -> bool {
        self.until.is_some_and(|until| Instant::now() >= until)
    }

    /// Gathers texels.
    fn take(&mut self, texels: &mut [Texels<'_>], notes: &mut [Notes], wanted: &[Texel]) -> Option<()> {
        let found = self.gathers(texels, wanted, (self.aim.seed, &|| self.is_over()))?;
        let channels = self.scene.channels();
        let straight = found.straight.chunks(channels);
        let found = found.radiosity.chunks(channels).zip(found.standard_error.chunks(channels)).zip(straight);
        for (&(chart, index), ((reflected, errors), straight)) in
            wanted.iter().zip(found).filter(|(_, ((found, _), _))| is_known(found))
        {
            texels[chart].set(index, reflected, straight);
            let noise_sq: f32 = errors.iter().map(|error| error * error).sum();
            notes[chart].noise_sq[index] = if noise_sq.is_finite() { noise_sq } else { 0.0 };
            self.squares.push([texels[chart].light_sq(index, reflected), f64::from(noise_sq)]);
        }
        Some(())
    }

    /// Gathers at texels until it is stopped; `None` if cancelled.
    fn gathers(&self, texels: &[Texels<'_>], wanted: &[Texel], (seed, late): (u64, Stop<'_>)) -> Option<Reflected> {
        let place = |&(chart, index): &Texel| texels[chart].place(self.scene, index, seed);
        let places: Vec<Place> = wanted.iter().map(place).collect();
        let Asked { gather, error_bars, observer, .. } = self.asked;
        let stop = || observer.cancelled() || late();
        let found = values::reflected_at(gather, error_bars, &places, self.part, (observer, &stop));
        (!observer.cancelled()).then_some(found)
    }

    /// What errors are relative to, squared: the least of all places in the local norm, the same for all by energy.
    fn scale_sq(&self) -> f64 {
        let light_sq = self.squares.iter().map(|[light_sq, _]| *light_sq);
        match self.aim.norm {
            ErrorNorm::Energy => light_sq.sum::<f64>() / self.squares.len().max(1) as f64,
            ErrorNorm::Local => {
                let mut lit: Vec<f64> = light_sq.filter(|light_sq| *light_sq > 0.0).collect();
                lit.par_sort_unstable_by(f64::total_cmp);
                lit.get(lit.len() / 2).copied().unwrap_or(0.0)
            }
        }
    }

    /// What the error at a place with so much light is relative to, squared.
    fn relative_to(&self, light_sq: f64, scale_sq: f64) -> f64 {
        match self.aim.norm {
            ErrorNorm::Energy => scale_sq,
            ErrorNorm::Local => light_sq.max(scale_sq),
        }
    }

    /// The part's share of the squared error that values may have.
    fn allowed_sq(&self) -> f64 {
        self.aim.error.powi(2) / PARTS.len() as f64
    }

    /// Whether what values are truly off where there is so much light is no more than allowed.
    fn is_small(&self, true_sq: f64, misfit: &Misfit, scale_sq: f64) -> bool {
        true_sq <= self.allowed_sq() * self.relative_to(misfit.light_sq, scale_sq)
    }

    /// The mean square of the standard errors of what was gathered, relative in the norm.
    fn wrong_sq(&self) -> f64 {
        let scale_sq = self.scale_sq();
        let relative = |[light_sq, noise_sq]: &[f64; 2]| match self.relative_to(*light_sq, scale_sq) {
            to if to > 0.0 => noise_sq / to,
            _ => 0.0,
        };
        self.squares.iter().map(relative).sum::<f64>() / self.squares.len().max(1) as f64
    }

    /// How far texels that were filled are off, relative in the norm: a mean square over some of them, free of the noise of the gathers that they are held
    /// against, with what doubt there is about it. These have random numbers of their own: a kept texel may have been gathered by those of all others.
    fn off_gathers_sq(&self, texels: &[Texels<'_>], filled: &[Texel]) -> Option<f64> {
        // One of each of as many strata.
        let count = CONTROLS.min(filled.len());
        let drawn = (0..count).map(|number| {
            let random = sampling::unit(sampling::hash(self.aim.seed, streams::BAKE_CONTROLS + number as u64));
            filled[((number as f64 + random) / count as f64 * filled.len() as f64) as usize]
        });
        let drawn: Vec<Texel> = drawn.collect();
        if drawn.is_empty() {
            return Some(0.0);
        }
        let late = || self.asked.until.is_some_and(|until| Instant::now() >= until);
        let seed = sampling::hash(self.aim.seed, streams::BAKE_CONTROLS);
        let found = self.gathers(texels, &drawn, (seed, &late))?;
        let (channels, scale_sq) = (self.scene.channels(), self.scale_sq());

        let found = found.radiosity.chunks(channels).zip(found.standard_error.chunks(channels));
        let off_sq = |(&(chart, index), (reflected, errors)): (&Texel, (&[f32], &[f32]))| {
            let of_channel = |((&own, &told), &error): ((&f32, &f32), &f32)| {
                let noise_sq = if error.is_finite() { f64::from(error).powi(2) } else { 0.0 };
                f64::from(own - told).powi(2) - noise_sq
            };
            let off_sq: f64 = reflected.iter().zip(texels[chart].reflected_of(index)).zip(errors).map(of_channel).sum();
            off_sq / self.relative_to(texels[chart].light_sq(index, reflected), scale_sq).max(f64::MIN_POSITIVE)
        };
        let all: Vec<f64> = drawn.iter().zip(found).filter(|(_, (found, _))| is_known(found)).map(off_sq).collect();
        if all.is_empty() {
            return Some(f64::INFINITY);
        }
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all.iter().map(|off_sq| (off_sq - mean).powi(2)).sum::<f64>() / (all.len() as f64).powi(2);
        Some((mean + CONFIDENCE_SIGMAS * variance.sqrt()).max(0.0))
    }
}
