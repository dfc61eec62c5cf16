//! Whether light comes to points where none was found.
//!
//! The local norm is over all area that light comes to, however little of it, and relative to the median over that area. Where values and
//! replicates find none, behind a small hole or deep in a slot, it may be rare: left out, that area would make the median too bright and the error too
//! small. So longer paths look for light there, unless it would change nothing. A point from which one finds some counts as lit, and all that
//! was found there counts as missed by values.
//!
//! How much lit area is not found even so is told by what was found a single time: with A1 the area of points where one round of paths found light and no
//! other did, and A2 that of points where more did, about A1^2 / (2 A2) is not found (Chao 1984), all of it if A2 is 0. The error is taken with
//! this part of the dark area and without it, whichever is larger. Where not even the median is known then, nothing can be said.
//!
//! Light that no path finds at any point is missed: some five hundred leave each dark point.

use rayon::prelude::*;

use super::estimate::{ErrorEstimate, ErrorSamples, EstimateLit};
use super::norm::{Lit, least_light};
use super::replicates::{ErrorSample, ReplicateGather, Replication, Searched};
use crate::geometry::{sampling, streams};
use crate::paths::{PathScratch, Place};
use crate::progress::Stop;
use crate::values::FinalGather;

/// The paths of each round of a search; each replicate makes one.
const PATHS: u32 = 64;

/// Bounces before such a path may end in a cell: cells that no light has found tell nothing.
const BOUNCES: u32 = 8;

/// It is searched where dark area would make the claim so many times as large if it counted as lit.
const MATTERS: f64 = 1.02;

impl ErrorSamples {
    /// The error in the local norm by `estimate`, over all area that light may come to; unknown where it cannot be told. `lit` is what values and
    /// replicates tell; where the search finds light it is added to that. `None` if stopped.
    pub(super) fn with_dark_area(
        &mut self,
        lit: &mut [Lit],
        with: &Replication<'_>,
        estimate: &EstimateLit<'_>,
        stop: Stop<'_>,
    ) -> Option<ErrorEstimate> {
        let least = least_light(lit);
        let (apart, all) = (estimate(self, lit), estimate(self, &counted(lit, |_| 1.0)));
        let claimed = |of: &Option<ErrorEstimate>| of.as_ref().map_or(f64::INFINITY, |of| of.claimed);
        if claimed(&all) <= MATTERS * claimed(&apart) {
            return Some(worse(apart, all));
        }

        self.search(lit, least, with, stop)?;
        let part = self.add_searched(lit);
        let found = estimate(self, lit);
        if part == 0.0 {
            return Some(found.unwrap_or(ErrorEstimate::UNKNOWN));
        }
        Some(worse(found, estimate(self, &counted(lit, |_| part))))
    }

    /// The same where no path can be sent: over all area but where a search before found none, if `none_since` no other light can come.
    pub(super) fn with_area_searched_before(&self, lit: &[Lit], estimate: &EstimateLit<'_>, none_since: bool) -> ErrorEstimate {
        let least = least_light(lit);
        let found = |(sample, point): (&ErrorSample, &Lit)| sample.searched.filter(|_| point.light <= least).map(|of| of.light);
        let found: Vec<Option<f64>> = self.samples.iter().zip(lit).map(found).collect();
        if found.iter().flatten().any(|&light| light > 0.0) {
            return ErrorEstimate::UNKNOWN;
        }
        let is_dark = |index: usize| none_since && found[index].is_some();
        worse(estimate(self, lit), estimate(self, &counted(lit, |index| if is_dark(index) { 0.0 } else { 1.0 })))
    }

    /// Marks the points where a search has found light that values and replicates still do not find. The part of the other dark area that may be lit
    /// as well.
    fn add_searched(&self, lit: &mut [Lit]) -> f64 {
        let least = least_light(lit);
        let (mut once, mut more, mut never) = (0.0, 0.0, 0.0);
        for (point, sample) in lit.iter_mut().zip(&self.samples).filter(|(point, _)| point.light <= least) {
            let Some(searched) = sample.searched.filter(|searched| searched.light > 0.0) else {
                never += point.area;
                continue;
            };
            (point.is_reached, point.missed) = (true, searched.light);
            *if searched.is_once { &mut once } else { &mut more } += point.area;
        }
        if once == 0.0 || never == 0.0 { 0.0 } else { (once * once / (2.0 * more * never)).min(1.0) }
    }

    /// Looks for light at the points that are dark, each once. `None` if stopped.
    fn search(&mut self, lit: &[Lit], least: f64, with: &Replication<'_>, stop: Stop<'_>) -> Option<()> {
        self.samples.par_iter_mut().zip(lit).for_each_init(PathScratch::default, |scratch, (sample, point)| {
            if sample.searched.is_none() && point.light <= least && !stop() {
                sample.searched = Some(searched_from(sample.place, least, with, scratch));
            }
        });
        (!stop()).then_some(())
    }
}

/// The same, with light on a part of the area of each point where none was found.
fn counted(lit: &[Lit], part: impl Fn(usize) -> f64) -> Vec<Lit> {
    let least = least_light(lit);
    let of = |(index, &point): (usize, &Lit)| {
        let part = part(index);
        if point.is_reached || point.light > least || part == 0.0 {
            return point;
        }
        Lit { is_reached: true, area: part * point.area, ..point }
    };
    lit.iter().enumerate().map(of).collect()
}

/// The one that claims more; unknown if either is.
fn worse(without: Option<ErrorEstimate>, with: Option<ErrorEstimate>) -> ErrorEstimate {
    match (without, with) {
        (Some(without), Some(with)) if with.claimed > without.claimed => with,
        (Some(without), Some(_)) => without,
        _ => ErrorEstimate::UNKNOWN,
    }
}

/// Looks for more light than `least` at a place, round by round, until two have found some.
fn searched_from(place: Place, least: f64, with: &Replication<'_>, scratch: &mut PathScratch) -> Searched {
    let reflectance = &with.scene.material_of(place.surface).reflectance[..with.scene.deciding()];
    let mut found = vec![0.0; with.scene.channels()];
    let (mut sum, mut rounds, mut hits) = (vec![0.0; reflectance.len()], 0, 0);
    for gather in &with.gathers {
        let place = Place { seed: sampling::hash(place.seed, streams::SEARCH + rounds), ..place };
        long_paths(gather).sampled_irradiance(&[place], PATHS, scratch, &mut found);
        rounds += 1;
        let reflected = || found.iter().zip(reflectance).map(|(h, rho)| rho * h);
        if length(reflected()) > least {
            hits += 1;
            sum.iter_mut().zip(reflected()).for_each(|(sum, b)| *sum += b);
        }
        if hits == 2 {
            break;
        }
    }
    Searched { light: length(sum.into_iter()) / rounds as f64, is_once: hits == 1 }
}

fn length(channels: impl Iterator<Item = f64>) -> f64 {
    channels.map(|b| b * b).sum::<f64>().sqrt()
}

fn long_paths<'a>(gather: &ReplicateGather<'a>) -> FinalGather<'a> {
    match gather {
        ReplicateGather::Truth(gather) => FinalGather { bounces: BOUNCES, ..*gather },
        ReplicateGather::Residual(gather) => FinalGather { paths: gather.paths, radiosities: gather.onward, bounces: BOUNCES },
    }
}
