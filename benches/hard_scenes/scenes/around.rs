//! Scenes of the repository with much black around them.

use std::path::Path;

use patchlight::scene::import::{ImportOptions, read_scene};

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{matt, sides};

/// How far outside the shell is, and how thick.
const OUTSIDE: f64 = 0.2;
const THICK: f64 = 0.01;

/// Half the side of the ground, and how far below it is.
const FAR: f64 = 1e4;
const BELOW: f64 = 1.0;

/// scenes/two_rooms.obj in a closed black box.
pub fn black_shell() -> Made {
    let (mut room, low, high) = copy_of("two_rooms");
    let black = matt(&mut room, "black_shell", [0.0; 3]);
    for (distance, along_far) in [(OUTSIDE, false), (OUTSIDE + THICK, true)] {
        for (side, is_far) in sides(low.map(|x| x - distance), high.map(|x| x + distance)) {
            side.add_to(&mut room, is_far == along_far, black);
        }
    }
    Made::of(room)
}

/// scenes/room.obj above a black ground; y is up.
pub fn black_ground() -> Made {
    let (mut room, low, _) = copy_of("room");
    let black = matt(&mut room, "black_ground", [0.0; 3]);
    room.quad([-FAR, low[1] - BELOW, -FAR], [0.0, 0.0, 2.0 * FAR], [2.0 * FAR, 0.0, 0.0], black);
    Made::of(room)
}

/// A scene of the repository, and the corners of the box around it.
fn copy_of(name: &str) -> (Room, [f64; 3], [f64; 3]) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
    let scene = read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene;
    let mut room = Room::default();
    for material in scene.materials() {
        room.named_material(&material.name, &material.reflectance, &material.exitance);
    }
    for surface in scene.surfaces() {
        room.face(&surface.polygon.vertices().collect::<Vec<_>>(), surface.material);
    }
    let bounds = scene.bounds();
    (room, bounds.min(), bounds.max())
}
