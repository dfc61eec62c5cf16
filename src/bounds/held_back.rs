//! What pairs without a link hold back at most.
//!
//! With the links as they are, B solves `B = E + rho K B`. Let K' be what pairs without a link would add. Then the whole answer
//! exceeds B by `e = (I - rho (K + K'))^-1 rho K' B`, and as no scene reflects more than it receives (the form factors of any point add
//! up to 1 at most),
//!
//! ```text
//! Integral of e <= 1 / (1 - rho_max) Integral of rho K' B
//! Integral over r of K' B from s <= min(A_r F_rs max B_s, F_sr Integral of B_s)      F the largest from any point, nothing in between
//! ```
//!
//! Of two clusters F is bounded by boxes and by cones of normals. What may carry most is taken apart, and bounded by the theorem for
//! polygons, until so much work is done.

use rayon::prelude::*;

use super::worst_first::{Light, Looked, Waiting, WorstFirst};
use crate::links::Pair;

/// So much is done to tell closely: a pair that is taken apart is one, polygons that are bounded are [`OF_POLYGONS`].
const MOST_WORK: usize = 1 << 15;
const OF_POLYGONS: usize = 1024;

/// The most that all surfaces together radiate less because of `pairs` without a link, in W, all channels added: proved for `light`,
/// what the links carry, up to what sweeps would still change.
pub(crate) fn bound_held_back(light: Light<'_>, pairs: &[Pair]) -> f64 {
    let mut waiting = WorstFirst::new(light, pairs.par_iter().with_min_len(256).copied());
    let (mut settled, mut work) = (0.0, 0);
    while work < MOST_WORK {
        match waiting.look() {
            Some(Looked::TakenApart) => work += 1,
            Some(Looked::Polygons(Waiting { pair, .. })) => {
                settled += waiting.power_of_polygons(pair);
                work += OF_POLYGONS;
            }
            None => break,
        }
    }
    let rounding = 1.0 + f64::EPSILON * (pairs.len() + MOST_WORK) as f64;
    (settled + waiting.into_rest().map(|waiting| waiting.power).sum::<f64>()) * rounding
}
