//! A dark room that a hole lights.

use super::super::path_tracer::Portal;
use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, matt, panel, plaster, sides, solid};

/// The wall between the rooms, and the middle of the hole in it.
const WALL: f64 = 0.01;
const MIDDLE: [f64; 2] = [1.5, 1.2];

/// A white chamber with a lamp of 3 x 3 x 2.5 m, and a dark room of 4 x 3 x 2.5 m behind its wall, which has a square hole of this side.
pub fn pinhole(side: f64) -> Made {
    let [low, high] = [-0.5, 0.5].map(|half| MIDDLE.map(|middle| middle + half * side));
    let hole = Rectangle { axis: 0, at: -WALL, low, high };
    let mut room = Room::default();
    let white = matt(&mut room, "chamber", [0.9, 0.89, 0.87]);
    let [floor, wall, ceiling] = plaster(&mut room);
    for (side, is_far) in sides([-3.0 - WALL, 0.0, 0.0], [-WALL, 3.0, 2.5]) {
        add_side(&mut room, (side, is_far), (side.axis == 0 && is_far).then_some(hole), white);
    }
    for (side, is_far) in sides([0.0; 3], [4.0, 3.0, 2.5]) {
        let material = if side.axis < 2 { wall } else { [floor, ceiling][usize::from(is_far)] };
        add_side(&mut room, (side, is_far), (side.axis == 0 && !is_far).then_some(hole), material);
    }
    hole.reveals(&mut room, 0.0, wall);
    panel(&mut room, [-1.5, 1.5], [1.0, 1.0], 2.45, 100.0);
    let object = matt(&mut room, "object", [0.6, 0.5, 0.4]);
    solid(&mut room, [1.5, 1.0, 0.0], [2.1, 1.6, 0.8], object);

    Made::of(room).through(Portal { corner: [0.0, low[0], low[1]], u: [0.0, side, 0.0], v: [0.0, 0.0, side] })
}

/// A side of a room, seen from within.
fn add_side(room: &mut Room, (side, is_far): (Rectangle, bool), hole: Option<Rectangle>, material: u32) {
    let pieces = hole.map_or_else(|| vec![side], |hole| side.around(hole).to_vec());
    pieces.into_iter().for_each(|piece| piece.add_to(room, !is_far, material));
}
