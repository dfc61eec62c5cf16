//! Spots: where in their cells aimed rays start.
//!
//! What a cell sends is what others see of it, and these may see but a part: the rest lies beneath a box, or behind a lamp's shade. Where
//! paths arrive tells which; so rays to lamps start from spots among the points where paths have arrived, as far apart as these are.

use rayon::prelude::*;

use crate::geometry::sampling;

/// Spots in a cell.
pub(super) const SPOTS: usize = 4;

/// A point of a cell where a path arrived.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub cell: u32,
    /// In the unit square over the cell.
    pub at: [f32; 2],
    /// The part of all light that the path stands for, if all were of one brightness.
    pub weight: f32,
}

/// The spots of each of `cells` among its views, in the unit square over the cell: drawn by weight, systematically along a curve that
/// fills the cell. `None` where nothing arrives.
pub(super) fn spots(cells: usize, views: &[Vec<View>], seed: u64) -> Vec<Option<[[f32; 2]; SPOTS]>> {
    // The views of each cell, one cell after the other.
    let all = || views.iter().flatten();
    let mut starts = vec![0_u32; cells + 1];
    all().for_each(|view| starts[view.cell as usize + 1] += 1);
    for cell in 0..cells {
        starts[cell + 1] += starts[cell];
    }
    let mut order = vec![([0.0_f32; 2], 0.0_f32); starts[cells] as usize];
    let mut next = starts.clone();
    for view in all() {
        let place = &mut next[view.cell as usize];
        order[*place as usize] = (view.at, view.weight);
        *place += 1;
    }

    let along_curve = |at: [f32; 2]| {
        let [column, row] = at.map(|along| ((along * 65536.0) as u32).min(65535));
        sampling::along_curve(column, row)
    };
    let of_cell = |cell: usize| {
        let mut views = order[starts[cell] as usize..starts[cell + 1] as usize].to_vec();
        views.sort_by_key(|(at, _)| along_curve(*at));
        let total: f32 = views.iter().map(|(_, weight)| weight).sum();
        let start = sampling::unit(sampling::hash(seed, cell as u64)) as f32;
        let (mut number, mut above) = (0, views.first()?.1);
        Some(std::array::from_fn(|spot| {
            let wanted = (spot as f32 + start) / SPOTS as f32 * total;
            while above < wanted && number + 1 < views.len() {
                number += 1;
                above += views[number].1;
            }
            views[number].0
        }))
    };
    (0..cells).into_par_iter().with_min_len(256).map(of_cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Views in the left half of a cell, eight times as many in its lower quarter: spots lie where they are, and by their weight.
    #[test]
    fn spots_lie_among_views_by_their_weight() {
        let random = |seed: u64| sampling::unit(sampling::hash(3, seed)) as f32;
        let view = |number: u64| {
            let is_low = number % 9 < 8;
            let at = [0.5 * random(2 * number), 0.5 * (random(2 * number + 1) + if is_low { 0.0 } else { 1.0 })];
            View { cell: 1, at, weight: if is_low { 1.0 } else { 24.0 } }
        };
        let views: Vec<Vec<View>> = (0..10).map(|batch| (90 * batch..90 * (batch + 1)).map(view).collect()).collect();
        let mut low = 0;
        let seeds = 200;
        for seed in 0..seeds {
            let spots = spots(3, &views, seed);
            assert!(spots[0].is_none() && spots[2].is_none());
            let spots = spots[1].unwrap();
            assert!(spots.iter().all(|at| at[0] < 0.5));
            let in_low = spots.iter().filter(|at| at[1] < 0.5).count();
            // A quarter of the weight is of the low ones: one of four spots, give or take what rounding does.
            assert!(in_low <= 2, "{spots:?}");
            low += in_low;
        }
        assert!((low as f64 / seeds as f64 - 1.0).abs() < 0.05, "{low} of {}", 4 * seeds);
    }
}
