//! Whether light comes to points where none was found.
//!
//! The local norm is over all area that light comes to, however little of it, and relative to the median over that area. Where values and
//! replicates find none, behind a small hole or deep in a slot, it may be rare: left out, that area would make the median too bright and the error too
//! small. So longer paths look for light there, unless it would change nothing. A point from which one finds some counts as lit, and all that
//! was found there counts as missed by values. Then light comes to all dark points that see a surface where some was found, and to those that see
//! their surfaces, and so on, however rare the paths are: the error is taken with all these and without, whichever is larger. Where not even the
//! median is known then, nothing can be said.
//!
//! If a path finds such light with the chance p, values by n paths scatter there by `1 / sqrt(n p)` of it at least. Where that is too much on a part a of
//! the lit area,
//!
//! ```text
//! a l^2 / (n p) > (the error that is asked for)^2
//! ```
//!
//! with l its light beside the median, at most 1, and all the paths that a value may have, no work that is left would do. So the error is told without
//! that area, and that there is more.
//!
//! Light that no path finds at any point is missed: some five hundred leave each dark point.

use std::collections::HashSet;

use rayon::prelude::*;

use super::estimate::{ErrorEstimate, ErrorSamples, EstimateLit};
use super::norm::{Lit, least_light, lit_points, median_light};
use super::replicates::{ErrorSample, REPLICATES, ReplicateGather, Replication, Searched};
use super::residual::ResidualGather;
use crate::geometry::{sampling, streams};
use crate::paths::{PathScratch, Place};
use crate::progress::Stop;
use crate::scene::SurfaceId;
use crate::values::FinalGather;

/// The paths of each round of a search, one by each replicate, and the rays that tell what a point sees.
const PATHS: u32 = 64;

/// Bounces before such a path may end, in a cell or by chance: cells that no light has found tell nothing.
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
        let reached = self.add_searched(lit);
        let found = estimate(self, lit);
        if reached.is_empty() {
            return Some(found.unwrap_or(ErrorEstimate::UNKNOWN));
        }
        let is_reached = self.that_see(reached, lit, with);
        let lit_with = counted(lit, |index| is_reached[index]);
        let all = estimate(self, &lit_with);
        let matters = claimed(&all) > MATTERS * claimed(&found);
        if matters && paths_to_tell(lit, &lit_with, &is_reached) > with.most_paths {
            return Some(ErrorEstimate { is_elsewhere: true, ..found.unwrap_or(ErrorEstimate::UNKNOWN) });
        }
        Some(worse(found, all))
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

    /// Marks the points where a search has found light that values and replicates still do not find. The surfaces that they lie on.
    fn add_searched(&self, lit: &mut [Lit]) -> HashSet<SurfaceId> {
        let (least, mut reached) = (least_light(lit), HashSet::new());
        for (point, sample) in lit.iter_mut().zip(&self.samples).filter(|(point, _)| point.light <= least) {
            if let Some(searched) = sample.searched.filter(|searched| searched.light > 0.0) {
                (point.is_reached, point.missed) = (true, searched.light);
                reached.insert(sample.place.surface);
            }
        }
        reached
    }

    /// By point, whether it is dark and sees one of these surfaces, or that of another such point.
    fn that_see(&self, mut reached: HashSet<SurfaceId>, lit: &[Lit], with: &Replication<'_>) -> Vec<bool> {
        let least = least_light(lit);
        let paths = long_paths(&with.gathers[0]).paths;
        let seen_from = |(sample, point): (&ErrorSample, &Lit)| {
            if point.light <= least { paths.sampled_seen(&sample.place, PATHS) } else { Vec::new() }
        };
        let seen: Vec<Vec<SurfaceId>> = self.samples.par_iter().zip(lit).map(seen_from).collect();
        let mut sees = vec![false; seen.len()];
        loop {
            let sees_one = |index: &usize| !sees[*index] && seen[*index].iter().any(|surface| reached.contains(surface));
            let more: Vec<usize> = (0..seen.len()).filter(sees_one).collect();
            if more.is_empty() {
                return sees;
            }
            for index in more {
                sees[index] = true;
                reached.insert(self.samples[index].place.surface);
            }
        }
    }

    /// Looks for light at the points that are dark, each once. `None` if stopped.
    fn search(&mut self, lit: &[Lit], least: f64, with: &Replication<'_>, stop: Stop<'_>) -> Option<()> {
        let share = with.gathers[0].share();
        let samples = self.samples.par_iter_mut().zip(lit).enumerate();
        samples.for_each_init(PathScratch::default, |scratch, (number, (sample, point))| {
            if share.has(number) && sample.searched.is_none() && point.light <= least && !stop() {
                sample.searched = Some(searched_from(sample.place, least, with, scratch));
            }
        });
        share.exchange(&mut self.samples);
        (!stop()).then_some(())
    }
}

/// The same, with light at all of these points.
fn counted(lit: &[Lit], is_reached: impl Fn(usize) -> bool) -> Vec<Lit> {
    let points = lit.iter().enumerate();
    points.map(|(index, &point)| Lit { is_reached: point.is_reached || is_reached(index), ..point }).collect()
}

/// The paths from a point, times the square of an error, that values need at least where the search was in vain, if its points count as lit.
fn paths_to_tell(lit: &[Lit], lit_with: &[Lit], is_searched: &[bool]) -> f64 {
    let searched = || lit.iter().zip(is_searched).filter(|(_, is_searched)| **is_searched).map(|(point, _)| point);
    let area = searched().map(|point| point.area).sum::<f64>();
    let found = searched().filter(|point| point.is_reached).map(|point| point.area).sum::<f64>() / area;
    let chance = -(1.0 - found).ln() / (f64::from(PATHS) * REPLICATES as f64);

    // Where it is dim beside the median, that light may be further off.
    let light = searched().map(|point| point.area * point.missed).sum::<f64>() / area;
    let relative = median_light(lit_with).map_or(1.0, |typical| (light / typical).min(1.0));
    let part = area / lit_points(lit_with).map(|point| point.area).sum::<f64>();
    part * relative * relative / chance
}

/// The one that claims more; unknown if either is.
fn worse(without: Option<ErrorEstimate>, with: Option<ErrorEstimate>) -> ErrorEstimate {
    match (without, with) {
        (Some(without), Some(with)) if with.claimed > without.claimed => with,
        (Some(without), Some(_)) => without,
        _ => ErrorEstimate::UNKNOWN,
    }
}

/// Looks for more light than `least` at a place, round by round.
fn searched_from(place: Place, least: f64, with: &Replication<'_>, scratch: &mut PathScratch) -> Searched {
    let reflectance = &with.scene.material_of(place.surface).reflectance[..with.scene.deciding()];
    let mut found = vec![0.0; with.scene.channels()];
    for (round, gather) in (0..).zip(&with.gathers) {
        let place = Place { seed: sampling::hash(place.seed, streams::SEARCH + round), ..place };
        long_paths(gather).sampled_irradiance(&[place], PATHS, scratch, &mut found);
        let sum_sq: f64 = found.iter().zip(reflectance).map(|(h, rho)| (rho * h).powi(2)).sum();
        let light = sum_sq.sqrt() / (round + 1) as f64;
        if light > least {
            return Searched { light };
        }
    }
    Searched { light: 0.0 }
}

fn long_paths<'a>(gather: &ReplicateGather<'a>) -> FinalGather<'a> {
    match gather {
        ReplicateGather::Truth(gather) => FinalGather { bounces: BOUNCES, ..*gather },
        &ReplicateGather::Residual(ResidualGather { paths, onward: radiosities, vertex_rays, .. }) => {
            FinalGather { paths, radiosities, bounces: BOUNCES, vertex_rays }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundred points, of which some were searched, and at one of these so much light was found.
    fn paths(searched: usize, missed: f64) -> f64 {
        let is_searched: Vec<bool> = (0..100).map(|index| index < searched).collect();
        let point = |index: usize| {
            let light = if index < searched { 0.0 } else { 1.0 };
            Lit { is_reached: index == 0, missed: if index == 0 { missed } else { 0.0 }, ..Lit::of(1.0, light) }
        };
        let lit: Vec<Lit> = (0..100).map(point).collect();
        paths_to_tell(&lit, &counted(&lit, |index| is_searched[index]), &is_searched)
    }

    #[test]
    fn what_is_dim_beside_the_median_needs_few_paths() {
        // One of twenty finds light by some five hundred paths: one in ten thousand does.
        let chance = -(0.95_f64).ln() / 512.0;
        assert!((paths(20, 20.0) / (0.2 / chance) - 1.0).abs() < 1e-12);
        assert!((paths(20, 2.0) / (0.2 * 0.01 / chance) - 1.0).abs() < 1e-12);
        // Where that area makes the median, it is all there is to be told.
        let rare = -(1.0 - 1.0 / 60.0_f64).ln() / 512.0;
        assert!((paths(60, 1e-6) / (0.6 / rare) - 1.0).abs() < 1e-12);
        // Where all searches find light it is not rare.
        assert_eq!(paths(1, 1.0), 0.0);
    }
}
