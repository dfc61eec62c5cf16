//! A dark room behind a slit.

use super::super::path_tracer::Portal;
use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, matt, panel, plaster, sides, solid};

/// The wall between the rooms, and the slit in it: its middle, its width, its height.
const WALL: f64 = 0.1;
const MIDDLE: f64 = 1.3;
const WIDTH: f64 = 0.05;
const HEIGHT: [f64; 2] = [0.02, 2.48];

/// Two rooms of 3 x 3 x 2.5 m; one is lit, in the other there are shelves, and only a slit in the wall between them lets light in.
pub fn slit() -> Made {
    let mut room = Room::default();
    let [floor, wall, ceiling] = plaster(&mut room);
    let slit = Rectangle { axis: 0, at: 3.0, low: [MIDDLE - 0.5 * WIDTH, HEIGHT[0]], high: [MIDDLE + 0.5 * WIDTH, HEIGHT[1]] };
    for (k, x) in [0.0, 3.0 + WALL].into_iter().enumerate() {
        for (side, is_far) in sides([x, 0.0, 0.0], [x + 3.0, 3.0, 2.5]) {
            let material = if side.axis < 2 { wall } else { [floor, ceiling][usize::from(is_far)] };
            let has_slit = side.axis == 0 && is_far == (k == 0);
            let pieces = if has_slit { side.around(slit).to_vec() } else { vec![side] };
            pieces.into_iter().for_each(|piece| piece.add_to(&mut room, !is_far, material));
        }
    }
    slit.reveals(&mut room, 3.0 + WALL, wall);
    panel(&mut room, [1.0, 1.5], [0.6, 0.4], 2.48, 100.0);
    let wood = matt(&mut room, "wood", [0.6, 0.48, 0.36]);
    for (x, y) in [(3.6, 0.4), (4.8, 2.0)] {
        for k in 0..5 {
            let z = 0.1 + 0.3 * f64::from(k);
            solid(&mut room, [x, y, z], [x + 0.8, y + 0.5, z + 0.02], wood);
        }
    }

    let [low, high] = [slit.low, slit.high];
    Made::of(room).through(Portal {
        corner: [3.0 + WALL, low[0], low[1]],
        u: [0.0, high[0] - low[0], 0.0],
        v: [0.0, 0.0, high[1] - low[1]],
    })
}
