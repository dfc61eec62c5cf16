//! Scenes with nothing to do.

use super::scene::HardScene;
use crate::rooms::{Room, straight};

/// Scenes with nothing to do.
pub fn next_to_nothing() -> Vec<HardScene> {
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut scenes = Vec::new();
    for (name, rho, exitance) in
        [("one triangle that shines", 0.5, 1.0), ("one dark triangle", 0.5, 0.0), ("one black triangle", 0.0, 0.0)]
    {
        let mut room = Room::default();
        let material = room.material(&[rho], &[exitance]);
        room.face(&triangle, material);
        scenes.push(HardScene::emitted_alone(name, room));
    }

    let mut room = Room::default();
    let grey = room.material(&[0.5], &[0.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| grey);
    scenes.push(HardScene::emitted_alone("a room without light", room));

    let mut room = Room::default();
    let black = room.material(&[0.0], &[2.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| black);
    scenes.push(HardScene::emitted_alone("a room that reflects nothing", room));

    // Convex and seen from outside: nothing sees anything.
    let mut room = Room::default();
    let grey = room.material(&[0.5], &[1.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), false, |_, _| grey);
    scenes.push(HardScene::emitted_alone("a room turned inside out", room));
    scenes
}
