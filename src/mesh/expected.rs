//! How much of the squared error each element is expected to have.
//!
//! A test's squared difference, less its noise, says that without bias, but a single one may be mostly noise. If it is clearly more than noise, it is
//! believed. Of all others one is only known together with those in elements that are as large against the distance of what is seen from there:
//! the larger, the less an element can follow the light, as in the split sphere model of Ward, Rubinstein and Clear (1988). So they get the mean of
//! their like, which is found as the best function that does not fall with that size (isotonic regression).

use super::growing::{Growing, Test};
use super::judged::Norm;

/// A difference is one of the function if its square is so many times its variance.
const SIGNIFICANT: f64 = 4.0;

/// A test, and the squared error that is expected where it was taken.
struct Expected<'a> {
    /// The number of the surface among those that grow.
    number: usize,
    test: &'a Test,
    /// The part of its element that it stands for, in m^2 or pixels.
    part: f64,
    /// In the norm, by m^2 or pixel; below 0 where noise is.
    error_sq: f64,
}

/// The expected squared errors of elements, in the norm: those that are more than 0, with the number of the surface among those that grow and of
/// the triangle; the largest first. And how large the squared error of the whole is, without bias but for what would be less than 0.
pub(super) fn expected_errors_sq(all: &[Growing], norm: &Norm) -> (Vec<(f64, usize, u32)>, f64) {
    let (tests, whole) = expected(all, norm);

    // Element by element.
    let mut sums = zeros(all);
    tests.iter().for_each(|of| sums[of.number][of.test.triangle as usize] += of.part * of.error_sq);
    let of_surface = |(number, sums): (usize, &Vec<f64>)| {
        let parts = sums.iter().enumerate().filter(|(_, sum)| **sum > 0.0);
        parts.map(|(triangle, &sum)| (sum, number, triangle as u32)).collect::<Vec<_>>()
    };
    let mut parts: Vec<_> = sums.iter().enumerate().flat_map(of_surface).collect();
    parts.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    (parts, whole.max(0.0))
}

/// The expected squared errors of the function in the mean over each element, noise of its nodes included, channels added, in W^2/m^4: by surface
/// and triangle, 0 in those that do not count.
pub(super) fn mean_errors_sq(all: &[Growing], norm: &Norm) -> Vec<Vec<f64>> {
    let mut means = zeros(all);
    for Expected { number, test, part, error_sq } in expected(all, norm).0 {
        let here = error_sq.max(0.0) / norm.weight(test.light_sq) + test.of_nodes_sq;
        means[number][test.triangle as usize] += part / all[number].weight(test.triangle) * here;
    }
    means
}

/// A number for each triangle of surfaces.
fn zeros(all: &[Growing]) -> Vec<Vec<f64>> {
    all.iter().map(|of| vec![0.0; of.is_tested.len()]).collect()
}

/// What is expected where each test was taken, and the squared error of the whole, without bias.
fn expected<'a>(all: &'a [Growing], norm: &Norm) -> (Vec<Expected<'a>>, f64) {
    // The part of its element that each test stands for, and what it says by m^2 or pixel.
    let mut tests: Vec<Expected<'_>> = Vec::new();
    for (number, of) in all.iter().enumerate() {
        let mut counts = vec![0_u32; of.is_tested.len()];
        of.tests.iter().for_each(|test| counts[test.triangle as usize] += 1);
        tests.extend(of.tests.iter().map(|test| {
            let part = of.weight(test.triangle) / f64::from(counts[test.triangle as usize]);
            Expected { number, test, part, error_sq: norm.weight(test.light_sq) * (test.difference_sq - test.noise_sq) }
        }));
    }
    let whole = tests.iter().map(|of| of.part * of.error_sq).sum();

    // Where it says little, what its like say.
    let is_clear = |test: &Test| test.difference_sq > SIGNIFICANT * test.noise_sq;
    let mut unclear: Vec<usize> = (0..tests.len()).filter(|&number| !is_clear(tests[number].test)).collect();
    unclear.sort_by(|&a, &b| tests[a].test.relative_size.total_cmp(&tests[b].test.relative_size).then(a.cmp(&b)));
    let of_unclear: Vec<[f64; 2]> = unclear.iter().map(|&number| [tests[number].error_sq, tests[number].part]).collect();
    unclear.iter().zip(isotonic(&of_unclear)).for_each(|(&number, mean)| tests[number].error_sq = mean);
    (tests, whole)
}

/// The function that does not fall and is nearest to values with weights, in their order: pool adjacent violators (Ayer et al. 1955).
fn isotonic(values: &[[f64; 2]]) -> impl Iterator<Item = f64> {
    // Pools of neighbours, each with its mean, its weight, and how many it holds.
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for &[value, weight] in values {
        let (mut mean, mut weight, mut count) = (value, weight, 1);
        while let Some(&(before, of_before, held)) = pools.last() {
            if before < mean {
                break;
            }
            mean = (before * of_before + mean * weight) / (of_before + weight);
            (weight, count) = (weight + of_before, count + held);
            pools.pop();
        }
        pools.push((mean, weight, count));
    }
    pools.into_iter().flat_map(|(mean, _, count)| std::iter::repeat_n(mean, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_falls_is_pooled() {
        let found: Vec<f64> = isotonic(&[[1.0, 1.0], [3.0, 1.0], [2.0, 3.0], [5.0, 1.0], [4.0, 1.0], [4.5, 2.0]]).collect();
        assert_eq!(found, [1.0, 2.25, 2.25, 4.5, 4.5, 4.5]);
        assert_eq!(isotonic(&[[2.0, 1.0], [1.0, 1.0], [0.0, 1.0]]).collect::<Vec<_>>(), [1.0; 3]);
    }
}
