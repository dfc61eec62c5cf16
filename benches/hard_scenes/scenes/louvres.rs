//! A room behind louvres.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, light, matt, plaster, sides, solid};

const SLATS: u32 = 41;
const SPACING: f64 = 0.05;
/// Depth and rise of a slat.
const SLAT: [f64; 2] = [0.04, 0.03];

/// A room of 5 x 4 x 3 m. A bright panel stands 30 cm outside its window, slats hang in it.
pub fn louvres() -> Made {
    let mut room = Room::default();
    let [floor, wall, ceiling] = plaster(&mut room);
    let (slat, lamp) = (matt(&mut room, "slat", [0.75, 0.74, 0.7]), light(&mut room, 200.0));
    let window = Rectangle { axis: 0, at: 0.0, low: [0.8, 0.5], high: [3.2, 2.6] };
    for (side, is_far) in sides([0.0; 3], [5.0, 4.0, 3.0]) {
        let material = if side.axis < 2 { wall } else { [floor, ceiling][usize::from(is_far)] };
        let pieces = if side.axis == 0 && !is_far { side.around(window).to_vec() } else { vec![side] };
        pieces.into_iter().for_each(|piece| piece.add_to(&mut room, !is_far, material));
    }
    let outside = Rectangle { at: -0.3, ..window };
    outside.add_to(&mut room, true, lamp);
    outside.reveals(&mut room, 0.0, wall);

    // The slats fall towards the room.
    let [y_low, y_high] = [window.low[0], window.high[0]];
    for k in 0..SLATS {
        let (x, z) = (-0.1, 0.52 + SPACING * f64::from(k));
        let (inner_x, upper_z) = (x + SLAT[0], z + SLAT[1]);
        room.sheet(&[[x, y_low, upper_z], [inner_x, y_low, z], [inner_x, y_high, z], [x, y_high, upper_z]], slat);
    }
    let table = matt(&mut room, "table", [0.5, 0.4, 0.28]);
    solid(&mut room, [2.0, 1.2, 0.7], [3.4, 2.6, 0.75], table);
    Made::of(room)
}
