//! Kirchhoff's furnace: in a closed room whose surfaces emit `E = (1 - rho) B0`, with any rho, `B = B0` everywhere.

#![allow(dead_code, reason = "each test uses a part")]

use patchlight::scene::Scene;

use crate::rooms::{Room, channels, straight, turned};
use crate::triangles::{Random, dot, sub};

/// A closed room of random boxes, standing and floating, every surface with a reflectance of its own, emitting (1 - rho) B0.
pub struct Kirchhoff {
    pub scene: Scene,
    /// The boxes, each as (corner, sides).
    boxes: Vec<([f64; 3], [[f64; 3]; 3])>,
    pub b0: Vec<f64>,
}

pub fn kirchhoff(seed: u64, count: usize) -> Kirchhoff {
    let mut random = Random(seed);
    let b0 = channels(&mut random, count, 0.5, 2.0);
    let mut room = Room::default();
    let material = |room: &mut Room, random: &mut Random| {
        let rho = channels(random, count, 0.1, 0.95);
        let exitance: Vec<f64> = rho.iter().zip(&b0).map(|(rho, b0)| (1.0 - rho) * b0).collect();
        room.material(&rho, &exitance)
    };
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.5), true, |room, _| material(room, &mut random));

    // A box in each quarter of the floor, so that none meets another; every other one stands on the floor.
    let mut boxes = Vec::new();
    for k in 0..4 {
        let floats = random.unit() < 0.5;
        let corner = [
            0.8 + 2.0 * f64::from(k % 2) + random.between(-0.1, 0.1),
            0.4 + 1.5 * f64::from(k / 2),
            if floats { random.between(0.2, 1.0) } else { 0.0 },
        ];
        let (x, y, z) = (random.between(0.2, 0.8), random.between(0.2, 0.6), random.between(0.1, 1.3));
        let sides = turned(x, y, z, random.between(0.0, 0.8));
        room.cuboid(corner, sides, false, |room, _| material(room, &mut random));
        boxes.push((corner, sides));
    }
    Kirchhoff { scene: room.scene(), boxes, b0 }
}

impl Kirchhoff {
    /// Whether a point is covered by a box that stands on it, or is the box's own underside.
    pub fn is_covered(&self, point: [f64; 3]) -> bool {
        let covers = |(corner, sides): &([f64; 3], [[f64; 3]; 3])| {
            let from_corner = sub(point, *corner);
            let inside = |side: [f64; 3]| (0.0..=1.0).contains(&(dot(from_corner, side) / dot(side, side)));
            corner[2] == 0.0 && inside(sides[0]) && inside(sides[1])
        };
        point[2] == 0.0 && self.boxes.iter().any(covers)
    }
}
