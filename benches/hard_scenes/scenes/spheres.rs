//! Curved things, in triangles.

use super::super::rooms::{Room, icosphere};
use super::super::triangles::add;
use super::made::Made;
use super::parts::{closed_room, matt, panel};

/// Sides of an icosahedron are halved so often: 1280 triangles.
const HALVINGS: u32 = 3;

/// Three spheres in a room of 4 x 4 x 3 m.
pub fn spheres() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 4.0, 3.0]);
    panel(&mut room, [2.0, 2.0], [0.8, 0.8], 2.95, 100.0);
    let spheres = [
        ([1.2, 1.2, 0.51], 0.5, [0.7, 0.3, 0.25]),
        ([2.6, 1.4, 0.41], 0.4, [0.3, 0.6, 0.35]),
        ([2.0, 2.6, 0.91], 0.6, [0.75, 0.74, 0.7]),
    ];
    for (k, (middle, radius, reflectance)) in spheres.into_iter().enumerate() {
        let material = matt(&mut room, &format!("sphere_{k}"), reflectance);
        for triangle in icosphere(radius, HALVINGS) {
            room.face(&triangle.map(|corner| add(corner, middle)), material);
        }
    }
    Made::of(room)
}
