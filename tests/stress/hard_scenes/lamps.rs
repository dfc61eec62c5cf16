//! Lamps from a speck to a whole wall, next to what they light, in large numbers.

use super::furnaces::grey;
use super::scene::HardScene;
use crate::rooms::{Room, straight};
use crate::triangles::Random;

/// A floor of 4 x 4 that reflects, and nothing else.
fn floor() -> Room {
    let mut room = Room::default();
    let floor = room.material(&[0.6], &[0.0]);
    room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], floor);
    room
}

/// A rectangle above the floor that shines down.
fn ceiling_lamp(room: &mut Room, [x, y, z]: [f64; 3], [width, depth]: [f64; 2], exitance: f64) {
    let lamp = room.material(&[0.0], &[exitance]);
    room.quad([x, y, z], [0.0, depth, 0.0], [width, 0.0, 0.0], lamp);
}

/// Lamps from a speck to a whole wall, next to what they light, in large numbers.
pub fn lamps() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    for (name, size) in [
        ("a lamp of a millimetre", [1e-3, 1e-3]),
        ("a lamp of a thousandth of a millimetre", [1e-6, 1e-6]),
        ("a lamp that is a line, aspect 1e6", [1.0, 1e-6]),
        ("a lamp as large as the floor", [4.0, 4.0]),
    ] {
        let mut room = floor();
        ceiling_lamp(&mut room, [-0.5 * size[0], -0.5 * size[1], 1.0], size, 1.0 / (size[0] * size[1]));
        scenes.push(HardScene::direct(name, room));
    }

    let mut room = floor();
    ceiling_lamp(&mut room, [-0.1, -0.1, 1e-3], [0.2, 0.2], 1.0);
    scenes.push(HardScene::direct("a lamp a millimetre from the floor that it shines on", room));

    let mut room = floor();
    let lamp = room.material(&[0.0], &[1.0]);
    room.quad([0.0, -0.1, 1e-3], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3], lamp);
    scenes.push(HardScene::direct("a lamp at right angles, a millimetre from the floor", room));

    let mut random = Random(13);
    let mut room = floor();
    for k in 0..200 {
        let corner = [0.25 * f64::from(k % 16) - 1.95, 0.3 * f64::from(k / 16) - 1.95, 1.5];
        ceiling_lamp(&mut room, corner, [0.1, 0.1], random.between(0.0, 10.0).powi(3));
    }
    scenes.push(HardScene::direct("two hundred lamps", room));

    // One bright lamp in a room that has light of its own.
    let mut room = Room::default();
    let (wall, lamp) = (grey(&mut room, 0.9, 1.0), grey(&mut room, 0.0, 1.0));
    room.cuboid([0.0; 3], straight(2.0, 2.0, 2.0), true, |_, face| if face == 5 { lamp } else { wall });
    scenes.push(HardScene::uniform("a wall that is a lamp", room));
    scenes
}
