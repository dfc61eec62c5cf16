//! The path tracer that makes references of benchmarks, held against exact values and against another program.
#![allow(clippy::print_stderr, reason = "a test tells what it measured")]

#[path = "../benches/support/path_tracer.rs"]
mod path_tracer;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use std::path::{Path, PathBuf};

use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::Backend;
use path_tracer::{PathTracer, Portal};
use rooms::{Room, points_of, straight};
use triangles::{Random, cross, dot, sub};
use two_squares::TwoSquares;

const BATCHES: u64 = 16;

/// The mean over batches and its standard error, by channel.
fn traced(tracer: &PathTracer, surface: SurfaceId, position: [f64; 3], count: u32) -> ([f64; 3], [f64; 3]) {
    let batches: Vec<[f64; 3]> =
        (0..BATCHES).map(|seed| tracer.batch(surface, position, count, Random(seed).bits()).radiosity).collect();
    let mean = [0, 1, 2].map(|k| batches.iter().map(|batch| batch[k]).sum::<f64>() / BATCHES as f64);
    let error = [0, 1, 2].map(|k| {
        let squares: f64 = batches.iter().map(|batch| (batch[k] - mean[k]).powi(2)).sum();
        (squares / (BATCHES * (BATCHES - 1)) as f64).sqrt()
    });
    (mean, error)
}

/// How far off values are, root mean square in standard errors: 1 for a tracer that is right and knows how noisy it is.
struct Deviation {
    squares: f64,
    count: usize,
}

impl Deviation {
    fn new() -> Self {
        Self { squares: 0.0, count: 0 }
    }

    fn add(&mut self, found: f64, expected: f64, error: f64) {
        self.squares += ((found - expected) / error.max(1e-12 * expected)).powi(2);
        self.count += 1;
    }

    fn check(&self, what: &str) {
        let deviation = (self.squares / self.count as f64).sqrt();
        eprintln!("{what}: {deviation:.2} standard errors over {} values", self.count);
        assert!(deviation < 1.3, "{what}: {deviation}");
    }
}

/// A room with boxes, a sheet and emitters of all kinds, in which all light is 1 (Kirchhoff).
fn furnace() -> Scene {
    let mut room = Room::default();
    let rho = [[0.3, 0.5, 0.9], [0.7, 0.6, 0.5], [0.0, 0.2, 0.8]];
    let [wall, object, leaf] = rho.map(|rho| room.material(&rho, &rho.map(|rho| 1.0 - rho)));
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.5), true, |_, _| wall);
    room.cuboid([1.0, 1.0, 0.0], straight(1.0, 0.5, 1.2), false, |_, _| object);
    room.sheet(&[[2.5, 1.0, 1.0], [3.5, 1.2, 1.1], [3.0, 2.0, 1.8]], leaf);
    room.scene()
}

#[test]
fn all_light_is_one_in_a_furnace_through_a_portal_too() {
    let scene = furnace();
    let portal = Portal { corner: [3.0, 0.5, 2.0], u: [0.5, 0.0, 0.0], v: [0.0, 0.0, 0.4] };
    for (portal, what) in [(None, "a furnace"), (Some(portal), "a furnace with a portal")] {
        let tracer = PathTracer::new(&scene, portal, Backend::Auto);
        let mut deviation = Deviation::new();
        for (point, surface) in points_of(&scene, 24, &mut Random(3)) {
            let (mean, error) = traced(&tracer, SurfaceId(surface as u32), point.position, 128);
            // Between the box and the floor that it stands on there is no light.
            if !is_under_the_box(point.position) {
                (0..3).for_each(|k| deviation.add(mean[k], 1.0, error[k]));
            }
        }
        deviation.check(what);
    }
}

/// On the floor below the box, or on its lower side.
fn is_under_the_box([x, y, z]: [f64; 3]) -> bool {
    z == 0.0 && (1.0..=2.0).contains(&x) && (1.0..=1.5).contains(&y)
}

#[test]
fn two_squares_with_a_blocker_are_as_the_exact_solution_says() {
    let mut room = Room::default();
    let (lower, upper) = (room.material(&[0.5; 3], &[1.0; 3]), room.material(&[0.7; 3], &[0.0; 3]));
    let black = room.material(&[0.0; 3], &[0.0; 3]);
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], lower);
    room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], upper);
    room.sheet(&[[0.25, 0.25, 0.5], [0.75, 0.25, 0.5], [0.75, 0.75, 0.5], [0.25, 0.75, 0.5]], black);
    let scene = room.scene();
    let (tracer, exact, mut random) = (PathTracer::new(&scene, None, Backend::Auto), TwoSquares::new(true), Random(7));
    let mut deviation = Deviation::new();
    for k in 0..40 {
        let (square, place) = (k % 2, [random.unit(), random.unit()]);
        let position = [place[0], place[1], square as f64];
        let (mean, error) = traced(&tracer, SurfaceId(square as u32), position, 512);
        assert!((mean[0] / exact.at(square, place) - 1.0).abs() < 0.03, "{mean:?}");
        deviation.add(mean[0], exact.at(square, place), error[0]);
    }
    deviation.check("two squares");
}

fn peers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers")
}

/// Rows of numbers; lines that are none, such as a header, are left out.
fn numbers(file: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines().filter_map(|line| line.split([' ', ',']).map(|number| number.parse().ok()).collect()).collect()
}

/// The surface that a point lies on, with the normal of its front.
fn surface_at(scene: &Scene, position: [f64; 3], normal: [f64; 3]) -> SurfaceId {
    let is_there = |surface: &patchlight::scene::Surface| {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let (own, size) = (surface.polygon.normal(), 1e-4 * surface.polygon.area().sqrt());
        let is_inside = (0..corners.len()).all(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            dot(cross(sub(b, a), sub(position, a)), own) > -size * size
        });
        is_inside && dot(own, normal) > 0.99 && dot(sub(position, corners[0]), own).abs() < size
    };
    SurfaceId(scene.surfaces().iter().position(is_there).unwrap() as u32)
}

#[test]
#[ignore = "needs ../shared/peers: scenes and references of other programs"]
fn mitsuba_finds_the_same() {
    for name in ["cornell", "office"] {
        let scene = read_scene(&peers().join(format!("scenes/{name}.obj")), &ImportOptions::default()).unwrap().scene;
        let tracer = PathTracer::new(&scene, None, Backend::Auto);
        let points = numbers(&peers().join(format!("scenes/{name}.pts")));
        let reference = numbers(&peers().join(format!("refs/{name}_ref.csv")));
        let (mut found, mut expected) = (0.0, 0.0);
        let mut deviation = Deviation::new();
        for (point, row) in points.iter().zip(&reference).step_by(10) {
            let position = [point[0], point[1], point[2]];
            let (mean, error) = traced(&tracer, surface_at(&scene, position, [point[3], point[4], point[5]]), position, 512);
            for k in 0..3 {
                deviation.add(mean[k], row[k], error[k].hypot(row[k + 3]));
                found += mean[k];
                expected += row[k];
            }
        }
        eprintln!("{name}: {:.3}% more light", 100.0 * (found / expected - 1.0));
        deviation.check(name);
    }
}
