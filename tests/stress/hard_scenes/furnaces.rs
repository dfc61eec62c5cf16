//! Closed rooms with boxes in which all light is 1 (Kirchhoff), in any unit, anywhere and turned.

use super::scene::HardScene;
use crate::rooms::{Room, straight, turned};
use crate::triangles::{Random, add, cross, times, unit};

/// Reflectances of most rooms.
pub const MODERATE: [f64; 2] = [0.2, 0.8];

/// Where a room stands, how large it is and how it is turned.
#[derive(Clone, Copy)]
pub struct Place {
    corner: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl Place {
    pub fn new(unit: f64) -> Self {
        Self { corner: [0.0; 3], axes: straight(unit, unit, unit) }
    }

    fn at(self, corner: [f64; 3]) -> Self {
        Self { corner, ..self }
    }

    fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        add(add(times(self.axes[0], x), times(self.axes[1], y)), times(self.axes[2], z))
    }

    fn point(&self, point: [f64; 3]) -> [f64; 3] {
        add(self.corner, self.vector(point))
    }

    fn sides(&self, sides: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        sides.map(|side| self.vector(side))
    }
}

/// A material in whose presence all light is `b0`.
pub fn grey(room: &mut Room, rho: f64, b0: f64) -> u32 {
    room.material(&[rho], &[(1.0 - rho) * b0])
}

/// A closed room of 4 x 3 x 2.5 with floating boxes, all with reflectances of their own, in which all light is 1.
pub fn furnace(place: Place, boxes: usize, reflectances: [f64; 2], seed: u64) -> Room {
    let mut random = Random(seed);
    let mut room = Room::default();
    let mut material = |room: &mut Room, _| {
        let rho = random.between(reflectances[0], reflectances[1]);
        grey(room, rho, 1.0)
    };
    room.cuboid(place.corner, place.sides(straight(4.0, 3.0, 2.5)), true, &mut material);

    // On a grid, so that none meets another.
    let mut shape = Random(seed + 1);
    let each_way = [4, 3, 2];
    for k in 0..boxes.min(24) {
        let cell = [k % each_way[0], k / each_way[0] % each_way[1], k / (each_way[0] * each_way[1])];
        let corner: [f64; 3] = std::array::from_fn(|axis| cell[axis] as f64 + 0.35 + shape.between(0.0, 0.2));
        let sides = turned(shape.between(0.1, 0.35), shape.between(0.1, 0.3), shape.between(0.05, 0.4), shape.between(0.0, 0.7));
        room.cuboid(place.point(corner), place.sides(sides), false, &mut material);
    }
    room
}

/// A closed room with `side` cubed floating boxes, their reflectances from 0.1 to 0.99.
pub fn furnace_of_small_boxes(side: usize) -> HardScene {
    let mut random = Random(21);
    let mut room = Room::default();
    let mut material = |room: &mut Room, _| {
        let rho = random.between(0.1, 0.99);
        grey(room, rho, 1.0)
    };
    room.cuboid([0.0; 3], straight(side as f64, side as f64, side as f64), true, &mut material);
    let mut shape = Random(22);
    for cell in 0..side.pow(3) {
        let corner = [cell % side, cell / side % side, cell / (side * side)];
        let corner = corner.map(|at| at as f64 + 0.35 + shape.between(0.0, 0.2));
        let sides = turned(shape.between(0.1, 0.35), shape.between(0.1, 0.3), shape.between(0.05, 0.4), shape.between(0.0, 0.7));
        room.cuboid(corner, sides, false, &mut material);
    }
    HardScene::uniform(format!("{} boxes", side.pow(3)), room)
}

/// Units of length, distance from the origin, rotation: of few surfaces, and of so many that clusters are made.
pub fn places() -> Vec<HardScene> {
    let mut random = Random(1);
    let w = random.direction();
    let u = unit(cross(w, random.direction()));
    let turned = Place { axes: [u, cross(w, u), w], ..Place::new(1.0) };
    let far = |unit: f64| Place::new(unit).at(times([1.0, -0.7, 0.4], 1e6 * unit));
    let named = [
        ("in units of 1e-6", Place::new(1e-6)),
        ("in units of 1e6", Place::new(1e6)),
        ("a million sizes away", far(1.0)),
        ("in units of 1e-6, a million away", far(1e-6)),
        ("turned", turned),
    ];
    let furnaces = named.into_iter().flat_map(|(name, place)| {
        [(2, "few"), (20, "many")]
            .map(|(boxes, count)| HardScene::uniform(format!("{count} boxes {name}"), furnace(place, boxes, MODERATE, 3)))
    });
    furnaces.collect()
}
