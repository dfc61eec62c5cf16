//! The Cornell box.
//!
//! Geometry as measured at the Cornell Program of Computer Graphics (published as "Cornell Box Data"; there in millimetres). The open
//! front is at z = 0, the light lies flush in a hole of the ceiling. The walls' reflectances are the usual linear RGB of the published spectra.

use super::model::{Model, Place, Point};

pub fn cornell() -> Model {
    let mut model = Model::new(&[
        "The Cornell box, in metres: open at z = 0, the light flush in a hole of the ceiling.",
        "Geometry: Cornell Box Data, Cornell University Program of Computer Graphics.",
        "Camera: eye 0.278 0.273 -0.8  target 0.278 0.273 0  up 0 1 0  vertical field of view 39.3 degrees",
    ]);
    model.material("white", [0.73, 0.73, 0.73], [0.0; 3]);
    model.material("red", [0.63, 0.065, 0.05], [0.0; 3]);
    model.material("green", [0.14, 0.45, 0.091], [0.0; 3]);
    model.material("light", [0.78, 0.78, 0.78], [17.0, 12.0, 4.0]);

    // From the published millimetres.
    let mut face = |material: &str, corners: &[Point]| {
        model.place = Some(Place::WORLD);
        model.face(material, &corners.iter().map(|corner| corner.map(|x| x / 1000.0)).collect::<Vec<_>>());
    };

    // The room. The right wall is not quite planar in the data, so it is two triangles.
    face("white", &[[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]]);
    face("white", &[[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]]);
    face("green", &[[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]]);
    face("red", &[[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2]]);
    face("red", &[[552.8, 0.0, 0.0], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]]);

    // The ceiling around the hole, and the light in it.
    let height = 548.8;
    face("white", &[[556.0, height, 0.0], [556.0, height, 227.0], [0.0, height, 227.0], [0.0, height, 0.0]]);
    face("white", &[[556.0, height, 332.0], [556.0, height, 559.2], [0.0, height, 559.2], [0.0, height, 332.0]]);
    face("white", &[[213.0, height, 227.0], [213.0, height, 332.0], [0.0, height, 332.0], [0.0, height, 227.0]]);
    face("white", &[[556.0, height, 227.0], [556.0, height, 332.0], [343.0, height, 332.0], [343.0, height, 227.0]]);
    face("light", &[[343.0, height, 227.0], [343.0, height, 332.0], [213.0, height, 332.0], [213.0, height, 227.0]]);

    // The blocks stand on the floor and have no bottom.
    let blocks = [
        (165.0, [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]]),
        (330.0, [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]]),
    ];
    for (height, corners) in blocks {
        face("white", &corners.map(|[x, z]| [x, height, z]));
        for k in 0..4 {
            let ([x, z], [next_x, next_z]) = (corners[k], corners[(k + 1) % 4]);
            face("white", &[[next_x, 0.0, next_z], [next_x, height, next_z], [x, height, z], [x, 0.0, z]]);
        }
    }
    model
}
