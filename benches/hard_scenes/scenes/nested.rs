//! Boxes in boxes.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, closed_room, matt, panel, sides};

const BOXES: u32 = 6;
const WALL: f64 = 0.01;
/// Side of the outermost box, and how much smaller each next one is.
const SIDE: f64 = 2.0;
const SHRINKS: f64 = 0.74;
/// Side of an opening, as a part of the box's side.
const OPENING: f64 = 0.8;

/// Six boxes one in another in a room of 4 x 4 x 3 m, each with an opening in another side than the one around it.
pub fn nested_boxes() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 3.0]);
    panel(&mut room, [2.0, 2.0], [0.8, 0.8], 2.95, 100.0);
    let card = matt(&mut room, "card", [0.75, 0.7, 0.62]);
    for k in 0..BOXES {
        let half = 0.5 * SIDE * SHRINKS.powi(k as i32);
        open_box(&mut room, [2.0, 2.0, 1.3], half, [5, 3, 1, 2, 0, 4][k as usize], card);
    }
    Made::of(room)
}

/// A cube with walls, open in the middle of one of its sides.
fn open_box(room: &mut Room, middle: [f64; 3], half: f64, open: usize, material: u32) {
    for (inset, is_outer) in [(0.0, true), (WALL, false)] {
        let reach = half - inset;
        let walls = sides(middle.map(|x| x - reach), middle.map(|x| x + reach));
        for (number, (side, is_far)) in walls.into_iter().enumerate() {
            let hole = opening(side, middle, half);
            let pieces = if number == open { side.around(hole).to_vec() } else { vec![side] };
            pieces.into_iter().for_each(|piece| piece.add_to(room, is_far == is_outer, material));
            if number == open && is_far != is_outer {
                // Of the two sheets of this wall the one that is nearer along the axis.
                hole.reveals(room, side.at + WALL, material);
            }
        }
    }
}

/// The opening in a side.
fn opening(side: Rectangle, middle: [f64; 3], half: f64) -> Rectangle {
    let reach = OPENING * half;
    let centre = [middle[(side.axis + 1) % 3], middle[(side.axis + 2) % 3]];
    Rectangle { low: centre.map(|x| x - reach), high: centre.map(|x| x + reach), ..side }
}
