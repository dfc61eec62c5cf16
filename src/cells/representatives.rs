//! Representatives: which cell's radiosity is used for a cell that has no position, or none on the side that is seen.

use super::equations::Equations;
use super::positions::Cell;
use crate::paths::LightPaths;

/// For every cell the nearest one of its surface whose position lies inside a solid, or outside, as `inside` says: for most cells
/// itself. Inside, only direct neighbours count: beyond, the whole cell may be what is seen from inside.
pub(super) fn representatives(paths: &LightPaths<'_>, cells: &[Cell], equations: &Equations, inside: bool) -> Vec<u32> {
    let mut representative: Vec<u32> = (0..cells.len() as u32).collect();
    let most_steps = if inside { 1 } else { usize::MAX };
    for (_, grid) in paths.grids.grids() {
        let first = grid.first as usize;
        let serves = |cell: usize| matches!(cells[cell], Cell::Position(_)) && equations.is_inside(cell) == inside;
        let mut open: Vec<usize> = (first..first + grid.len()).filter(|&cell| !serves(cell)).collect();
        if open.is_empty() || open.len() == grid.len() {
            // All cells serve; or none does, and only rounding lets a path from that side end here.
            let any = (first..first + grid.len()).find(|&cell| matches!(cells[cell], Cell::Position(_))).unwrap_or(first);
            open.into_iter().filter(|&cell| matches!(cells[cell], Cell::Empty)).for_each(|cell| representative[cell] = any as u32);
            continue;
        }

        // Round by round, cells without a representative take that of a neighbour.
        let columns = grid.columns as usize;
        let mut is_open = vec![false; grid.len()];
        open.iter().for_each(|cell| is_open[cell - first] = true);
        let mut steps = 0;
        while !open.is_empty() && steps < most_steps {
            steps += 1;
            let found: Vec<(usize, u32)> = open
                .iter()
                .filter_map(|&cell| {
                    let (index, column) = (cell - first, (cell - first) % columns);
                    let left = (column > 0).then(|| index - 1);
                    let right = (column + 1 < columns).then_some(index + 1);
                    let (below, above) = (index.checked_sub(columns), (index + columns < grid.len()).then_some(index + columns));
                    let neighbours = [left, right, below, above].into_iter().flatten();
                    neighbours.into_iter().find(|&near| !is_open[near]).map(|near| (cell, representative[first + near]))
                })
                .collect();
            for &(cell, by) in &found {
                representative[cell] = by;
                is_open[cell - first] = false;
            }
            open.retain(|cell| is_open[cell - first]);
        }
    }
    representative
}
