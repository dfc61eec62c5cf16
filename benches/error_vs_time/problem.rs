//! Scenes with points and references: what runs are scored against.
#![allow(clippy::print_stderr, reason = "a benchmark tells how far it is")]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::visibility::{Backend, OccluderMesh, Ray, build};

use super::peers::Peers;
use super::run;
use super::two_squares::TwoSquares;

/// Points of scenes that have none of their own.
const POINTS: usize = 2000;

/// A point: position and normal.
type Point = [f64; 6];

/// A scene, points, and what is right there.
pub struct Problem {
    pub name: String,
    pub scene: PathBuf,
    pub points: Vec<Point>,
    pub reference: Vec<[f64; 3]>,
    /// E at the points.
    exitance: Vec<[f64; 3]>,
    /// One standard deviation of the reference, relative in the norm of errors.
    noise: f64,
    /// Where the reference comes from.
    pub reference_is: String,
    /// Whether a bake of the whole scene is timed too.
    pub bakes: bool,
    /// Whether both ways of gathering are timed, not just the one that the program chooses.
    pub both_ways: bool,
}

/// All scenes that are there, or those with one of the `wanted` words in their names.
pub fn all(root: &Path, folder: &Path, wanted: &[String], peers: Option<&Peers>) -> Vec<Problem> {
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str()));
    let mut problems = vec![two_squares(folder)];
    let shared = root.join("../shared/peers");
    problems.extend(["cornell", "office"].into_iter().filter_map(|name| of_peers(&shared, name)));
    problems.retain(|problem| is_wanted(&problem.name));
    let own_scene = |name: &str| (name.replace('_', " "), root.join(format!("scenes/{name}.obj")));
    let by_others = |name: &str| (format!("{name} (by others)"), root.join(format!("../shared/scenes/{name}/scene.obj")));
    let scenes = ["full_office", "room", "dining_room", "hevea", "two_rooms"].map(own_scene).into_iter();
    for (name, scene) in scenes.chain(["corridor", "oa_czest1dm"].map(by_others)) {
        if is_wanted(&name) && scene.is_file() {
            eprintln!("{name}: looking for its reference");
            problems.push(with_reference(name, scene, folder, peers));
        }
    }
    problems
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

fn read(scene: &Path) -> Scene {
    read_scene(scene, &ImportOptions::default()).expect("a scene of the repository").scene
}

/// Two facing squares with a blocker between them: exact.
fn two_squares(folder: &Path) -> Problem {
    let scene = folder.join("two_squares.obj");
    let text = "mtllib two_squares.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv .25 .25 .5\nv .75 .25 .5\n\
                v .75 .75 .5\nv .25 .75 .5\nusemtl lower\nf 1 2 3 4\nusemtl upper\nf 5 8 7 6\nusemtl black\nf 9 10 11 12\nf 12 11 10 9\n";
    std::fs::write(&scene, text).expect("a scene is written");
    let radiance = 1.0 / PI;
    let materials = format!(
        "newmtl lower\nKd .5 .5 .5\nKe {radiance} {radiance} {radiance}\nnewmtl upper\nKd .7 .7 .7\nnewmtl black\nKd 0 0 0\n"
    );
    std::fs::write(folder.join("two_squares.mtl"), materials).expect("materials are written");

    let exact = TwoSquares::new(true);
    let mut random = Random(3);
    let (mut points, mut reference, mut exitance) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..POINTS {
        let (square, [x, y]) = (k % 2, [random.unit(), random.unit()]);
        points.push([x, y, square as f64, 0.0, 0.0, 1.0 - 2.0 * square as f64]);
        reference.push([exact.at(square, [x, y]); 3]);
        exitance.push([1.0 - square as f64; 3]);
    }
    let (name, reference_is) = ("two squares".to_owned(), "exact".to_owned());
    Problem { name, scene, points, reference, exitance, noise: 0.0, reference_is, bakes: false, both_ways: true }
}

/// A scene that peers were measured on, if it is there.
fn of_peers(folder: &Path, name: &str) -> Option<Problem> {
    let numbers = |file: PathBuf| -> Option<Vec<Vec<f64>>> {
        let text = std::fs::read_to_string(file).ok()?;
        Some(text.lines().filter_map(|line| line.split([' ', ',']).map(|number| number.parse().ok()).collect()).collect())
    };
    let points = numbers(folder.join(format!("scenes/{name}.pts")))?;
    let rows = numbers(folder.join(format!("refs/{name}_ref.csv")))?;
    let sum_sq =
        |columns: std::ops::Range<usize>| -> f64 { rows.iter().flat_map(|row| &row[columns.clone()]).map(|x| x * x).sum() };
    Some(Problem {
        name: format!("{name} of the peers"),
        scene: folder.join(format!("scenes/{name}.obj")),
        points: points.iter().map(|row| std::array::from_fn(|k| row[k])).collect(),
        reference: rows.iter().map(|row| [row[0], row[1], row[2]]).collect(),
        exitance: vec![[0.0; 3]; rows.len()],
        noise: (sum_sq(3..6) / sum_sq(0..3)).sqrt(),
        reference_is: "path tracing, converged".to_owned(),
        bakes: name == "office",
        both_ways: true,
    })
}

/// A scene with a reference by a path tracer where one is installed.
fn with_reference(name: String, scene: PathBuf, folder: &Path, peers: Option<&Peers>) -> Problem {
    let points = spread(&read(&scene), POINTS, 5);
    let exitance = vec![[0.0; 3]; points.len()];
    let (reference, reference_is) = (Vec::new(), String::new());
    let both_ways = name == "full office";
    let mut problem = Problem { name, scene, points, reference, exitance, noise: 0.0, reference_is, bakes: false, both_ways };
    (problem.reference, problem.noise, problem.reference_is) = match peers {
        Some(peers) => peers.reference(&problem, folder),
        None => own_reference(&problem, folder),
    };
    problem
}

/// Light paths of our own, four times as accurate as anything that is scored, with another seed.
fn own_reference(problem: &Problem, folder: &Path) -> (Vec<[f64; 3]>, f64, String) {
    let (values, report) = (folder.join("reference.csv"), folder.join("reference.json"));
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.arg("solve").arg(&problem.scene).args([
        "--error",
        "0.0025",
        "--seed",
        "977",
        "--set",
        "gather=hemisphere",
        "--time",
        "60",
    ]);
    command.arg("--points").arg(problem.points_file(folder)).arg("--values").arg(&values).arg("--report").arg(&report);
    run::timed(&mut command);
    let text = std::fs::read_to_string(report).expect("the program wrote a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("a report is JSON");
    let claimed = report["error"]["estimate"].as_f64().expect("a claim");
    let reference_is = format!("light paths of our own, claimed {:.2}%", 100.0 * claimed);
    (run::read_values(&values), claimed, reference_is)
}

/// SplitMix64.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Points uniform by area on what does not emit, from which no ray meets a back: others are covered, and nobody sees them.
fn spread(scene: &Scene, count: usize, seed: u64) -> Vec<Point> {
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
