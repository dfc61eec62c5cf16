//! What to do about an error that is too large, or of which too little is known to claim it. Decides, changes nothing.
//!
//! The square of the error has two parts: noise of the gather at points, which is sampled by gathering again and falls as rays are
//! added, and the rest, which falls as cell radiosities are found more finely. Either is known as well as replicates and points are many.
//! What is claimed follows from all four. So what each choice will leave is foreseen, and how far what is measured then may lie off that: this is
//! the chance that it will do. A choice that fails costs its work and leaves the others, so the one that takes the least work for its chance comes
//! first (the index rule for such searches: Weitzman, Econometrica 47, 1979).

use super::effort::{AIM, Law};
use super::plan::{MOST_RAYS_FACTOR, Plan, left_by_finer_cells};
use super::step::{Choice, NextStep};
use crate::error::{Doubts, ErrorEstimate, SIGMAS, largest_sq_for_claim};

/// Refined is to so many times the tolerance, at most and at least: the law is one of the mean of many scenes.
const MOST_REFINED: f64 = 0.1;
const LEAST_REFINED: f64 = 0.6;

/// Values may take so many times the rays.
const RAY_FACTORS: [f64; 5] = [1.0, 1.5, 2.0, 4.0, MOST_RAYS_FACTOR];

/// Where nothing foreseen will do, values that are mostly noise take so many times the rays.
const MORE_RAYS_FACTOR: f64 = 4.0;

/// What does less often than this is not counted on: one step will not be enough.
const LEAST_CHANCE: f64 = 0.1;

/// Until values over cells can be claimed they take so many times the work that is foreseen. Measured: 1.23 in the mean of twelve scenes, 1 in three
/// of five runs, at most 3.5.
const OVER_CELLS_IN_ALL: f64 = 1.25;

/// Points may be so many times as many, and replicates have so many times the rays.
const REPLICATE_FACTORS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// What may be done beside what is told by factors, by its predicted work in rays; infinite where that is no way.
pub(super) struct Instead {
    /// Links refined by [`refinement`], without what is judged then.
    pub refine: f64,
    /// All that values over cells take beyond what those over links would take.
    pub take_cells: f64,
}

/// Decides what to do about an error; `value_noise` is the part of it that is noise of the values at points.
pub(super) fn next_step(plan: &Plan, error: &ErrorEstimate, value_noise: f64, instead: &Instead) -> NextStep {
    let requested = plan.requested();
    if plan.should_pass_unresolved(error.by_unresolved) && !plan.has_estimated_enough() {
        return NextStep::PassUnresolved;
    }
    if error.claimed <= requested {
        return if error.is_elsewhere { NextStep::Exhausted } else { NextStep::GoodEnough };
    }
    if plan.has_estimated_enough() || (value_noise >= requested && !plan.may_take_more_rays()) {
        // Whatever else is made better, this noise is left.
        return NextStep::Exhausted;
    }

    if error.lit == 0.0 && !error.claimed.is_finite() {
        // No point has found the light that there is: more of them may.
        let more = Choice { points: 1.5, ..Choice::NOTHING };
        return if plan.may_know_closer(&more) { NextStep::MorePoints } else { NextStep::Exhausted };
    }
    if !error.claimed.is_finite() {
        // Half of the lit area has so little light that no replicate has found it: more of their rays may.
        let more = Choice { replicate_rays: 2.0, ..Choice::NOTHING };
        return if plan.may_know_closer(&more) { NextStep::MoreReplicateRays } else { NextStep::Exhausted };
    }

    // The least work for its chance.
    let noise = if plan.has_found_cells_in_vain() { value_noise.max(error.measured) } else { value_noise };
    let doubtful =
        Doubtful { left_by_links: plan.left_by_links(refinement(plan, error)), ..Doubtful::new(error, noise, plan.over_cells) };
    let chance = |choice: &Choice| doubtful.chance(choice, requested);
    let work = |choice: &Choice| plan.work_of(choice) + if choice.refines { instead.refine } else { 0.0 };
    let index = |choice: &Choice| work(choice) / chance(choice);
    let likely = choices(plan, instead).filter(|choice| *choice != Choice::NOTHING && chance(choice) >= LEAST_CHANCE);
    let likely = likely.min_by(|a, b| index(a).total_cmp(&index(b)));

    // Where one step will not be enough, begin with what is worst; where that is links, refine them.
    let mut choice = match likely {
        Some(choice) if index(&choice) <= OVER_CELLS_IN_ALL * instead.take_cells => choice,
        Some(_) => return NextStep::TakeCells,
        None => {
            let worst = doubtful.worst(requested);
            let otherwise = Choice { finds_cells: plan.over_cells, ..Choice::NOTHING };
            let is_dear = plan.over_cells && plan.work_of(&worst) > plan.work_of(&otherwise);
            if worst.keeps_values() && (is_dear || !plan.may_know_closer(&worst)) { otherwise } else { worst }
        }
    };
    if choice == Choice::NOTHING || (likely.is_none() && plan.work_of(&choice) > instead.take_cells) {
        return refine_or_take_cells(plan, error, instead);
    }

    if plan.has_found_cells() {
        choice = choice.once_judged();
    }

    // Where values and what is known of them must both become better, what is known comes first only if that alone may well do, and sooner.
    let known_alone = Choice { rays: 1.0, refines: false, ..choice };
    let may_do = chance(&known_alone) >= chance(&choice.of_values()).max(LEAST_CHANCE);
    step_towards(plan, error, if may_do && !choice.finds_cells { known_alone } else { choice })
}

/// The next step towards a choice: replicates are added little by little, because each time may tell that it is enough, or will not do.
fn step_towards(plan: &Plan, error: &ErrorEstimate, choice: Choice) -> NextStep {
    if choice.keeps_values() {
        return if choice.replicate_rays > 1.0 { NextStep::MoreReplicateRays } else { NextStep::MorePoints };
    }
    if choice.refines {
        return NextStep::Refine(refinement(plan, error));
    }
    if choice.finds_cells {
        return if plan.may_find_cells() { NextStep::FindCells(choice.rays) } else { NextStep::Exhausted };
    }
    if plan.may_take_more_rays() { NextStep::MoreRays(choice.rays) } else { NextStep::Exhausted }
}

/// The step to better links, or over to cells where that takes less.
fn refine_or_take_cells(plan: &Plan, error: &ErrorEstimate, instead: &Instead) -> NextStep {
    if instead.take_cells < instead.refine {
        NextStep::TakeCells
    } else if plan.may_refine() {
        NextStep::Refine(refinement(plan, error))
    } else {
        NextStep::Exhausted
    }
}

/// Links are to be refined to so many times the tolerance.
pub(super) fn refinement(plan: &Plan, error: &ErrorEstimate) -> f64 {
    let exceeded = error.measured.max(0.5 * error.claimed) / (AIM * plan.requested());
    plan.tolerance_factor(1.0 / exceeded).clamp(MOST_REFINED, LEAST_REFINED)
}

/// What may be done that is foreseen.
fn choices(plan: &Plan, instead: &Instead) -> impl Iterator<Item = Choice> {
    let (may_take_more_rays, may_find_cells) = (plan.may_take_more_rays(), plan.may_find_cells());
    let rays = RAY_FACTORS.into_iter().filter(move |&rays| rays == 1.0 || may_take_more_rays);
    let of_values = rays.flat_map(|rays| [false, true].map(|finds_cells| (rays, finds_cells)));
    let of_values = of_values.filter(move |&(_, finds_cells)| !finds_cells || may_find_cells);
    let (most_points, most_rays) = plan.most_replicates();
    let of_replicates = move || {
        let points = REPLICATE_FACTORS.into_iter().filter(move |&points| points <= most_points);
        let rays = move || REPLICATE_FACTORS.into_iter().filter(move |&rays| rays <= most_rays);
        points.flat_map(move |points| rays().map(move |replicate_rays| (points, replicate_rays)))
    };
    let of_values = of_values.map(|(rays, finds_cells)| Choice { rays, finds_cells, ..Choice::NOTHING });
    let refined = instead.refine.is_finite().then_some(Choice { refines: true, ..Choice::NOTHING });
    of_values.chain(refined).flat_map(move |of_values| {
        of_replicates().map(move |(points, replicate_rays)| Choice { points, replicate_rays, ..of_values })
    })
}

/// An error that cannot be claimed yet.
struct Doubtful<'a> {
    error: &'a ErrorEstimate,
    /// The parts of the square of the error: noise of the gather at points, and all other.
    noise_sq: f64,
    other_sq: f64,
    /// Whether values end in cells, or replicates alone.
    has_cells: bool,
    /// The part of what is off values beside their noise that refined links leave.
    left_by_links: f64,
}

impl<'a> Doubtful<'a> {
    /// The error is not below the noise of values, which is known better.
    fn new(error: &'a ErrorEstimate, value_noise: f64, has_cells: bool) -> Self {
        let noise_sq = value_noise.powi(2);
        Self { error, noise_sq, other_sq: (error.measured.powi(2) - noise_sq).max(0.0), has_cells, left_by_links: 1.0 }
    }

    /// Whether replicates have much in common, beyond what may be chance of their noise at points.
    fn is_common(&self) -> bool {
        self.error.doubts.common > self.error.doubts.replicates
    }

    /// What takes away the largest part of the square of the claim; nothing where that is the bias of links. Finding cells anew takes much, and what
    /// replicates found may be chance: then it is known closer first. Over links, to know closer what is more than is asked for would not do.
    fn worst(&self, requested: f64) -> Choice {
        let Doubts { replicates, common, noise, median, .. } = self.error.doubts;
        let doubt = SIGMAS * replicates.hypot(common).hypot(median);
        let noise_sq = self.noise_sq + SIGMAS * noise;
        if noise_sq >= self.other_sq.max(doubt) {
            Choice { rays: MORE_RAYS_FACTOR, ..Choice::NOTHING }
        } else if doubt > self.other_sq && !self.is_common() && (self.has_cells || self.error.measured <= requested) {
            self.closer()
        } else {
            Choice { finds_cells: self.has_cells || (self.is_common() && doubt > self.other_sq), ..Choice::NOTHING }
        }
    }

    /// The next step to know better: more rays where replicates are noisy, more points where these differ or tell the median light too little.
    fn closer(&self) -> Choice {
        if self.error.ray_share > 0.5 && self.error.doubts.replicates > self.error.doubts.median {
            Choice { replicate_rays: 2.0, ..Choice::NOTHING }
        } else {
            Choice { points: 1.5, ..Choice::NOTHING }
        }
    }

    /// The part of what is off values beside their noise that a choice leaves.
    fn left(&self, choice: &Choice) -> f64 {
        match choice {
            Choice { refines: true, .. } => self.left_by_links,
            Choice { finds_cells: true, .. } if self.has_cells => left_by_finer_cells(),
            _ => 1.0,
        }
    }

    /// The variances of the measured square by noise of the replicates' rays, and by the scatter of points, after a choice.
    fn variances_of_replicates(&self, choice: &Choice) -> (f64, f64) {
        let ErrorEstimate { doubts, ray_share, .. } = self.error;
        let by_points = doubts.replicates.powi(2) / choice.points;
        (by_points * ray_share / choice.replicate_rays.powi(2), by_points * (1.0 - ray_share) * self.left(choice).powi(2))
    }

    /// The doubts after a choice.
    fn doubts_after(&self, choice: &Choice) -> Doubts {
        let Doubts { replicates, common, noise, median, skewness } = self.error.doubts;
        let (of_rays, of_points) = self.variances_of_replicates(choice);
        let of_replicates = (of_rays + of_points).sqrt();
        let common = match (self.is_common(), choice.finds_cells) {
            (true, true) => common * left_by_finer_cells(),
            (true, false) => common,
            // As much as may be chance.
            (false, _) => common * of_replicates / replicates.max(f64::MIN_POSITIVE),
        };
        let by_points = 1.0 / choice.points.sqrt();
        // The skewness of a sum of independent parts falls as one over the root of how many there are.
        let noise = by_points * noise * Law::left_by_rays(choice.rays);
        // Relative to another light it is so many times as much.
        let left = self.square_after(choice) / (self.noise_sq + self.other_sq).max(f64::MIN_POSITIVE);
        let median = by_points * median * left;
        Doubts { replicates: of_replicates, common, noise, median, skewness: by_points * skewness }
    }

    /// The square of the error that a choice is expected to leave.
    fn square_after(&self, choice: &Choice) -> f64 {
        self.noise_sq * Law::left_by_rays(choice.rays) + self.left(choice) * self.other_sq
    }

    /// The chance that no more than is requested can be claimed after a choice, as far as that can be foreseen.
    fn chance(&self, choice: &Choice, requested: f64) -> f64 {
        // What is measured then lies around what was measured now: by all that is in doubt now and then where it is drawn anew, else by so much as
        // is learnt. Where cells are found, replicates are drawn anew, but not the points.
        let around = |now: f64, then: f64, is_new: bool| if is_new { now + then } else { (now - then).max(0.0) };
        let (now, then, left_sq) = (self.error.doubts, self.doubts_after(choice), self.left(choice).powi(2));
        let (rays_now, points_now) = self.variances_of_replicates(&Choice::NOTHING);
        let (rays_then, points_then) = self.variances_of_replicates(choice);
        let of_rays = around(left_sq * rays_now, rays_then, choice.finds_cells);
        let of_common = around(left_sq * now.common.powi(2), then.common.powi(2), choice.finds_cells);
        let of_points = around(left_sq * points_now, points_then, false);
        let of_noise = around((now.noise * Law::left_by_rays(choice.rays)).powi(2), then.noise.powi(2), !choice.keeps_values());

        let room = largest_sq_for_claim(requested, then.all()) - self.square_after(choice);
        chance_of_room(room, of_rays + of_common + of_points + of_noise)
    }
}

/// The chance that a normal number of this variance is no larger than so.
fn chance_of_room(room: f64, variance: f64) -> f64 {
    if variance > 0.0 { 0.5 * libm::erfc(-room / (2.0 * variance).sqrt()) } else { f64::from(u8::from(room >= 0.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Scatter, claim};
    use crate::geometry::sampling::{hash, unit};

    /// About normal, with variance 1: a sum of twelve uniform numbers.
    fn normal(seed: u64) -> f64 {
        (0..12).map(|k| unit(hash(seed, k))).sum::<f64>() - 6.0
    }

    fn estimate(measured: f64, replicates: f64, ray_share: f64) -> ErrorEstimate {
        ErrorEstimate { measured, doubts: Doubts { replicates, ..Doubts::default() }, ray_share, ..ErrorEstimate::default() }
    }

    #[test]
    fn what_is_left_shrinks_with_its_own_choice_alone() {
        let error = estimate(0.02, 0.0, 0.0);
        let (rays, cells) = (Choice { rays: 4.0, ..Choice::NOTHING }, Choice { finds_cells: true, ..Choice::NOTHING });
        let noisy = Doubtful::new(&error, 0.02, true);
        assert!((noisy.square_after(&rays) / (4e-4 * Law::left_by_rays(4.0)) - 1.0).abs() < 1e-12);
        assert_eq!(noisy.square_after(&cells), noisy.square_after(&Choice::NOTHING));
        let coarse = Doubtful::new(&error, 0.0, true);
        assert_eq!(coarse.square_after(&rays), coarse.square_after(&Choice::NOTHING));
        assert!((coarse.square_after(&cells) / (4e-4 * left_by_finer_cells()) - 1.0).abs() < 1e-12);

        // Refined links leave no less noise, and cells of replicates change nothing of values over links.
        let refined = Choice { refines: true, ..Choice::NOTHING };
        let [noisy, coarse] = [0.02, 0.0].map(|noise| Doubtful { left_by_links: 0.3, ..Doubtful::new(&error, noise, false) });
        assert_eq!(noisy.square_after(&refined), noisy.square_after(&Choice::NOTHING));
        assert!((coarse.square_after(&refined) / (0.3 * 4e-4) - 1.0).abs() < 1e-12);
        assert_eq!(coarse.square_after(&cells), coarse.square_after(&Choice::NOTHING));
    }

    #[test]
    fn doubt_falls_with_points_and_where_it_is_noise_of_replicates_faster_with_their_rays() {
        let points = Choice { points: 4.0, ..Choice::NOTHING };
        let rays = Choice { replicate_rays: 4.0, ..Choice::NOTHING };
        let foreseen =
            |share: f64, choice: &Choice| Doubtful::new(&estimate(0.01, 1e-4, share), 0.0, true).doubts_after(choice).replicates;
        for share in [0.0, 1.0] {
            assert!((foreseen(share, &points) / 0.5e-4 - 1.0).abs() < 1e-12);
        }
        assert!((foreseen(1.0, &rays) / 0.25e-4 - 1.0).abs() < 1e-12);
        assert_eq!(foreseen(0.0, &rays), 1e-4);
    }

    #[test]
    fn the_error_is_not_thought_below_the_noise_of_values() {
        let error = estimate(0.0, 1e-5, 1.0);
        assert_eq!(Doubtful::new(&error, 0.008, true).square_after(&Choice::NOTHING), 0.008_f64.powi(2));
    }

    /// By normal numbers: what will be measured is drawn around the truth, and that around what was measured.
    #[test]
    fn the_chance_is_how_often_a_claim_will_do() {
        let error = estimate(0.008, 2e-5, 1.0);
        let doubtful = Doubtful::new(&error, 0.0, true);
        for choice in [
            Choice { replicate_rays: 2.0, ..Choice::NOTHING },
            Choice { finds_cells: true, replicate_rays: 2.0, ..Choice::NOTHING },
        ] {
            let (left, then) = (doubtful.left(&choice), doubtful.doubts_after(&choice).replicates);
            // More rays of the same replicates add what they find by themselves to what was known.
            let weight = 1.0 - (then / 2e-5).powi(2);
            let will_do = |trial: u64| {
                let (truth, noise) = (6.4e-5 + 2e-5 * normal(hash(trial, 1)), then * normal(hash(trial, 2)));
                let added = |found: f64| 6.4e-5 + weight * (found - 6.4e-5);
                let measured = if choice.finds_cells { left * truth + noise } else { added(truth + noise / weight.sqrt()) };
                claim(measured, Scatter { deviation: then, skewness: 0.0 }) <= 0.01
            };
            let often = (0..20_000).filter(|&trial| will_do(trial)).count() as f64 / 20_000.0;
            let chance = doubtful.chance(&choice, 0.01);
            assert!((chance - often).abs() < 0.02, "{chance} for {often} of {choice:?}");
        }
        assert_eq!(Doubtful::new(&estimate(0.008, 0.0, 0.0), 0.0, true).chance(&Choice::NOTHING, 0.01), 1.0);
    }
}
