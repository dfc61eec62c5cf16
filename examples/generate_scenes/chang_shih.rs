//! Two scenes with the numbers of polygons of those of Chang, Shih 1998, section 4, which shows pictures but gives no coordinates.
//!
//! The first has four polygons that make 832 elements at 1/256 of the largest area: three of one area and one of a quarter of it.
//! The second is a living room of 246 polygons. Where they stand is our choice.

use super::furniture::{Chance, bookshelf, ceiling_lamp, materials, picture, plain_chair, plant, table};
use super::interior::Interior;
use super::model::{Model, Place, Side};

use Side::Bottom;

/// A corner of three squares, and a lamp of a quarter of their area before it, which shades them from each other in part.
pub fn four_polygons() -> Model {
    let mut model = Model::new(&[
        "Four polygons, in metres, y up: a floor, two walls, and a lamp that hangs before them and shines down.",
        "Camera: eye 2.2 1.3 2.4  target 0.35 0.4 0.35  up 0 1 0  vertical field of view 40 degrees",
    ]);
    model.material("floor", [0.5; 3], [0.0; 3]);
    model.material("left", [0.7, 0.3, 0.3], [0.0; 3]);
    model.material("back", [0.3, 0.3, 0.7], [0.0; 3]);
    model.material("lamp", [0.2; 3], [4.0; 3]);
    model.object("corner", Place::WORLD);
    model.face("floor", &[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    model.face("left", &[[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]]);
    model.face("back", &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    model.object("lamp", Place::WORLD);
    let (low, high, height) = (0.2, 0.7, 0.6);
    model.face("lamp", &[[low, height, low], [high, height, low], [high, height, high], [low, height, high]]);
    model
}

/// A sofa, an armchair, a low table, a shelf of books, a plant, a picture, two lamps and a window.
pub fn living_room() -> Model {
    let mut model = Model::new(&[
        "Living room, 246 polygons, in metres, y up.",
        "Camera: eye 4.7 1.6 3.75  target 1.7 0.8 1.2  up 0 1 0  vertical field of view 60 degrees",
    ]);
    materials(&mut model);
    let room = Interior { width: 5.0, height: 2.6, depth: 4.0, windows: &[[1.3, 2.8]], walls: ["accent_wall", "wall"] };
    room.shell(&mut model);
    model.object("ceiling_lamps", Place::WORLD);
    ceiling_lamp(&mut model, room.height, [1.2, 1.6], [1.9, 2.3]);
    ceiling_lamp(&mut model, room.height, [3.2, 1.6], [3.9, 2.3]);
    seat(&mut model, "sofa", Place::at([0.15, 0.0, 2.0], 0.0), 0.95);
    seat(&mut model, "armchair", Place::at([2.1, 0.0, 3.75], 90.0), 0.45);
    model.object("low_table", Place::at([1.9, 0.0, 2.0], 4.0));
    table(&mut model, "walnut", [0.35, 0.55], 0.4, 0.035, 0.05);
    model.cuboid("book_red", [-0.15, 0.4, 0.12], [0.11, 0.43, 0.32], &[Bottom]);
    let mut chance = Chance(98);
    bookshelf(&mut model, "shelf", Place::at([2.4, 0.0, 0.02], 0.0), 5, [0.05, 0.09], &mut chance);
    plain_chair(&mut model, "chair", Place::at([4.1, 0.0, 1.2], -70.0));
    plant(&mut model, Place::at([0.5, 0.0, 0.5], 0.0), 9);
    picture(&mut model, Place::at([4.2, 1.6, 0.0], 0.0), [0.8, 0.6]);
    room.floor_of(&mut model, 246, ["floor", "floor_light"]);
    model
}

/// A seat with a back and two arms that looks along its own +x, twice `half` wide. 20 faces.
fn seat(model: &mut Model, name: &str, place: Place, half: f64) {
    model.object(name, place);
    let deep = 0.85;
    model.cuboid("cushion", [0.0, 0.0, -half], [deep, 0.42, half], &[Bottom]);
    model.cuboid("cushion", [0.0, 0.42, -half], [0.2, 0.8, half], &[Bottom]);
    for (low, high) in [(-half, 0.18 - half), (half - 0.18, half)] {
        model.cuboid("cushion", [0.2, 0.42, low], [deep, 0.6, high], &[Bottom]);
    }
}
