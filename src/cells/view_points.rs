//! View points: where in a cell next-event estimation starts.
//!
//! The radiosity of a cell should be that of the part that others see: the rest may lie beneath a box or behind a lampshade. Points
//! where paths arrive lie in that part. So next-event rays start from some of these points, chosen evenly among them: the more, the more
//! finely cells are found, since direct light may vary over a cell by any factor.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::geometry::sampling;

/// Next-event rays of each view point: each takes the form factors of emitters at the point, which one ray alone would not be worth. Empirical.
const RAYS_OF_VIEW_POINT: usize = 4;

/// A cell has so many view points, where it has as many paths. Empirical.
const LEAST_VIEW_POINTS: usize = 4;

/// How many view points go with so many paths.
pub(super) fn view_point_count(paths: usize) -> usize {
    (paths / RAYS_OF_VIEW_POINT).max(paths.clamp(1, LEAST_VIEW_POINTS))
}

/// Bytes of the view points of a cell with so many paths.
pub(super) fn bytes_of_view_points(paths: usize) -> usize {
    size_of::<Box<[[f32; 2]]>>() + view_point_count(paths) * size_of::<[f32; 2]>()
}

/// A point of a cell where a path arrived.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Arrival {
    pub cell: u32,
    /// Coordinates within the cell, each in [0, 1].
    pub at: [f32; 2],
    /// In proportion to the light that the path brings if all surfaces are equally bright: the area of the cell where it starts.
    pub weight: f32,
}

/// The `count` view points of each of so many cells, by coordinates within the cell: drawn from its arrivals by weight, by systematic sampling along
/// the Morton curve through the cell. None where nothing arrives.
pub(super) fn view_points(cells: usize, count: usize, arrivals: Vec<Vec<Arrival>>, seed: u64) -> Vec<Box<[[f32; 2]]>> {
    // The arrivals of each cell, one cell after the other.
    let all = || arrivals.iter().flatten();
    let mut starts = vec![0_u32; cells + 1];
    all().for_each(|arrival| starts[arrival.cell as usize + 1] += 1);
    for cell in 0..cells {
        starts[cell + 1] += starts[cell];
    }
    let mut order = vec![([0.0_f32; 2], 0.0_f32); starts[cells] as usize];
    let mut next = starts.clone();
    for arrival in all() {
        let place = &mut next[arrival.cell as usize];
        order[*place as usize] = (arrival.at, arrival.weight);
        *place += 1;
    }
    drop(arrivals);

    // Their order along the curve, and the draws.
    let along_curve = |at: [f32; 2]| {
        let [column, row] = at.map(|along| ((along * 65536.0) as u32).min(65535));
        sampling::along_curve(column, row)
    };
    let of_cell = |cell: usize| {
        let mut arrivals = order[starts[cell] as usize..starts[cell + 1] as usize].to_vec();
        arrivals.sort_by_key(|(at, _)| along_curve(*at));
        let total: f32 = arrivals.iter().map(|(_, weight)| weight).sum();
        let start = sampling::unit(sampling::hash(seed, cell as u64)) as f32;
        let Some(&(_, mut above)) = arrivals.first() else { return Box::default() };
        let mut number = 0;
        let draw = |point: usize| {
            let wanted = (point as f32 + start) / count as f32 * total;
            while above < wanted && number + 1 < arrivals.len() {
                number += 1;
                above += arrivals[number].1;
            }
            arrivals[number].0
        };
        (0..count).map(draw).collect()
    };
    (0..cells).into_par_iter().with_min_len(256).map(of_cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrivals in the left half of a cell, eight times as many in its lower quarter: view points lie where they are, and by their
    /// weight.
    #[test]
    fn view_points_lie_among_arrivals_by_their_weight() {
        let random = |seed: u64| sampling::unit(sampling::hash(3, seed)) as f32;
        let arrival = |number: u64| {
            let is_low = number % 9 < 8;
            let at = [0.5 * random(2 * number), 0.5 * (random(2 * number + 1) + if is_low { 0.0 } else { 1.0 })];
            Arrival { cell: 1, at, weight: if is_low { 1.0 } else { 24.0 } }
        };
        let arrivals: Vec<Vec<Arrival>> = (0..10).map(|batch| (90 * batch..90 * (batch + 1)).map(arrival).collect()).collect();
        let mut low = 0;
        let seeds = 200;
        for seed in 0..seeds {
            let view_points = view_points(3, 4, arrivals.clone(), seed);
            assert!(view_points[0].is_empty() && view_points[2].is_empty());
            let view_points = &view_points[1];
            assert!(view_points.len() == 4 && view_points.iter().all(|at| at[0] < 0.5));
            let in_low = view_points.iter().filter(|at| at[1] < 0.5).count();
            // A quarter of the weight is of the low ones: one of four view points, give or take what rounding does.
            assert!(in_low <= 2, "{view_points:?}");
            low += in_low;
        }
        assert!((low as f64 / seeds as f64 - 1.0).abs() < 0.05, "{low} of {}", 4 * seeds);
    }
}
