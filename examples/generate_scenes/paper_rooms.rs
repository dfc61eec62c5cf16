//! Five rooms with the names and numbers of polygons of those of Holzschuch, Sillion, Drettakis 1994 (table 1), made anew.
//!
//! The floor has as many boards as it takes for the exact number. Walls face inwards, furniture outwards; undersides that touch something
//! are left out.

use super::furniture::{
    Chance, bookshelf, ceiling_lamp, chair, desk_lamp, leaf, materials, office_desk, picture, plain_chair, plant, pot, table,
};
use super::interior::Interior;
use super::model::{Model, Place, Point, Side};

use Side::{Back, Bottom, Top};

fn begin(title: &str, camera: &str) -> Model {
    let mut model = Model::new(&[title, camera]);
    materials(&mut model);
    model
}

/// A desk with a screen, a visitor's chair, a shelf, a picture, one lamp and a window.
pub fn full_office() -> Model {
    let mut model = begin(
        "Full office, 170 polygons, in metres, y up.",
        "Camera: eye 3.8 1.65 3.85  target 1.5 0.85 0.9  up 0 1 0  vertical field of view 58 degrees",
    );
    let room = Interior { width: 4.0, height: 2.7, depth: 4.0, windows: &[[1.3, 2.9]], walls: ["accent_wall", "wall"] };
    room.shell(&mut model);
    model.object("lamp", Place::WORLD);
    ceiling_lamp(&mut model, room.height, [1.5, 1.6], [2.7, 2.2]);
    office_desk(&mut model, "desk", Place::at([1.6, 0.0, 0.95], 180.0));
    plain_chair(&mut model, "chair", Place::at([1.55, 0.0, 1.75], 12.0));
    let mut chance = Chance(7);
    bookshelf(&mut model, "shelf", Place::at([2.8, 0.0, 0.02], 0.0), 5, [0.05, 0.09], &mut chance);
    room.floor_of(&mut model, 170, ["floor", "floor_light"]);
    model
}

/// A table that is laid, four chairs, a lamp above, a sideboard, curtains and pictures.
pub fn dining_room() -> Model {
    let mut model = begin(
        "Dining room, 402 polygons, in metres, y up.",
        "Camera: eye 4.6 1.7 3.85  target 2.0 0.75 1.6  up 0 1 0  vertical field of view 58 degrees",
    );
    let room = Interior { width: 4.8, height: 2.7, depth: 4.0, windows: &[[1.3, 2.7]], walls: ["warm_wall", "wall"] };
    room.shell(&mut model);
    room.curtains(&mut model);

    // The table, and four chairs that look at it.
    let height = 0.75;
    model.object("table", Place::at([2.3, 0.0, 2.0], 0.0));
    table(&mut model, "walnut", [0.85, 0.5], height, 0.04, 0.06);
    for (name, x, z, degrees) in [
        ("chair_back", 2.3, 1.25, 180.0),
        ("chair_front", 2.35, 2.75, 0.0),
        ("chair_left", 1.2, 2.0, -90.0),
        ("chair_right", 3.4, 2.0, 84.0),
    ] {
        chair(&mut model, name, Place::at([x, 0.0, z], degrees));
    }

    // Plates and glasses, a bowl.
    model.object("plates", Place::at([2.3, height, 2.0], 0.0));
    for (x, z) in [(0.0, -0.33), (0.05, 0.33), (-0.62, 0.0), (0.62, 0.0)] {
        model.walls("porcelain", 6, [x, z], (0.0, 0.08), (0.02, 0.12));
        model.disk("porcelain", 6, [x, z], (0.02, 0.12));
    }
    model.walls("porcelain", 8, [0.0, 0.0], (0.0, 0.06), (0.09, 0.15));
    model.rim("porcelain", 8, [0.0, 0.0], (0.09, 0.14), (0.09, 0.15));
    model.inner_walls("porcelain", 8, [0.0, 0.0], (0.012, 0.05), (0.09, 0.14));
    model.disk("porcelain", 8, [0.0, 0.0], (0.012, 0.05));

    // The lamp hangs above: a shade that is dark outside, with a disk that shines down.
    model.object("pendant", Place::at([2.3, 0.0, 2.0], 0.0));
    model.walls("metal", 8, [0.0, 0.0], (1.62, 0.26), (1.82, 0.09));
    model.disk("metal", 8, [0.0, 0.0], (1.82, 0.09));
    model.disk_below("lamp_warm", 8, [0.0, 0.0], (1.62, 0.26));
    model.cuboid("black", [-0.006, 1.82, -0.006], [0.006, room.height, 0.006], &[Bottom, Top]);
    model.object("ceiling_lamps", Place::WORLD);
    ceiling_lamp(&mut model, room.height, [3.6, 0.5], [4.2, 0.8]);

    // A sideboard with doors along the back wall.
    model.object("sideboard", Place::at([2.4, 0.0, 0.02], 0.0));
    model.cuboid("oak", [-0.8, 0.0, 0.0], [0.8, 0.8, 0.42], &[Bottom]);
    for k in 0..3 {
        let x = -0.78 + 0.525 * f64::from(k);
        model.cuboid("white_paint", [x, 0.08, 0.42], [x + 0.51, 0.77, 0.435], &[Back]);
    }
    model.cuboid("metal", [-0.5, 0.8, 0.1], [-0.1, 0.82, 0.35], &[Bottom]);
    picture(&mut model, Place::at([2.4, 1.6, 0.0], 0.0), [1.0, 0.7]);
    room.floor_of(&mut model, 402, ["floor", "floor_light"]);
    model
}

/// A desk with a lamp and a chair before it.
fn workplace(model: &mut Model, number: usize, x: f64, z: f64, degrees: f64) {
    office_desk(model, &format!("desk_{number}"), Place::at([x, 0.0, z], degrees));
    let (sin, cos) = degrees.to_radians().sin_cos();
    let at = |dx: f64, dz: f64| [x + cos * dx + sin * dz, 0.0, z - sin * dx + cos * dz];
    let [lamp_x, _, lamp_z] = at(-0.62, -0.2);
    desk_lamp(model, Place::at([lamp_x, 0.74, lamp_z], degrees - 20.0));
    chair(model, &format!("desk_chair_{number}"), Place::at(at(0.0, 0.62), degrees + 8.0 * (number as f64 - 1.5)));
}

/// Two desks, six chairs, shelves of books, four lamps.
pub fn east_room() -> Model {
    let mut model = begin(
        "East room, 1006 polygons, in metres, y up: two desks, six chairs.",
        "Camera: eye 6.0 1.75 4.75  target 2.3 0.7 1.3  up 0 1 0  vertical field of view 60 degrees",
    );
    let room = Interior { width: 6.3, height: 2.8, depth: 5.0, windows: &[[0.8, 2.1], [2.9, 4.2]], walls: ["accent_wall", "wall"] };
    room.shell(&mut model);
    room.door(&mut model, 4.9);
    model.object("ceiling_lamps", Place::WORLD);
    for (x, z) in [(1.4, 1.1), (4.1, 1.1), (1.4, 3.4), (4.1, 3.4)] {
        ceiling_lamp(&mut model, room.height, [x, z], [x + 0.9, z + 0.3]);
    }
    workplace(&mut model, 1, 0.6, 1.5, 90.0);
    workplace(&mut model, 2, 0.6, 3.6, 90.0);

    // A table for four.
    model.object("table", Place::at([3.6, 0.0, 3.0], 0.0));
    table(&mut model, "oak", [0.7, 0.7], 0.74, 0.035, 0.06);
    model.cuboid("paper", [-0.3, 0.74, -0.1], [-0.09, 0.752, 0.2], &[Bottom]);
    model.cuboid("book_blue", [0.1, 0.74, -0.35], [0.28, 0.77, -0.1], &[Bottom]);
    for (k, (x, z, degrees)) in
        [(0.0, -0.85, 180.0), (0.05, 0.85, 4.0), (-0.85, 0.0, -90.0), (0.85, -0.05, 92.0)].into_iter().enumerate()
    {
        chair(&mut model, &format!("chair_{}", k + 3), Place::at([3.6 + x, 0.0, 3.0 + z], degrees));
    }

    let mut chance = Chance(11);
    for (k, books) in [26, 20, 16].into_iter().enumerate() {
        let x = 1.2 + 1.05 * k as f64;
        bookshelf(&mut model, &format!("shelf_{k}"), Place::at([x, 0.0, 0.02], 0.0), books, [0.035, 0.08], &mut chance);
    }
    plant(&mut model, Place::at([5.85, 0.0, 0.5], 0.0), 13);
    room.floor_of(&mut model, 1006, ["carpet", "carpet"]);
    model
}

/// Four desks, ten chairs, shelves of books, six lamps.
pub fn west_room() -> Model {
    let mut model = begin(
        "West room, 1647 polygons, in metres, y up: four desks, ten chairs.",
        "Camera: eye 8.1 1.85 5.75  target 3.2 0.6 1.8  up 0 1 0  vertical field of view 60 degrees",
    );
    let room = Interior { width: 8.4, height: 2.9, depth: 6.0, windows: &[[0.7, 2.3], [3.4, 5.0]], walls: ["warm_wall", "wall"] };
    room.shell(&mut model);
    room.door(&mut model, 7.1);
    model.object("ceiling_lamps", Place::WORLD);
    for x in [1.3, 3.8, 6.3] {
        for z in [1.4, 4.1] {
            ceiling_lamp(&mut model, room.height, [x, z], [x + 1.0, z + 0.3]);
        }
    }
    workplace(&mut model, 1, 0.6, 1.5, 90.0);
    workplace(&mut model, 2, 0.6, 4.2, 90.0);
    workplace(&mut model, 3, 2.9, 2.0, -90.0);
    workplace(&mut model, 4, 2.9, 4.4, -90.0);

    // A long table for six.
    model.object("table", Place::at([5.9, 0.0, 3.5], 0.0));
    table(&mut model, "oak", [1.2, 0.5], 0.74, 0.035, 0.06);
    for k in 0..3 {
        let x = -0.8 + 0.7 * f64::from(k);
        model.cuboid("paper", [x, 0.74, 0.1], [x + 0.21, 0.745, 0.4], &[Bottom]);
    }
    for k in 0..6 {
        let (x, side) = (5.1 + 0.8 * f64::from(k % 3), f64::from(k / 3));
        let degrees = 180.0 * (1.0 - side) + 5.0 * f64::from(k % 3 - 1);
        chair(&mut model, &format!("chair_{}", k + 5), Place::at([x, 0.0, 2.8 + 1.4 * side], degrees));
    }

    let mut chance = Chance(5);
    for (k, books) in [28, 20, 16, 28].into_iter().enumerate() {
        let x = 1.5 + 1.05 * k as f64;
        bookshelf(&mut model, &format!("shelf_{k}"), Place::at([x, 0.0, 0.02], 0.0), books, [0.03, 0.07], &mut chance);
    }
    plant(&mut model, Place::at([7.9, 0.0, 5.5], 0.0), 14);
    plant(&mut model, Place::at([0.5, 0.0, 5.6], 0.0), 12);
    for z in [2.4, 4.4] {
        picture(&mut model, Place::at([8.4, 1.6, z], -90.0), [1.1, 0.8]);
    }
    room.floor_of(&mut model, 1647, ["carpet", "carpet"]);
    model
}

/// A rubber tree in a pot, with branches and leaves of three leaflets each, and three lamps.
pub fn hevea() -> Model {
    let mut model = begin(
        "Hevea, 2355 polygons, in metres, y up: a rubber tree with three light sources.",
        "Camera: eye 3.75 1.7 3.8  target 1.9 1.4 1.7  up 0 1 0  vertical field of view 66 degrees",
    );
    let room = Interior { width: 4.0, height: 3.2, depth: 4.0, windows: &[], walls: ["warm_wall", "wall"] };
    room.shell(&mut model);
    model.object("lamps", Place::WORLD);
    for (x, z) in [(0.5, 0.6), (2.9, 0.5), (1.6, 2.9)] {
        ceiling_lamp(&mut model, room.height, [x, z], [x + 0.6, z + 0.6]);
    }
    model.object("pot", Place::at([2.0, 0.0, 1.8], 0.0));
    pot(&mut model, (0.2, 0.3, 0.42));

    // The trunk tapers; whorls of branches grow from it, leaves from the branches.
    model.object("tree", Place::at([2.0, 0.38, 1.8], 0.0));
    let trunk = 2.1;
    for k in 0..6 {
        let at = |k: f64| (trunk * k / 6.0, 0.035 - 0.024 * k / 6.0);
        model.walls("bark", 6, [0.0, 0.0], at(f64::from(k)), at(f64::from(k + 1)));
    }
    let mut chance = Chance(3);
    for k in 0..24 {
        let share = f64::from(k) / 24.0;
        let turn = f64::from(k) * 137.5_f64.to_radians();
        let length = 0.85 - 0.55 * share;
        let foot = [0.0, 0.65 + 1.45 * share, 0.0];
        let along = [length * turn.cos(), length * (0.25 + 0.5 * share), length * turn.sin()];
        branch(&mut model, foot, along, &mut chance);
    }
    room.floor_of(&mut model, 2355, ["floor", "floor_light"]);
    model
}

/// A branch of 3 sides and its leaves at the end of stalks: 3 faces, and 15 leaves of 3 leaflets of 2 faces.
fn branch(model: &mut Model, foot: Point, along: Point, chance: &mut Chance) {
    let at = |t: f64| -> Point { std::array::from_fn(|k| foot[k] + t * along[k]) };
    let flat = along[0].hypot(along[2]);
    let (east, north) = ([-along[2] / flat, 0.0, along[0] / flat], [0.0, 1.0, 0.0]);
    let corner = |t: f64, radius: f64, k: usize| -> Point {
        let (sin, cos) = (k as f64 / 3.0 * std::f64::consts::TAU).sin_cos();
        let base = at(t);
        std::array::from_fn(|i| base[i] + radius * (cos * east[i] + sin * north[i]))
    };
    for k in 0..3 {
        let next = (k + 1) % 3;
        model.face("bark", &[corner(0.0, 0.012, next), corner(0.0, 0.012, k), corner(1.0, 0.0, k)]);
    }
    for k in 0..15 {
        let foot = at(0.3 + 0.7 * (f64::from(k) + chance.next()) / 15.0);
        let turn = f64::from(k) * 137.5_f64.to_radians() + chance.next();
        for leaflet in 0..3 {
            let turn = turn + 0.7 * f64::from(leaflet - 1);
            let (sin, cos) = turn.sin_cos();
            let (length, half) = (0.11 + 0.05 * chance.next(), 0.022 + 0.008 * chance.next());
            let droop = -0.5 * length * chance.next() + 0.02;
            let stalk: Point = [foot[0] + 0.05 * cos, foot[1] + 0.02 + 0.02 * chance.next(), foot[2] + 0.05 * sin];
            let material = if chance.next() > 0.6 { "leaf_light" } else { "leaf" };
            leaf(model, material, stalk, [length * cos, droop, length * sin], [-half * sin, 0.3 * half, half * cos]);
        }
    }
}
