//! A cloud of leaves.

use super::super::rooms::Room;
use super::super::triangles::{Random, add, cross, times, unit};
use super::made::Made;
use super::parts::{closed_room, matt, panel};

const LEAVES: u32 = 2000;
/// Half the length and half the width of a leaf.
const LEAF: [f64; 2] = [0.035, 0.018];
const MIDDLE: [f64; 3] = [2.0, 2.0, 1.3];
const RADIUS: f64 = 0.9;

/// Leaves in a ball in a room of 4 x 4 x 3 m. They reflect one channel well and the others hardly.
pub fn leaves() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 3.0]);
    panel(&mut room, [2.0, 2.0], [0.8, 0.8], 2.95, 100.0);
    let leaf = matt(&mut room, "leaf", [0.06, 0.85, 0.05]);
    let mut random = Random(5);
    for _ in 0..LEAVES {
        let place = add(MIDDLE, times(random.direction(), RADIUS * random.unit().cbrt()));
        let along = random.direction();
        let across = times(unit(cross(along, random.direction())), LEAF[1]);
        let along = times(along, LEAF[0]);
        let corners = [along, across, times(along, -1.0), times(across, -1.0)].map(|way| add(place, way));
        room.sheet(&corners, leaf);
    }
    Made::of(room)
}
