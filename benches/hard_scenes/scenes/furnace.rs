//! A white box.

use super::super::rooms::Room;
use super::made::Made;
use super::parts::sides;

/// An empty box of 4 x 3 x 2.5 m that reflects nearly all; one wall shines.
pub fn furnace() -> Made {
    let rho = [0.99, 0.985, 0.98];
    let mut room = Room::default();
    let (white, shining) = (room.named_material("white", &rho, &[0.0; 3]), room.named_material("shining", &rho, &[1.0, 1.0, 1.0]));
    for (side, is_far) in sides([0.0; 3], [4.0, 3.0, 2.5]) {
        side.add_to(&mut room, !is_far, if side.axis == 0 && !is_far { shining } else { white });
    }
    Made::of(room)
}
