//! What to do about an error that is too large, or of which too little is known to claim it. Decides, changes nothing.
//!
//! The square of the error has two parts: noise of the gather at points, which is sampled by gathering again and falls as rays are
//! added, and the rest, which falls as cell radiosities are found more finely. Either is known as well as replicates and points are many.
//! What is claimed follows from all four, so what each choice will let be claimed is foreseen, and the least work that should do is found
//! among all of them.

use super::effort::{AIM, Law};
use super::plan::{MORE_POSITION_RAYS, MORE_POSITIONS, MOST_RAYS_FACTOR, Plan};
use super::step::{Choice, NextStep};
use crate::error::{Doubts, ErrorEstimate, SIGMAS, claim};

/// Refined is to so many times the tolerance, at most and at least: the law is one of the mean of many scenes.
const MOST_REFINED: f64 = 0.1;
const LEAST_REFINED: f64 = 0.6;

/// Values may take so many times the rays.
const RAY_FACTORS: [f64; 5] = [1.0, 1.5, 2.0, 4.0, MOST_RAYS_FACTOR];

/// Where nothing foreseen will do, values that are mostly noise take so many times the rays.
const MORE_RAYS_FACTOR: f64 = 4.0;

/// What is foreseen must do with this to spare: estimates scatter, and a step that falls short costs another.
const SAFETY: f64 = 0.95;

/// Points may be so many times as many, and replicates have so many times the rays.
const REPLICATE_FACTORS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// Decides what to do about an error; `value_noise` is the part of it that is noise of the values at points.
pub(super) fn next_step(plan: &Plan, error: &ErrorEstimate, value_noise: f64) -> NextStep {
    let requested = plan.requested();
    if error.claimed <= requested {
        return NextStep::GoodEnough;
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

    // The least work that should do. Where nothing is known of the work of better links, replicates are worth some.
    let doubtful = Doubtful::new(error, value_noise, plan.has_cells());
    let will_do = |choice: &Choice| doubtful.estimate_claim(choice) <= SAFETY * requested;
    let is_worth_it = |choice: &Choice| !choice.keeps_values() || plan.is_worthwhile(plan.work_of(choice));
    let by_work = |a: &Choice, b: &Choice| plan.work_of(a).total_cmp(&plan.work_of(b));
    let choice = choices(plan, &doubtful).filter(|choice| will_do(choice) && is_worth_it(choice)).min_by(by_work);

    // Where none will do, begin with what is worst; where that is links, refine them.
    let worst = || Some(doubtful.worst(requested)).filter(|choice| !choice.keeps_values() || plan.may_know_closer(choice));
    let otherwise = || if plan.has_cells() { Choice { finds_cells: true, ..Choice::NOTHING } } else { Choice::NOTHING };
    let choice = choice.or_else(worst).unwrap_or_else(otherwise);
    if choice == Choice::NOTHING {
        return refine(plan, error);
    }

    // Finding cells anew takes much, and what replicates found may be chance. Where values and what is known of them must both become
    // better, what the claim gains most by comes first.
    let closer = doubtful.closer();
    let knows_first = choice.finds_cells
        && doubtful.may_be_chance()
        && !doubtful.is_common()
        && plan.may_know_closer(&closer)
        && plan.work_of(&closer) < plan.work_of(&choice);
    let known_alone = Choice { rays: 1.0, ..choice };
    let tells_more = !choice.finds_cells && doubtful.estimate_claim(&known_alone) < doubtful.estimate_claim(&choice.of_values());
    step_towards(
        plan,
        if knows_first {
            closer
        } else if tells_more {
            known_alone
        } else {
            choice
        },
    )
}

/// The next step towards a choice: replicates are added little by little, because each time may tell that it is enough, or will not do.
fn step_towards(plan: &Plan, choice: Choice) -> NextStep {
    if choice.keeps_values() {
        return if choice.replicate_rays > 1.0 { NextStep::MoreReplicateRays } else { NextStep::MorePoints };
    }
    if choice.finds_cells {
        return if plan.may_find_cells() { NextStep::FindCells(choice.rays) } else { NextStep::Exhausted };
    }
    if plan.may_take_more_rays() { NextStep::MoreRays(choice.rays) } else { NextStep::Exhausted }
}

/// The step to better links.
fn refine(plan: &Plan, error: &ErrorEstimate) -> NextStep {
    if plan.may_refine() {
        let exceeded = error.measured.max(0.5 * error.claimed) / (AIM * plan.requested());
        return NextStep::Refine(plan.tolerance_factor(1.0 / exceeded).clamp(MOST_REFINED, LEAST_REFINED));
    }
    NextStep::Exhausted
}

/// What may be done that is foreseen; better links are not among it.
fn choices(plan: &Plan, doubtful: &Doubtful) -> impl Iterator<Item = Choice> {
    let (may_take_more_rays, may_find_cells) = (plan.may_take_more_rays(), plan.may_find_cells());
    let is_foreseen = plan.has_cells() || doubtful.is_noise();
    let rays = RAY_FACTORS.into_iter().filter(move |&rays| rays == 1.0 || (is_foreseen && may_take_more_rays));
    let of_values = rays.flat_map(|rays| [false, true].map(|finds_cells| (rays, finds_cells)));
    let of_values = of_values.filter(move |&(_, finds_cells)| !finds_cells || may_find_cells);
    let (most_points, most_rays) = plan.most_replicates();
    let of_replicates = move || {
        let points = REPLICATE_FACTORS.into_iter().filter(move |&points| points <= most_points);
        let rays = move || REPLICATE_FACTORS.into_iter().filter(move |&rays| rays <= most_rays);
        points.flat_map(move |points| rays().map(move |replicate_rays| (points, replicate_rays)))
    };
    of_values.flat_map(move |(rays, finds_cells)| {
        of_replicates().map(move |(points, replicate_rays)| Choice { rays, finds_cells, points, replicate_rays })
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
}

impl<'a> Doubtful<'a> {
    /// The error is not below the noise of values, which is known better.
    fn new(error: &'a ErrorEstimate, value_noise: f64, has_cells: bool) -> Self {
        let noise_sq = value_noise.powi(2);
        Self { error, noise_sq, other_sq: (error.measured.powi(2) - noise_sq).max(0.0), has_cells }
    }

    /// Whether replicates have much in common, beyond what may be chance of their noise at points.
    fn is_common(&self) -> bool {
        self.error.doubts.common > self.error.doubts.replicates
    }

    /// What takes away the largest part of the square of the claim; nothing where that is the bias of links. To know closer what is more than
    /// is asked for would not do.
    fn worst(&self, requested: f64) -> Choice {
        let Doubts { replicates, common, noise, .. } = self.error.doubts;
        let doubt = SIGMAS * replicates.hypot(common);
        let noise_sq = self.noise_sq + SIGMAS * noise;
        if noise_sq >= self.other_sq.max(doubt) {
            Choice { rays: MORE_RAYS_FACTOR, ..Choice::NOTHING }
        } else if doubt > self.other_sq && !self.is_common() && self.error.measured <= requested {
            self.closer()
        } else {
            Choice { finds_cells: self.has_cells || doubt > self.other_sq, ..Choice::NOTHING }
        }
    }

    fn is_noise(&self) -> bool {
        self.noise_sq > self.other_sq
    }

    /// Whether all that is not noise of the gather at points may be a chance of the replicates.
    fn may_be_chance(&self) -> bool {
        self.other_sq < SIGMAS * self.error.doubts.replicates.hypot(self.error.doubts.common)
    }

    /// The next step to know better: more rays where replicates are noisy, else more points.
    fn closer(&self) -> Choice {
        if self.error.ray_share > 0.5 {
            Choice { replicate_rays: 2.0, ..Choice::NOTHING }
        } else {
            Choice { points: 1.5, ..Choice::NOTHING }
        }
    }

    /// What may be claimed after a choice, as far as it can be foreseen.
    fn estimate_claim(&self, choice: &Choice) -> f64 {
        let more_cells = if choice.finds_cells { (MORE_POSITIONS, f64::from(MORE_POSITION_RAYS)) } else { (1.0, 1.0) };
        let left = Law::left_by_cells(more_cells.0, more_cells.1);
        let noise_left = Law::left_by_rays(choice.rays);
        let ErrorEstimate { doubts, ray_share, .. } = self.error;
        let of_values = if self.has_cells { left } else { 1.0 };
        let by_points = 1.0 / choice.points.sqrt();
        let of_replicates = by_points * (ray_share / choice.replicate_rays.powi(2) + (1.0 - ray_share) * of_values.powi(2)).sqrt();
        let doubts = Doubts {
            replicates: doubts.replicates * of_replicates,
            common: doubts.common * if self.is_common() { left } else { of_replicates },
            noise: by_points * doubts.noise * noise_left,
            // That of a sum of independent parts falls as one over the root of how many there are.
            skewness: by_points * doubts.skewness,
        };
        claim(self.noise_sq * noise_left + of_values * self.other_sq, doubts.all())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Scatter;

    fn normal(deviation: f64) -> Scatter {
        Scatter { deviation, skewness: 0.0 }
    }

    fn estimate(measured: f64, replicates: f64, ray_share: f64) -> ErrorEstimate {
        ErrorEstimate { measured, doubts: Doubts { replicates, ..Doubts::default() }, ray_share, ..ErrorEstimate::default() }
    }

    #[test]
    fn what_is_left_shrinks_with_its_own_choice_alone() {
        let error = estimate(0.02, 0.0, 0.0);
        let (rays, cells) = (Choice { rays: 4.0, ..Choice::NOTHING }, Choice { finds_cells: true, ..Choice::NOTHING });
        let noisy = Doubtful::new(&error, 0.02, true);
        assert!(noisy.is_noise());
        let noise_left = Law::left_by_rays(4.0);
        assert!((noisy.estimate_claim(&rays) / claim(4e-4 * noise_left, Scatter::default()) - 1.0).abs() < 1e-12);
        assert_eq!(noisy.estimate_claim(&cells), noisy.estimate_claim(&Choice::NOTHING));
        let coarse = Doubtful::new(&error, 0.0, true);
        assert!(!coarse.is_noise());
        assert_eq!(coarse.estimate_claim(&rays), coarse.estimate_claim(&Choice::NOTHING));
        let left = Law::left_by_cells(MORE_POSITIONS, f64::from(MORE_POSITION_RAYS));
        assert!((coarse.estimate_claim(&cells) / claim(4e-4 * left, Scatter::default()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn doubt_falls_with_points_and_where_it_is_noise_of_replicates_faster_with_their_rays() {
        let points = Choice { points: 4.0, ..Choice::NOTHING };
        let rays = Choice { replicate_rays: 4.0, ..Choice::NOTHING };
        let foreseen = |share: f64, choice: &Choice| Doubtful::new(&estimate(0.01, 1e-4, share), 0.0, true).estimate_claim(choice);
        for share in [0.0, 1.0] {
            assert!((foreseen(share, &points) / claim(1e-4, normal(0.5e-4)) - 1.0).abs() < 1e-12);
        }
        assert!((foreseen(1.0, &rays) / claim(1e-4, normal(0.25e-4)) - 1.0).abs() < 1e-12);
        assert_eq!(foreseen(0.0, &rays), foreseen(0.0, &Choice::NOTHING));
    }

    #[test]
    fn the_error_is_not_thought_below_the_noise_of_values() {
        let error = estimate(0.0, 1e-5, 1.0);
        assert_eq!(Doubtful::new(&error, 0.008, true).estimate_claim(&Choice::NOTHING), claim(0.008_f64.powi(2), normal(1e-5)));
    }
}
