//! Random clouds of leaves between a floor and a ceiling of squares, and lines between such squares, for what asks transmittance maps.
#![allow(dead_code, reason = "each test and bench uses a part")]

use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::{Segment, Visibility};

use crate::rooms::Room;
use crate::triangles::{Random, add, cross, dot, spread, sub, times};

/// Receivers on the floor in a row 4 m long, sources 3 m above in another; the cloud is between them.
pub const ENDS: usize = 8;

/// Leaves in a box, denser towards the middle, so that means over all of it are wrong for every part.
#[derive(Clone, Copy, Debug)]
pub struct Cloud {
    pub leaves: usize,
    /// The side of a leaf, in metres.
    pub leaf: f64,
    /// The half sides of the box, in metres.
    pub half: [f64; 3],
    /// The side of the squares of floor and ceiling, in metres.
    pub end: f64,
    pub seed: u64,
}

impl Cloud {
    /// Of 3000 leaves in a box 1.6 m wide.
    pub fn of(leaf: f64, seed: u64) -> Self {
        Self { leaves: 3000, leaf, half: [0.8; 3], end: 0.5, seed }
    }

    /// The floor and the ceiling, whose squares take turns as the first surfaces, and the leaves, which are sheets.
    pub fn scene(&self) -> Scene {
        let mut random = Random(self.seed);
        let mut room = Room::default();
        let (ground, lamp, leaf) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[10.0]), room.material(&[0.3], &[0.0]));
        floor_and_ceiling(&mut room, self.end, ground, lamp);
        for _ in 0..self.leaves {
            let [x, y, z] = self.half.map(|half| random.between(-half, half) * random.unit().sqrt());
            let (along, other) = (random.direction(), random.direction());
            let across = cross(along, other);
            let side = |direction: [f64; 3]| times(direction, self.leaf / dot(direction, direction).sqrt());
            let (foot, u, v) = ([x, y, 1.5 + z], side(along), side(across));
            room.sheet(&[foot, add(foot, u), add(add(foot, u), v), add(foot, v)], leaf);
        }
        room.scene()
    }
}

/// The squares, by turns one of the floor and one of the ceiling.
pub fn floor_and_ceiling(room: &mut Room, end: f64, ground: u32, lamp: u32) {
    for k in 0..ENDS {
        let x = -2.0 + 4.0 * k as f64 / ENDS as f64;
        room.quad([x, -0.5 * end, 0.0], [end, 0.0, 0.0], [0.0, end, 0.0], ground);
        room.quad([x, -0.5 * end, 3.0], [0.0, end, 0.0], [end, 0.0, 0.0], lamp);
    }
}

/// Two parallelograms and the lines between them.
pub struct Ends {
    pub pair: [NodeId; 2],
    surfaces: [SurfaceId; 2],
}

/// Every square of the floor with every one of the ceiling.
pub fn all_ends(hierarchy: &Hierarchy) -> Vec<Ends> {
    let pairs = (0..ENDS).flat_map(|from| (0..ENDS).map(move |to| [2 * from, 2 * to + 1]));
    pairs.map(|pair| Ends::of(hierarchy, pair.map(|surface| SurfaceId(surface as u32)))).collect()
}

impl Ends {
    pub fn of(hierarchy: &Hierarchy, surfaces: [SurfaceId; 2]) -> Self {
        Self { pair: surfaces.map(|surface| hierarchy.node_of(surface)), surfaces }
    }

    /// Independent lines, uniform by area.
    pub fn lines(&self, scene: &Scene, count: usize, random: &mut Random) -> Vec<Segment> {
        (0..count).map(|_| self.line(scene, std::array::from_fn(|_| random.unit()))).collect()
    }

    /// Lines that are evenly spread, from a random start.
    pub fn spread_lines(&self, scene: &Scene, count: usize, random: &mut Random) -> Vec<Segment> {
        let start = std::array::from_fn(|_| random.unit());
        (0..count).map(|index| self.line(scene, spread(start, index))).collect()
    }

    fn line(&self, scene: &Scene, [u, v, s, t]: [f64; 4]) -> Segment {
        let point = |surface: SurfaceId, u: f64, v: f64| {
            let corners: Vec<[f64; 3]> = scene.surface(surface).polygon.vertices().collect();
            let side = |corner: usize| sub(corners[corner], corners[0]);
            add(corners[0], add(times(side(1), u), times(side(3), v)))
        };
        let [from_plane, to_plane] = self.surfaces.map(|surface| scene.surface(surface).plane());
        Segment { from: point(self.surfaces[0], u, v), to: point(self.surfaces[1], s, t), from_plane, to_plane }
    }
}

/// The part of the lines that pass, by rays.
pub fn passing(lines: &[Segment], visibility: &dyn Visibility) -> f64 {
    let mut occluded = vec![false; lines.len()];
    visibility.occluded(lines, &mut occluded);
    occluded.iter().filter(|occluded| !**occluded).count() as f64 / lines.len() as f64
}
