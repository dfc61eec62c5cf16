//! Two white rooms with a doorway between them and a lamp in one: all light in the other has been reflected, most of that in the first has.

use super::model::{Model, Place, Point, Side};

use Side::{Bottom, Top};

const HEIGHT: f64 = 2.6;
const DEPTH: f64 = 4.0;
/// From where to where the rooms go in x; between them is the wall.
const LIT: [f64; 2] = [0.0, 4.0];
const OTHER: [f64; 2] = [4.2, 8.2];
/// The doorway: from where to where in z, and how high.
const DOORWAY: [f64; 2] = [2.6, 3.5];
const LINTEL: f64 = 2.05;

pub fn two_rooms() -> Model {
    let mut model = Model::new(&[
        "Two white rooms with a doorway between them and a lamp in one, in metres, y up: strong indirect light.",
        "Camera: eye 8.0 1.6 0.4  target 5.0 1.0 3.0  up 0 1 0  vertical field of view 60 degrees",
    ]);
    model.material("wall", [0.9, 0.89, 0.87], [0.0; 3]);
    model.material("blue_wall", [0.75, 0.82, 0.88], [0.0; 3]);
    model.material("ceiling", [0.92, 0.92, 0.91], [0.0; 3]);
    model.material("floor", [0.8, 0.77, 0.72], [0.0; 3]);
    model.material("wood", [0.8, 0.7, 0.6], [0.0; 3]);
    model.material("shade", [0.9, 0.9, 0.9], [0.0; 3]);
    model.material("lamp", [0.0; 3], [20.0, 18.0, 14.0]);

    // What encloses the rooms.
    for (name, [left, right], far_wall) in [("lit_room", LIT, "wall"), ("other_room", OTHER, "blue_wall")] {
        model.object(name, Place::WORLD);
        floor(&mut model, [left, right], [0.0, DEPTH]);
        model.face("ceiling", &level(HEIGHT, [left, right], [0.0, DEPTH], false));
        model.face("wall", &[[left, 0.0, 0.0], [right, 0.0, 0.0], [right, HEIGHT, 0.0], [left, HEIGHT, 0.0]]);
        model.face(far_wall, &[[right, 0.0, DEPTH], [left, 0.0, DEPTH], [left, HEIGHT, DEPTH], [right, HEIGHT, DEPTH]]);
    }
    model.face("wall", &across(LIT[0], [0.0, HEIGHT], [0.0, DEPTH], true));
    model.face("wall", &across(OTHER[1], [0.0, HEIGHT], [0.0, DEPTH], false));

    // The wall between them, seen from both, and the doorway in it.
    model.object("doorway", Place::WORLD);
    let [near, far] = DOORWAY;
    for (x, looks_right) in [(LIT[1], false), (OTHER[0], true)] {
        model.face("wall", &across(x, [0.0, HEIGHT], [0.0, near], looks_right));
        model.face("wall", &across(x, [0.0, HEIGHT], [far, DEPTH], looks_right));
        model.face("wall", &across(x, [LINTEL, HEIGHT], DOORWAY, looks_right));
    }
    let [left, right] = [LIT[1], OTHER[0]];
    floor(&mut model, [left, right], DOORWAY);
    model.face("wood", &level(LINTEL, [left, right], DOORWAY, false));
    model.face("wood", &[[left, 0.0, near], [right, 0.0, near], [right, LINTEL, near], [left, LINTEL, near]]);
    model.face("wood", &[[right, 0.0, far], [left, 0.0, far], [left, LINTEL, far], [right, LINTEL, far]]);

    // A lamp under the ceiling where nothing in the other room sees it.
    model.object("lamp", Place::WORLD);
    model.cuboid("shade", [3.6, 2.5, 0.2], [3.95, HEIGHT, 0.7], &[Bottom, Top]);
    model.face("lamp", &level(2.5, [3.6, 3.95], [0.2, 0.7], false));

    // Boxes to cast shadows.
    for (name, low, high) in [
        ("chest", [0.3, 0.0, 2.6], [1.3, 0.8, 3.6]),
        ("table", [5.6, 0.0, 1.0], [6.9, 0.74, 1.8]),
        ("cupboard", [7.3, 0.0, 2.9], [8.0, 1.9, 3.9]),
    ] {
        model.object(name, Place::WORLD);
        model.cuboid("wood", low, high, &[Bottom]);
    }
    model
}

fn floor(model: &mut Model, x: [f64; 2], z: [f64; 2]) {
    model.face("floor", &level(0.0, x, z, true));
}

/// A level rectangle that looks up or down.
fn level(y: f64, [left, right]: [f64; 2], [near, far]: [f64; 2], looks_up: bool) -> [Point; 4] {
    let mut corners = [[left, y, near], [left, y, far], [right, y, far], [right, y, near]];
    if !looks_up {
        corners.reverse();
    }
    corners
}

/// A rectangle that looks along +x or -x.
fn across(x: f64, [low, high]: [f64; 2], [near, far]: [f64; 2], looks_right: bool) -> [Point; 4] {
    let mut corners = [[x, low, far], [x, low, near], [x, high, near], [x, high, far]];
    if !looks_right {
        corners.reverse();
    }
    corners
}
