//! Values at points beside what replicates found there.

use std::ops::Range;

use rayon::prelude::*;

use super::norm::Lit;
use super::pairs::{PairProducts, mean_and_variance};
use super::replicates::{ErrorSample, REPLICATES};
use crate::geometry::{sampling, streams};
use crate::paths::{Place, place_at};
use crate::progress::Stop;
use crate::scene::Scene;
use crate::values::{Gather, Gathered, Over, RayBudget, Scratch};

/// What a value says of the light at a point may differ from what replicates say by so many of their standard deviations.
const LIGHT_SIGMAS: f64 = 2.0;

/// Of two values one of which is so many times the other, the smaller tells the light: a rare path has made the other bright.
const TOO_FAR_APART: f64 = 2.0;

/// What is known at a point in one channel, in W/m^2: the reflected radiosities of two values, which are equal where only one was taken, and
/// by how much the replicates find them too bright.
pub(super) struct Compared {
    pub values: [f64; 2],
    pub residuals: [f64; REPLICATES],
}

impl Compared {
    pub fn value(&self) -> f64 {
        0.5 * (self.values[0] + self.values[1])
    }

    /// Half the square of the difference of both values: the variance of one.
    pub fn variance(&self) -> f64 {
        0.5 * (self.values[0] - self.values[1]).powi(2)
    }

    /// The true light.
    pub fn truths(&self) -> [f64; REPLICATES] {
        self.residuals.map(|residual| self.value() - residual)
    }
}

/// What values are judged by.
#[derive(Clone, Copy)]
pub(super) struct Judging<'a> {
    pub scene: &'a Scene,
    /// Whether values are taken twice: over cells, where replicates find residuals.
    pub is_taken_twice: bool,
}

impl<'a> Judging<'a> {
    /// Of values that are gathered so.
    pub fn of(gather: &Gather<'a>) -> Self {
        Self { scene: gather.scene, is_taken_twice: matches!(gather.over, Over::Cells(_)) }
    }

    /// The channels in which the error is judged: those of all light groups together.
    pub fn channels(&self) -> Range<usize> {
        0..self.scene.deciding()
    }
}

/// What is known at a point, in these channels one by one.
pub(super) fn compared<'a>(
    sample: &'a ErrorSample,
    judging: Judging<'a>,
    values: &'a [Gathered; 2],
    channels: Range<usize>,
) -> impl Iterator<Item = Compared> + 'a {
    let material = judging.scene.material_of(sample.place.surface);
    let finds_residual = judging.is_taken_twice;
    channels.map(move |channel| {
        let values = [0, 1].map(|half: usize| values[half].radiosity[channel] - material.exitance[channel]);
        let value = 0.5 * (values[0] + values[1]);
        let residuals = sample.found.each_ref().map(|found| {
            let found = material.reflectance[channel] * found[channel];
            if finds_residual { found } else { value - found }
        });
        Compared { values, residuals }
    })
}

/// The same budget with other random numbers.
pub(super) fn by_other_rays(budget: RayBudget) -> RayBudget {
    RayBudget { seed: sampling::hash(budget.seed, streams::VALUES_AGAIN), ..budget }
}

/// The values that `gather` gives at `places` with a budget, one by one; `None` if stopped before.
pub(super) fn values_at(places: &[Place], gather: &Gather<'_>, budget: RayBudget, stop: Stop<'_>) -> Option<Vec<Gathered>> {
    let share = gather.share();
    let value = |scratch: &mut Scratch, (number, place): (usize, &Place)| {
        if stop() {
            return None;
        }
        let mut value = Gathered::default();
        if share.has(number) {
            let place = place_at(place.point, place.surface, budget.seed);
            gather.values_at(&[place], budget, scratch, &mut value);
        }
        Some(value)
    };
    let mut values: Vec<Gathered> = places.par_iter().enumerate().map_init(Scratch::default, value).collect::<Option<_>>()?;
    share.exchange(&mut values);
    Some(values)
}

/// A point that stands for so much area, as norms see it: the light there is what values tell, as far as replicates do not contradict.
pub(super) fn lit(area: f64, channels: impl Iterator<Item = Compared>, judging: Judging<'_>) -> Lit {
    let channels: Vec<Compared> = channels.collect();
    let (mut by_replicates, mut variance, mut noise_sq) = (0.0, 0.0, 0.0);
    let mut truth = PairProducts::default();
    for compared in &channels {
        let (mean, of_mean) = mean_and_variance(compared.truths());
        by_replicates += mean * mean;
        variance += of_mean;
        truth.add(1.0, compared.truths());
        noise_sq += 0.5 * compared.variance();
    }
    let norm = |of: fn(&Compared) -> f64| channels.iter().map(|compared| of(compared).powi(2)).sum::<f64>().sqrt();
    let (by_replicates, slack) = (by_replicates.sqrt(), LIGHT_SIGMAS * variance.sqrt());
    let light = norm(Compared::value).max(by_replicates - slack).min(by_replicates + slack);
    let [first, second] = [norm(|of| of.values[0]), norm(|of| of.values[1])];
    let is_too_far = first.max(second) > TOO_FAR_APART * first.min(second);
    let by_smaller = if is_too_far { first.min(second).min(light) } else { light };
    // Over cells truths are told by values, and have the noise of these.
    let light_sq = truth.all - if judging.is_taken_twice { noise_sq } else { 0.0 };
    Lit { by_smaller, light_sq, ..Lit::of(area, light) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    #[test]
    fn what_a_rare_path_makes_bright_is_not_relative_to_itself() {
        let square = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![material], vec![(square, 0, 0)], Sides::Front).unwrap();
        let judging = Judging { scene: &scene, is_taken_twice: true };
        let of_values = |values: [f64; 2]| {
            let Lit { light, by_smaller, .. } = lit(1.0, [Compared { values, residuals: [0.0; REPLICATES] }].into_iter(), judging);
            [light, by_smaller]
        };
        assert_eq!(of_values([1.0, 1.5]), [1.25, 1.25]);
        assert_eq!(of_values([1.0, 9.0]), [5.0, 1.0]);
        assert_eq!(of_values([9.0, 0.0]), [4.5, 0.0]);
    }
}
