//! What to do when the requested error is not reached: which remedy, and when to give up.

use super::remedy::{Doubtful, Remedy};
use super::{ERROR_POINTS, MAX_LOOK_RAYS, MAX_POINT_RAYS, Plan, TOLERANCE_POWER};
use crate::solve::error_estimate::{ErrorEstimate, TWICE};
use crate::solve::{Gather, Strategy};

/// What a round left to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum Verdict {
    /// The claimed error is at most the requested one.
    GoodEnough,
    /// The error may well be small enough, but the estimate is too noisy to claim it: look at more points.
    LookCloser,
    /// Values at points are too noisy: more rays to each.
    MoreRays,
    /// Radiosities at the ends of paths are too noisy or too coarse: resolve them more finely. Values may take more rays too.
    Resolve,
    /// Another round of refinement, to a finer tolerance.
    Refine,
    /// More effort would not help, or is not allowed.
    Exhausted,
}

/// Rounds after which refining once more would not help either.
const MAX_REFINEMENTS: u32 = 8;

/// Times that radiosities are resolved more finely.
const MAX_RESOLVES: u32 = 6;

/// Looks at more points after which the estimate will not get better.
pub(super) const MAX_LOOKS: u32 = 16;

/// The part of the requested error that is aimed at: the claim lies above what is measured.
const AIM: f64 = 0.7;

/// Where values are not what is worst, looks are worth so many times the work of the first ones.
const FEW_TIMES: f64 = 4.0;

/// Values may take so many times the rays.
const RAY_FACTORS: [f64; 8] = [1.0, 1.25, 1.5, 2.0, 3.0, 4.0, 6.0, MOST_RAYS_FACTOR];
const MOST_RAYS_FACTOR: f64 = 8.0;

/// What is foreseen must do with this to spare: estimates scatter, and a step that falls short costs another.
const SAFETY: f64 = 0.95;

/// Looks may be so many times as many, or have so many times the rays.
const LOOK_FACTORS: [f64; 8] = [1.0, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, 32.0];

/// Where radiosities are found too noisy or too coarse, times so much: twice the positions alone made them no better in two of three rooms.
const MORE_POSITIONS: f64 = 1.25;
const MORE_POSITION_RAYS: u32 = 2;

impl Plan {
    /// The work of looks for which a claim is waited for where nothing is known of the work of better links: more, the more was done
    /// for these.
    fn worthwhile_work(&self) -> f64 {
        FEW_TIMES * self.first_look_work * 2_f64.powi(self.refinements as i32)
    }

    fn may_resolve(&self) -> bool {
        self.gather == Gather::Hemisphere && self.refinements < MAX_RESOLVES
    }

    /// What may be done that is foreseen; better links are not among it.
    fn remedies(&self, doubtful: &Doubtful) -> impl Iterator<Item = Remedy> {
        let (may_take_more_rays, may_resolve) = (self.may_take_more_rays(), self.may_resolve());
        let is_foreseen = self.gather == Gather::Hemisphere || doubtful.is_noise();
        let rays = RAY_FACTORS.into_iter().filter(move |&rays| rays == 1.0 || (is_foreseen && may_take_more_rays));
        let of_values = rays.flat_map(|rays| [false, true].map(|resolves| (rays, resolves)));
        let of_values = of_values.filter(move |&(_, resolves)| !resolves || may_resolve);
        let (most_points, most_rays) = self.most_looks();
        let of_looks = move || {
            let points = LOOK_FACTORS.into_iter().filter(move |&points| points <= most_points);
            let rays = move || LOOK_FACTORS.into_iter().filter(move |&rays| rays <= most_rays);
            points.flat_map(move |points| rays().map(move |look_rays| (points, look_rays)))
        };
        of_values.flat_map(move |(rays, resolves)| {
            of_looks().map(move |(points, look_rays)| Remedy { rays, resolves, points, look_rays })
        })
    }

    /// So many times the points, and so many times the rays of each look, are the most that there may be.
    fn most_looks(&self) -> (f64, f64) {
        let most_points = (*ERROR_POINTS.end() as f64 / self.error_points as f64).max(1.0);
        let most_rays = (f64::from(MAX_LOOK_RAYS) / f64::from(self.look_rays)).max(1.0);
        (most_points, most_rays)
    }

    /// The work of a remedy, in rays: values are taken anew, here and by the user; where radiosities are resolved anew, so are those of
    /// looks, and the looks themselves.
    fn remedy_work(&self, remedy: &Remedy) -> f64 {
        let twice = if self.gather == Gather::Hemisphere { 1.0 / TWICE as f64 } else { 0.0 };
        let taken = (1.0 + twice) * self.error_points as f64;
        let known = if remedy.only_looks() { taken } else { 0.0 };
        let values = taken * remedy.points * remedy.rays - known + (remedy.rays - 1.0) * self.values;
        let positions = MORE_POSITIONS * (self.total_area / self.resolution.side.powi(2) + self.surfaces as f64);
        let rays = MORE_POSITION_RAYS * 2 * (self.resolution.rays + 2 * self.look_resolution().rays);
        let resolving = if remedy.resolves { positions * f64::from(rays) } else { 0.0 };
        let known = if remedy.resolves { 0.0 } else { 1.0 };
        f64::from(self.point_rays) * values + resolving + (remedy.points * remedy.look_rays - known) * self.look_work()
    }

    /// Looks at the error that was reached, and sees to what is worst: noise of the estimate, noise at the points, or the links.
    /// `gather_noise` tells the part of the error that is noise at the points; that costs values, so it is asked only where it may decide.
    pub fn judge(&mut self, error: &ErrorEstimate, gather_noise: impl FnOnce() -> f64) -> Verdict {
        let requested = self.options.error;
        if error.claimed <= requested {
            return Verdict::GoodEnough;
        }
        self.looks += 1;
        if self.looks > MAX_LOOKS {
            return Verdict::Exhausted;
        }
        let gather_noise = *self.gather_noise.get_or_insert_with(gather_noise);
        if gather_noise >= requested && !self.may_take_more_rays() {
            // Whatever else is made better, this noise is left.
            return Verdict::Exhausted;
        }

        // The least work that should do. Where nothing is known of the work of better links, looks are worth some.
        let doubtful = Doubtful::new(error, gather_noise);
        let will_do = |remedy: &Remedy| doubtful.estimate_claim(remedy) <= SAFETY * requested;
        let is_worth_it = |remedy: &Remedy| {
            self.gather == Gather::Hemisphere || !remedy.only_looks() || self.remedy_work(remedy) <= self.worthwhile_work()
        };
        let by_work = |a: &Remedy, b: &Remedy| self.remedy_work(a).total_cmp(&self.remedy_work(b));
        let remedy = self.remedies(&doubtful).filter(|remedy| will_do(remedy) && is_worth_it(remedy)).min_by(by_work);

        // Where none will do, begin with what is worst.
        let worst = Remedy {
            rays: if doubtful.is_noise() { MOST_RAYS_FACTOR } else { 1.0 },
            resolves: !doubtful.is_noise(),
            ..Remedy::NONE
        };
        let remedy = remedy.unwrap_or(worst);

        // Resolving anew takes much, and what looks found may be chance.
        let (closer, (most_points, most_rays)) = (doubtful.closer_look(), self.most_looks());
        let is_allowed = closer.points <= most_points && closer.look_rays <= most_rays && self.looks < MAX_LOOKS / 2;
        let looks_first =
            remedy.resolves && doubtful.may_be_chance() && is_allowed && self.remedy_work(&closer) < self.remedy_work(&remedy);
        let remedy = if looks_first { closer } else { remedy };
        if remedy.only_looks() {
            // Step by step: the next one may tell that it is enough, or that it will not do.
            if remedy.look_rays > 1.0 {
                self.look_rays = (2 * self.look_rays).min(MAX_LOOK_RAYS);
            } else {
                self.error_points += self.error_points / 2;
            }
            return Verdict::LookCloser;
        }
        self.gather_noise = None;
        if remedy.rays > 1.0 && self.may_take_more_rays() {
            self.point_rays = (f64::from(self.point_rays) * remedy.rays).min(f64::from(MAX_POINT_RAYS)) as u32;
            if !remedy.resolves {
                return Verdict::MoreRays;
            }
        }
        if self.gather == Gather::Hemisphere {
            if !self.may_resolve() {
                return Verdict::Exhausted;
            }
            self.refinements += 1;
            self.resolution.side /= MORE_POSITIONS.sqrt();
            self.resolution.rays *= MORE_POSITION_RAYS;
            return Verdict::Resolve;
        }
        self.refinements += 1;
        if self.options.strategy.links_surfaces() {
            return Verdict::Exhausted;
        }
        if self.options.tolerance.is_some() || self.options.strategy == Strategy::Uniform || self.refinements >= MAX_REFINEMENTS {
            return Verdict::Exhausted;
        }
        let excess = error.measured.max(0.5 * error.claimed) / (AIM * requested);
        self.tolerance *= excess.powf(-TOLERANCE_POWER).clamp(0.1, 0.6);
        Verdict::Refine
    }
}
