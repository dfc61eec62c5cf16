//! Whether light comes to points where none was found.
//!
//! The local norm is over all area that light comes to, however little of it, and relative to the median over that area. Where values and
//! replicates find none, behind a small hole or deep in a slot, it may be rare: left out, that area would make the median too bright and the error too
//! small. So longer paths look for light there, unless it would change nothing. A point from which one finds some counts as lit, and all that
//! was found there counts as missed by values. Where some points of a surface are found late, others of it may be that were not found at all: the error
//! is taken with these and without, whichever is larger. Where not even the median is known then, nothing can be said.
//!
//! It may miss light that less than one path in a hundred thousand finds: some five hundred leave each dark point.

use std::collections::HashSet;

use rayon::prelude::*;

use super::estimate::{ErrorEstimate, ErrorSamples, EstimateLit};
use super::norm::{Lit, least_light};
use super::replicates::{ErrorSample, ReplicateGather, Replication, Searched};
use crate::geometry::{sampling, streams};
use crate::paths::{PathScratch, Place};
use crate::progress::Stop;
use crate::scene::SurfaceId;
use crate::values::FinalGather;

/// The paths of each round of a search.
const ROUNDS: [u32; 4] = [64, 64, 128, 256];

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
        let (apart, all) = (estimate(self, lit), estimate(self, &counted(lit, |_| true)));
        let claimed = |of: &Option<ErrorEstimate>| of.as_ref().map_or(f64::INFINITY, |of| of.claimed);
        if claimed(&all) <= MATTERS * claimed(&apart) {
            return Some(worse(apart, all));
        }

        self.search(lit, least, with, stop)?;
        let late = self.add_searched(lit);
        let found = estimate(self, lit);
        if late.is_empty() {
            return Some(found.unwrap_or(ErrorEstimate::UNKNOWN));
        }
        let with_theirs = counted(lit, |index| late.contains(&self.samples[index].place.surface));
        Some(worse(found, estimate(self, &with_theirs)))
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
        worse(estimate(self, lit), estimate(self, &counted(lit, |index| !is_dark(index))))
    }

    /// Marks the points where a search has found light that values and replicates still do not find; the surfaces where it found some late.
    fn add_searched(&self, lit: &mut [Lit]) -> HashSet<SurfaceId> {
        let (least, mut late) = (least_light(lit), HashSet::new());
        for (point, sample) in lit.iter_mut().zip(&self.samples).filter(|(point, _)| point.light <= least) {
            if let Some(searched) = sample.searched.filter(|searched| searched.light > 0.0) {
                (point.is_reached, point.missed) = (true, searched.light);
                late.extend(searched.is_late.then_some(sample.place.surface));
            }
        }
        late
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

/// The same, with light at all of these points.
fn counted(lit: &[Lit], is_reached: impl Fn(usize) -> bool) -> Vec<Lit> {
    let points = lit.iter().enumerate();
    points.map(|(index, &point)| Lit { is_reached: point.is_reached || is_reached(index), ..point }).collect()
}

/// The one that claims more; unknown if either is.
fn worse(without: Option<ErrorEstimate>, with: Option<ErrorEstimate>) -> ErrorEstimate {
    match (without, with) {
        (Some(without), Some(with)) if with.claimed > without.claimed => with,
        (Some(without), Some(_)) => without,
        _ => ErrorEstimate::UNKNOWN,
    }
}

/// Looks for more light than `least` at a place, round by round, by paths of one replicate after the other.
fn searched_from(place: Place, least: f64, with: &Replication<'_>, scratch: &mut PathScratch) -> Searched {
    let reflectance = &with.scene.material_of(place.surface).reflectance[..with.scene.deciding()];
    let mut found = vec![0.0; with.scene.channels()];
    let mut cast = 0;
    for (round, (rays, gather)) in ROUNDS.into_iter().zip(&with.gathers).enumerate() {
        let place = Place { seed: sampling::hash(place.seed, streams::SEARCH + round as u64), ..place };
        long_paths(gather).sampled_irradiance(&[place], rays, scratch, &mut found);
        cast += rays;
        let sum_sq: f64 = found.iter().zip(reflectance).map(|(h, rho)| (rho * h).powi(2)).sum();
        let light = sum_sq.sqrt() * f64::from(rays) / f64::from(cast);
        if light > least {
            return Searched { light, is_late: round > 0 };
        }
    }
    Searched { light: 0.0, is_late: false }
}

fn long_paths<'a>(gather: &ReplicateGather<'a>) -> FinalGather<'a> {
    match gather {
        ReplicateGather::Truth(gather) => FinalGather { bounces: BOUNCES, ..*gather },
        ReplicateGather::Residual(gather) => FinalGather { paths: gather.paths, radiosities: gather.onward, bounces: BOUNCES },
    }
}
