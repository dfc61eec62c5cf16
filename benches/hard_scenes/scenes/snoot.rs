//! A lamp deep in a tube.

use super::super::path_tracer::Portal;
use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, closed_room, light, matt, sides, solid};

/// Middle of the tube, half its inner side, its walls, and the heights of its mouth and its lamp.
const MIDDLE: f64 = 2.0;
const HALF: f64 = 0.05;
const WALL: f64 = 0.002;
const MOUTH: f64 = 2.5;
const LAMP: f64 = 2.9;

/// A tube hangs in a room of 4 x 4 x 3 m, white inside, with a lamp at its upper end.
pub fn snoot() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 3.0]);
    let (inside, outside) = (matt(&mut room, "tube_inside", [0.85, 0.84, 0.82]), matt(&mut room, "tube_outside", [0.3, 0.3, 0.32]));
    let (lamp, object) = (light(&mut room, 20_000.0), matt(&mut room, "object", [0.6, 0.5, 0.4]));
    let square = |half: f64, at: f64| Rectangle { axis: 2, at, low: [MIDDLE - half; 2], high: [MIDDLE + half; 2] };
    square(HALF, LAMP).add_to(&mut room, false, lamp);
    square(HALF, MOUTH).reveals(&mut room, LAMP, inside);
    let outer = HALF + WALL;
    for (side, is_far) in sides([MIDDLE - outer, MIDDLE - outer, MOUTH], [MIDDLE + outer, MIDDLE + outer, LAMP + WALL]) {
        let is_mouth = side.axis == 2 && !is_far;
        let pieces = if is_mouth { side.around(square(HALF, MOUTH)).to_vec() } else { vec![side] };
        pieces.into_iter().for_each(|piece| piece.add_to(&mut room, is_far, outside));
    }
    solid(&mut room, [2.2, 1.2, 0.0], [2.8, 1.8, 0.6], object);

    let mouth = Portal { corner: [MIDDLE - HALF, MIDDLE - HALF, MOUTH], u: [0.0, 2.0 * HALF, 0.0], v: [2.0 * HALF, 0.0, 0.0] };
    Made::of(room).through(mouth)
}
