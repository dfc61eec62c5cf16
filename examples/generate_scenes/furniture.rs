//! Furniture that several rooms share, in metres, y up. Each piece stands on the floor of its own place.

use super::model::{Model, Place, Point, Side};

use Side::{Back, Bottom, Front, Left, Right, Top};

/// Numbers from 0 to 1 that are the same on every machine.
pub struct Chance(pub u32);

impl Chance {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1_u32 << 24)
    }
}

/// A table top on four legs; the bottom of the top is seen between the legs.
pub fn table(model: &mut Model, material: &str, half: [f64; 2], height: f64, thickness: f64, leg: f64) {
    let [x, z] = half;
    model.cuboid(material, [-x, height - thickness, -z], [x, height, z], &[]);
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let (cx, cz) = (sx * (x - leg), sz * (z - leg));
        let half = 0.5 * leg;
        model.cuboid(material, [cx - half, 0.0, cz - half], [cx + half, height - thickness, cz + half], &[Bottom, Top]);
    }
}

/// A level rectangle towards the viewer at depth `z`.
pub fn rectangle(low: [f64; 2], high: [f64; 2], z: f64) -> [Point; 4] {
    [[low[0], low[1], z], [high[0], low[1], z], [high[0], high[1], z], [low[0], high[1], z]]
}

/// A flat frame of four strips inside of a rectangle.
pub fn frame(model: &mut Model, material: &str, low: [f64; 2], high: [f64; 2], strip: f64, z: f64) {
    let (inner_low, inner_high) = (low.map(|v| v + strip), high.map(|v| v - strip));
    model.face(material, &rectangle(low, [high[0], inner_low[1]], z));
    model.face(material, &rectangle([low[0], inner_high[1]], high, z));
    model.face(material, &rectangle([low[0], inner_low[1]], [inner_low[0], inner_high[1]], z));
    model.face(material, &rectangle([inner_high[0], inner_low[1]], [high[0], inner_high[1]], z));
}

/// A chair that looks along its own -z.
pub fn chair(model: &mut Model, name: &str, place: Place) {
    model.object(name, place);
    table(model, "oak", [0.21, 0.21], 0.45, 0.03, 0.035);
    for x in [-0.19, 0.16] {
        model.cuboid("oak", [x, 0.45, 0.175], [x + 0.03, 0.92, 0.205], &[Bottom]);
    }
    for low in [0.6, 0.78] {
        model.cuboid("oak", [-0.16, low, 0.18], [0.16, low + 0.11, 0.2], &[Left, Right]);
    }
    model.cuboid("cushion", [-0.19, 0.45, -0.19], [0.19, 0.485, 0.165], &[Bottom]);
}

/// Materials of rooms: those that a model uses are written.
pub fn materials(model: &mut Model) {
    for (name, reflectance) in [
        ("wall", [0.74, 0.71, 0.64]),
        ("accent_wall", [0.30, 0.44, 0.50]),
        ("warm_wall", [0.68, 0.50, 0.36]),
        ("ceiling", [0.82, 0.82, 0.80]),
        ("floor", [0.44, 0.29, 0.17]),
        ("floor_light", [0.50, 0.34, 0.21]),
        ("carpet", [0.28, 0.32, 0.38]),
        ("white_paint", [0.80, 0.80, 0.78]),
        ("oak", [0.56, 0.39, 0.22]),
        ("walnut", [0.27, 0.16, 0.09]),
        ("metal", [0.45, 0.45, 0.46]),
        ("black", [0.04, 0.04, 0.045]),
        ("screen", [0.06, 0.07, 0.09]),
        ("cushion", [0.78, 0.60, 0.22]),
        ("rug", [0.62, 0.56, 0.46]),
        ("rug_stripe", [0.16, 0.27, 0.36]),
        ("curtain", [0.72, 0.66, 0.55]),
        ("terracotta", [0.60, 0.27, 0.16]),
        ("earth", [0.09, 0.06, 0.04]),
        ("bark", [0.34, 0.26, 0.19]),
        ("leaf", [0.13, 0.36, 0.10]),
        ("leaf_light", [0.28, 0.48, 0.14]),
        ("porcelain", [0.76, 0.77, 0.80]),
        ("paper", [0.80, 0.78, 0.70]),
    ] {
        model.material(name, reflectance, [0.0; 3]);
    }
    for (name, reflectance) in BOOK_COLOURS {
        model.material(name, reflectance, [0.0; 3]);
    }
    model.material("lamp", [0.6; 3], [24.0, 22.0, 18.5]);
    model.material("lamp_warm", [0.6, 0.55, 0.45], [46.0, 35.0, 21.0]);
    model.material("sky", [0.1; 3], [2.6, 3.3, 4.2]);
}

/// Covers of books.
const BOOK_COLOURS: [(&str, Point); 6] = [
    ("book_red", [0.52, 0.09, 0.07]),
    ("book_blue", [0.09, 0.17, 0.42]),
    ("book_cream", [0.70, 0.64, 0.50]),
    ("book_green", [0.10, 0.30, 0.16]),
    ("book_grey", [0.36, 0.35, 0.34]),
    ("book_yellow", [0.70, 0.52, 0.14]),
];

/// A desk, 1.6 m wide, at which one sits at +z: a pedestal of drawers, a panel, a screen, a keyboard, paper. 62 faces.
pub fn office_desk(model: &mut Model, name: &str, place: Place) {
    model.object(name, place);
    let height = 0.74;
    model.cuboid("oak", [-0.8, height - 0.03, -0.4], [0.8, height, 0.4], &[]);
    model.cuboid("walnut", [0.32, 0.04, -0.36], [0.76, height - 0.03, 0.34], &[Top]);
    for k in 0..3 {
        let low = 0.06 + 0.21 * f64::from(k);
        model.cuboid("oak", [0.34, low, 0.34], [0.74, low + 0.19, 0.352], &[Back]);
    }
    model.cuboid("walnut", [-0.76, 0.0, -0.36], [-0.72, height - 0.03, 0.36], &[Bottom, Top]);

    // Screen on a foot, keyboard, a stack of paper and a book.
    model.cuboid("black", [-0.14, height, -0.24], [0.14, height + 0.012, -0.06], &[Bottom]);
    model.cuboid("black", [-0.025, height + 0.012, -0.18], [0.025, height + 0.16, -0.15], &[Bottom]);
    model.cuboid("black", [-0.3, height + 0.1, -0.15], [0.3, height + 0.47, -0.12], &[Front]);
    frame(model, "black", [-0.3, height + 0.1], [0.3, height + 0.47], 0.015, -0.12);
    model.face("screen", &rectangle([-0.285, height + 0.115], [0.285, height + 0.455], -0.12));
    model.cuboid("metal", [-0.22, height, 0.08], [0.2, height + 0.018, 0.22], &[Bottom]);
    model.cuboid("paper", [0.38, height, 0.0], [0.59, height + 0.012, 0.28], &[Bottom]);
}

/// A lamp on a desk, at the desk's height: foot, arm, and a head that shines down. 39 faces.
pub fn desk_lamp(model: &mut Model, place: Place) {
    model.object("desk_lamp", place);
    model.walls("metal", 6, [0.0, 0.0], (0.0, 0.08), (0.018, 0.08));
    model.disk("metal", 6, [0.0, 0.0], (0.018, 0.08));
    model.cuboid("metal", [-0.008, 0.018, -0.008], [0.008, 0.42, 0.008], &[Bottom]);
    model.cuboid("metal", [0.008, 0.39, -0.008], [0.14, 0.406, 0.008], &[Left]);
    model.walls("book_green", 8, [0.2, 0.0], (0.34, 0.09), (0.43, 0.05));
    model.disk("book_green", 8, [0.2, 0.0], (0.43, 0.05));
    model.disk_below("lamp_warm", 8, [0.2, 0.0], (0.34, 0.09));
}

/// A plain chair that looks along its own -z: seat, four legs, back. 27 faces.
pub fn plain_chair(model: &mut Model, name: &str, place: Place) {
    model.object(name, place);
    table(model, "walnut", [0.22, 0.21], 0.45, 0.04, 0.04);
    model.cuboid("walnut", [-0.22, 0.45, 0.17], [0.22, 0.9, 0.2], &[Bottom]);
}

/// A shelf of one metre against a wall behind it, open to +z, 0.3 m deep: 31 faces, and up to `books` books of 5 faces.
///
/// Books stand in rows from the top board down, `thickness` from and up to.
pub fn bookshelf(model: &mut Model, name: &str, place: Place, books: usize, thickness: [f64; 2], chance: &mut Chance) {
    model.object(name, place);
    let (width, depth, height, board, back) = (1.0, 0.3, 2.0, 0.025, 0.01);
    for x in [0.0, width - board] {
        model.cuboid("oak", [x, 0.0, 0.0], [x + board, height, depth], &[Bottom]);
    }
    model.cuboid("oak", [board, 0.0, 0.0], [width - board, height, back], &[Bottom, Left, Right]);
    let tops = [0.1, 0.48, 0.86, 1.24, 1.62, height];
    for top in tops {
        model.cuboid("oak", [board, top - board, back], [width - board, top, depth - 0.01], &[Left, Right, Back]);
    }

    let mut left = books;
    for pair in tops.windows(2).rev() {
        let room = pair[1] - board - pair[0];
        let mut x = board + 0.01;
        while left > 0 {
            let right = x + thickness[0] + (thickness[1] - thickness[0]) * chance.next();
            if right > width - board - 0.005 {
                break;
            }
            let tall = room * (0.62 + 0.3 * chance.next());
            let deep = 0.16 + 0.07 * chance.next();
            let (colour, _) = BOOK_COLOURS[(chance.next() * 5.999) as usize];
            model.cuboid(colour, [x, pair[0], depth - 0.02 - deep], [right, pair[0] + tall, depth - 0.02], &[Bottom]);
            x = right + 0.002;
            left -= 1;
        }
    }
}

/// A pot with earth, at the floor: 25 faces with 8 sides.
pub fn pot(model: &mut Model, (low, high, tall): (f64, f64, f64)) {
    let centre = [0.0, 0.0];
    model.walls("terracotta", 8, centre, (0.0, low), (tall, high));
    model.rim("terracotta", 8, centre, (tall, high - 0.025), (tall, high));
    model.inner_walls("terracotta", 8, centre, (tall - 0.04, high - 0.03), (tall, high - 0.025));
    model.disk("earth", 8, centre, (tall - 0.04, high - 0.03));
}

/// A rhomb that is seen from both sides, from `foot` along `along`, half as wide as `aside`: 2 faces.
pub fn leaf(model: &mut Model, material: &str, foot: Point, along: Point, aside: Point) {
    let at = |t: f64, s: f64| std::array::from_fn(|k| foot[k] + t * along[k] + s * aside[k]);
    model.sheet(material, &[at(0.0, 0.0), at(0.45, 1.0), at(1.0, 0.0), at(0.45, -1.0)]);
}

/// A pot with a stem and `leaves` leaves around it: 30 faces, and 2 for every leaf.
pub fn plant(model: &mut Model, place: Place, leaves: usize) {
    model.object("plant", place);
    pot(model, (0.13, 0.19, 0.3));
    model.walls("bark", 4, [0.0, 0.0], (0.26, 0.018), (1.2, 0.012));
    model.disk("bark", 4, [0.0, 0.0], (1.2, 0.012));
    for k in 0..leaves {
        let share = (k as f64 + 0.5) / leaves as f64;
        let (sin, cos) = (k as f64 * 137.5_f64.to_radians()).sin_cos();
        let (length, rise) = (0.46 - 0.25 * share, 0.08 + 0.2 * share);
        let half = 0.1 * (11.0 / leaves.max(11) as f64).sqrt();
        let foot = [0.02 * cos, 0.4 + 0.8 * share, 0.02 * sin];
        let material = if k % 3 == 0 { "leaf_light" } else { "leaf" };
        leaf(model, material, foot, [length * cos, rise, length * sin], [-half * sin, 0.0, half * cos]);
    }
}

/// A picture in a frame that hangs on the wall behind it: 17 faces.
pub fn picture(model: &mut Model, place: Place, [width, high]: [f64; 2]) {
    model.object("picture", place);
    let (low, top) = ([-width / 2.0, -high / 2.0], [width / 2.0, high / 2.0]);
    model.cuboid("black", [low[0], low[1], 0.0], [top[0], top[1], 0.03], &[Back, Front]);
    frame(model, "black", low, top, 0.03, 0.03);
    let (low, top) = (low.map(|v| v + 0.03), top.map(|v| v - 0.03));
    frame(model, "paper", low, top, 0.05, 0.03);
    let (low, top) = (low.map(|v| v + 0.05), top.map(|v| v - 0.05));
    let middle = low[1] + 0.4 * (top[1] - low[1]);
    let across = low[0] + 0.62 * (top[0] - low[0]);
    for (material, from, to) in [
        ("rug_stripe", low, [across, middle]),
        ("book_yellow", [across, low[1]], [top[0], middle]),
        ("leaf", [low[0], middle], [across, 0.5 * (middle + top[1])]),
        ("book_cream", [low[0], 0.5 * (middle + top[1])], [across, top[1]]),
        ("book_red", [across, middle], top),
    ] {
        model.face(material, &rectangle(from, to, 0.03));
    }
}

/// A box below the ceiling whose underside shines: 5 faces. `low` and `high` are corners in x and z.
pub fn ceiling_lamp(model: &mut Model, ceiling: f64, low: [f64; 2], high: [f64; 2]) {
    let deep = 0.06;
    model.cuboid("metal", [low[0], ceiling - deep, low[1]], [high[0], ceiling, high[1]], &[Top, Bottom]);
    let y = ceiling - deep;
    model.face("lamp", &[[low[0], y, low[1]], [high[0], y, low[1]], [high[0], y, high[1]], [low[0], y, high[1]]]);
}
