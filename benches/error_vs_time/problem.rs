//! A scene with points and a reference: what runs are scored against.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::visibility::{Backend, OccluderMesh, Ray, build};

/// Points of a whole bake: an office of 344 m^2 in texels of 5 cm.
pub const BAKE_POINTS: usize = 138_000;

/// A point: position and normal.
type Point = [f64; 6];

/// A scene, points, and what is right there.
pub struct Problem {
    pub name: String,
    pub scene: PathBuf,
    pub points: Vec<Point>,
    pub reference: Vec<[f64; 3]>,
    /// E at the points.
    pub exitance: Vec<[f64; 3]>,
    /// One standard deviation of the reference, relative in the norm of errors.
    pub noise: f64,
    /// Where the reference comes from.
    pub reference_is: String,
    /// Whether a bake of the whole scene is timed too.
    pub bakes: bool,
    /// Whether both solvers are timed, not just the one that the program chooses.
    pub both_solvers: bool,
}

impl Problem {
    pub fn file_name(&self) -> String {
        self.name.replace(' ', "_").replace(['(', ')'], "")
    }

    /// The points as the program reads them.
    pub fn points_file(&self, folder: &Path) -> PathBuf {
        let file = folder.join(format!("{}_points.csv", self.file_name()));
        write_points(&file, self.points.iter());
        file
    }

    /// The scored points and so many in all, as texels of a bake.
    pub fn bake_points(&self, folder: &Path, count: usize) -> PathBuf {
        let file = folder.join(format!("{}_bake.csv", self.file_name()));
        let more = spread(&read(&self.scene), count - self.points.len(), 77);
        write_points(&file, self.points.iter().chain(&more));
        file
    }

    /// `||B - R|| / ||R - E||`, and what the noise of the reference adds to it.
    pub fn error_of(&self, found: &[[f64; 3]]) -> (f64, f64) {
        let (mut error_sq, mut norm_sq) = (0.0, 0.0);
        for ((found, expected), exitance) in found.iter().zip(&self.reference).zip(&self.exitance) {
            for channel in 0..3 {
                error_sq += (found[channel] - expected[channel]).powi(2);
                norm_sq += (expected[channel] - exitance[channel]).powi(2);
            }
        }
        ((error_sq / norm_sq).sqrt(), self.noise)
    }
}

fn write_points<'a>(file: &Path, points: impl Iterator<Item = &'a Point>) {
    let mut text = String::from("x,y,z,nx,ny,nz\n");
    for [x, y, z, nx, ny, nz] in points {
        let _ = writeln!(text, "{x},{y},{z},{nx},{ny},{nz}");
    }
    std::fs::write(file, text).expect("points are written");
}

pub fn read(scene: &Path) -> Scene {
    read_scene(scene, &ImportOptions::default()).expect("a scene of the repository").scene
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Points uniform by area on what does not emit, from which no ray meets a back: others are covered, and nobody sees them.
pub fn spread(scene: &Scene, count: usize, seed: u64) -> Vec<Point> {
    const RAYS: usize = 32;
    let visibility = build(Backend::Obvhs, &OccluderMesh::of_scene(scene)).expect("the backend of every build");
    let mut random = Random(seed);
    let is_dark = |surface: usize| {
        let material = &scene.materials()[scene.surfaces()[surface].material as usize];
        material.exitance.iter().all(|&e| e == 0.0)
    };
    let mut below = Vec::new();
    let mut total = 0.0;
    for (index, surface) in scene.surfaces().iter().enumerate().filter(|(index, _)| is_dark(*index)) {
        total += surface.polygon.area();
        below.push((total, index));
    }

    let mut points = Vec::with_capacity(count);
    let mut hits = vec![None; RAYS];
    while points.len() < count {
        let drawn = total * random.unit();
        let surface = &scene.surfaces()[below[below.partition_point(|(area, _)| *area <= drawn).min(below.len() - 1)].1];
        let Some(position) = point_of(&surface.polygon.vertices().collect::<Vec<_>>(), surface.polygon.normal(), &mut random)
        else {
            continue;
        };
        let normal = surface.polygon.normal();
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| Ray { origin: position, direction: cosine(normal, &mut random), origin_plane: surface.plane() })
            .collect();
        visibility.first_hits(&rays, &mut hits);
        let meets_back = rays.iter().zip(&hits).any(|(ray, hit)| {
            hit.is_some_and(|hit| dot(scene.surfaces()[hit.surface as usize].polygon.normal(), ray.direction) > 0.0)
        });
        if !meets_back {
            let ([x, y, z], [nx, ny, nz]) = (position, normal);
            points.push([x, y, z, nx, ny, nz]);
        }
    }
    points
}

/// A point of the box around a convex polygon in its plane, if it lies in the polygon.
fn point_of(corners: &[[f64; 3]], normal: [f64; 3], random: &mut Random) -> Option<[f64; 3]> {
    // A parallelogram over each triangle of the fan, of which half is used: uniform, as triangles are drawn by area.
    let sub = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let area = |k: usize| dot(cross(sub(corners[k], corners[0]), sub(corners[k + 1], corners[0])), normal);
    let total: f64 = (1..corners.len() - 1).map(area).sum();
    let mut drawn = total * random.unit();
    let k = (1..corners.len() - 1).find(|&k| {
        drawn -= area(k);
        drawn < 0.0
    })?;
    let (mut s, mut t) = (random.unit(), random.unit());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    let (u, v) = (sub(corners[k], corners[0]), sub(corners[k + 1], corners[0]));
    Some(std::array::from_fn(|axis| corners[0][axis] + s * u[axis] + t * v[axis]))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A direction by the cosine.
fn cosine(normal: [f64; 3], random: &mut Random) -> [f64; 3] {
    // A point of the unit sphere that touches the plane.
    let (height, angle) = (2.0 * random.unit() - 1.0, TAU * random.unit());
    let radius = (1.0 - height * height).sqrt();
    let sphere = [radius * angle.cos(), radius * angle.sin(), height];
    std::array::from_fn(|k| normal[k] * (1.0 + 1e-9) + sphere[k])
}
