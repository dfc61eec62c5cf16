//! Noisy values at nodes, fitted to those around them where light is smooth.
//!
//! Around each node the quadratic function is found that is nearest to the values of nodes near by (local regression, Cleveland and Devlin 1988). If what is
//! left is no more than their noise explains, there is nothing but noise to tell the node from the function, and it takes its value there: its variance
//! falls to a small part. If not, fewer nodes are taken, and at last the node stays as it was found. Nodes beyond a step are not near: they are not joined.
//!
//! All nodes count alike: weights by their variances would favour the dark ones, which seem to have less noise.

use glam::DVec2;
use rayon::prelude::*;

use super::bisection::{Triangle, Triangles};

/// Coefficients of a quadratic function.
const TERMS: usize = 6;

/// So many more nodes than coefficients tell whether a function fits.
const SPARE: usize = 6;

/// What is left may be larger than its expectation by so many standard deviations.
const SIGNIFICANT: f64 = 1.0;

/// Pivots below this part of the largest mean that nodes do not tell all coefficients.
const SINGULAR: f64 = 1e-9;

/// Which nodes are joined by triangles.
struct Patches<'a> {
    triangles: &'a Triangles,
    /// Where the triangles of each node begin, and one more.
    starts: Vec<u32>,
    around: Vec<u32>,
}

/// The values of nodes with their variances, by node and channel, fitted; so many channels decide, of so many in all.
pub(super) fn fitted(triangles: &Triangles, found: &[[f32; 2]], [deciding, channels]: [usize; 2]) -> Vec<[f32; 2]> {
    let patches = Patches::new(triangles);
    let mut fitted = found.to_vec();
    fitted.par_chunks_mut(channels).enumerate().for_each(|(node, values)| {
        let near = patches.grown(&[node as u32]);
        let far = patches.grown(&near);
        let fits = |patch: Vec<u32>| {
            let fit = Fit::new(triangles, node as u32, &patch)?;
            fit.explains(found, &patch, [deciding, channels]).then_some((patch, fit))
        };
        let Some((patch, fit)) = fits(far).or_else(|| fits(near)) else { return };
        for (channel, value) in values.iter_mut().enumerate() {
            let (mut sum, mut variance) = (0.0, 0.0);
            for (&other, [weight, ..]) in patch.iter().zip(&fit.weights) {
                let [b, noise] = found[other as usize * channels + channel].map(f64::from);
                sum += weight * b;
                variance += weight * weight * noise;
            }
            *value = [sum as f32, variance as f32];
        }
    });
    fitted
}

impl<'a> Patches<'a> {
    fn new(triangles: &'a Triangles) -> Self {
        let mut starts = vec![0; triangles.nodes.len() + 1];
        let nodes = || triangles.triangles.iter().map(Triangle::nodes).enumerate();
        nodes().flat_map(|(_, nodes)| nodes).for_each(|node| starts[node as usize + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let mut next = starts.clone();
        let mut around = vec![0; starts.last().map_or(0, |&count| count as usize)];
        for (triangle, nodes) in nodes() {
            for node in nodes {
                around[next[node as usize] as usize] = triangle as u32;
                next[node as usize] += 1;
            }
        }
        Self { triangles, starts, around }
    }

    /// All nodes of the triangles that some nodes belong to, ascending.
    fn grown(&self, nodes: &[u32]) -> Vec<u32> {
        let around = |&node: &u32| &self.around[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize];
        let mut triangles: Vec<u32> = nodes.iter().flat_map(around).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        let mut grown: Vec<u32> =
            triangles.into_iter().flat_map(|triangle| self.triangles.triangles[triangle as usize].nodes()).collect();
        grown.sort_unstable();
        grown.dedup();
        grown
    }
}

/// How values on a patch make the quadratic function that is nearest to them.
struct Fit {
    /// By node of the patch: the terms of the function there. They are about the node that is fitted.
    terms: Vec<[f64; TERMS]>,
    /// By node of the patch: what its value has in each coefficient. The first is the function at the node that is fitted.
    weights: Vec<[f64; TERMS]>,
}

impl Fit {
    /// `None` if a patch has too few nodes, or they lie so that they do not tell all coefficients.
    fn new(triangles: &Triangles, node: u32, patch: &[u32]) -> Option<Self> {
        if patch.len() < TERMS + SPARE {
            return None;
        }
        let at = |node: u32| triangles.nodes[node as usize].sampled_at;
        let reach = patch.iter().map(|&other| at(other).distance(at(node))).fold(0.0, f64::max);
        let terms_at = |&other: &u32| {
            let DVec2 { x, y } = (at(other) - at(node)) / reach;
            [1.0, x, y, x * x, x * y, y * y]
        };
        let terms: Vec<[f64; TERMS]> = patch.iter().map(terms_at).collect();
        let mut normal = [[0.0; TERMS]; TERMS];
        for of in &terms {
            for (row, sums) in normal.iter_mut().enumerate() {
                sums.iter_mut().zip(of).for_each(|(sum, term)| *sum += of[row] * term);
            }
        }
        let lower = cholesky(normal)?;
        let weights = terms.iter().map(|of| solved(&lower, *of)).collect();
        Some(Self { terms, weights })
    }

    /// Whether what the values of a patch are off the function is no more than their noise.
    fn explains(&self, found: &[[f32; 2]], patch: &[u32], [deciding, channels]: [usize; 2]) -> bool {
        let (mut left, mut noise) = (0.0, 0.0);
        for channel in 0..deciding {
            let value = |node: u32| found[node as usize * channels + channel].map(f64::from);
            let mut coefficients = [0.0; TERMS];
            for (&node, weights) in patch.iter().zip(&self.weights) {
                let [b, variance] = value(node);
                coefficients.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * b);
                noise += variance;
            }
            for (&node, terms) in patch.iter().zip(&self.terms) {
                let function: f64 = terms.iter().zip(coefficients).map(|(term, coefficient)| term * coefficient).sum();
                left += (value(node)[0] - function).powi(2);
            }
        }
        let free = (patch.len() - TERMS) as f64;
        left <= noise * free / patch.len() as f64 * (1.0 + SIGNIFICANT * (2.0 / free).sqrt())
    }
}

/// The lower triangle whose product with its transpose a matrix is.
fn cholesky(matrix: [[f64; TERMS]; TERMS]) -> Option<[[f64; TERMS]; TERMS]> {
    let mut lower = [[0.0; TERMS]; TERMS];
    for row in 0..TERMS {
        for column in 0..=row {
            let sum: f64 = (0..column).map(|k| lower[row][k] * lower[column][k]).sum();
            let rest = matrix[row][column] - sum;
            if row > column {
                lower[row][column] = rest / lower[column][column];
            } else if rest > SINGULAR * matrix[0][0] {
                lower[row][row] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(lower)
}

/// What the product of a lower triangle and its transpose takes to `right`.
fn solved(lower: &[[f64; TERMS]; TERMS], mut right: [f64; TERMS]) -> [f64; TERMS] {
    for row in 0..TERMS {
        let sum: f64 = (0..row).map(|k| lower[row][k] * right[k]).sum();
        right[row] = (right[row] - sum) / lower[row][row];
    }
    for row in (0..TERMS).rev() {
        let sum: f64 = (row + 1..TERMS).map(|k| lower[k][row] * right[k]).sum();
        right[row] = (right[row] - sum) / lower[row][row];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;
    use crate::mesh::triangulation::triangulate;

    const NOISE: f64 = 0.02;

    fn triangles() -> Triangles {
        triangulate(&[DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y], &[], 2e-3)
    }

    /// Values of a function with uniform noise of this variance, in one channel.
    fn noisy(triangles: &Triangles, function: impl Fn(DVec2) -> f64) -> Vec<[f32; 2]> {
        let off = |number: u64| NOISE * 12.0_f64.sqrt() * (sampling::unit(sampling::hash(3, number)) - 0.5);
        let of_node = |(number, at): (u64, DVec2)| [(function(at) + off(number)) as f32, (NOISE * NOISE) as f32];
        (0..).zip(triangles.nodes.iter().map(|node| node.sampled_at)).map(of_node).collect()
    }

    fn rms_off(triangles: &Triangles, values: &[[f32; 2]], function: impl Fn(DVec2) -> f64) -> f64 {
        let off = |(at, value): (DVec2, f32)| (f64::from(value) - function(at)).powi(2);
        let nodes = triangles.nodes.iter().map(|node| node.sampled_at);
        (nodes.zip(values.iter().map(|of| of[0])).map(off).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn noise_of_smooth_light_falls_to_a_part_that_variances_tell() {
        let (all, smooth) = (triangles(), |at: DVec2| 1.0 + 0.5 * at.x - 0.3 * at.y + 0.4 * (2.0 * at.x * at.y).sin());
        let found = noisy(&all, smooth);
        let fitted = fitted(&all, &found, [1, 1]);
        let (before, after) = (rms_off(&all, &found, smooth), rms_off(&all, &fitted, smooth));
        let told = (fitted.iter().map(|of| f64::from(of[1])).sum::<f64>() / fitted.len() as f64).sqrt();
        assert!((before / NOISE - 1.0).abs() < 0.1 && after < 0.6 * NOISE, "{before} {after}");
        assert!((after / told - 1.0).abs() < 0.25, "{after} {told}");
    }

    #[test]
    fn what_is_more_than_noise_stays() {
        // A ridge of twenty times the noise, as narrow as an element: what is beside it loses its noise, it keeps its height.
        let (all, ridge) = (triangles(), |at: DVec2| 1.0 + 20.0 * NOISE * (-((at.x - 0.5) / 0.03).powi(2)).exp());
        let found = noisy(&all, ridge);
        let fitted = fitted(&all, &found, [1, 1]);
        assert!(rms_off(&all, &fitted, ridge) < rms_off(&all, &found, ridge));
        for (node, value) in all.nodes.iter().zip(&fitted) {
            assert!((f64::from(value[0]) - ridge(node.sampled_at)).abs() < 3.0 * NOISE, "{} {}", node.at, value[0]);
        }
    }

    #[test]
    fn without_noise_nothing_changes_but_by_rounding() {
        let (all, square) = (triangles(), |at: DVec2| 1.0 - at.x + at.x * at.y);
        let found: Vec<[f32; 2]> =
            noisy(&all, square).iter().zip(&all.nodes).map(|(_, n)| [square(n.sampled_at) as f32, 0.0]).collect();
        let fitted = fitted(&all, &found, [1, 1]);
        assert!(rms_off(&all, &fitted, square) < 1e-6);
    }
}
