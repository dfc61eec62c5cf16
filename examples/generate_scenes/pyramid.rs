//! A pyramid under two small triangular lights, after figure 4.4 of Lischinski's thesis of 1994, which shows it without measures.

use super::model::{Model, Place, Point};

/// Six faces and a floor. Pyramid and lights reflect nothing, so that the light on the floor is direct light alone, which is known exactly.
pub fn pyramid() -> Model {
    let mut model = Model::new(&[
        "A pyramid on a floor under two small triangular lights, in metres, y up. Only the floor reflects.",
        "Camera: eye 2.6 3 3.4  target 0 0.2 0  up 0 1 0  vertical field of view 45 degrees",
    ]);
    model.material("floor", [0.5; 3], [0.0; 3]);
    model.material("pyramid", [0.0; 3], [0.0; 3]);
    model.material("light", [0.0; 3], [60.0; 3]);
    model.object("floor", Place::WORLD);
    model.face("floor", &[[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0]]);

    // Turned, so that no side runs along the floor's.
    model.object("pyramid", Place::at([0.1, 0.0, -0.05], 25.0));
    let (half, apex) = (0.6, [0.0, 1.1, 0.0]);
    let base: [Point; 4] = [[half, 0.0, -half], [-half, 0.0, -half], [-half, 0.0, half], [half, 0.0, half]];
    for k in 0..4 {
        model.face("pyramid", &[base[k], base[(k + 1) % 4], apex]);
    }

    for (name, place) in [("light_left", Place::at([-1.2, 2.2, -0.7], 10.0)), ("light_right", Place::at([0.9, 2.2, 1.1], 70.0))] {
        model.object(name, place);
        model.face("light", &[[-0.1, 0.0, -0.08], [0.12, 0.0, -0.06], [0.0, 0.0, 0.13]]);
    }
    model
}
