//! Noisy values at nodes, fitted to those around them as far as light is smooth.
//!
//! Around each node quadratic functions are found that are nearest to the values of more and more nodes (local regression, Cleveland and Devlin 1988). The
//! more nodes, the less noise, and the more may light differ from such a function. What each is off at a node follows without bias from what it is off the
//! node's own value, from the noise of that, and from what that has in it (Stein 1981); the mean over nodes near by tells the fits apart. Of all fits, and
//! of the value as it was found, the node takes the mean, weighted by the exponential of what they are off (Leung and Barron 2006): where two are equally
//! good there is no step from one to the other, which would show as a crease. Nodes beyond a step are not near: they are not joined.
//!
//! All nodes count alike: weights by their variances would favour the dark ones, which seem to have less noise.

use glam::DVec2;
use rayon::prelude::*;

use super::bisection::{Triangle, Triangles};

/// Coefficients of a quadratic function.
const TERMS: usize = 6;

/// Fits are made to so many nodes: twice what tells the coefficients, then twice as many each time, for half of the variance. With the last the noise
/// is about a quarter.
const COUNTS: [usize; 4] = [12, 24, 48, 96];

/// The value as it was found, and the fits.
const CHOICES: usize = COUNTS.len() + 1;

/// So many nodes tell the fits apart: as many as a fit of middle size has.
const POOLED: usize = COUNTS[1];

/// The weight of an estimate is the exponential of what squares it is off in all, over so many times the variance of a value: the least for which the mean
/// is proven to be about as good as the best of them.
const TEMPERATURE: f64 = 4.0;

/// Pivots below this part of the largest mean that nodes do not tell all coefficients.
const SINGULAR: f64 = 1e-9;

/// Nodes are looked for until there are so many times as many as wanted: those that are nearest by edges are not all the nearest.
const LOOKED_FOR: usize = 2;

/// Bytes that a node takes while it is fitted.
pub(super) const fn bytes_of_node(channels: usize) -> usize {
    size_of::<Estimates>() + CHOICES * channels * size_of::<[f32; 2]>()
}

/// The values of nodes with their variances, by node and channel, fitted; so many channels decide, of so many in all.
pub(super) fn fitted(triangles: &Triangles, found: &[[f32; 2]], [deciding, channels]: [usize; 2]) -> Vec<[f32; 2]> {
    // All fits of each node.
    let patches = Patches::new(triangles);
    let estimates_of = |scratch: &mut Scratch, node: usize| patches.estimates(node as u32, found, [deciding, channels], scratch);
    let nodes = (0..triangles.nodes.len()).into_par_iter();
    let estimates: Vec<(Estimates, Vec<[f32; 2]>)> = nodes.map_init(|| Scratch::new(triangles), estimates_of).collect();

    // Their mean, by how good they are around it.
    let mut fitted = found.to_vec();
    fitted.par_chunks_mut(channels).enumerate().for_each(|(node, values)| {
        let (of_node, by_choice) = &estimates[node];
        let Some(weights) = of_node.weights(|other| &estimates[other as usize].0) else { return };
        for (channel, value) in values.iter_mut().enumerate() {
            // Fits share most of their nodes, so their noise adds up.
            let (mut mean, mut deviation) = (0.0, 0.0);
            for (weight, of_choice) in weights.iter().zip(by_choice.chunks(channels)) {
                let [estimate, variance] = of_choice[channel].map(f64::from);
                mean += weight * estimate;
                deviation += weight * variance.sqrt();
            }
            *value = [mean as f32, (deviation * deviation) as f32];
        }
    });
    fitted
}

/// How good the estimates of a node are.
#[derive(Clone, Copy, Debug)]
struct Estimates {
    /// The nodes near by that tell it, and how many there are.
    near: [u32; POOLED],
    pooled: usize,
    /// The variance of values there, channels added.
    noise_sq: f32,
    /// What squares each is off at the node, without bias, channels added; infinite where there is no such fit.
    off_sq: [f32; CHOICES],
}

impl Estimates {
    /// The weights of the estimates in their mean; `None` where there is nothing but the value as it was found, or no noise.
    fn weights<'a>(&self, of: impl Fn(u32) -> &'a Self) -> Option<[f64; CHOICES]> {
        let near = &self.near[..self.pooled];
        let is_there = |choice: usize| self.off_sq[choice].is_finite();
        let noise_sq: f64 = near.iter().map(|&node| f64::from(of(node).noise_sq)).sum::<f64>() / near.len().max(1) as f64;
        if noise_sq <= 0.0 || !(1..CHOICES).any(is_there) {
            return None;
        }

        // Sums over nodes near by, as many for all: fits that some of them lack are told by the others.
        let off_sq = std::array::from_fn::<f64, CHOICES, _>(|choice| {
            let found = || near.iter().map(|&node| f64::from(of(node).off_sq[choice])).filter(|off_sq| off_sq.is_finite());
            if is_there(choice) { found().sum::<f64>() * near.len() as f64 / found().count() as f64 } else { f64::INFINITY }
        });
        let least = off_sq.into_iter().fold(f64::INFINITY, f64::min);
        let weights = off_sq.map(|off_sq| (-(off_sq - least) / (TEMPERATURE * noise_sq)).exp());
        let sum: f64 = weights.iter().sum();
        Some(weights.map(|weight| weight / sum))
    }
}

/// Which nodes are joined by triangles.
struct Patches<'a> {
    triangles: &'a Triangles,
    /// Where the triangles of each node begin, and one more.
    starts: Vec<u32>,
    around: Vec<u32>,
}

/// Memory that is reused from node to node.
struct Scratch {
    /// By node and triangle: the node for which it was last met.
    node_met: Vec<u32>,
    triangle_met: Vec<u32>,
    /// Nodes with the squares of their distances.
    near: Vec<(f64, u32)>,
}

impl Scratch {
    fn new(triangles: &Triangles) -> Self {
        let (nodes, triangles) = (triangles.nodes.len(), triangles.triangles.len());
        Self { node_met: vec![u32::MAX; nodes], triangle_met: vec![u32::MAX; triangles], near: Vec::new() }
    }
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

    /// Where the value of a node is taken.
    fn at(&self, node: u32) -> DVec2 {
        self.triangles.nodes[node as usize].sampled_at
    }

    /// The nodes nearest to one that are joined with it, and the squares of their distances, ascending: itself, and `count` others if there are so many.
    fn nearest<'b>(&self, node: u32, count: usize, scratch: &'b mut Scratch) -> &'b [(f64, u32)] {
        // Ring by ring.
        let Scratch { node_met, triangle_met, near } = scratch;
        near.clear();
        near.push((0.0, node));
        node_met[node as usize] = node;
        let mut next = 0;
        while next < near.len() && near.len() <= LOOKED_FOR * count {
            let ring = next..near.len();
            next = near.len();
            for number in ring {
                let (_, from) = near[number];
                for &triangle in &self.around[self.starts[from as usize] as usize..self.starts[from as usize + 1] as usize] {
                    if std::mem::replace(&mut triangle_met[triangle as usize], node) == node {
                        continue;
                    }
                    for other in self.triangles.triangles[triangle as usize].nodes() {
                        if std::mem::replace(&mut node_met[other as usize], node) != node {
                            near.push((self.at(node).distance_squared(self.at(other)), other));
                        }
                    }
                }
            }
        }

        // The nearest of them.
        let by_distance = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if near.len() > count + 1 {
            near.select_nth_unstable_by(count, by_distance);
            near.truncate(count + 1);
        }
        near.sort_unstable_by(by_distance);
        near
    }

    /// What the value of a node is by itself and by all fits, by channel with its variance, and how good these are.
    fn estimates(
        &self,
        node: u32,
        found: &[[f32; 2]],
        [deciding, channels]: [usize; 2],
        scratch: &mut Scratch,
    ) -> (Estimates, Vec<[f32; 2]>) {
        let near = self.nearest(node, COUNTS[COUNTS.len() - 1], scratch);
        let of = |node: u32, channel: usize| found[node as usize * channels + channel].map(f64::from);

        // Variances of single values are noisy.
        let pooled = near.len().min(POOLED);
        let noise = |channel: usize| near[..pooled].iter().map(|&(_, other)| of(other, channel)[1]).sum::<f64>() / pooled as f64;
        let noise: Vec<f64> = (0..channels).map(noise).collect();
        let noise_sq: f64 = noise[..deciding].iter().sum();
        let mut off_sq = [f32::INFINITY; CHOICES];
        off_sq[0] = noise_sq as f32;
        let mut estimates = vec![[0.0; 2]; CHOICES * channels];
        estimates[..channels].copy_from_slice(&found[node as usize * channels..][..channels]);

        for (choice, &count) in (1..).zip(&COUNTS) {
            let Some(weights) = self.weights_of_fit(near, count) else { continue };
            let mut sum_sq = 0.0;
            for (channel, noise) in noise.iter().enumerate() {
                let (mut estimate, mut variance) = (0.0, 0.0);
                for (weight, &(_, other)) in weights.iter().zip(near) {
                    let [value, noise] = of(other, channel);
                    estimate += weight * value;
                    variance += weight * weight * noise;
                }
                estimates[choice * channels + channel] = [estimate as f32, variance as f32];
                if channel < deciding {
                    sum_sq += (estimate - of(node, channel)[0]).powi(2) + (2.0 * weights[0] - 1.0) * noise;
                }
            }
            off_sq[choice] = sum_sq as f32;
        }
        let mut pool = [0; POOLED];
        pool.iter_mut().zip(near).for_each(|(pooled, &(_, other))| *pooled = other);
        (Estimates { near: pool, pooled, noise_sq: noise_sq as f32, off_sq }, estimates)
    }

    /// What the values of the `count` nearest nodes have in the quadratic function that is fitted to them, at the first of them. They count less the farther
    /// they are, as far as the next (Epanechnikov 1969), so that none comes in with a jump. `None` if there are too few, or they lie so that they do
    /// not tell all coefficients.
    fn weights_of_fit(&self, near: &[(f64, u32)], count: usize) -> Option<Vec<f64>> {
        let (&(_, node), &(reach_sq, _)) = (near.first()?, near.get(count)?);
        let reach = reach_sq.sqrt();
        let terms_at = |&(_, other): &(f64, u32)| {
            let DVec2 { x, y } = (self.at(other) - self.at(node)) / reach;
            [1.0, x, y, x * x, x * y, y * y]
        };
        let terms: Vec<[f64; TERMS]> = near[..count].iter().map(terms_at).collect();
        let counts: Vec<f64> = near[..count].iter().map(|(distance_sq, _)| 1.0 - distance_sq / reach_sq).collect();
        let mut normal = [[0.0; TERMS]; TERMS];
        for (of, counts) in terms.iter().zip(&counts) {
            for (row, sums) in normal.iter_mut().enumerate() {
                sums[..=row].iter_mut().zip(of).for_each(|(sum, term)| *sum += counts * of[row] * term);
            }
        }
        let lower = cholesky(normal)?;
        let mut first = [0.0; TERMS];
        first[0] = 1.0;
        let of_value = solved(&lower, first);
        let weight =
            |(of, counts): (&[f64; TERMS], &f64)| counts * of.iter().zip(of_value).map(|(term, of)| term * of).sum::<f64>();
        Some(terms.iter().zip(&counts).map(weight).collect())
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
        triangulate(&[DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y], &[], 2e-3, 0.0)
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
        assert!((before / NOISE - 1.0).abs() < 0.1 && after < 0.4 * NOISE, "{before} {after}");
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
