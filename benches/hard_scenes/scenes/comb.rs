//! A comb of plates.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{Rectangle, light, matt};

const PLATES: u32 = 100;

/// Plates of 1 x 0.5 m, a gap apart, and a lamp of 1 x 1 m one metre above them; no room around.
pub fn comb(gap: f64) -> Made {
    let mut room = Room::default();
    let (plate, lamp) = (matt(&mut room, "plate", [0.25, 0.24, 0.22]), light(&mut room, 100.0));
    for k in 0..PLATES {
        let rectangle = Rectangle { axis: 0, at: gap * f64::from(k), low: [0.0, 0.0], high: [1.0, 0.5] };
        rectangle.add_sheet_to(&mut room, plate);
    }
    let middle = 0.5 * gap * f64::from(PLATES - 1);
    Rectangle { axis: 2, at: 1.5, low: [middle - 0.5, 0.0], high: [middle + 0.5, 1.0] }.add_to(&mut room, false, lamp);
    Made::of(room)
}
