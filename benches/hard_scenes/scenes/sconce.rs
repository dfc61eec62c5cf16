//! A lamp that shines on the wall it hangs on.

use super::super::path_tracer::Portal;
use super::super::rooms::Room;
use super::made::Made;
use super::parts::{closed_room, light, matt, sides, solid};

/// The lamp: its gap to the wall, its lower and upper corner, its thickness.
const GAP: f64 = 0.05;
const LOW: [f64; 2] = [1.8, 1.6];
const HIGH: [f64; 2] = [2.2, 1.9];
const THICKNESS: f64 = 0.04;

/// A room of 4 x 4 x 2.6 m with a table; a plate of 40 x 30 cm hangs 5 cm from a wall and shines on that.
pub fn sconce() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 2.6]);
    let (lamp, back) = (light(&mut room, 300.0), matt(&mut room, "back", [0.7, 0.69, 0.67]));
    for (side, is_far) in sides([GAP, LOW[0], LOW[1]], [GAP + THICKNESS, HIGH[0], HIGH[1]]) {
        side.add_to(&mut room, is_far, if side.axis == 0 && !is_far { lamp } else { back });
    }
    let wood = matt(&mut room, "wood", [0.6, 0.48, 0.36]);
    solid(&mut room, [1.6, 1.2, 0.7], [3.0, 2.0, 0.74], wood);
    for (x, y) in [(1.62, 1.22), (2.94, 1.22), (1.62, 1.94), (2.94, 1.94)] {
        solid(&mut room, [x, y, 0.0], [x + 0.04, y + 0.04, 0.7], wood);
    }

    // The wall is lit that far around the plate: by a source of its size at the distance of the plate.
    let [low, high] = [LOW.map(|low| low - 3.0 * GAP), HIGH.map(|high| high + 3.0 * GAP)];
    Made::of(room).through(Portal {
        corner: [0.0, low[0], low[1]],
        u: [0.0, high[0] - low[0], 0.0],
        v: [0.0, 0.0, high[1] - low[1]],
    })
}
