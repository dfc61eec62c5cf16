//! Lamps that are small: very many, or one.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, closed_room, light, matt, sides, solid};

/// Lamps of a board along either side, how far apart they are, and their size.
const LAMPS: u32 = 50;
const SPACING: f64 = 0.02;
const SIZE: f64 = 0.005;
/// The height of lamps; boards are a millimetre above, the grid hangs below.
const HEIGHT: f64 = 2.7;
/// Cells of a grid along either side, and its height.
const CELLS: u32 = 10;
const GRID: [f64; 2] = [2.58, 2.68];

/// Four boards of 2500 lamps each under the ceiling of a room of 4 x 4 x 2.8 m, each behind a grid.
pub fn many() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 2.8]);
    let (lamp, board) = (light(&mut room, 4000.0), matt(&mut room, "board", [0.6, 0.6, 0.58]));
    for [x, y] in [[0.7, 0.7], [2.3, 0.7], [0.7, 2.3], [2.3, 2.3]] {
        for (side, is_far) in sides([x, y, HEIGHT + 0.001], [x + 1.0, y + 1.0, HEIGHT + 0.021]) {
            side.add_to(&mut room, is_far, board);
        }
        for k in 0..LAMPS * LAMPS {
            let at = |step: u32, from: f64| from + SPACING * (f64::from(step) + 0.5);
            let [a, b] = [at(k % LAMPS, x), at(k / LAMPS, y)];
            let half = 0.5 * SIZE;
            let square = Rectangle { axis: 2, at: HEIGHT, low: [a - half, b - half], high: [a + half, b + half] };
            square.add_to(&mut room, false, lamp);
        }
        for k in 0..=CELLS {
            let along = f64::from(k) / f64::from(CELLS);
            let slats = [
                Rectangle { axis: 0, at: x + along, low: [y, GRID[0]], high: [y + 1.0, GRID[1]] },
                Rectangle { axis: 1, at: y + along, low: [GRID[0], x], high: [GRID[1], x + 1.0] },
            ];
            for slat in slats {
                slat.add_sheet_to(&mut room, board);
            }
        }
    }
    let object = matt(&mut room, "object", [0.5, 0.4, 0.3]);
    solid(&mut room, [1.4, 1.2, 0.0], [2.4, 1.9, 0.8], object);
    Made::of(room)
}

/// A lamp of 1 cm^2 in a room of 5 x 4 x 3 m.
pub fn one() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [5.0, 4.0, 3.0]);
    let lamp = light(&mut room, 3e5);
    Rectangle { axis: 2, at: 2.4, low: [2.495, 1.995], high: [2.505, 2.005] }.add_to(&mut room, false, lamp);
    let object = matt(&mut room, "object", [0.6, 0.45, 0.35]);
    for (low, high) in [([1.0, 1.0, 0.0], [1.8, 1.6, 1.2]), ([3.2, 2.4, 0.0], [3.9, 3.1, 0.6]), ([2.2, 2.6, 1.2], [2.8, 2.9, 1.5])]
    {
        solid(&mut room, low, high, object);
    }
    Made::of(room)
}
