//! A room behind vertical blinds.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, matt, plaster, sides, solid};

const SLATS: u32 = 35;
const SPACING: f64 = 0.085;
/// Half of the width of a slat, and its angle to the window.
const HALF_WIDTH: f64 = 0.045;
const TURNED_DEGREES: f64 = 25.0;

/// A room of 5 x 4 x 2.8 m. A panel of 7 x 6 m, which reflects half, shines 2 m outside its window; slats hang before that, closed but for a quarter.
pub fn blinds() -> Made {
    let mut room = Room::default();
    let [floor, wall, ceiling] = plaster(&mut room);
    let slat = matt(&mut room, "slat", [0.8, 0.79, 0.77]);
    let table = matt(&mut room, "table", [0.5, 0.4, 0.28]);
    behind_blinds(room, ([floor, wall, ceiling], slat, table), [0.5; 3])
}

/// The same, all of it white.
pub fn white_blinds() -> Made {
    const WHITE: [f64; 3] = [0.9, 0.882, 0.864];
    let mut room = Room::default();
    let white = matt(&mut room, "white", WHITE);
    behind_blinds(room, ([white; 3], white, white), WHITE)
}

/// With these materials of floor, wall and ceiling, of slats, and of the table; and what the panel reflects.
fn behind_blinds(mut room: Room, ([floor, wall, ceiling], slat, table): ([u32; 3], u32, u32), of_panel: [f64; 3]) -> Made {
    let panel = room.named_material("panel", &of_panel, &[30.0, 27.6, 24.0]);
    let window = Rectangle { axis: 1, at: 4.0, low: [0.7, 1.0], high: [2.5, 4.0] };
    for (side, is_far) in sides([0.0; 3], [5.0, 4.0, 2.8]) {
        let material = if side.axis < 2 { wall } else { [floor, ceiling][usize::from(is_far)] };
        let pieces = if side.axis == 1 && is_far { side.around(window).to_vec() } else { vec![side] };
        pieces.into_iter().for_each(|piece| piece.add_to(&mut room, !is_far, material));
    }
    Rectangle { axis: 1, at: 6.0, low: [-1.0, -1.0], high: [5.0, 6.0] }.add_to(&mut room, false, panel);

    let (sin, cos) = TURNED_DEGREES.to_radians().sin_cos();
    let half = [HALF_WIDTH * cos, HALF_WIDTH * sin];
    for k in 0..SLATS {
        let (x, y) = (window.low[1] + SPACING * (f64::from(k) + 0.5), 3.9);
        let [near, far] = [-1.0, 1.0].map(|sign| [x + sign * half[0], y + sign * half[1]]);
        let corner = |[x, y]: [f64; 2], z: f64| [x, y, z];
        room.sheet(&[corner(near, 0.72), corner(far, 0.72), corner(far, 2.45), corner(near, 2.45)], slat);
    }
    solid(&mut room, [2.0, 1.2, 0.7], [3.4, 2.6, 0.75], table);
    Made::of(room)
}
