//! Scenes made on the spot: boxes, squares, spheres, random polygons.
#![allow(dead_code, reason = "each test and bench uses a part")]

use std::path::Path;

use patchlight::geometry::Polygon;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{RunOptions, SolveOptions, SolveReport};

use crate::triangles::{Random, add, cross, sub, times, unit};

/// Faces and materials on their way to a scene.
#[derive(Default)]
pub struct Room {
    materials: Vec<Material>,
    faces: Vec<(Polygon, u32, u32)>,
}

impl Room {
    /// A room of 4 x 3 x 3 m, lit by two lamps of one material and a third one, `tube`, of another colour; what stands in it is of the material `block`,
    /// whose number comes along.
    pub fn with_lamps() -> (Self, u32) {
        let mut room = Self::default();
        let walls = room.named_material("wall", &[0.7, 0.6, 0.5], &[0.0; 3]);
        let block = room.named_material("block", &[0.3, 0.4, 0.5], &[0.0; 3]);
        let lamp = room.named_material("lamp", &[0.2; 3], &[30.0, 28.0, 25.0]);
        let tube = room.named_material("tube", &[0.0; 3], &[2.0, 5.0, 40.0]);
        room.cuboid([0.0; 3], straight(4.0, 3.0, 3.0), true, |_, _| walls);
        // They look down.
        for (x, material) in [(0.6, lamp), (2.9, lamp), (1.9, tube)] {
            room.quad([x, 2.98, 1.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.5], material);
        }
        (room, block)
    }

    /// Adds a material; the number to name it by.
    pub fn material(&mut self, reflectance: &[f64], exitance: &[f64]) -> u32 {
        self.named_material(&format!("m{}", self.materials.len()), reflectance, exitance)
    }

    /// The same under a name of one's own.
    pub fn named_material(&mut self, name: &str, reflectance: &[f64], exitance: &[f64]) -> u32 {
        self.materials.push(Material { name: name.to_owned(), reflectance: reflectance.to_vec(), exitance: exitance.to_vec() });
        self.materials.len() as u32 - 1
    }

    /// Adds a face, counter-clockwise seen from the front.
    pub fn face(&mut self, vertices: &[[f64; 3]], material: u32) {
        self.faces.push((Polygon::new(vertices).unwrap(), material, self.faces.len() as u32));
    }

    /// Adds both sides of a sheet.
    pub fn sheet(&mut self, vertices: &[[f64; 3]], material: u32) {
        self.face(vertices, material);
        let reversed: Vec<[f64; 3]> = vertices.iter().rev().copied().collect();
        self.face(&reversed, material);
    }

    /// Adds the parallelogram at `corner` with sides `u`, `v`, facing along `u x v`.
    pub fn quad(&mut self, corner: [f64; 3], u: [f64; 3], v: [f64; 3], material: u32) {
        self.face(&[corner, add(corner, u), add(add(corner, u), v), add(corner, v)], material);
    }

    /// Adds the parallelepiped at `corner` with sides `u`, `v`, `w` (right-handed); its faces look in or out. `material(face)` names the
    /// material of each; faces come in pairs without and with `w`, `u`, `v`.
    pub fn cuboid(
        &mut self,
        corner: [f64; 3],
        sides: [[f64; 3]; 3],
        inward: bool,
        mut material: impl FnMut(&mut Self, usize) -> u32,
    ) {
        for axis in 0..3 {
            let (u, v, w) = (sides[axis], sides[(axis + 1) % 3], sides[(axis + 2) % 3]);
            let (near, far) = (material(self, 2 * axis), material(self, 2 * axis + 1));
            let ((nu, nv), (fu, fv)) = if inward { ((u, v), (v, u)) } else { ((v, u), (u, v)) };
            self.quad(corner, nu, nv, near);
            self.quad(add(corner, w), fu, fv, far);
        }
    }

    pub fn scene(self) -> Scene {
        let channels = self.materials[0].reflectance.len();
        Scene::new(channels, self.materials, self.faces, Sides::Front).unwrap()
    }
}

/// Sides along the axes.
pub fn straight(x: f64, y: f64, z: f64) -> [[f64; 3]; 3] {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

/// Sides turned about the vertical axis.
pub fn turned(x: f64, y: f64, z: f64, angle: f64) -> [[f64; 3]; 3] {
    let (sin, cos) = angle.sin_cos();
    [[x * cos, x * sin, 0.0], [-y * sin, y * cos, 0.0], [0.0, 0.0, z]]
}

/// The closed unit cube seen from inside, all of one material.
pub fn cube(reflectance: &[f64], exitance: &[f64]) -> Scene {
    let mut room = Room::default();
    let material = room.material(reflectance, exitance);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| material);
    room.scene()
}

/// A closed room of 4 x 4 x 3 m with `boxes` small turned boxes that stand or hang anywhere, and a lamp under the ceiling: enough surfaces
/// for clusters.
pub fn crowded(boxes: usize, seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut room = Room::default();
    let lamp = room.material(&[0.0; 3], &channels(&mut random, 3, 20.0, 30.0));
    let colours: Vec<u32> = (0..8).map(|_| room.material(&channels(&mut random, 3, 0.2, 0.8), &[0.0; 3])).collect();
    room.cuboid([0.0; 3], straight(4.0, 4.0, 3.0), true, |_, face| colours[face]);
    room.quad([1.5, 1.5, 2.98], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    for k in 0..boxes {
        let corner = [random.between(0.3, 3.3), random.between(0.3, 3.3), random.between(0.0, 2.3)];
        let side = |random: &mut Random| random.between(0.05, 0.3);
        let sides = turned(side(&mut random), side(&mut random), side(&mut random), random.between(0.0, 1.5));
        room.cuboid(corner, sides, false, |_, _| colours[k % colours.len()]);
    }
    room.scene()
}

/// Two unit squares that face each other at distance 1: the lower emits 1 and reflects 0.5, the upper reflects 0.7. With `blocker` a
/// thin black square of half the side hangs in the middle.
pub fn two_squares(blocker: bool) -> Scene {
    let mut room = Room::default();
    let (lower, upper) = (room.material(&[0.5], &[1.0]), room.material(&[0.7], &[0.0]));
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], lower);
    room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], upper);
    if blocker {
        let black = room.material(&[0.0], &[0.0]);
        room.sheet(&[[0.25, 0.25, 0.5], [0.75, 0.25, 0.5], [0.75, 0.75, 0.5], [0.25, 0.75, 0.5]], black);
    }
    room.scene()
}

/// A room with 27 boxes floating in it, so that clusters gather and emit; materials by the number of the box, that of the room being 27.
pub fn room_of_boxes(mut material: impl FnMut(&mut Room, usize) -> u32) -> Scene {
    let mut room = Room::default();
    room.cuboid([0.0; 3], straight(4.0, 4.0, 3.0), true, |room, _| material(room, 27));
    for k in 0..27 {
        let at = |digit: usize, step: f64| 0.4 + step * f64::from(digit as u8);
        let corner = [at(k % 3, 1.2), at(k / 3 % 3, 1.2), at(k / 9, 0.8)];
        room.cuboid(corner, straight(0.2, 0.3, 0.25), false, |room, _| material(room, k));
    }
    room.scene()
}

/// Triangles of a sphere-like polyhedron around 0 with corners at distance `radius`: an icosahedron, each side halved `halvings` times.
pub fn icosphere(radius: f64, halvings: u32) -> Vec<[[f64; 3]; 3]> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut corners = Vec::new();
    for (one, phi) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        corners.extend([[0.0, one, phi], [one, phi, 0.0], [phi, 0.0, one]]);
    }
    let distance = |a: usize, b: usize| sub(corners[a], corners[b]).iter().map(|x| x * x).sum::<f64>();
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if distance(a, b) < 4.1 && distance(b, c) < 4.1 && distance(a, c) < 4.1 {
                    triangles.push([corners[a], corners[b], corners[c]]);
                }
            }
        }
    }
    for _ in 0..halvings {
        let middle = |a, b| unit(add(a, b));
        triangles = (triangles.into_iter())
            .map(|triangle| triangle.map(unit))
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let outward = |[a, b, c]: [[f64; 3]; 3]| {
        let normal = cross(sub(b, a), sub(c, a));
        if normal.iter().zip(a).map(|(n, x)| n * x).sum::<f64>() > 0.0 { [a, b, c] } else { [a, c, b] }
    };
    triangles.into_iter().map(|triangle| outward(triangle.map(|corner| times(unit(corner), radius)))).collect()
}

/// Solves with options, in one go.
pub fn solve(scene: Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    let (evaluator, report) = pipeline::solve(scene, options, &RunOptions::default(), &Silent).unwrap();
    evaluator.solution().validate().unwrap_or_else(|fault| panic!("the solution is not valid: {fault}"));
    (evaluator, report)
}

/// A scene solved to an error on so many threads, and what is claimed of it.
pub fn solved(scene: Scene, error: f64, threads: usize) -> (Evaluator, f64) {
    let options = SolveOptions { error, ..SolveOptions::default() };
    let run = RunOptions { threads, ..RunOptions::default() };
    let (evaluator, report) = pipeline::solve(scene, &options, &run, &Silent).unwrap();
    (evaluator, report.error.estimate)
}

/// A scene of the repository, by the name of its file.
pub fn read(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    read_scene(&path, &ImportOptions::default()).unwrap().scene
}

/// The same solution with another number of rays to a point. Asked of the solve itself, its error estimate would take as many, too.
pub fn with_point_rays(evaluator: &Evaluator, rays: u32) -> Evaluator {
    regathered(evaluator, rays, evaluator.solution().options().seed)
}

/// The same solution with another number of rays to a point, of another seed.
pub fn regathered(evaluator: &Evaluator, rays: u32, seed: u64) -> Evaluator {
    let mut fields = serde_json::to_value(evaluator.solution()).unwrap();
    fields["point_rays"] = rays.into();
    fields["options"]["seed"] = seed.into();
    Evaluator::new(serde_json::from_value(fields).unwrap(), &RunOptions::default()).unwrap()
}

/// Radiosities at points of known surfaces, in f64.
pub fn values(evaluator: &Evaluator, points: &[SurfacePoint]) -> Vec<f64> {
    let values = evaluator.values_at(points, &Silent).unwrap();
    assert_eq!(values.missed, 0, "points that lie on no surface");
    values.radiosity.into_iter().map(f64::from).collect()
}

/// A point of a convex polygon, uniform by area.
pub fn point_of(polygon: &Polygon, random: &mut Random) -> SurfacePoint {
    let corners: Vec<[f64; 3]> = polygon.vertices().collect();
    let twice_area = |k: usize| {
        let normal = cross(sub(corners[k], corners[0]), sub(corners[k + 1], corners[0]));
        normal.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    let mut left = 2.0 * polygon.area() * random.unit();
    let mut k = 1;
    while k + 2 < corners.len() && left > twice_area(k) {
        left -= twice_area(k);
        k += 1;
    }
    let (mut s, mut t) = (random.unit(), random.unit());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    let position =
        std::array::from_fn(|i| corners[0][i] + s * (corners[k][i] - corners[0][i]) + t * (corners[k + 1][i] - corners[0][i]));
    SurfacePoint { position, normal: polygon.normal() }
}

/// Points of all surfaces, uniform by area, each with its surface.
pub fn points_of(scene: &Scene, count: usize, random: &mut Random) -> Vec<(SurfacePoint, usize)> {
    let areas: Vec<f64> = scene.surfaces().iter().map(|surface| surface.polygon.area()).collect();
    let total: f64 = areas.iter().sum();
    let mut points = Vec::with_capacity(count);
    while points.len() < count {
        let mut left = total * random.unit();
        let surface = areas
            .iter()
            .position(|area| {
                left -= area;
                left < 0.0
            })
            .unwrap_or(0);
        points.push((point_of(&scene.surfaces()[surface].polygon, random), surface));
    }
    points
}

/// `random.between` for every channel.
pub fn channels(random: &mut Random, count: usize, low: f64, high: f64) -> Vec<f64> {
    (0..count).map(|_| random.between(low, high)).collect()
}
