//! What replicates have in common at all points: the noise of their cells.
//!
//! It does not average out over the points, so the scatter between these does not show it. It shows when one replicate is left out (the jackknife
//! over replicates), beyond what the noise of rays at single points does to that. What cells bring comes from a whole hemisphere, so it is much
//! the same at points that lie near each other and face the same way. Means over such neighbourhoods have it too, and less of the noise of rays,
//! which would hide it, or be taken for it.

use std::ops::Range;

use glam::DVec3;

use super::compared::{Judging, compared};
use super::estimate::ErrorSamples;
use super::pairs::PairProducts;
use super::replicates::{ErrorSample, REPLICATES};

/// Points of a neighbourhood, at most. Of some hundred points at least, so many times fewer neighbourhoods still tell one part of a scene from
/// another.
const MOST_POINTS: usize = 8;

/// What a mean square is at least, it is found larger than by so many deviations: Student's t with seven degrees of freedom, 97.5%.
const SURE: f64 = 2.36;
const _: () = assert!(REPLICATES - 1 == 7);

/// Adds what the replicates found at a point, by channel, with the root of its weight.
trait Visit: Fn(usize, &mut dyn FnMut(usize, f64, [f64; REPLICATES])) {}
impl<V: Fn(usize, &mut dyn FnMut(usize, f64, [f64; REPLICATES]))> Visit for V {}

/// Where a point lies, and which way it faces.
type Coordinates = [f64; 6];

impl ErrorSamples {
    /// The variance of the measured square by what replicates have in common from neighbourhood to neighbourhood of points; `weights` are of squares.
    pub(super) fn common_variance(&self, judging: Judging<'_>, weights: &[f64], channels: Range<usize>) -> f64 {
        let coordinates = self.coordinates(judging);
        variance_between(&neighbourhoods(&coordinates), |index, add| {
            let residuals = compared(&self.samples[index], judging, &self.values[index], channels.clone());
            residuals.enumerate().for_each(|(channel, compared)| add(channel, weights[index].sqrt(), compared.residuals));
        })
    }

    /// The root mean square of what cells on unresolved surfaces make values wrong by, as far as that is alike at points of a neighbourhood: at least so
    /// much, to [`SURE`]. `weights` are of squares.
    pub(super) fn least_by_unresolved(&self, judging: Judging<'_>, weights: &[f64], channels: Range<usize>) -> f64 {
        let mut all = PairProducts::default();
        for points in neighbourhoods(&self.coordinates(judging)) {
            all.add_all(&square_of_mean(&points, &|index: usize, add: &mut dyn FnMut(usize, f64, [f64; REPLICATES])| {
                let sample = &self.samples[index];
                let reflectance = &judging.scene.material_of(sample.place.surface).reflectance;
                for (number, channel) in channels.clone().enumerate() {
                    let found = sample.of_unresolved.each_ref().map(|found| reflectance[channel] * found[channel]);
                    add(number, weights[index].sqrt(), found);
                }
            }));
        }
        at_least(&all)
    }

    /// Of each point. Two that face opposite ways are twice as far apart as a point is from the middle of all, on average.
    fn coordinates(&self, judging: Judging<'_>) -> Vec<Coordinates> {
        let count = self.samples.len() as f64;
        let middle = self.samples.iter().map(|sample| sample.place.point).sum::<DVec3>() / count;
        let spread_sq = self.samples.iter().map(|sample| sample.place.point.distance_squared(middle)).sum::<f64>() / count;
        let coordinates = |sample: &ErrorSample| {
            let facing = judging.scene.surface(sample.place.surface).polygon.normal().map(|component| spread_sq.sqrt() * component);
            let DVec3 { x, y, z } = sample.place.point;
            [x, y, z, facing[0], facing[1], facing[2]]
        };
        self.samples.iter().map(coordinates).collect()
    }
}

/// Neighbourhoods of points, each by their numbers: the points are halved across where they extend farthest, until few are left.
fn neighbourhoods(coordinates: &[Coordinates]) -> Vec<Vec<usize>> {
    let mut found = Vec::new();
    let mut left = vec![(0..coordinates.len()).collect::<Vec<usize>>()];
    while let Some(mut points) = left.pop() {
        if points.len() <= MOST_POINTS {
            found.push(points);
            continue;
        }
        let along = |axis: usize| points.iter().map(move |&point| coordinates[point][axis]);
        let extent = |axis: usize| along(axis).fold(f64::MIN, f64::max) - along(axis).fold(f64::MAX, f64::min);
        let axis = (0..6).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |&a, &b| coordinates[a][axis].total_cmp(&coordinates[b][axis]).then(a.cmp(&b)));
        left.push(points.split_off(middle));
        left.push(points);
    }
    found
}

/// The variance over draws of the replicates of the sum of squares of what neighbourhoods have on average, less what each of them has by itself.
/// `visit` adds what the replicates found at a point, by channel, with the root of its weight.
fn variance_between(neighbourhoods: &[Vec<usize>], visit: impl Visit) -> f64 {
    let (mut all, mut by_themselves) = (PairProducts::default(), 0.0);
    for points in neighbourhoods {
        let products = square_of_mean(points, &visit);
        by_themselves += products.variance();
        all.add_all(&products);
    }
    (all.variance() - by_themselves).max(0.0)
}

/// What the root of a mean square is at least.
fn at_least(square: &PairProducts) -> f64 {
    (square.all - SURE * square.variance().sqrt()).max(0.0).sqrt()
}

/// The square of the mean over the points of a neighbourhood, times as many as they are.
fn square_of_mean(points: &[usize], visit: &impl Visit) -> PairProducts {
    // The sums over its points: their square, over how many there are.
    let mut sums: Vec<[f64; REPLICATES]> = Vec::new();
    for &point in points {
        visit(point, &mut |channel, root_weight, found| {
            sums.resize(sums.len().max(channel + 1), [0.0; REPLICATES]);
            sums[channel].iter_mut().zip(found).for_each(|(sum, found)| *sum += root_weight * found);
        });
    }
    let mut products = PairProducts::default();
    sums.into_iter().for_each(|found| products.add(1.0 / points.len() as f64, found));
    products
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling::{hash, unit};

    const POINTS: usize = 512;

    /// A square floor and a ceiling over it, 1 m above.
    fn coordinates() -> Vec<Coordinates> {
        let point = |index: u64| {
            let facing = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
            [unit(hash(1, index)), unit(hash(2, index)), 0.5 - 0.5 * facing, 0.0, 0.0, facing]
        };
        (0..POINTS as u64).map(point).collect()
    }

    /// About normal, with variance 1.
    fn normal(seed: u64) -> f64 {
        (0..12).map(|k| unit(hash(seed, k))).sum::<f64>() - 6.0
    }

    #[test]
    fn neighbours_are_near_each_other_and_face_the_same_way() {
        let coordinates = coordinates();
        let found = neighbourhoods(&coordinates);
        let mut all = found.concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..POINTS) && found.len() == POINTS / MOST_POINTS);
        for points in found {
            let first = coordinates[points[0]];
            assert!(points.iter().all(|&point| coordinates[point][5] == first[5]));
            // 32 of them cover 1 m^2.
            assert!(
                points.iter().all(|&point| [0, 1].iter().all(|&axis: &usize| (coordinates[point][axis] - first[axis]).abs() < 0.5))
            );
        }
    }

    /// The variance that is found over trials, the true one, and that of the sum over points by the noise of rays, each the mean over trials.
    fn trials(common: f64, noise: f64) -> [f64; 3] {
        const TRIALS: u64 = 2_000;
        let (coordinates, off) = (coordinates(), 0.01);
        let neighbourhoods = neighbourhoods(&coordinates);
        let (mut sum, mut sum_sq, mut found, mut of_rays) = (0.0, 0.0, 0.0, 0.0);
        for trial in 0..TRIALS {
            // Values are off by the same everywhere; each replicate has a slope over the floor, and noise of its own at each point.
            let slopes: [f64; REPLICATES] = std::array::from_fn(|k| common * normal(hash(trial, k as u64)));
            let residuals = |point: usize| {
                let noise_of = |k: usize| noise * normal(hash(hash(trial, point as u64), 100 + k as u64));
                std::array::from_fn(|k| off + slopes[k] * (0.5 + coordinates[point][0]) + noise_of(k))
            };
            let (mut all, mut by_points) = (PairProducts::default(), 0.0);
            for point in 0..POINTS {
                let mut products = PairProducts::default();
                products.add(1.0 / POINTS as f64, residuals(point));
                by_points += products.variance();
                all.add_all(&products);
            }
            (sum, sum_sq, of_rays) = (sum + all.all, sum_sq + all.all * all.all, of_rays + by_points);
            found += variance_between(&neighbourhoods, |point, add| add(0, (POINTS as f64).sqrt().recip(), residuals(point)));
        }
        let mean = sum / TRIALS as f64;
        [found / TRIALS as f64, sum_sq / TRIALS as f64 - mean * mean, of_rays / TRIALS as f64]
    }

    #[test]
    fn what_is_common_is_found_and_noise_of_rays_is_not_taken_for_it() {
        // By the noise of cells alone all of the variance is in common.
        let [found, variance, _] = trials(0.005, 0.0);
        assert!((found / variance - 1.0).abs() < 0.15, "{found} for {variance}");

        // By the noise of rays alone nothing is.
        let [found, _, of_rays] = trials(0.0, 0.05);
        assert!(found < 0.1 * of_rays, "{found} for {of_rays}");
    }

    #[test]
    fn what_is_alike_nearby_is_at_least_as_large_as_is_told() {
        const TRIALS: u64 = 4_000;
        let neighbourhoods = neighbourhoods(&coordinates());
        let (off, mut told, mut too_large) = (0.01, 0.0, 0);
        for trial in 0..TRIALS {
            let mut all = PairProducts::default();
            for points in &neighbourhoods {
                all.add_all(&square_of_mean(points, &|point: usize, add: &mut dyn FnMut(usize, f64, [f64; REPLICATES])| {
                    let noise_of = |k: usize| 0.05 * normal(hash(hash(trial, point as u64), k as u64));
                    add(0, (POINTS as f64).sqrt().recip(), std::array::from_fn(|k| off + noise_of(k)));
                }));
            }
            told += at_least(&all) / TRIALS as f64;
            too_large += u32::from(at_least(&all) > off);
        }
        // Noise of a point is five times what is to be told.
        assert!(told > 0.5 * off && f64::from(too_large) < 0.04 * TRIALS as f64, "{told}, {too_large} too large");
    }
}
