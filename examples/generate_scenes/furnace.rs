//! A closed furnace: the radiosity inside is known exactly.

use super::model::{Model, Place};

pub fn furnace() -> Model {
    let mut model = Model::new(&[
        "A closed unit cube seen from inside, reflectance 0.5, emitted radiance 1: B = pi / (1 - 0.5) = 2 pi W/m^2 everywhere.",
        "Camera: eye 0.5 0.5 0.95  target 0.5 0.5 0  up 0 1 0",
    ]);
    model.material("wall", [0.5; 3], [1.0; 3]);
    model.object("cube", Place::WORLD);
    let corner = |bits: usize| [bits & 1, bits >> 1 & 1, bits >> 2].map(|bit| bit as f64);
    for corners in [[0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5]] {
        model.face("wall", &corners.map(corner));
    }
    model
}
