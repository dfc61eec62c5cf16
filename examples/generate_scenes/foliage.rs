//! Plants: trees, shrubs and hedges of many small leaves, and maize, in metres, y up. Leaves have two sides.

use std::f64::consts::{PI, TAU};

use super::furniture::{Chance, leaf};
use super::model::{Model, Place, Point};

/// The angle by which one leaf or branch is turned from the last, so that none hides the next.
const GOLDEN: f64 = 137.5;

/// A branch carries so many smaller ones.
const BRANCHES: usize = 4;

/// The most leaves of a twig: of more, twigs branch once more.
const LEAVES_OF_TWIG: usize = 90;

/// How far a leaf is from the twig that carries it, as a part of the twig.
const SPREAD: f64 = 0.55;

/// A tree or a shrub.
#[derive(Clone, Copy)]
pub struct Growth {
    /// Where it stands, and how tall the trunk is below the branches.
    pub foot: Point,
    pub trunk: f64,
    /// The radius of the trunk at the ground.
    pub girth: f64,
    /// The length of the first branches; each next one has seven tenths of it.
    pub branch: f64,
    /// The area of all leaves, one side, in m^2.
    pub leaf_area: f64,
    pub leaves: usize,
}

/// A broad-leaved tree: limbs of 5 sides, and exactly `leaves` leaves of 2 faces in bunches around the last of them.
pub fn broad_leaved(model: &mut Model, name: &str, growth: Growth, chance: &mut Chance) {
    model.object(&format!("{name}_wood"), Place::WORLD);
    let top = add(growth.foot, [0.0, growth.trunk, 0.0]);
    limb(model, [growth.foot, top], [growth.girth, 0.7 * growth.girth]);

    // Branches of branches, until the last ones carry no more leaves than a twig does.
    let twigs_wanted = growth.leaves.div_ceil(LEAVES_OF_TWIG).max(BRANCHES);
    let mut limbs: Vec<(Point, Point)> = vec![(top, [0.0, 1.0, 0.0])];
    let (mut length, mut radius) = (growth.branch, 0.6 * growth.girth);
    let mut twigs = Vec::new();
    while limbs.len() < twigs_wanted {
        twigs.clear();
        for (limb_number, &(foot, along)) in limbs.iter().enumerate() {
            for k in 0..BRANCHES {
                let turn = ((limb_number * BRANCHES + k) as f64 * GOLDEN).to_radians() + 0.5 * chance.next();
                let lean = if k == 0 { 0.2 } else { 0.75 + 0.35 * chance.next() };
                let towards = leaning(along, lean, turn);
                let end = add(foot, scaled(towards, length * (0.8 + 0.4 * chance.next())));
                limb(model, [foot, end], [radius, 0.6 * radius]);
                twigs.push((end, towards));
            }
        }
        limbs.clone_from(&twigs);
        (length, radius) = (0.7 * length, 0.6 * radius);
    }

    // A rhomb has half the area of its length times its width, which is 0.6 of the length.
    model.object(&format!("{name}_leaves"), Place::WORLD);
    let leaf_length = (growth.leaf_area / growth.leaves as f64 / 0.3).sqrt();
    for number in 0..growth.leaves {
        let (end, along) = limbs[number % limbs.len()];
        let place = length * SPREAD * 2.0 * chance.next().cbrt();
        let towards = leaning(along, PI * chance.next(), TAU * chance.next());
        hang(model, add(end, scaled(towards, place)), towards, leaf_length, chance);
    }
}

/// A hedge of `leaves` leaves in a box from `low` to `high`, denser towards front and back, and stems in its middle.
pub fn hedge(model: &mut Model, [low, high]: [Point; 2], leaf_area: f64, leaves: usize, chance: &mut Chance) {
    model.object("hedge_wood", Place::WORLD);
    let stems = ((high[0] - low[0]) / 0.5).ceil() as usize;
    for k in 0..stems {
        let x = low[0] + (high[0] - low[0]) * (k as f64 + 0.5) / stems as f64;
        let foot = [x, 0.0, 0.5 * (low[2] + high[2]) + 0.1 * (chance.next() - 0.5)];
        limb(model, [foot, add(foot, [0.1 * (chance.next() - 0.5), 0.8 * high[1], 0.0])], [0.03, 0.012]);
    }
    model.object("hedge_leaves", Place::WORLD);
    let leaf_length = (leaf_area / leaves as f64 / 0.3).sqrt();
    for _ in 0..leaves {
        // Light does not come to the middle, and leaves fall there.
        let outwards = |at: f64| 0.5 + 0.5 * (2.0 * at - 1.0).signum() * (2.0 * at - 1.0).abs().powf(0.6);
        let part: Point = std::array::from_fn(|axis| if axis == 2 { outwards(chance.next()) } else { chance.next() });
        let foot = std::array::from_fn(|k| low[k] + (high[k] - low[k]) * part[k]);
        let towards = leaning([0.0, 1.0, 0.0], 1.2 + 0.6 * chance.next(), TAU * chance.next());
        hang(model, foot, towards, leaf_length, chance);
    }
}

/// A maize plant of 2.1 m: a stem, and twelve leaves left and right of it, each a ribbon that bends over.
pub fn maize(model: &mut Model, foot: Point, chance: &mut Chance) {
    let (tall, leaves) = (2.1, 12);
    limb(model, [foot, add(foot, [0.0, tall, 0.0])], [0.014, 0.006]);
    let row = TAU * chance.next();
    for k in 0..leaves {
        let share = f64::from(k) / f64::from(leaves);
        let turn = row + PI * f64::from(k) + 0.5 * (chance.next() - 0.5);
        let long = 0.45 + 1.2 * share * (1.0 - share) + 0.1 * chance.next();
        ribbon(model, add(foot, [0.0, 0.25 + (tall - 0.3) * share, 0.0]), turn, long);
    }
}

/// The quads of a leaf of maize: it rises steeply, bends over and hangs. Its width grows fast and then tapers.
fn ribbon(model: &mut Model, foot: Point, turn: f64, long: f64) {
    const PIECES: u32 = 6;
    let (sin, cos) = turn.sin_cos();
    let width = |t: f64| 0.045 * (4.0 * t).min(1.0) * (1.0 - t).sqrt() + 0.004;
    let (mut at, mut t) = (foot, 0.0);
    for piece in 0..PIECES {
        let slope = 1.25 - 2.1 * f64::from(piece) / f64::from(PIECES);
        let step = long / f64::from(PIECES);
        let next = add(at, [step * slope.cos() * cos, step * slope.sin(), step * slope.cos() * sin]);
        let next_t = t + 1.0 / f64::from(PIECES);
        let edge = |point: Point, t: f64, side: f64| add(point, [-side * width(t) * sin, 0.0, side * width(t) * cos]);
        model.sheet("blade", &[edge(at, t, 1.0), edge(at, t, -1.0), edge(next, next_t, -1.0), edge(next, next_t, 1.0)]);
        (at, t) = (next, next_t);
    }
}

/// A leaf at a point, that grows along a direction and hangs down a little, turned at random about its length.
fn hang(model: &mut Model, foot: Point, towards: Point, length: f64, chance: &mut Chance) {
    let along = unit(add(towards, [0.0, -0.35, 0.0]));
    let [across, up] = aside(along);
    let roll = 1.2 * (chance.next() - 0.5);
    let half_width = 0.3 * length;
    let side = std::array::from_fn(|k| half_width * (roll.cos() * across[k] + roll.sin() * up[k]));
    leaf(model, if chance.next() < 0.3 { "leaf_light" } else { "leaf" }, foot, scaled(along, length), side);
}

/// The sides and the tip of a stump of 5 sides from one point to another; its foot is in what it grows from.
fn limb(model: &mut Model, [foot, end]: [Point; 2], [thick, thin]: [f64; 2]) {
    const SIDES: usize = 5;
    let [across, up] = aside(unit(std::array::from_fn(|k| end[k] - foot[k])));
    let ring = |middle: Point, radius: f64| {
        move |k: usize| -> Point {
            let (sin, cos) = (TAU * (k % SIDES) as f64 / SIDES as f64).sin_cos();
            std::array::from_fn(|i| middle[i] + radius * (cos * across[i] + sin * up[i]))
        }
    };
    let (below, above) = (ring(foot, thick), ring(end, thin));
    for k in 0..SIDES {
        model.face("bark", &[below(k), below(k + 1), above(k + 1), above(k)]);
    }
    model.face("bark", &std::array::from_fn::<Point, SIDES, _>(above));
}

/// The direction that leans from another by an angle, turned about it.
fn leaning(along: Point, lean: f64, turn: f64) -> Point {
    let [across, up] = aside(along);
    let (sin, cos) = turn.sin_cos();
    unit(std::array::from_fn(|k| lean.cos() * along[k] + lean.sin() * (cos * across[k] + sin * up[k])))
}

/// Two directions at right angles to one and to each other; the three turn counter-clockwise. The first is level.
fn aside([x, y, z]: Point) -> [Point; 2] {
    let flat = x.hypot(z);
    let across = if flat > 1e-6 { [z / flat, 0.0, -x / flat] } else { [1.0, 0.0, 0.0] };
    let [a, b, c] = across;
    [across, [y * c - z * b, z * a - x * c, x * b - y * a]]
}

fn unit(a: Point) -> Point {
    scaled(a, 1.0 / a.iter().map(|x| x * x).sum::<f64>().sqrt())
}

fn scaled(a: Point, factor: f64) -> Point {
    a.map(|x| factor * x)
}

fn add(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + b[k])
}
