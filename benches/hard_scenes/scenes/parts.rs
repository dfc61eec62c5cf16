//! What rooms are made of: rectangles along the axes, with and without holes, and lamps.

use super::super::rooms::{Room, straight};

/// A rectangle perpendicular to an axis, its corners given in the next two axes (of x: y and z; of y: z and x; of z: x and y).
#[derive(Clone, Copy)]
pub struct Rectangle {
    pub axis: usize,
    pub at: f64,
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Rectangle {
    /// Adds it, facing along its axis or against it.
    pub fn add_to(self, room: &mut Room, along: bool, material: u32) {
        let Self { axis, at, low, high } = self;
        let mut corner = [0.0; 3];
        (corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (at, low[0], low[1]);
        let side = |k: usize| {
            let mut side = [0.0; 3];
            side[(axis + 1 + k) % 3] = high[k] - low[k];
            side
        };
        let (u, v) = if along { (side(0), side(1)) } else { (side(1), side(0)) };
        room.quad(corner, u, v, material);
    }

    /// Adds both of its sides.
    pub fn add_sheet_to(self, room: &mut Room, material: u32) {
        self.add_to(room, true, material);
        self.add_to(room, false, material);
    }

    /// What is left of it around a hole.
    pub fn around(self, hole: Self) -> [Self; 4] {
        [
            Self { high: [hole.low[0], self.high[1]], ..self },
            Self { low: [hole.high[0], self.low[1]], ..self },
            Self { low: [hole.low[0], self.low[1]], high: [hole.high[0], hole.low[1]], ..self },
            Self { low: [hole.low[0], hole.high[1]], high: [hole.high[0], self.high[1]], ..self },
        ]
    }

    /// The four sides of a hole of this shape from `self.at` on to `end`, further along the axis, seen from within the hole.
    pub fn reveals(self, room: &mut Room, end: f64, material: u32) {
        let Self { axis, at, low, high } = self;
        for k in 0..2 {
            // Of the two axes after the first one, `k` is perpendicular to this side; the other runs along it.
            let across = 1 - k;
            let span = |at_side: f64| {
                let (own, other) = ((axis + 1 + k) % 3, (axis + 1 + across) % 3);
                let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
                (from[axis], to[axis], from[other], to[other]) = (at, end, low[across], high[across]);
                let corner = |values: [f64; 3]| [values[(own + 1) % 3], values[(own + 2) % 3]];
                Self { axis: own, at: at_side, low: corner(from), high: corner(to) }
            };
            span(low[k]).add_to(room, true, material);
            span(high[k]).add_to(room, false, material);
        }
    }
}

/// The six sides of a box, each with whether it is the one further along its axis.
pub fn sides(low: [f64; 3], high: [f64; 3]) -> [(Rectangle, bool); 6] {
    std::array::from_fn(|side| {
        let (axis, is_far) = (side / 2, side % 2 == 1);
        let corner = |values: [f64; 3]| [values[(axis + 1) % 3], values[(axis + 2) % 3]];
        let at = if is_far { high[axis] } else { low[axis] };
        (Rectangle { axis, at, low: corner(low), high: corner(high) }, is_far)
    })
}

/// A closed room from 0 to `high` with a floor, walls and a ceiling of their own.
pub fn closed_room(room: &mut Room, high: [f64; 3]) {
    let materials = plaster(room);
    for (side, is_far) in sides([0.0; 3], high) {
        side.add_to(room, !is_far, materials[if side.axis < 2 { 1 } else { 2 * usize::from(is_far) }]);
    }
}

/// Floor, walls, ceiling.
pub fn plaster(room: &mut Room) -> [u32; 3] {
    [("floor", [0.42, 0.36, 0.3]), ("wall", [0.7, 0.68, 0.64]), ("ceiling", [0.8, 0.8, 0.78])]
        .map(|(name, rho)| room.named_material(name, &rho, &[0.0; 3]))
}

/// A material that reflects only.
pub fn matt(room: &mut Room, name: &str, reflectance: [f64; 3]) -> u32 {
    room.named_material(name, &reflectance, &[0.0; 3])
}

/// A warm light of about this exitance that reflects nothing.
pub fn light(room: &mut Room, exitance: f64) -> u32 {
    room.named_material("lamp", &[0.0; 3], &[exitance, 0.92 * exitance, 0.8 * exitance])
}

/// A box from `low` to `high`, seen from outside.
pub fn solid(room: &mut Room, low: [f64; 3], high: [f64; 3], material: u32) {
    room.cuboid(low, straight(high[0] - low[0], high[1] - low[1], high[2] - low[2]), false, |_, _| material);
}

/// A panel 2 cm thick whose lower side shines: its middle, its two sizes, the height of its upper side.
pub fn panel(room: &mut Room, [x, y]: [f64; 2], [width, depth]: [f64; 2], top: f64, exitance: f64) {
    let (shining, frame) = (light(room, exitance), matt(room, "panel", [0.8, 0.79, 0.77]));
    let (low, high) = ([x - 0.5 * width, y - 0.5 * depth, top - 0.02], [x + 0.5 * width, y + 0.5 * depth, top]);
    for (side, is_far) in sides(low, high) {
        side.add_to(room, is_far, if side.axis == 2 && !is_far { shining } else { frame });
    }
}
