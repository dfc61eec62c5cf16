//! Scenes of vegetation under a sky: a tree, a hedge, a field of maize, a garden with a house, and a shrub that is small enough to be kept.
//!
//! A sky is a box of dim panels around the scene, and the sun a small bright one: nothing is infinitely far in a scene of polygons. Leaves reflect from
//! both sides and let nothing through. Channels are red, green and blue, but in the maize, where they are bands that crops are watched in.

use super::foliage::{Growth, broad_leaved, hedge as grow_hedge, maize as grow_maize};
use super::furniture::Chance;
use super::model::{Model, Place, Point, Side};

/// The scene of a kind, by the name that the program takes: of so many leaves, of maize so many plants.
pub fn of_kind(kind: &str, count: usize, seed: u32) -> Option<Model> {
    match kind {
        "tree" => Some(tree(count, seed)),
        "hedge" => Some(hedge(count, seed)),
        "maize" => Some(maize(count, seed)),
        "garden" => Some(garden(count, seed)),
        _ => None,
    }
}

/// A broad-leaved tree of about six metres on a lawn; the more leaves, the smaller, so that their area stays that of a dense crown.
pub fn tree(leaves: usize, seed: u32) -> Model {
    let mut model = begin(&[
        &format!("A broad-leaved tree of {leaves} leaves, seed {seed}, in metres, y up."),
        "Camera: eye 6.6 2.2 6.4  target 0 2.9 0  up 0 1 0  vertical field of view 45 degrees",
    ]);
    sky(&mut model, 8.0, 9.0, [4.5, 3.5]);
    let growth = Growth { foot: [0.0; 3], trunk: 1.5, girth: 0.16, branch: 1.35, leaf_area: 70.0, leaves };
    broad_leaved(&mut model, "tree", growth, &mut Chance(seed));
    model
}

/// A shrub of 2000 leaves on a square of lawn.
pub fn shrub() -> Model {
    let mut model = begin(&[
        "A shrub of 2000 leaves, in metres, y up.",
        "Camera: eye 2.3 1.5 2.4  target 0 0.75 0  up 0 1 0  vertical field of view 45 degrees",
    ]);
    sky(&mut model, 3.0, 4.0, [1.8, 1.2]);
    let growth = Growth { foot: [0.0; 3], trunk: 0.25, girth: 0.04, branch: 0.42, leaf_area: 6.0, leaves: 2000 };
    broad_leaved(&mut model, "shrub", growth, &mut Chance(5));
    model
}

/// A hedge of four metres, and a path before it.
pub fn hedge(leaves: usize, seed: u32) -> Model {
    let mut model = begin(&[
        &format!("A hedge of {leaves} leaves, seed {seed}, in metres, y up."),
        "Camera: eye 3.4 1.9 4.6  target 0 0.7 0  up 0 1 0  vertical field of view 45 degrees",
    ]);
    sky(&mut model, 6.0, 7.0, [3.0, -2.5]);
    model.object("path", Place::WORLD);
    model.face("gravel", &[[-5.0, 0.01, 1.0], [-5.0, 0.01, 2.2], [5.0, 0.01, 2.2], [5.0, 0.01, 1.0]]);
    grow_hedge(&mut model, [[-2.0, 0.05, -0.4], [2.0, 1.6, 0.4]], 26.0, leaves, &mut Chance(seed));
    model
}

/// Maize in rows of ten, 0.75 m apart, 0.22 m from plant to plant. Channels are near infrared, red and green, as in a colour-infrared photograph:
/// green leaves reflect near infrared by about a half, red by a twentieth.
pub fn maize(plants: usize, seed: u32) -> Model {
    let mut model = Model::new(&[
        &format!("Maize, {plants} plants, seed {seed}, in metres, y up. Channels: near infrared, red, green."),
        "Camera: eye 3.6 3 3.9  target 0 0.9 0  up 0 1 0  vertical field of view 45 degrees",
    ]);
    for (name, reflectance) in [("lawn", [0.28, 0.2, 0.15]), ("bark", [0.45, 0.08, 0.14]), ("blade", [0.47, 0.05, 0.11])] {
        model.material(name, reflectance, [0.0; 3]);
    }
    lights(&mut model, [1.6, 2.6, 3.0], [150.0, 190.0, 190.0]);
    let rows = plants.div_ceil(10);
    let half = 3.0_f64.max(0.4 * rows as f64) + 1.0;
    sky(&mut model, half, 6.0, [2.0, 1.2]);
    model.object("maize", Place::WORLD);
    let mut chance = Chance(seed);
    for plant in 0..plants {
        let (row, along) = (plant / 10, plant % 10);
        let x = 0.75 * (row as f64 - 0.5 * (rows as f64 - 1.0)) + 0.04 * (chance.next() - 0.5);
        let z = 0.22 * (along as f64 - 4.5) + 0.04 * (chance.next() - 0.5);
        grow_maize(&mut model, [x, 0.0, z], &mut chance);
    }
    model
}

/// A house, a tree on either side of the path to its door, and a hedge towards the street; a third of the leaves each.
pub fn garden(leaves: usize, seed: u32) -> Model {
    let mut model = begin(&[
        &format!("A garden of {leaves} leaves with a house, seed {seed}, in metres, y up."),
        "Camera: eye 8.6 4.2 7.6  target -0.6 1.7 -1.4  up 0 1 0  vertical field of view 50 degrees",
    ]);
    sky(&mut model, 11.0, 11.0, [6.5, 4.0]);
    house(&mut model);
    model.object("path", Place::WORLD);
    model.face("gravel", &[[-0.7, 0.01, -3.0], [-0.7, 0.01, 6.0], [0.7, 0.01, 6.0], [0.7, 0.01, -3.0]]);
    let mut chance = Chance(seed);
    let third = leaves / 3;
    for (name, x, z, branch) in [("left_tree", -4.2, 1.2, 1.0), ("right_tree", 4.0, 0.2, 1.2)] {
        let growth = Growth { foot: [x, 0.0, z], trunk: 1.4, girth: 0.13, branch, leaf_area: 40.0, leaves: third };
        broad_leaved(&mut model, name, growth, &mut chance);
    }
    grow_hedge(&mut model, [[-7.0, 0.05, 5.2], [-1.2, 1.3, 5.9]], 30.0, leaves - 2 * third, &mut chance);
    model
}

/// Walls with a door and windows, a gable roof: 8 m wide, 5 m deep, at the back of the garden.
fn house(model: &mut Model) {
    let (half, back, front, eaves, ridge) = (4.0, -8.0, -3.0, 3.0, 5.2);
    let middle = 0.5 * (back + front);
    model.object("house", Place::WORLD);
    model.cuboid("plaster", [-half, 0.0, back], [half, eaves, front], &[Side::Bottom, Side::Top]);
    for (x, turned) in [(half, false), (-half, true)] {
        let mut gable = [[x, eaves, front], [x, eaves, back], [x, ridge, middle]];
        if turned {
            gable.swap(0, 1);
        }
        model.face("plaster", &gable);
    }
    let slope = |z: f64, out: f64| -> [Point; 4] {
        let (left, right) = (-half - out, half + out);
        if z > middle {
            [[left, eaves, z], [right, eaves, z], [right, ridge, middle], [left, ridge, middle]]
        } else {
            [[right, eaves, z], [left, eaves, z], [left, ridge, middle], [right, ridge, middle]]
        }
    };
    model.face("tiles", &slope(front, 0.0));
    model.face("tiles", &slope(back, 0.0));
    let on_front = |model: &mut Model, material: &str, [x, y]: [f64; 2], [width, high]: [f64; 2]| {
        let (low, top) = ([x, y, front], [x + width, y + high, front + 0.03]);
        model.cuboid(material, low, top, &[Side::Back]);
    };
    on_front(model, "door", [-0.5, 0.0], [1.0, 2.1]);
    for x in [-3.1, 1.9] {
        on_front(model, "glass", [x, 1.0], [1.2, 1.2]);
    }
}

/// Materials of plants and of what stands beside them.
fn begin(header: &[&str]) -> Model {
    let mut model = Model::new(header);
    for (name, reflectance) in [
        ("lawn", [0.12, 0.24, 0.07]),
        ("gravel", [0.42, 0.39, 0.34]),
        ("bark", [0.24, 0.18, 0.13]),
        ("leaf", [0.09, 0.21, 0.05]),
        ("leaf_light", [0.16, 0.32, 0.08]),
        ("plaster", [0.74, 0.70, 0.60]),
        ("tiles", [0.46, 0.18, 0.12]),
        ("door", [0.16, 0.24, 0.30]),
        ("glass", [0.08, 0.10, 0.12]),
    ] {
        model.material(name, reflectance, [0.0; 3]);
    }
    lights(&mut model, [1.7, 2.2, 3.0], [230.0, 205.0, 165.0]);
    model
}

/// The materials of sky and sun, by their radiance. Clouds send back a little of what the ground sends up.
fn lights(model: &mut Model, sky: Point, sun: Point) {
    model.material("sky", [0.1; 3], sky);
    model.material("sun", [0.0; 3], sun);
}

/// A lawn, `2 half` wide and deep, in a box of sky, and the sun at its top at x and z.
fn sky(model: &mut Model, half: f64, top: f64, [x, z]: [f64; 2]) {
    model.object("lawn", Place::WORLD);
    model.face("lawn", &[[-half, 0.0, -half], [-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half]]);
    model.object("sky", Place::WORLD);
    let corner = |x: f64, z: f64, y: f64| [x * half, y, z * half];
    model.face("sky", &[corner(-1.0, -1.0, top), corner(1.0, -1.0, top), corner(1.0, 1.0, top), corner(-1.0, 1.0, top)]);
    for [(ax, az), (bx, bz)] in
        [[(-1.0, -1.0), (1.0, -1.0)], [(1.0, -1.0), (1.0, 1.0)], [(1.0, 1.0), (-1.0, 1.0)], [(-1.0, 1.0), (-1.0, -1.0)]]
    {
        model.face("sky", &[corner(ax, az, 0.0), corner(bx, bz, 0.0), corner(bx, bz, top), corner(ax, az, top)]);
    }
    model.object("sun", Place::WORLD);
    let (y, side) = (top - 0.05, 0.45);
    model.cuboid("sky", [x - side, y, z - side], [x + side, top, z + side], &[Side::Top, Side::Bottom]);
    model.face("sun", &[[x - side, y, z - side], [x + side, y, z - side], [x + side, y, z + side], [x - side, y, z + side]]);
}
