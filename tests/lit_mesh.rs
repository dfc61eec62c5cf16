//! Radiosity as a function on the surfaces: held against what is known exactly, against better values at points, and against itself.

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::f64::consts::PI;
use std::path::Path;

use kirchhoff::kirchhoff;
use patchlight::mesh::LitMesh;
use patchlight::output::{Provenance, write_mesh_ply};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::{Observer, Silent};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{RunOptions, SolveOptions};
use rooms::Room;
use triangles::Random;

fn solved(scene: Scene, error: f64, threads: usize) -> (Evaluator, f64) {
    let options = SolveOptions { error, ..SolveOptions::default() };
    let run = RunOptions { threads, ..RunOptions::default() };
    let (evaluator, report) = pipeline::solve(scene, &options, &run, &Silent).unwrap();
    (evaluator, report.error.estimate)
}

fn read(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    read_scene(&path, &ImportOptions::default()).unwrap().scene
}

/// Points uniform over the area of the surfaces that reflect.
fn points_on(scene: &Scene, count: usize) -> Vec<SurfacePoint> {
    let mut random = Random(7);
    let mut points = Vec::new();
    let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    for surface in scene.surfaces() {
        if scene.materials()[surface.material as usize].reflectance.iter().all(|&rho| rho == 0.0) {
            continue;
        }
        let wanted = count as f64 * surface.polygon.area() / area + random.unit();
        let (vertices, normal) = (surface.polygon.vertices().collect::<Vec<_>>(), surface.polygon.normal());
        for _ in 0..wanted as usize {
            // A triangle of the fan, by area.
            let areas: Vec<f64> = (1..vertices.len() - 1).map(|k| fan_area(&vertices, k)).collect();
            let mut left = random.unit() * areas.iter().sum::<f64>();
            let k = 1 + areas
                .iter()
                .position(|area| {
                    left -= area;
                    left < 0.0
                })
                .unwrap_or(areas.len() - 1);
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = [0, k, k + 1].map(|k| vertices[k]);
            points.push(SurfacePoint { position: std::array::from_fn(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i])), normal });
        }
    }
    points
}

fn fan_area(vertices: &[[f64; 3]], k: usize) -> f64 {
    let side = |to: usize| -> [f64; 3] { std::array::from_fn(|i| vertices[to][i] - vertices[0][i]) };
    let (u, v) = (side(k), side(k + 1));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The form factor from a point under a corner of a rectangle that is parallel to it: sides over the distance (Howell, B-3).
fn under_corner(a: f64, b: f64) -> f64 {
    let of = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
    (of(a, b) + of(b, a)) / (2.0 * PI)
}

#[test]
fn under_a_lamp_the_function_is_lamberts() {
    // A black lamp of 1 m, 0.8 m above a floor of 4 m: nothing but direct light.
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[10.0]));
    room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], grey);
    room.quad([-0.5, -0.5, 0.8], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    let (evaluator, _) = solved(room.scene(), 0.02, 0);
    for error in [0.05, 0.01, 0.002] {
        let mesh = evaluator.lit_mesh(error, &Silent).unwrap();
        assert!(mesh.claimed <= error, "{} claimed", mesh.claimed);
        let points = points_on(evaluator.solution().scene(), 3000);
        let values = evaluator.values_of_mesh(&mesh, &points);
        let (mut errors_sq, mut exact) = (Vec::new(), Vec::new());
        for (point, value) in points.iter().zip(values) {
            let [x, y, _] = point.position.map(|x| x / 0.8);
            let part = |x: f64, y: f64| under_corner(x.abs(), y.abs()) * x.signum() * y.signum();
            let half = 0.5 / 0.8;
            let form_factor =
                part(x + half, y + half) - part(x - half, y + half) - part(x + half, y - half) + part(x - half, y - half);
            exact.push(0.5 * 10.0 * form_factor);
            errors_sq.push((f64::from(value) - exact[exact.len() - 1]).powi(2));
        }
        let mut sorted = exact.clone();
        sorted.sort_by(f64::total_cmp);
        let typical = sorted[sorted.len() / 2];
        let local =
            (errors_sq.iter().zip(&exact).map(|(e, b)| e / b.max(typical).powi(2)).sum::<f64>() / exact.len() as f64).sqrt();
        assert!(local <= mesh.claimed, "{local} off, {} claimed", mesh.claimed);
    }
}

#[test]
fn in_a_furnace_the_function_is_constant() {
    for seed in [1, 2] {
        let furnace = kirchhoff(seed, 3);
        let (evaluator, claimed) = solved(furnace.scene.clone(), 0.02, 0);
        let mesh = evaluator.lit_mesh(0.02, &Silent).unwrap();
        let points = points_on(evaluator.solution().scene(), 3000);
        let points: Vec<SurfacePoint> = points.into_iter().filter(|point| !furnace.is_covered(point.position)).collect();
        let values = evaluator.values_of_mesh(&mesh, &points);
        let off = |(k, &b): (usize, &f32)| (f64::from(b) / furnace.b0[k % 3] - 1.0).powi(2);
        let off = (values.iter().enumerate().map(off).sum::<f64>() / values.len() as f64).sqrt();
        let all = claimed.hypot(mesh.claimed);
        assert!(off <= all, "seed {seed}: {off} off, {all} claimed");
    }
}

#[test]
fn what_is_claimed_covers_the_truth_over_links_and_over_cells() {
    for name in ["cornell.obj", "two_rooms.obj"] {
        let scene = read(name);
        let points = points_on(&scene, 2000);
        let truth = solved(scene.clone(), 0.01, 0).0.values_at(&points, &Silent).unwrap().radiosity;
        let (evaluator, claimed) = solved(scene, 0.05, 0);
        let mesh = evaluator.lit_mesh(0.05, &Silent).unwrap();
        let values = evaluator.values_of_mesh(&mesh, &points);
        let squares: Vec<[f64; 2]> = values
            .chunks(3)
            .zip(truth.chunks(3))
            .map(|(f, t)| {
                let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(of).sum::<f64>();
                [sum(&|k| f64::from(f[k] - t[k]).powi(2)), sum(&|k| f64::from(t[k]).powi(2))]
            })
            .collect();
        let mut light: Vec<f64> = squares.iter().map(|of| of[1]).collect();
        light.sort_by(f64::total_cmp);
        let typical = light[light.len() / 2];
        let local = (squares.iter().map(|[e, b]| e / b.max(typical)).sum::<f64>() / squares.len() as f64).sqrt();
        // The truth is 1% off itself.
        let all = claimed.hypot(mesh.claimed).hypot(0.01);
        assert!(local <= all, "{name}: {local} off, {all} claimed");
    }
}

#[test]
fn threads_change_nothing_and_an_observer_ends_it() {
    let mesh = |threads| solved(read("two_rooms.obj"), 0.1, threads).0.lit_mesh(0.1, &Silent).unwrap();
    assert_eq!(mesh(1), mesh(3));

    struct Cancels;
    impl Observer for Cancels {
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(solved(read("cornell.obj"), 0.1, 0).0.lit_mesh(0.1, &Cancels), None);
}

#[test]
fn elements_cover_all_that_reflects_and_are_written_as_triangles() {
    let scene = read("cornell.obj");
    let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    let (evaluator, _) = solved(scene, 0.1, 0);
    let mesh: LitMesh = evaluator.lit_mesh(0.1, &Silent).unwrap();
    let (mut covered, mut elements) = (0.0, 0);
    mesh.for_each_element(evaluator.solution().scene(), |_, nodes, radiosity| {
        assert!(radiosity.iter().all(|b| b.is_finite() && *b >= 0.0));
        covered += fan_area(&nodes[..3], 1);
        elements += 1;
    });
    assert_eq!(elements, mesh.elements());
    assert!((covered / area - 1.0).abs() < 1e-6, "{covered} of {area}");

    let mut file = Vec::new();
    let provenance = Provenance::new(evaluator.solution().options());
    write_mesh_ply(&mut file, evaluator.solution().scene(), &mesh, &provenance).unwrap();
    let end = file.windows(11).position(|text| text == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(file[..end].to_vec()).unwrap();
    let count = |what: &str| -> usize {
        header.lines().find_map(|line| line.strip_prefix(&format!("element {what} "))).unwrap().parse().unwrap()
    };
    assert_eq!(count("face"), 4 * elements);
    assert_eq!(file.len() - end, count("vertex") * (3 * 8 + 3 * 4) + count("face") * (1 + 3 * 4 + 4));
}
