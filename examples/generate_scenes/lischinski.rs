//! Four scenes with the numbers of polygons and lights of those of Lischinski 1994, chapter 4, which shows pictures but gives no coordinates.
//!
//! Section 4.3.4 tells of a square exhibit room of 47 polygons with a modern sculpture and two small square lights; table 4.3 of a room of 1,688
//! polygons with a distant polygon for the sun and another light close to the ceiling, whose 6,744 edges in table 4.4 are those of all but the two lights;
//! so its gallery of sculptures under six large ceiling lights, 2,112 edges, has 534 polygons, and its room after Mackintosh with 26 edges of lights and
//! 11,544 others 2,886 beside the lights. What stands in them, and where, is our choice.

use super::furniture::{Chance, bookshelf, chair, frame, materials, picture, table};
use super::interior::Interior;
use super::model::{Model, Place, Point, Side};

use Side::{Bottom, Front, Top};

fn begin(title: &str, camera: &str) -> Model {
    let mut model = Model::new(&[title, camera]);
    materials(&mut model);
    model
}

/// A box whose underside shines, `deep` below a ceiling: 5 faces.
fn light(model: &mut Model, material: &str, ceiling: f64, deep: f64, [low, high]: [[f64; 2]; 2]) {
    let y = ceiling - deep;
    model.cuboid("metal", [low[0], y, low[1]], [high[0], ceiling, high[1]], &[Top, Bottom]);
    model.face(material, &[[low[0], y, low[1]], [high[0], y, low[1]], [high[0], y, high[1]], [low[0], y, high[1]]]);
}

/// The sides of a pyramid over a polygon that is counter-clockwise seen from above.
fn pyramid(model: &mut Model, material: &str, base: &[Point], apex: Point) {
    for (k, &corner) in base.iter().enumerate() {
        model.face(material, &[corner, base[(k + 1) % base.len()], apex]);
    }
}

/// A level square that is counter-clockwise seen from above.
fn square(y: f64, half: f64) -> [Point; 4] {
    [[-half, y, half], [half, y, half], [half, y, -half], [-half, y, -half]]
}

/// A square room with a sculpture on a pedestal, two pieces beside it, and two small square lights.
pub fn exhibit_room() -> Model {
    let mut model = begin(
        "Exhibit room, 47 polygons, in metres, y up: a sculpture under two small square lights.",
        "Camera: eye 4.75 1.9 4.75  target 2.2 0.75 2.1  up 0 1 0  vertical field of view 52 degrees",
    );
    model.material("spot", [0.5; 3], [150.0, 142.0, 128.0]);
    let room = Interior { width: 5.0, height: 3.0, depth: 5.0, windows: &[], walls: ["wall", "wall"] };
    room.shell(&mut model);
    model.object("lights", Place::WORLD);
    for [x, z] in [[1.0, 1.2], [3.4, 3.2]] {
        light(&mut model, "spot", room.height, 0.05, [[x, z], [x + 0.3, z + 0.3]]);
    }

    // Two turned columns on a pedestal bear a beam, on which a pyramid stands: 23 faces.
    model.object("pedestal", Place::at([2.5, 0.0, 2.3], 0.0));
    model.cuboid("white_paint", [-0.5, 0.0, -0.5], [0.5, 0.4, 0.5], &[Bottom]);
    for (name, x, degrees) in [("left_column", -0.26, 30.0), ("right_column", 0.26, 10.0)] {
        model.object(name, Place::at([2.5 + x, 0.4, 2.3], degrees));
        model.cuboid("book_red", [-0.08, 0.0, -0.08], [0.08, 0.7, 0.08], &[Bottom, Top]);
    }
    model.object("beam", Place::at([2.5, 1.1, 2.3], 12.0));
    model.cuboid("book_blue", [-0.55, 0.0, -0.14], [0.55, 0.16, 0.14], &[]);
    model.object("pyramid", Place::at([2.4, 1.26, 2.3], 40.0));
    pyramid(&mut model, "book_yellow", &square(0.0, 0.09), [0.0, 0.45, 0.0]);

    // On the floor a leaning pyramid of three sides, and a block: 8 faces.
    model.object("leaning", Place::at([1.2, 0.0, 3.5], 0.0));
    pyramid(&mut model, "leaf", &[[-0.25, 0.0, 0.2], [0.3, 0.0, 0.15], [0.0, 0.0, -0.3]], [0.2, 0.9, 0.0]);
    model.object("block", Place::at([3.9, 0.0, 1.1], 25.0));
    model.cuboid("terracotta", [-0.3, 0.0, -0.2], [0.3, 0.55, 0.2], &[Bottom]);
    room.floor_of(&mut model, 47, ["floor_light", "floor_light"]);
    model
}

/// A room with two openings in its left wall, through which the sun shines, and a light close to the ceiling. All faces have four corners.
pub fn sunlit_room() -> Model {
    let mut model = begin(
        "Sunlit room, 1688 polygons, in metres, y up: a small distant polygon is the sun, another light is close to the ceiling.",
        "Camera: eye 5.7 1.7 4.6  target 1.8 0.75 1.5  up 0 1 0  vertical field of view 60 degrees",
    );
    let openings = [[0.8, 2.0], [2.9, 4.1]];
    let room = Interior { width: 6.0, height: 2.8, depth: 5.0, windows: &openings, walls: ["wall", "warm_wall"] };
    room.shell_with_openings(&mut model);
    window_bars(&mut model, &openings);

    // A square of a metre and a half, thirty metres away, seen as 2.9 degrees; it looks at the middle of the floor.
    model.material("sun", [0.0; 3], [12000.0, 11000.0, 9000.0]);
    model.object("sun", Place::WORLD);
    facing_square(&mut model, "sun", [-22.0, 17.5, 10.0], [2.5, 0.0, 2.3], 0.75);
    model.object("ceiling_light", Place::WORLD);
    light(&mut model, "lamp", room.height, 0.08, [[2.4, 2.2], [3.6, 2.8]]);

    // A table with four chairs in the sun, a low table, shelves.
    model.object("table", Place::at([2.5, 0.0, 2.5], 8.0));
    table(&mut model, "oak", [0.8, 0.5], 0.74, 0.035, 0.06);
    model.cuboid("paper", [-0.3, 0.74, -0.1], [-0.09, 0.752, 0.2], &[Bottom]);
    model.cuboid("book_blue", [0.1, 0.74, -0.25], [0.28, 0.77, 0.0], &[Bottom]);
    for (name, x, z, degrees) in [
        ("chair_back", 2.4, 1.75, 185.0),
        ("chair_front", 2.6, 3.3, 5.0),
        ("chair_left", 1.4, 2.6, -85.0),
        ("chair_right", 3.6, 2.4, 95.0),
    ] {
        chair(&mut model, name, Place::at([x, 0.0, z], degrees));
    }
    model.object("low_table", Place::at([4.6, 0.0, 1.2], 0.0));
    table(&mut model, "walnut", [0.5, 0.3], 0.4, 0.03, 0.05);
    let mut chance = Chance(94);
    for k in 0..4 {
        let place = Place::at([1.1 + 1.02 * f64::from(k), 0.0, 0.02], 0.0);
        bookshelf(&mut model, &format!("shelf_{k}"), place, 62, [0.022, 0.04], &mut chance);
    }
    picture(&mut model, Place::at([6.0, 1.6, 2.5], -90.0), [1.1, 0.8]);
    room.floor_of(&mut model, 1688, ["floor", "floor_light"]);
    model
}

/// Two bars across each opening of the left wall, and one along: 18 faces an opening.
fn window_bars(model: &mut Model, openings: &[[f64; 2]]) {
    model.object("bars", Place::WORLD);
    let (low, high) = (Interior::SILL, Interior::LINTEL);
    for &[near, far] in openings {
        let (middle, half) = (0.5 * (near + far), 0.02);
        for y in [low + (high - low) / 3.0, low + 2.0 * (high - low) / 3.0] {
            for [from, to] in [[near, middle - half], [middle + half, far]] {
                model.cuboid("white_paint", [-0.1, y - half, from], [-0.06, y + half, to], &[Side::Back, Front]);
            }
        }
        model.cuboid("white_paint", [-0.1, low, middle - half], [-0.06, high, middle + half], &[Top, Bottom]);
    }
}

/// A square around `centre` that looks at `target`.
fn facing_square(model: &mut Model, material: &str, centre: Point, target: Point, half: f64) {
    let axis = |k: usize| target[k] - centre[k];
    let (length, flat) = ((0..3).map(|k| axis(k) * axis(k)).sum::<f64>().sqrt(), axis(0).hypot(axis(2)));
    let [x, y, z] = [0, 1, 2].map(|k| axis(k) / length);
    let right = [z * length / flat, 0.0, -x * length / flat];
    let up = [y * right[2], z * right[0] - x * right[2], -y * right[0]];
    let at = |s: f64, t: f64| std::array::from_fn(|k| centre[k] + half * (s * right[k] + t * up[k]));
    model.face(material, &[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]);
}

/// Sculptures on pedestals under six large ceiling lights. All faces have four corners.
pub fn gallery() -> Model {
    let mut model = begin(
        "Gallery, 534 polygons, in metres, y up: sculptures under six large ceiling lights.",
        "Camera: eye 11.2 2.0 7.2  target 4.5 1.0 3.0  up 0 1 0  vertical field of view 60 degrees",
    );
    let room = Interior { width: 12.0, height: 4.0, depth: 8.0, windows: &[], walls: ["wall", "wall"] };
    room.shell(&mut model);
    model.object("lights", Place::WORLD);
    for k in 0..6 {
        let (x, z) = (1.2 + 3.8 * f64::from(k % 3), 1.2 + 3.6 * f64::from(k / 3));
        light(&mut model, "lamp", room.height, 0.1, [[x, z], [x + 2.0, z + 2.0]]);
    }
    for (k, colour) in ["book_red", "book_blue", "book_yellow", "leaf", "terracotta", "book_cream"].into_iter().enumerate() {
        let place = Place::at([2.2 + 3.8 * (k % 3) as f64, 0.0, 2.2 + 3.6 * (k / 3) as f64], 17.0 * k as f64);
        model.object("pedestal", place);
        model.cuboid("white_paint", [-0.45, 0.0, -0.45], [0.45, 0.7, 0.45], &[Bottom]);
        if k % 2 == 0 { twisted_tower(&mut model, colour) } else { arches(&mut model, colour) }
    }
    for (x, degrees, z) in [(0.0, 90.0, 4.0), (12.0, -90.0, 4.0)] {
        picture(&mut model, Place::at([x, 1.8, z], degrees), [1.8, 1.2]);
    }
    for x in [2.2, 6.0, 9.8] {
        picture(&mut model, Place::at([x, 1.8, 0.0], 0.0), [1.4, 1.0]);
    }
    room.floor_of(&mut model, 534, ["floor_light", "floor"]);
    model
}

/// Slabs on a pedestal, each turned against the one below and so much smaller that it stands on it whole: 45 faces.
fn twisted_tower(model: &mut Model, material: &str) {
    /// In degrees.
    const TURN: f64 = 8.0;
    for k in 0..9 {
        let (sin, cos) = (TURN * f64::from(k)).to_radians().sin_cos();
        let (sin_of_turn, cos_of_turn) = TURN.to_radians().sin_cos();
        let half = 0.4 / (sin_of_turn + cos_of_turn).powi(k);
        let (low, high) = (0.7 + 0.14 * f64::from(k), 0.84 + 0.14 * f64::from(k));
        let at = |x: f64, z: f64, y: f64| [half * (cos * x + sin * z), y, half * (cos * z - sin * x)];
        let ring = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let corners = |y: f64| ring.map(|[x, z]| at(x, z, y));
        let (below, above) = (corners(low), corners(high));
        model.face(material, &above);
        for side in 0..4 {
            let next = (side + 1) % 4;
            model.face(material, &[below[side], below[next], above[next], above[side]]);
        }
    }
}

/// Gates on a pedestal, one upon the other: two posts and a beam each, 56 faces.
fn arches(model: &mut Model, material: &str) {
    let mut low = 0.7;
    for k in 0..4 {
        let (half, tall, post) = (0.36 - 0.08 * f64::from(k), 0.38 - 0.05 * f64::from(k), 0.05);
        for x in [-half + post, half - post] {
            model.cuboid(material, [x - post, low, -post], [x + post, low + tall, post], &[Bottom, Top]);
        }
        model.cuboid(material, [-half, low + tall, -0.08], [half, low + tall + 0.1, 0.08], &[]);
        low += tall + 0.1;
    }
}

/// A room with panelled walls and high-backed chairs of slats, lit by five square lanterns and one of six corners.
pub fn panelled_room() -> Model {
    let mut model = begin(
        "Panelled room, 2892 polygons, in metres, y up: richly panelled, with high-backed chairs of slats and six lanterns.",
        "Camera: eye 5.6 1.75 5.5  target 2.2 1.0 1.6  up 0 1 0  vertical field of view 62 degrees",
    );
    let room = Interior { width: 6.0, height: 2.9, depth: 6.0, windows: &[], walls: ["white_paint", "white_paint"] };
    room.shell(&mut model);
    model.object("lanterns", Place::WORLD);
    for [x, z] in [[1.2, 1.2], [4.4, 1.2], [1.2, 4.4], [4.4, 4.4], [2.8, 0.5]] {
        light(&mut model, "lamp_warm", room.height, 0.3, [[x, z], [x + 0.4, z + 0.4]]);
    }
    model.object("middle_lantern", Place::at([3.0, 0.0, 3.0], 0.0));
    model.walls("metal", 6, [0.0, 0.0], (2.4, 0.3), (2.9, 0.3));
    model.disk_below("lamp_warm", 6, [0.0, 0.0], (2.4, 0.3));

    // Panels on all four walls, a table with eight chairs, a dresser.
    for (x, z, degrees) in [(0.0, 0.0, 0.0), (6.0, 0.0, -90.0), (6.0, 6.0, 180.0), (0.0, 6.0, 90.0)] {
        panelling(&mut model, Place::at([x, 0.0, z], degrees));
    }
    model.object("table", Place::at([3.0, 0.0, 3.0], 0.0));
    table(&mut model, "walnut", [1.3, 0.6], 0.74, 0.04, 0.08);
    for k in 0..6 {
        let (x, side) = (2.1 + 0.9 * f64::from(k % 3), f64::from(k / 3));
        slat_chair(&mut model, Place::at([x, 0.0, 2.25 + 1.5 * side], 180.0 * (1.0 - side)));
    }
    slat_chair(&mut model, Place::at([1.35, 0.0, 3.0], -90.0));
    slat_chair(&mut model, Place::at([4.65, 0.0, 3.0], 90.0));
    room.floor_of(&mut model, 2892, ["floor", "floor_light"]);
    model
}

/// Panels along six metres of a wall that looks along +z: 12 across and 4 above one another, each a raised board in a frame of strips, under a rail.
fn panelling(model: &mut Model, place: Place) {
    model.object("panelling", place);
    for k in 0..12 {
        let x = 0.11 + 0.485 * f64::from(k);
        for (low, high) in [(0.15, 0.6), (0.66, 1.1), (1.16, 1.6), (1.66, 1.95)] {
            model.cuboid("walnut", [x, low, 0.0], [x + 0.445, high, 0.012], &[Side::Back, Front]);
            frame(model, "walnut", [x, low], [x + 0.445, high], 0.05, 0.012);
            model.face("oak", &super::furniture::rectangle([x + 0.05, low + 0.05], [x + 0.395, high - 0.05], 0.012));
        }
    }
    model.cuboid("walnut", [0.1, 2.0, 0.0], [5.9, 2.06, 0.08], &[Side::Back]);
}

/// A chair that looks along its own -z, with a high back of slats: 104 faces.
fn slat_chair(model: &mut Model, place: Place) {
    model.object("slat_chair", place);
    table(model, "walnut", [0.2, 0.2], 0.44, 0.03, 0.035);
    for x in [-0.2, 0.17] {
        model.cuboid("walnut", [x, 0.44, 0.17], [x + 0.03, 1.35, 0.2], &[Bottom]);
    }
    for low in [0.5, 0.9, 1.25] {
        model.cuboid("walnut", [-0.17, low, 0.175], [0.17, low + 0.04, 0.195], &[Side::Left, Side::Right]);
    }
    for k in 0..7 {
        let x = -0.145 + 0.045 * f64::from(k);
        for (low, high) in [(0.54, 0.9), (0.94, 1.25)] {
            model.cuboid("walnut", [x, low, 0.18], [x + 0.02, high, 0.19], &[Bottom, Top]);
        }
    }
}
