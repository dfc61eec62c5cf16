//! A hall of any number of polygons, to see how cost grows: bays of five by five metres, each with a lamp, a table, chairs, shelves of books and a
//! plant.
//!
//! The number of bays grows with the power 3/4 of the number of polygons, so a larger hall is richer too; every bay has a lamp of its own, so it is
//! as bright. What the furniture leaves goes into books, then leaves, and the last few into sheets of paper on the tables.

use super::furniture::{Chance, bookshelf, ceiling_lamp, chair, materials, plant, table};
use super::model::{Model, Place};

/// A bay is as wide as deep.
const BAY: f64 = 5.0;
const HEIGHT: f64 = 3.2;
/// Polygons of an empty shelf, a plant without leaves, a book, a leaf.
const SHELF: usize = 31;
const PLANT: usize = 30;
const BOOK: usize = 5;
const LEAF: usize = 2;
/// Books that a shelf surely holds.
const BOOKS_A_SHELF: usize = 170;
/// Shelves stand in up to two rows of four, the second with its back to the first.
const MOST_SHELVES: usize = 8;

/// A hall of exactly `polygons` polygons, at least 400; `seed` decides about books and about how chairs stand.
pub fn hall(polygons: usize, seed: u32) -> Model {
    let mut model = Model::new(&[&format!("A hall of {polygons} polygons, seed {seed}, in metres, y up.")]);
    materials(&mut model);
    let mut chance = Chance(seed);

    // As square as bays allow.
    let bays = ((polygons as f64 / 1000.0).powf(0.75).round() as usize).max(1);
    let columns = (bays as f64).sqrt().ceil() as usize;
    let rows = bays.div_ceil(columns);
    let (width, depth) = (columns as f64 * BAY, rows as f64 * BAY);
    model.object("shell", Place::WORLD);
    model.face("wall", &[[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, HEIGHT, 0.0], [0.0, HEIGHT, 0.0]]);
    model.face("wall", &[[width, 0.0, depth], [0.0, 0.0, depth], [0.0, HEIGHT, depth], [width, HEIGHT, depth]]);
    model.face("warm_wall", &[[width, 0.0, 0.0], [width, 0.0, depth], [width, HEIGHT, depth], [width, HEIGHT, 0.0]]);
    model.face("accent_wall", &[[0.0, 0.0, depth], [0.0, 0.0, 0.0], [0.0, HEIGHT, 0.0], [0.0, HEIGHT, depth]]);
    model.face("ceiling", &[[0.0, HEIGHT, 0.0], [width, HEIGHT, 0.0], [width, HEIGHT, depth], [0.0, HEIGHT, depth]]);

    // The polygons that are left are shared over the bays that are left.
    let bays = columns * rows;
    for bay in 0..bays {
        let budget = (polygons - model.face_count()) / (bays - bay);
        let corner = [(bay % columns) as f64 * BAY, (bay / columns) as f64 * BAY];
        furnish(&mut model, corner, budget, &mut chance);
    }
    model
}

/// Fills a bay with exactly `budget` polygons.
fn furnish(model: &mut Model, [x, z]: [f64; 2], budget: usize, chance: &mut Chance) {
    let end = model.face_count() + budget;
    model.object("floor", Place::WORLD);
    model.face("carpet", &[[x, 0.0, z], [x, 0.0, z + BAY], [x + BAY, 0.0, z + BAY], [x + BAY, 0.0, z]]);
    ceiling_lamp(model, HEIGHT, [x + 1.9, z + 2.2], [x + 3.1, z + 2.8]);
    let height = 0.74;
    model.object("table", Place::at([x + 2.5, 0.0, z + 3.2], 0.0));
    table(model, "oak", [0.8, 0.5], height, 0.035, 0.06);
    for (name, dx, dz, degrees) in [("chair_back", 0.0, -0.75, 180.0), ("chair_front", 0.0, 0.75, 0.0)] {
        chair(model, name, Place::at([x + 2.5 + dx, 0.0, z + 3.2 + dz], degrees + 20.0 * (chance.next() - 0.5)));
    }

    // Two thirds of what is left are books, a third leaves; whatever remains of both is paper.
    let left = end - model.face_count() - PLANT;
    let shelves = (2 * left / 3 / (SHELF + BOOK * BOOKS_A_SHELF / 2)).clamp(1, MOST_SHELVES);
    let books = (2 * left / 3).saturating_sub(shelves * SHELF) / BOOK;
    for shelf in 0..shelves {
        let share = (books / shelves + usize::from(shelf < books % shelves)).min(BOOKS_A_SHELF);
        let at = 0.3 + 1.1 * (shelf % 4) as f64;
        let place =
            if shelf < 4 { Place::at([x + at, 0.0, z + 0.7], 0.0) } else { Place::at([x + at + 1.0, 0.0, z + 0.69], 180.0) };
        bookshelf(model, "shelf", place, share, [0.018, 0.026], chance);
    }
    let leaves = (end - model.face_count() - PLANT) / LEAF;
    plant(model, Place::at([x + 4.4, 0.0, z + 4.4], 0.0), leaves.min(MOST_LEAVES));
    model.object("paper", Place::at([x + 2.5, height + 0.002, z + 3.2], 0.0));
    papers(model, end - model.face_count());
}

/// More leaves on one plant would be too small to see.
const MOST_LEAVES: usize = 1500;

/// Sheets of paper side by side on a table of 1.6 m by 1 m, seen from above.
fn papers(model: &mut Model, count: usize) {
    let across = ((count as f64 * 1.6).sqrt().ceil() as usize).max(4);
    let down = count.div_ceil(across).max(3);
    let (pitch_x, pitch_z) = (1.5 / across as f64, 0.9 / down as f64);
    for k in 0..count {
        let (left, far) = (-0.75 + pitch_x * (k % across) as f64, -0.45 + pitch_z * (k / across) as f64);
        let (right, near) = (left + 0.8 * pitch_x, far + 0.8 * pitch_z);
        model.face("paper", &[[left, 0.0, near], [right, 0.0, near], [right, 0.0, far], [left, 0.0, far]]);
    }
}
