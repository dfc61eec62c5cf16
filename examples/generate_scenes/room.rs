//! A furnished room: desk, shelf with books, sofa, tables, lamps, plant, pictures, a window with curtains.
//!
//! Five by four metres, 2.7 m high. The walls face inwards, furniture outwards. Bottoms and backs that touch something are left out, so
//! that no two surfaces face each other in one plane.

use super::furniture::{Chance, chair, frame, rectangle, table};
use super::model::{Model, Place, Side};

use Side::{Back, Bottom, Front, Left, Right, Top};

const WIDTH: f64 = 5.0;
const HEIGHT: f64 = 2.7;
const DEPTH: f64 = 4.0;

pub fn room() -> Model {
    let mut model = Model::new(&[
        "A furnished room, in metres, y up: x to the right, z towards the viewer.",
        "Camera: eye 4.72 1.62 3.82  target 1.75 0.88 0.75  up 0 1 0  vertical field of view 55 degrees",
    ]);
    materials(&mut model);
    shell(&mut model);
    window(&mut model);
    door_and_skirting(&mut model);
    rug(&mut model);
    shelf(&mut model);
    desk(&mut model);
    chair(&mut model, "desk_chair", Place::at([1.95, 0.0, 1.02], 190.0));
    chair(&mut model, "reading_chair", Place::at([3.5, 0.0, 1.5], 68.0));
    sofa(&mut model);
    coffee_table(&mut model);
    floor_lamp(&mut model);
    plant(&mut model);
    sideboard(&mut model);
    pictures(&mut model);
    model
}

fn materials(model: &mut Model) {
    let dark = [0.0; 3];
    for (name, reflectance) in [
        ("wall", [0.74, 0.71, 0.64]),
        ("accent_wall", [0.30, 0.44, 0.50]),
        ("ceiling", [0.82, 0.82, 0.80]),
        ("floor", [0.44, 0.29, 0.17]),
        ("floor_light", [0.50, 0.34, 0.21]),
        ("white_paint", [0.80, 0.80, 0.78]),
        ("oak", [0.56, 0.39, 0.22]),
        ("walnut", [0.27, 0.16, 0.09]),
        ("metal", [0.45, 0.45, 0.46]),
        ("black", [0.04, 0.04, 0.045]),
        ("screen", [0.06, 0.07, 0.09]),
        ("sofa", [0.58, 0.22, 0.12]),
        ("cushion", [0.78, 0.60, 0.22]),
        ("rug", [0.62, 0.56, 0.46]),
        ("rug_stripe", [0.16, 0.27, 0.36]),
        ("curtain", [0.72, 0.66, 0.55]),
        ("terracotta", [0.60, 0.27, 0.16]),
        ("earth", [0.09, 0.06, 0.04]),
        ("leaf", [0.13, 0.36, 0.10]),
        ("leaf_light", [0.28, 0.48, 0.14]),
        ("porcelain", [0.76, 0.77, 0.80]),
        ("paper", [0.80, 0.78, 0.70]),
        ("book_red", [0.52, 0.09, 0.07]),
        ("book_blue", [0.09, 0.17, 0.42]),
        ("book_green", [0.10, 0.30, 0.16]),
        ("book_yellow", [0.70, 0.52, 0.14]),
        ("book_grey", [0.36, 0.35, 0.34]),
        ("book_cream", [0.70, 0.64, 0.50]),
    ] {
        model.material(name, reflectance, dark);
    }
    model.material("ceiling_light", [0.6; 3], [11.0, 9.8, 8.0]);
    model.material("sky", [0.1; 3], [2.6, 3.3, 4.2]);
    model.material("lamp_shade", [0.6, 0.55, 0.45], [7.0, 4.3, 1.9]);
    model.material("desk_lamp", [0.6; 3], [26.0, 19.0, 10.0]);
}

/// Floor boards, walls around the window, the ceiling around its light.
fn shell(model: &mut Model) {
    model.object("shell", Place::WORLD);
    for board in 0..10 {
        let (near, far) = (f64::from(board) * 0.4, f64::from(board + 1) * 0.4);
        let material = if board % 3 == 1 { "floor_light" } else { "floor" };
        model.face(material, &[[0.0, 0.0, near], [0.0, 0.0, far], [WIDTH, 0.0, far], [WIDTH, 0.0, near]]);
    }
    model.face("wall", &[[0.0, 0.0, 0.0], [WIDTH, 0.0, 0.0], [WIDTH, HEIGHT, 0.0], [0.0, HEIGHT, 0.0]]);
    model.face("wall", &[[WIDTH, 0.0, DEPTH], [0.0, 0.0, DEPTH], [0.0, HEIGHT, DEPTH], [WIDTH, HEIGHT, DEPTH]]);
    model.face("wall", &[[WIDTH, 0.0, 0.0], [WIDTH, 0.0, DEPTH], [WIDTH, HEIGHT, DEPTH], [WIDTH, HEIGHT, 0.0]]);

    // The left wall around the window.
    let left = |model: &mut Model, y: [f64; 2], z: [f64; 2]| {
        model.face("accent_wall", &[[0.0, y[0], z[1]], [0.0, y[0], z[0]], [0.0, y[1], z[0]], [0.0, y[1], z[1]]]);
    };
    left(model, [0.0, WINDOW.low], [0.0, DEPTH]);
    left(model, [WINDOW.high, HEIGHT], [0.0, DEPTH]);
    left(model, [WINDOW.low, WINDOW.high], [0.0, WINDOW.near]);
    left(model, [WINDOW.low, WINDOW.high], [WINDOW.far, DEPTH]);

    // The ceiling around the light, which lies flush in it.
    let ceiling = |model: &mut Model, material: &str, x: [f64; 2], z: [f64; 2]| {
        model.face(material, &[[x[0], HEIGHT, z[0]], [x[1], HEIGHT, z[0]], [x[1], HEIGHT, z[1]], [x[0], HEIGHT, z[1]]]);
    };
    let (x, z) = ([2.0, 3.2], [1.8, 2.4]);
    ceiling(model, "ceiling", [0.0, WIDTH], [0.0, z[0]]);
    ceiling(model, "ceiling", [0.0, WIDTH], [z[1], DEPTH]);
    ceiling(model, "ceiling", [0.0, x[0]], z);
    ceiling(model, "ceiling", [x[1], WIDTH], z);
    ceiling(model, "ceiling_light", x, z);
}

struct Opening {
    low: f64,
    high: f64,
    near: f64,
    far: f64,
    depth: f64,
}

const WINDOW: Opening = Opening { low: 0.95, high: 2.25, near: 1.2, far: 2.8, depth: 0.16 };

/// The reveal, the sky behind the pane, the bars, a sill and two curtains.
fn window(model: &mut Model) {
    model.object("window", Place::WORLD);
    let Opening { low, high, near, far, depth } = WINDOW;
    model.face("white_paint", &[[-depth, low, near], [-depth, low, far], [0.0, low, far], [0.0, low, near]]);
    model.face("white_paint", &[[-depth, high, far], [-depth, high, near], [0.0, high, near], [0.0, high, far]]);
    model.face("white_paint", &[[-depth, low, near], [0.0, low, near], [0.0, high, near], [-depth, high, near]]);
    model.face("white_paint", &[[0.0, low, far], [-depth, low, far], [-depth, high, far], [0.0, high, far]]);
    model.face("sky", &[[-depth, low, far], [-depth, low, near], [-depth, high, near], [-depth, high, far]]);

    // One upright bar from end to end and two level ones that meet it.
    let (back, front, middle) = (-0.12, -0.08, 0.5 * (near + far));
    model.cuboid("white_paint", [back, low, middle - 0.02], [front, high, middle + 0.02], &[Bottom, Top]);
    let across = low + 0.62 * (high - low);
    model.cuboid("white_paint", [back, across - 0.02, near], [front, across + 0.02, middle - 0.02], &[Back, Front]);
    model.cuboid("white_paint", [back, across - 0.02, middle + 0.02], [front, across + 0.02, far], &[Back, Front]);
    model.cuboid("white_paint", [0.0, low - 0.03, near - 0.05], [0.035, low, far + 0.05], &[Left]);

    // Curtains in folds, seen from both sides, and their rail.
    model.object("curtains", Place::WORLD);
    for start in [near - 0.42, far] {
        for fold in 0..7 {
            let at = |k: i32| (if k % 2 == 0 { 0.05 } else { 0.1 }, start + 0.06 * f64::from(k));
            let ((x0, z0), (x1, z1)) = (at(fold), at(fold + 1));
            model.sheet("curtain", &[[x0, 0.12, z0], [x1, 0.12, z1], [x1, 2.37, z1], [x0, 2.37, z0]]);
        }
    }
    model.cuboid("metal", [0.06, 2.375, near - 0.5], [0.09, 2.4, far + 0.5], &[]);
}

fn door_and_skirting(model: &mut Model) {
    model.object("door", Place::WORLD);
    let (left, right, top) = (3.72, 4.56, 2.05);
    model.cuboid("white_paint", [left, 0.0, 0.0], [right, top, 0.025], &[Bottom, Back, Left, Right, Top]);
    for (low, high) in [(0.15, 0.95), (1.1, 1.9)] {
        model.cuboid("white_paint", [left + 0.12, low, 0.025], [right - 0.12, high, 0.037], &[Back]);
    }
    // The frame stands around it, a little further into the room.
    let (deep, flush) = (0.045, 0.025);
    model.cuboid("white_paint", [left - 0.07, 0.0, 0.0], [left, top, deep], &[Bottom, Back, Top, Right]);
    model.cuboid("white_paint", [right, 0.0, 0.0], [right + 0.07, top, deep], &[Bottom, Back, Top, Left]);
    model.cuboid("white_paint", [left - 0.07, top, 0.0], [right + 0.07, top + 0.07, deep], &[Back, Bottom]);
    model.face("white_paint", &[[left, 0.0, deep], [left, 0.0, flush], [left, top, flush], [left, top, deep]]);
    model.face("white_paint", &[[right, 0.0, flush], [right, 0.0, deep], [right, top, deep], [right, top, flush]]);
    model.face("white_paint", &[[left, top, flush], [right, top, flush], [right, top, deep], [left, top, deep]]);
    model.cuboid("metal", [left + 0.05, 1.0, 0.025], [left + 0.16, 1.025, 0.075], &[Back]);

    // Skirting boards end at the corners and at the door.
    model.object("skirting", Place::WORLD);
    let (height, depth) = (0.08, 0.015);
    model.cuboid("white_paint", [0.0, 0.0, 0.0], [left - 0.07, height, depth], &[Bottom, Back, Left, Right]);
    model.cuboid("white_paint", [right + 0.07, 0.0, 0.0], [WIDTH, height, depth], &[Bottom, Back, Left, Right]);
    model.cuboid("white_paint", [0.0, 0.0, depth], [depth, height, DEPTH], &[Bottom, Back, Left, Front]);
    model.cuboid("white_paint", [WIDTH - depth, 0.0, depth], [WIDTH, height, DEPTH], &[Bottom, Back, Right, Front]);
}

/// A rug of stripes, a centimetre thick.
fn rug(model: &mut Model) {
    model.object("rug", Place::at([2.35, 0.0, 2.05], 4.0));
    let (x, z, height) = (1.15, 0.8, 0.01);
    model.cuboid("rug", [-x, 0.0, -z], [x, height, z], &[Bottom, Top]);
    let stripes = [0.0, 0.12, 0.2, 0.26, 0.74, 0.8, 0.88, 1.0];
    for (k, pair) in stripes.windows(2).enumerate() {
        let (from, to) = (-x + 2.0 * x * pair[0], -x + 2.0 * x * pair[1]);
        let material = if k % 2 == 1 { "rug_stripe" } else { "rug" };
        model.face(material, &[[from, height, z], [to, height, z], [to, height, -z], [from, height, -z]]);
    }
}

/// A shelf with five boards of books.
fn shelf(model: &mut Model) {
    model.object("shelf", Place::at([0.12, 0.0, 0.02], 0.0));
    let (width, depth, height, board) = (1.0, 0.3, 2.0, 0.025);
    model.cuboid("oak", [0.0, 0.0, 0.0], [board, height, depth], &[Bottom]);
    model.cuboid("oak", [width - board, 0.0, 0.0], [width, height, depth], &[Bottom]);
    let back = 0.01;
    model.cuboid("oak", [board, 0.0, 0.0], [width - board, height, back], &[Bottom, Left, Right]);

    // Heights of the tops of the boards; the last closes the shelf.
    let tops = [0.1, 0.46, 0.82, 1.18, 1.54, height];
    for top in tops {
        model.cuboid("oak", [board, top - board, back], [width - board, top, depth - 0.01], &[Left, Right, Back]);
    }

    // Books: thickness, height and depth from a small generator of our own, so that they never change.
    let colours = ["book_red", "book_blue", "book_cream", "book_green", "book_grey", "book_yellow"];
    let mut chance = Chance(20);
    for (k, pair) in tops.windows(2).enumerate().skip(1) {
        let room = pair[1] - board - pair[0];
        let mut x = board + 0.01 + 0.05 * chance.next();
        let end = width - board - if k % 2 == 0 { 0.16 } else { 0.4 };
        while x < end {
            let thickness = 0.05 + 0.06 * chance.next();
            let tall = room * (0.62 + 0.3 * chance.next());
            let deep = 0.16 + 0.07 * chance.next();
            let colour = colours[(chance.next() * 5.999) as usize];
            let right = (x + thickness).min(width - board - 0.005);
            model.cuboid(colour, [x, pair[0], depth - 0.02 - deep], [right, pair[0] + tall, depth - 0.02], &[Bottom]);
            x = right + 0.003 + if chance.next() > 0.85 { 0.06 } else { 0.0 };
        }
    }
    for x in [0.05, 0.52] {
        model.cuboid("rug", [x, tops[0], 0.04], [x + 0.42, tops[0] + 0.26, depth - 0.02], &[Bottom]);
    }
    model.walls("porcelain", 8, [0.82, 0.17], (0.82, 0.06), (1.0, 0.085));
    model.disk("black", 8, [0.82, 0.17], (1.0, 0.085));
}

/// A desk with drawers, a screen, a keyboard, a mug and a lamp.
fn desk(model: &mut Model) {
    model.object("desk", Place::at([1.98, 0.0, 0.42], 0.0));
    let height = 0.74;
    table(model, "walnut", [0.75, 0.36], height, 0.03, 0.05);

    // Three drawers hang below the top.
    model.cuboid("walnut", [0.3, 0.12, -0.3], [0.66, height - 0.03, 0.28], &[Top]);
    for k in 0..3 {
        let low = 0.14 + 0.19 * f64::from(k);
        model.cuboid("oak", [0.31, low, 0.28], [0.65, low + 0.17, 0.292], &[Back]);
    }

    // Screen on a foot, keyboard, paper.
    model.cuboid("black", [-0.14, height, -0.22], [0.14, height + 0.012, -0.04], &[Bottom]);
    model.cuboid("black", [-0.025, height + 0.012, -0.16], [0.025, height + 0.16, -0.13], &[Bottom]);
    model.cuboid("black", [-0.3, height + 0.1, -0.13], [0.3, height + 0.47, -0.1], &[Front]);
    frame(model, "black", [-0.3, height + 0.1], [0.3, height + 0.47], 0.015, -0.1);
    model.face("screen", &rectangle([-0.285, height + 0.115], [0.285, height + 0.455], -0.1));
    model.cuboid("metal", [-0.22, height, 0.08], [0.2, height + 0.018, 0.22], &[Bottom]);
    model.cuboid("paper", [0.34, height, 0.0], [0.55, height + 0.012, 0.28], &[Bottom]);
    model.cuboid("book_blue", [0.36, height + 0.012, 0.03], [0.52, height + 0.04, 0.25], &[Bottom]);
    model.walls("book_yellow", 6, [0.27, 0.2], (height, 0.036), (height + 0.09, 0.04));
    model.disk("earth", 6, [0.27, 0.2], (height + 0.09, 0.04));

    // The lamp: foot, arm, and a head that shines down.
    model.object("desk_lamp", Place::at([1.38, height, 0.32], 0.0));
    model.walls("metal", 6, [0.0, 0.0], (0.0, 0.08), (0.018, 0.08));
    model.disk("metal", 6, [0.0, 0.0], (0.018, 0.08));
    model.cuboid("metal", [-0.008, 0.018, -0.008], [0.008, 0.42, 0.008], &[Bottom]);
    model.cuboid("metal", [0.008, 0.39, -0.008], [0.14, 0.406, 0.008], &[Left]);
    model.walls("book_green", 8, [0.2, 0.0], (0.34, 0.09), (0.43, 0.05));
    model.disk("book_green", 8, [0.2, 0.0], (0.43, 0.05));
    model.disk_below("desk_lamp", 8, [0.2, 0.0], (0.34, 0.09));
}

/// A sofa below the window, looking into the room.
fn sofa(model: &mut Model) {
    model.object("sofa", Place::at([0.14, 0.0, 2.0], 0.0));
    let (deep, half) = (0.85, 0.95);
    model.cuboid("sofa", [0.0, 0.1, -half], [deep, 0.3, half], &[]);
    for (x, z) in [(0.06, -0.85), (0.06, 0.85), (deep - 0.06, -0.85), (deep - 0.06, 0.85)] {
        model.cuboid("walnut", [x - 0.025, 0.0, z - 0.025], [x + 0.025, 0.1, z + 0.025], &[Bottom, Top]);
    }
    model.cuboid("sofa", [0.0, 0.3, -half], [0.2, 0.8, half], &[Bottom]);
    for (low, high) in [(-half, -half + 0.18), (half - 0.18, half)] {
        model.cuboid("sofa", [0.2, 0.3, low], [deep, 0.6, high], &[Bottom, Left]);
    }
    for z in [-0.76, 0.005] {
        model.cuboid("sofa", [0.215, 0.3, z], [deep + 0.02, 0.44, z + 0.755], &[Bottom]);
    }

    // Loose cushions stand on the seats.
    for (z, degrees, material) in [(-0.5, 14.0, "cushion"), (0.5, -10.0, "rug_stripe")] {
        model.object("cushion", Place::at([0.42, 0.445, 2.0 + z], degrees));
        model.cuboid(material, [-0.06, 0.0, -0.19], [0.06, 0.36, 0.19], &[]);
    }
}

/// A low table on the rug, with books and a bowl.
fn coffee_table(model: &mut Model) {
    model.object("coffee_table", Place::at([2.05, 0.01, 2.05], 3.0));
    let height = 0.4;
    table(model, "walnut", [0.32, 0.52], height, 0.035, 0.045);
    model.cuboid("book_red", [-0.15, height, 0.12], [0.11, height + 0.03, 0.32], &[Bottom]);
    model.cuboid("book_cream", [-0.12, height + 0.03, 0.14], [0.09, height + 0.055, 0.3], &[Bottom]);

    // The bowl is open: outside, rim, inside, ground.
    let centre = [0.02, -0.22];
    model.walls("porcelain", 7, centre, (height, 0.07), (height + 0.08, 0.14));
    model.rim("porcelain", 7, centre, (height + 0.08, 0.13), (height + 0.08, 0.14));
    model.inner_walls("porcelain", 7, centre, (height + 0.012, 0.06), (height + 0.08, 0.13));
    model.disk("porcelain", 7, centre, (height + 0.012, 0.06));
    for (x, z, material) in [(0.0, -0.25, "book_red"), (0.05, -0.19, "leaf_light")] {
        model.walls(material, 6, [x, z], (height + 0.012, 0.03), (height + 0.07, 0.022));
        model.disk(material, 6, [x, z], (height + 0.07, 0.022));
    }
}

/// A lamp whose shade glows.
fn floor_lamp(model: &mut Model) {
    model.object("floor_lamp", Place::at([0.42, 0.0, 0.66], 0.0));
    let centre = [0.0, 0.0];
    model.walls("black", 8, centre, (0.0, 0.14), (0.025, 0.13));
    model.disk("black", 8, centre, (0.025, 0.13));
    model.walls("metal", 4, centre, (0.025, 0.012), (1.3, 0.012));
    model.walls("lamp_shade", 10, centre, (1.3, 0.2), (1.58, 0.13));
    model.disk("lamp_shade", 10, centre, (1.58, 0.13));
    model.disk_below("lamp_shade", 10, centre, (1.3, 0.2));
}

/// A pot with earth, a stem, and leaves that are seen from both sides.
fn plant(model: &mut Model) {
    model.object("plant", Place::at([3.2, 0.0, 0.42], 0.0));
    let centre = [0.0, 0.0];
    model.walls("terracotta", 8, centre, (0.0, 0.13), (0.3, 0.19));
    model.rim("terracotta", 8, centre, (0.3, 0.165), (0.3, 0.19));
    model.inner_walls("terracotta", 8, centre, (0.26, 0.16), (0.3, 0.165));
    model.disk("earth", 8, centre, (0.26, 0.16));
    model.walls("walnut", 4, centre, (0.26, 0.018), (1.05, 0.012));
    model.disk("walnut", 4, centre, (1.05, 0.012));
    for leaf in 0..11 {
        let turn = f64::from(leaf) * 137.5_f64.to_radians();
        let (sin, cos) = turn.sin_cos();
        let height = 0.45 + 0.05 * f64::from(leaf);
        let (length, half, rise) = (0.46 - 0.018 * f64::from(leaf), 0.1 - 0.003 * f64::from(leaf), 0.1 + 0.018 * f64::from(leaf));

        // A rhomb from the stem outwards and upwards.
        let along = |t: f64, aside: f64| {
            [(0.02 + length * t) * cos - aside * sin, height + rise * t, (0.02 + length * t) * sin + aside * cos]
        };
        let material = if leaf % 3 == 0 { "leaf_light" } else { "leaf" };
        model.sheet(material, &[along(0.0, 0.0), along(0.45, half), along(1.0, 0.0), along(0.45, -half)]);
    }
}

/// A low cupboard at the right wall with a vase.
fn sideboard(model: &mut Model) {
    model.object("sideboard", Place::at([4.55, 0.0, 1.45], -90.0));
    // In its own frame it looks along +z, which is into the room.
    let (half, height) = (0.75, 0.72);
    model.cuboid("oak", [-half, 0.0, -0.4], [half, height, 0.0], &[Bottom]);
    for k in 0..3 {
        let x = -half + 0.02 + 0.49 * f64::from(k);
        model.cuboid("white_paint", [x, 0.09, 0.0], [x + 0.48, height - 0.03, 0.015], &[Back]);
    }
    let centre = [-0.35, -0.2];
    model.walls("porcelain", 8, centre, (height, 0.05), (height + 0.12, 0.1));
    model.walls("porcelain", 8, centre, (height + 0.12, 0.1), (height + 0.28, 0.035));
    model.disk("black", 8, centre, (height + 0.28, 0.035));
    model.cuboid("book_cream", [0.2, height, -0.3], [0.45, height + 0.04, -0.12], &[Bottom]);
}

/// Framed pictures above the desk.
fn pictures(model: &mut Model) {
    for (name, x, y, width, high) in [("picture_large", 1.98, 1.72, 0.9, 0.62), ("picture_small", 3.1, 1.68, 0.42, 0.54)] {
        model.object(name, Place::at([x, y, 0.0], 0.0));
        let (low, top) = ([-width / 2.0, -high / 2.0], [width / 2.0, high / 2.0]);
        model.cuboid("black", [low[0], low[1], 0.0], [top[0], top[1], 0.03], &[Back, Front]);
        frame(model, "black", low, top, 0.03, 0.03);

        // A field of coloured rectangles in a mount.
        let (low, top) = (low.map(|v| v + 0.03), top.map(|v| v - 0.03));
        frame(model, "paper", low, top, 0.05, 0.03);
        let (low, top) = (low.map(|v| v + 0.05), top.map(|v| v - 0.05));
        let at = |u: f64, v: f64| [low[0] + u * (top[0] - low[0]), low[1] + v * (top[1] - low[1])];
        for (material, from, to) in [
            ("rug_stripe", at(0.0, 0.0), at(1.0, 0.3)),
            ("book_yellow", at(0.0, 0.3), at(0.35, 0.7)),
            ("sofa", at(0.35, 0.3), at(0.8, 0.55)),
            ("book_cream", at(0.35, 0.55), at(0.8, 0.7)),
            ("leaf", at(0.8, 0.3), at(1.0, 0.7)),
            ("accent_wall", at(0.0, 0.7), at(0.6, 1.0)),
            ("book_red", at(0.6, 0.7), at(1.0, 1.0)),
        ] {
            model.face(material, &rectangle(from, to, 0.03));
        }
    }
}
