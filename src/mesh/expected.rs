//! How much of the squared error each element is expected to have.
//!
//! A test's squared difference, less its noise, says that without bias, but a single one may be mostly noise, or may have missed an edge of light. If it is
//! clearly more than noise, it is believed. Of all others one is only known together with those whose elements have as large a hierarchical surplus, by
//! which the elements' own nodes tell how far light is from linear there: they get the mean of their like, which is found as the best function that does
//! not fall with it (isotonic regression).

use super::bends::SIGNIFICANT;
use super::growing::{Growing, Test};
use super::judged::Norm;

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
        tests.extend(of.tests_with_parts().map(|(test, part)| Expected {
            number,
            test,
            part,
            error_sq: norm.weight(test.light_sq) * (test.difference_sq - test.noise_sq),
        }));
    }
    let whole = tests.iter().map(|of| of.part * of.error_sq).sum();

    // What its like say, all of them, where that is more or it says little.
    let surpluses: Vec<f64> =
        tests.iter().map(|of| norm.weight(of.test.light_sq) * all[of.number].surplus_sq(of.test.triangle)).collect();
    let mut order: Vec<usize> = (0..tests.len()).collect();
    order.sort_by(|&a, &b| surpluses[a].total_cmp(&surpluses[b]).then(a.cmp(&b)));
    let in_order: Vec<[f64; 2]> = order.iter().map(|&number| [tests[number].error_sq, tests[number].part]).collect();
    for (&number, mean) in order.iter().zip(isotonic(&in_order)) {
        let Expected { test, error_sq, .. } = &mut tests[number];
        let is_clear = test.difference_sq > SIGNIFICANT * test.noise_sq;
        *error_sq = if is_clear { error_sq.max(mean) } else { mean };
    }

    // As much in all as was found.
    let counted: f64 = tests.iter().map(|of| of.part * of.error_sq).sum();
    if whole > 0.0 {
        tests.iter_mut().for_each(|of| of.error_sq *= whole / counted);
    }
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
