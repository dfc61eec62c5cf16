//! What a cluster lets through: tau(rho, theta), the directional transmittance, and the two terms that tell how coarse that is.
//!
//! With tau(rho, theta) the transmittance of a cluster along the line `x cos theta + y sin theta = rho`, rho from the middle of its box
//! (Soler and Sillion 1996, sections 2.3 and 8.1):
//!
//! ```text
//! mean(theta) = 1/D(theta) Integral tau(rho, theta) drho        over the D(theta) metres of lines that meet the box
//! rho_1(theta, delta) = sup over |theta' - theta| <= delta of || tau(., theta') - tau(., theta) ||        (R_1 in the paper)
//! rho_2(theta)        = || tau(., theta) - mean(theta) ||                                                 (R_2)
//! ```
//!
//! in L2. Segments are opaque, so tau is 0 or 1, `rho_1^2` the length by which two shadows differ, and `rho_2^2 = D mean (1 - mean)`.
//!
//! **What the paper leaves open**, and how it is closed:
//! - Section 8.1 stores R_1 as a function of theta, but it depends on delta as well. It is stored for deltas that double, and the next larger one is taken.
//! - The supremum is over all directions, samples are not. Here it is bounded: over each cell of directions, what is covered somewhere and what is covered
//!   everywhere hold the shadow of each direction between them (`shadow`). Theta alone is a sample, and the shadow there exact.
//! - R_1 depends on where rho is measured from. The middle of the box makes it small, and the cluster's own.
//! - In section 2.3 `L n C != 0` must mean the box, or the mean would be 0: footnote 2, by which a cluster is its contents, is for section 5.

use std::f64::consts::PI;

use glam::DVec2;

use super::shadow::Shadow;

/// The directional transmittance of a cluster, and both terms, at directions that divide pi evenly.
#[derive(Clone, Debug)]
pub struct DirectionalTransmittance {
    half_box: DVec2,
    samples: Vec<Sample>,
}

/// What is stored for one direction.
#[derive(Clone, Debug)]
struct Sample {
    mean: f64,
    /// Squares of rho_1 for the widths of [`reach`].
    rho_1_sq: Vec<f64>,
}

/// A cluster as it is seen in about one direction: the constant that stands for its transmittance, and how far off that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The directional transmittance, from 0 to 1.
    pub mean: f64,
    /// A bound of R_1, in sqrt(m).
    pub rho_1: f64,
    /// R_2, in sqrt(m), over all that the box covers in some direction of the spread.
    pub rho_2: f64,
}

/// Cells on either side of a sample that its width of number `level` reaches: 0, 1, 2, 4, ...
fn reach(level: usize) -> usize {
    (1 << level) >> 1
}

impl DirectionalTransmittance {
    /// Of segments by their ends, about the middle of their box, which is `2 half_box` wide and high.
    pub(super) fn of(segments: &[[DVec2; 2]], half_box: DVec2, directions: usize) -> Self {
        let cell = PI / directions as f64;
        let bound = |j: usize| Shadow::over(segments, [j as f64 * cell, (j + 1) as f64 * cell]);
        let around: Vec<[Shadow; 2]> = (0..2 * directions).map(bound).collect();
        let sample = |k: usize| {
            let theta = (k as f64 + 0.5) * cell;
            let shadow = Shadow::at(segments, DVec2::from_angle(theta));
            let covered = shadow.length();
            let differs = |j: usize| {
                let [somewhere, everywhere] = &around[j % around.len()];
                somewhere.length() - somewhere.overlap(&shadow) + covered - everywhere.overlap(&shadow)
            };

            // Outwards, cell by cell on both sides, as far as sightlines turn: by a right angle, from any place in the sample's cell.
            let (mut rho_1_sq, mut most, farthest) = (Vec::new(), 0.0_f64, directions / 2 + 1);
            for distance in 0..=farthest {
                most = most.max(differs(k + distance)).max(differs(k + around.len() - distance));
                if distance == reach(rho_1_sq.len()) || distance == farthest {
                    rho_1_sq.push(most);
                }
            }
            let width = width(half_box, theta);
            Sample { mean: if width > 0.0 { (1.0 - covered / width).clamp(0.0, 1.0) } else { 1.0 }, rho_1_sq }
        };
        Self { half_box, samples: (0..directions).map(sample).collect() }
    }

    /// The directional transmittance at the sample next to a direction, and bounds of both terms over all directions within `spread` of `theta`.
    ///
    /// Theta is the angle of the lines' normal, in radians. The spread is from 0 to pi/2, within which all lines have a normal.
    pub fn around(&self, theta: f64, spread: f64) -> Resolution {
        let count = self.samples.len();
        let cell = PI / count as f64;
        let nearest = (theta.rem_euclid(PI) / cell) as usize % count;
        let centre = (nearest as f64 + 0.5) * cell;
        let aside = (theta.rem_euclid(PI) - centre).abs();
        let sample = &self.samples[nearest];

        // A level that reaches n cells holds whatever is within n + 1/2 of the sample.
        let cells = (aside + spread) / cell - 0.5;
        let is_enough = |level: &usize| reach(*level) as f64 >= cells;
        let level = (0..sample.rho_1_sq.len()).find(is_enough).unwrap_or(sample.rho_1_sq.len() - 1);

        // Where the box is wider in other directions than in that of the sample, its lines miss it in the latter, and tau is 1.
        let (mean, here) = (sample.mean, width(self.half_box, centre));
        let wider = (widest(self.half_box, [theta - spread, theta + spread]) - here).max(0.0);
        let rho_2_sq = here * mean * (1.0 - mean) + wider * (1.0 - mean).powi(2);
        Resolution { mean, rho_1: sample.rho_1_sq[level].sqrt(), rho_2: rho_2_sq.sqrt() }
    }
}

/// D(theta): how wide the shadow of a box is.
fn width(half_box: DVec2, theta: f64) -> f64 {
    2.0 * half_box.dot(DVec2::from_angle(theta).abs())
}

/// The most of that in a range of directions.
fn widest(half_box: DVec2, [low, high]: [f64; 2]) -> f64 {
    // It is widest across a diagonal, and of one rise and one fall between the axes.
    let diagonal = half_box.y.atan2(half_box.x);
    let across = [diagonal, -diagonal].into_iter().filter(|angle| (angle - low).rem_euclid(PI) <= high - low);
    across.chain([low, high]).map(|theta| width(half_box, theta)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Three bars in a box of 2 by 2 whose middle is the origin.
    const BARS: [[DVec2; 2]; 3] = [
        [DVec2::new(-1.0, 1.0), DVec2::new(-0.5, 1.0)],
        [DVec2::new(0.0, 0.0), DVec2::new(0.5, 0.0)],
        [DVec2::new(1.0, -1.0), DVec2::new(0.8, -0.2)],
    ];

    #[test]
    fn the_mean_is_the_part_of_the_box_that_is_not_covered() {
        let found = DirectionalTransmittance::of(&BARS, DVec2::ONE, 90);
        // Lines with a normal about along x are vertical: 1.2 of 2 m are covered.
        let resolution = found.around(0.0, 0.0);
        let theta = 0.5 * PI / 90.0;
        let width = 2.0 * (theta.cos() + theta.sin());
        let covered = 1.0 * theta.cos() + (0.2 * theta.cos() - 0.8 * theta.sin());
        assert!((resolution.mean - (1.0 - covered / width)).abs() < 1e-14);
        let rho_2 = (width * resolution.mean * (1.0 - resolution.mean)).sqrt();
        assert!((resolution.rho_2 - rho_2).abs() < 1e-14);
    }

    #[test]
    fn rho_1_bounds_what_shadows_differ_by_and_is_near_it() {
        let (count, found) = (180, DirectionalTransmittance::of(&BARS, DVec2::ONE, 180));
        for k in 0..count {
            let centre = (k as f64 + 0.5) * PI / count as f64;
            let here = Shadow::at(&BARS, DVec2::from_angle(centre));
            for spread in [0.001, 0.02, 0.3, FRAC_PI_2] {
                let bound = found.around(centre, spread).rho_1;
                let differs = |step: i32| {
                    let other = Shadow::at(&BARS, DVec2::from_angle(centre + spread * f64::from(step) / 200.0));
                    (here.length() + other.length() - 2.0 * here.overlap(&other)).max(0.0).sqrt()
                };
                let most = (-200..=200).map(differs).fold(0.0, f64::max);
                assert!(most <= bound + 1e-12, "{most} exceeds {bound}");
                // Deltas double, so shadows may move by twice as much and a cell more.
                let is_narrow = spread < 0.1;
                assert!(!is_narrow || bound.powi(2) <= 8.0 * (3.0 * spread + 2.0 * PI / count as f64), "{bound} for {spread}");
            }
        }
    }

    #[test]
    fn the_box_is_widest_across_a_diagonal() {
        let half_box = DVec2::new(1.0, 0.3);
        for (low, high) in [(0.0, 0.1), (0.1, 0.5), (-0.5, -0.1), (1.0, 2.0), (2.5, 3.2), (0.0, PI)] {
            let sampled = (0..=1000).map(|k| width(half_box, low + (high - low) * f64::from(k) / 1000.0)).fold(0.0, f64::max);
            let found = widest(half_box, [low, high]);
            assert!(found >= sampled - 1e-12 && found < sampled + 1e-5, "{found}, {sampled}");
        }
    }
}
