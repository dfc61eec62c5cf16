//! Exact values against rays: many of a backend, with a standard error, and a fine grid of exact ones.

use std::path::Path;

use patchlight::direct::{DirectEffort, DirectIrradiance, Method, direct_irradiance};
use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, Surface, SurfaceId};
use patchlight::visibility::{Backend, Segment};

use crate::rooms::{Room, crowded, point_of, straight, turned};
use crate::triangles::{Random, add, dot, sub};
use crate::{backend, emitters, exact};

/// Rays from each point, so many times with other random numbers.
const RAYS: u32 = 2048;
const TIMES: u64 = 8;

/// Largest deviation of one point in standard errors: some thousand points are looked at.
const SIGMAS: f64 = 5.0;

/// What rounding of coordinates leaves of the light that comes along a surface, in W/m^2.
const ROUNDING: f64 = 1e-12;

fn random_points(scene: &Scene, count: usize, seed: u64) -> Vec<(SurfaceId, [f64; 3])> {
    let mut random = Random(seed);
    let mut point = || {
        let id = random.below(scene.surfaces().len());
        (SurfaceId(id as u32), point_of(&scene.surfaces()[id].polygon, &mut random).position)
    };
    (0..count).map(|_| point()).collect()
}

/// Holds exact values against rays: each point by itself, and all by the mean square of what they are off by in standard errors.
///
/// `rounding` is what rounding of coordinates leaves of the light, in W/m^2. The standard error of few rays that differ, or none, is not known to be small: to it is added what one ray of all is worth.
fn check(name: &str, scene: &Scene, points: &[(SurfaceId, [f64; 3])], rounding: f64) {
    let exact = exact(scene, points);
    let rays = backend(scene, Backend::Auto);
    let effort = DirectEffort { rays: RAYS, method: Method::Rays };
    let runs: Vec<_> = (0..TIMES).map(|seed| direct_irradiance(scene, &*rays, points, effort, seed)).collect();
    let mean = |of: &dyn Fn(&DirectIrradiance) -> f64| runs.iter().map(of).sum::<f64>() / TIMES as f64;
    let (channels, mut squares, mut random, mut lit) = (scene.channels(), 0.0, 0, 0);
    for (index, exact) in exact.iter().enumerate() {
        let (point, channel) = (points[index / channels], index % channels);
        let (found, variance) = (mean(&|run| run.irradiance[index]), mean(&|run| run.variance[index]) / TIMES as f64);
        let of_one_ray = unoccluded(scene, point)[channel] / (f64::from(RAYS) * TIMES as f64);
        let standard_error = variance.sqrt() + of_one_ray + rounding;
        let off = (exact - found).abs();
        assert!(off <= SIGMAS * standard_error, "{name}: {exact} exactly, {found} +- {standard_error:e} by rays, at {point:?}");
        lit += usize::from(*exact > 0.0);
        if variance > 0.0 {
            random += 1;
            squares += (off / standard_error).powi(2);
        }
    }
    assert!(squares <= 1.5 * f64::from(random), "{name}: {squares} for {random} points");
    assert!(3 * lit > points.len() && random > 10, "{name}: {lit} points are lit, {random} in penumbrae");
}

/// What all emitters would bring to a point with nothing in between, by channel.
fn unoccluded(scene: &Scene, (surface, point): (SurfaceId, [f64; 3])) -> Vec<f64> {
    let normal = scene.surface(surface).polygon.normal();
    let mut sums = vec![0.0; scene.channels()];
    for id in emitters(scene) {
        let form_factor = point_form_factor(point, normal, &scene.surface(id).polygon);
        sums.iter_mut().zip(&scene.material_of(id).exitance).for_each(|(sum, e)| *sum += form_factor * e);
    }
    sums
}

/// A closed room with lamps and boxes, tiles and triangles, some of which touch each other, the walls and the lamps, or pass through each other.
fn random_room(seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.0), true, |_, _| grey);
    // Coordinates on a coarse grid, so that much is coplanar and touches.
    let mut coarse = |low: f64, high: f64| (random.between(low, high) * 4.0).round() / 4.0;
    for k in 0..3 {
        let corner = [coarse(0.0, 3.0), coarse(0.0, 2.0), if k == 0 { 2.0 - 1.0 / 128.0 } else { coarse(0.5, 1.75) }];
        room.quad(corner, [0.0, 0.75, 0.0], [0.5 + 0.25 * f64::from(k), 0.0, 0.0], lamp);
    }
    for k in 0..8 {
        let corner = [coarse(0.0, 3.5), coarse(0.0, 2.5), coarse(0.0, 1.5)];
        let (x, y, z) = (coarse(0.25, 0.75), coarse(0.25, 0.75), coarse(0.25, 0.75));
        let sides = if k % 2 == 0 { straight(x, y, z) } else { turned(x, y, z, coarse(0.0, 1.5)) };
        room.cuboid(corner, sides, false, |_, _| grey);
    }
    for _ in 0..6 {
        let corner = [random.between(0.2, 3.8), random.between(0.2, 2.8), random.between(0.1, 1.9)];
        let [u, v] = [random.direction(), random.direction()].map(|direction| direction.map(|x| 0.6 * x));
        room.face(&[corner, add(corner, u), add(corner, v)], grey);
    }
    room.scene()
}

#[test]
fn random_rooms_whose_furniture_touches() {
    for seed in 0..12 {
        let scene = random_room(seed);
        check(&format!("seed {seed}"), &scene, &random_points(&scene, 60, seed), ROUNDING);
    }
}

/// As files give it: turned, and coordinates rounded to a micrometre, so that polygons are not quite flat and what touched nearly does.
fn turned_and_rounded(scene: &Scene) -> Scene {
    let ([sin, cos], [across, along]) = ([0.6, 0.8], [0.28, 0.96]);
    let turn = |[x, y, z]: [f64; 3]| {
        let [x, y] = [cos * x - sin * y, sin * x + cos * y];
        [x, along * y - across * z, across * y + along * z].map(|coordinate| (coordinate * 1e6).round() / 1e6)
    };
    let face = |surface: &Surface| {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().map(turn).collect();
        (Polygon::new(&corners).unwrap(), surface.material, surface.face)
    };
    let faces = scene.surfaces().iter().map(face).collect();
    Scene::new(scene.channels(), scene.materials().to_vec(), faces, scene.sides()).unwrap()
}

#[test]
fn rooms_that_are_turned_and_rounded() {
    // Exact values take a lamp's corners as they are, rays its plane: they are a micrometre apart, and lamps about a metre away.
    for seed in 40..46 {
        let scene = turned_and_rounded(&random_room(seed));
        check(&format!("seed {seed}"), &scene, &random_points(&scene, 80, seed), 1e-6);
    }
}

#[test]
fn crowded_rooms() {
    for (boxes, seed) in [(10, 1), (40, 2), (120, 3)] {
        let scene = crowded(boxes, seed);
        check(&format!("{boxes} boxes"), &scene, &random_points(&scene, 100, seed), ROUNDING);
    }
}

#[test]
fn scenes_of_the_repository() {
    for name in ["cornell", "room", "full_office", "living_room"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        check(name, &scene, &random_points(&scene, 200, 5), ROUNDING);
    }
}

#[test]
#[ignore = "needs ../shared/peers: scenes of other programs"]
fn scenes_of_other_programs() {
    for name in ["cornell", "office"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../shared/peers/scenes/{name}.obj"));
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        check(name, &scene, &random_points(&scene, 200, 5), ROUNDING);
    }
}

/// The kernel over the visible midpoints of a fine grid on each source, each segment decided in f64.
#[test]
fn exact_rays_to_a_fine_grid_agree() {
    const SIDE: usize = 64;
    let at = |k: usize| (k as f64 + 0.5) / SIDE as f64;
    for seed in 20..24 {
        let scene = random_room(seed);
        let reference = backend(&scene, Backend::BruteForce);
        for &(surface, point) in &random_points(&scene, 12, seed) {
            let normal = scene.surface(surface).polygon.normal();
            let (mut sum, mut most) = (0.0, 0.0_f64);
            for id in emitters(&scene) {
                let source = scene.surface(id);
                let corners: Vec<[f64; 3]> = source.polygon.vertices().collect();
                let (u, v) = (sub(corners[1], corners[0]), sub(corners[3], corners[0]));
                let to = |k: usize| {
                    let (s, t) = (at(k % SIDE), at(k / SIDE));
                    std::array::from_fn(|axis| corners[0][axis] + s * u[axis] + t * v[axis])
                };
                let (from_plane, to_plane) = (scene.surface(surface).plane(), source.plane());
                let segments: Vec<Segment> =
                    (0..SIDE * SIDE).map(|k| Segment { from: point, to: to(k), from_plane, to_plane }).collect();
                let mut occluded = vec![false; segments.len()];
                reference.occluded(&segments, &mut occluded);
                for (segment, occluded) in segments.iter().zip(&occluded) {
                    let way = sub(segment.to, point);
                    let cosines = dot(normal, way).max(0.0) * -dot(source.polygon.normal(), way).min(0.0);
                    let brings =
                        cosines / (std::f64::consts::PI * dot(way, way).powi(2)) * source.polygon.area() / (SIDE * SIDE) as f64;
                    most = most.max(brings);
                    sum += if *occluded { 0.0 } else { brings };
                }
            }
            // Some ten shadow edges cross the grid; a cell on one is off by half of what it brings, at random along the edge.
            let expected = most * (10.0 * SIDE as f64).sqrt();
            let found = exact(&scene, &[(surface, point)])[0];
            assert!((found - sum).abs() <= 2.0 * expected + 1e-4 * sum, "seed {seed}: {found}, {sum} over the grid, at {point:?}");
        }
    }
}
