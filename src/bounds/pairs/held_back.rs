//! What pairs without a link hold back at most.
//!
//! With the links as they are, B solves `B = E + rho K B`. Let K' be what pairs without a link would add. Then the whole answer exceeds B
//! by `e = (I - rho (K + K'))^-1 rho K' B`. As the form factors of any point add up to 1 at most,
//!
//! ```text
//! Integral of e <= 1 / (1 - rho_max) Integral of rho K' B
//! Integral over r of K' B from s <= min(A_r F_rs max B_s, F_sr Integral of B_s)      F the largest from any point, nothing in between
//! ```
//!
//! F is bounded by boxes and by cones of normals. The pair that may carry most is split first; what comes down to polygons is bounded by
//! the theorem for these, until [`MOST_WORK`] is done.

use rayon::prelude::*;

use super::worst_first::{Light, Waiting, Worst, WorstFirst};
use crate::links::Pair;
use crate::progress::Stop;

/// The most work, in units of splitting a pair.
const MOST_WORK: usize = 1 << 15;

/// The work of bounding two polygons, in the same unit.
const WORK_OF_POLYGONS: usize = 1024;

/// The most that all surfaces together radiate less because `pairs` have no link, in W, all channels added. Proved, if sweeps over the
/// links would no longer change `light`. Once stopped, the bound is as wide as what
/// is known by then.
pub(crate) fn bound_held_back(light: Light<'_>, pairs: &[Pair], stop: Stop<'_>) -> f64 {
    if pairs.is_empty() {
        return 0.0;
    }
    let all = bound_all(light);
    if stop() {
        return all;
    }
    let mut waiting = WorstFirst::new(light, pairs.par_iter().with_min_len(256).copied().take_any_while(|_| !stop()));
    if stop() {
        return all;
    }
    let (mut settled, mut work) = (0.0, 0);
    while work < MOST_WORK && !stop() {
        match waiting.split_worst() {
            Some(Worst::Split) => work += 1,
            Some(Worst::Polygons(Waiting { pair, .. })) => {
                settled += waiting.power_of_polygons(pair);
                work += WORK_OF_POLYGONS;
            }
            None => break,
        }
    }
    let rounding = 1.0 + f64::EPSILON * (pairs.len() + MOST_WORK) as f64;
    all.min((settled + waiting.into_rest().map(|waiting| waiting.power).sum::<f64>()) * rounding)
}

/// The same, if nothing is known of the pairs: all that is sent arrives, and where it is reflected most.
fn bound_all(light: Light<'_>) -> f64 {
    let Light { scene, hierarchy, radiosity } = light;
    let channels = scene.channels();
    let of_channel = |channel: usize| {
        let highest = scene.materials().iter().map(|material| material.reflectance[channel]).fold(0.0, f64::max);
        let leaves = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node));
        let sent: f64 = leaves.map(|node| hierarchy.area(node) * radiosity[node.index() * channels + channel]).sum();
        highest / (1.0 - highest) * sent
    };
    let rounding = 1.0 + f64::EPSILON * hierarchy.len() as f64;
    (0..channels).map(of_channel).sum::<f64>() * rounding
}
