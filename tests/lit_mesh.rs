//! Radiosity as a function on the surfaces: held against what is known exactly, against better values at points, and against itself.

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::f64::consts::PI;
use std::io::{self, Cursor};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use kirchhoff::kirchhoff;
use patchlight::mesh::LitMesh;
use patchlight::output::{Provenance, write_mesh_ply, write_quadratic_mesh_ply, write_solution};
use patchlight::pipeline;
use patchlight::progress::{Observer, Progress, Silent, Stage};
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{Norm, RunOptions, SolveOptions, Solver, StoppedBy};
use rooms::{Room, read, solved};
use triangles::Random;

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
    // All surfaces emit: over cells most emission is left to paths.
    for (seed, solver) in [(1, Solver::Links), (2, Solver::Links), (2, Solver::Cells), (3, Solver::Cells), (4, Solver::Auto)] {
        let furnace = kirchhoff(seed, 3);
        let options = SolveOptions { error: 0.02, solver, ..SolveOptions::default() };
        let (evaluator, report) = pipeline::solve(furnace.scene.clone(), &options, &RunOptions::default(), &Silent).unwrap();
        let mesh = evaluator.lit_mesh(0.02, &Silent).unwrap();
        let points = points_on(evaluator.solution().scene(), 3000);
        let points: Vec<SurfacePoint> = points.into_iter().filter(|point| !furnace.is_covered(point.position)).collect();
        let values = evaluator.values_of_mesh(&mesh, &points);
        let off = |(k, &b): (usize, &f32)| (f64::from(b) / furnace.b0[k % 3] - 1.0).powi(2);
        let off = (values.iter().enumerate().map(off).sum::<f64>() / values.len() as f64).sqrt();
        let all = report.error.estimate.hypot(mesh.claimed);
        assert!(off <= all, "seed {seed}, {solver:?}: {off} off, {all} claimed");
    }
}

/// The error of values in three channels, in either norm, every point counting alike.
fn error_of(values: &[f32], truth: &[f32], norm: Norm) -> f64 {
    let squares = |(f, t): (&[f32], &[f32])| {
        let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(of).sum::<f64>();
        [sum(&|k| f64::from(f[k] - t[k]).powi(2)), sum(&|k| f64::from(t[k]).powi(2))]
    };
    let squares: Vec<[f64; 2]> = values.chunks(3).zip(truth.chunks(3)).map(squares).collect();
    if norm == Norm::Energy {
        let [errors, light] = [0, 1].map(|k| squares.iter().map(|of| of[k]).sum::<f64>());
        return (errors / light).sqrt();
    }
    let mut light: Vec<f64> = squares.iter().map(|of| of[1]).collect();
    light.sort_by(f64::total_cmp);
    let typical = light[light.len() / 2];
    (squares.iter().map(|[e, b]| e / b.max(typical)).sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn what_is_asked_for_holds_for_the_function_over_links_and_over_cells() {
    for name in ["cornell.obj", "two_rooms.obj"] {
        let scene = read(name);
        let points = points_on(&scene, 2000);
        let truth = solved(scene.clone(), 0.01, 0).0.values_at(&points, &Silent).unwrap().radiosity;
        for norm in [Norm::Local, Norm::Energy] {
            let options = SolveOptions { error: 0.05, norm, lit_mesh: true, ..SolveOptions::default() };
            let (evaluator, report) = pipeline::solve(scene.clone(), &options, &RunOptions::default(), &Silent).unwrap();
            let told = report.lit_mesh.unwrap();
            assert!(report.converged && report.stopped_by == StoppedBy::Error && report.time_s.mesh > 0.0, "{name}: {told:?}");
            assert!((told.whole.estimate - told.off_values.estimate.hypot(report.error.estimate)).abs() < 1e-12);
            assert!(told.whole.estimate <= 0.05 && report.error.requested == 0.05, "{name}: {told:?}");
            assert_eq!(evaluator.solution().options(), &options);
            let mesh = evaluator.mesh().unwrap();
            assert_eq!((told.elements, told.nodes), (mesh.elements() as u64, mesh.nodes() as u64));
            // Near the lamp nodes are noisy: elements that followed the noise would be tens of thousands.
            assert!(told.elements < 5_000, "{name}: {told:?}");

            // By energy the lamps count as well: what they emit is exact, so it is left out. The truth is 1% off itself.
            let values = evaluator.mesh_values_at(&points).unwrap();
            assert_eq!(values.missed, 0);
            assert!(
                values.standard_error.iter().all(|se| se.is_finite()) && values.error.unwrap().local < 0.1,
                "{:?}",
                values.error
            );
            let off = error_of(&values.radiosity, &truth, norm);
            assert!(off <= told.whole.estimate.hypot(0.01), "{name}: {off} off, {told:?}");
        }
    }
}

/// Says no, or cancels, once the mesh is made.
struct Refuses {
    is_mesh: AtomicBool,
    cancels: bool,
    /// Bytes that are allowed then: what is asked for first.
    allowed: AtomicU64,
    allows_first: bool,
}

impl Refuses {
    fn new(cancels: bool, allows_first: bool) -> Self {
        Self { is_mesh: AtomicBool::new(false), cancels, allowed: AtomicU64::new(0), allows_first }
    }
}

impl Observer for Refuses {
    fn progress(&self, progress: &Progress) {
        if progress.stage == Stage::Mesh {
            self.is_mesh.store(true, Relaxed);
        }
    }

    fn cancelled(&self) -> bool {
        self.cancels && self.is_mesh.load(Relaxed)
    }

    fn allows_memory(&self, bytes: u64) -> bool {
        if self.cancels || !self.is_mesh.load(Relaxed) {
            return true;
        }
        if self.allows_first {
            // All light may begin with a few more elements than indirect light; four times as many are refused.
            let _ = self.allowed.compare_exchange(0, bytes + bytes / 100, Relaxed, Relaxed);
        }
        bytes <= self.allowed.load(Relaxed)
    }
}

#[test]
fn limits_end_the_mesh_and_leave_the_values() {
    let options = SolveOptions { error: 0.02, lit_mesh: true, ..SolveOptions::default() };
    let solve = |observer: &dyn Observer, time_s| {
        let run = RunOptions { time_s, ..RunOptions::default() };
        pipeline::solve(read("cornell.obj"), &options, &run, observer).unwrap()
    };
    for (observer, stopped_by) in
        [(Refuses::new(true, false), StoppedBy::Cancelled), (Refuses::new(false, false), StoppedBy::Memory)]
    {
        let (evaluator, report) = solve(&observer, None);
        assert_eq!((evaluator.mesh(), report.lit_mesh, report.converged, report.stopped_by), (None, None, false, stopped_by));
        assert!(report.error.estimate < 0.02 && evaluator.solution().options().lit_mesh, "{:?}", report.error);
    }

    // What there is when memory ends is judged as it is.
    let (evaluator, report) = solve(&Refuses::new(false, true), None);
    let told = report.lit_mesh.unwrap();
    assert!(evaluator.mesh().is_some() && told.whole.estimate > 0.02 && told.whole.estimate.is_finite(), "{told:?}");
    assert_eq!((report.converged, report.stopped_by), (false, StoppedBy::Memory));

    // A budget that is just enough for the values: the count stays within it, whether it is enough for the mesh or not.
    let solve_within = |options: &SolveOptions, memory_bytes| {
        let run = RunOptions { memory_bytes, ..RunOptions::default() };
        pipeline::solve(read("cornell.obj"), options, &run, &Silent).unwrap().1
    };
    let of_values = SolveOptions { error: 0.02 * 0.2_f64.sqrt(), lit_mesh: false, ..options.clone() };
    let enough = solve_within(&of_values, None).accounted_bytes;
    let report = solve_within(&options, Some(enough));
    assert!(report.accounted_bytes <= enough && report.error.estimate < 0.02, "{report:?}");
    let ended_by = if report.converged { StoppedBy::Error } else { StoppedBy::Memory };
    assert_eq!((report.stopped_by, report.claimed() <= 0.02), (ended_by, report.converged));

    // No time is left for anything.
    let (evaluator, report) = solve(&Silent, Some(0.0));
    assert_eq!((evaluator.mesh(), report.converged, report.stopped_by), (None, false, StoppedBy::Time));
}

#[test]
fn channels_that_are_read_off_others_are_in_the_mesh_as_well() {
    let room = |channels: usize| {
        let mut room = Room::default();
        let (grey, lamp) =
            (room.material(&vec![0.5; channels], &vec![0.0; channels]), room.material(&vec![0.0; channels], &vec![10.0; channels]));
        room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], grey);
        room.quad([-0.5, -0.5, 0.8], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        let options = SolveOptions { error: 0.1, lit_mesh: true, ..SolveOptions::default() };
        pipeline::solve(room.scene(), &options, &RunOptions::default(), &Silent).unwrap().0
    };
    let [one, three] = [1, 3].map(room);
    let points = points_on(one.solution().scene(), 100);
    let [one, three] = [one, three].map(|evaluator| evaluator.mesh_values_at(&points).unwrap().radiosity);
    assert_eq!(three, one.iter().flat_map(|&b| [b; 3]).collect::<Vec<f32>>());
    assert!(one.iter().any(|&b| b > 0.0));
}

/// A triangle alone over a black lamp: what is asked for is far beyond what may be tried, and the claim says so.
#[test]
fn an_error_of_next_to_nothing_takes_no_more_than_the_most() {
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[10.0]));
    room.quad([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], grey);
    room.quad([-5.0, -5.0, 20.0], [0.0, 10.0, 0.0], [10.0, 0.0, 0.0], lamp);
    let (evaluator, _) = solved(room.scene(), 0.1, 0);
    for error in [1e-6, 1e-300] {
        let mesh = evaluator.lit_mesh(error, &Silent).unwrap();
        assert!(mesh.claimed.is_finite() && mesh.elements() > 0);
    }
}

#[test]
fn threads_change_nothing_and_an_observer_ends_it() {
    let options = SolveOptions { error: 0.1, lit_mesh: true, ..SolveOptions::default() };
    let stored = |threads| {
        let run = RunOptions { threads, ..RunOptions::default() };
        let (evaluator, _) = pipeline::solve(read("two_rooms.obj"), &options, &run, &Silent).unwrap();
        assert!(evaluator.mesh().is_some());
        let mut file = Cursor::new(Vec::new());
        write_solution(&mut file, evaluator.solution(), &Provenance::new(&options)).unwrap();
        file.into_inner()
    };
    assert!(stored(1) == stored(3));

    struct Cancels;
    impl Observer for Cancels {
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(solved(read("cornell.obj"), 0.1, 0).0.lit_mesh(0.1, &Cancels), None);
}

#[test]
fn elements_cover_all_that_reflects_and_are_written_as_triangles_or_as_they_are() {
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

    // A face of six vertices, or four triangles; nodes are vertices either way.
    let provenance = Provenance::new(evaluator.solution().options());
    let nodes = mesh.nodes();
    for (faces, corners, write) in [(4 * elements, 3, write_mesh_ply as Writer), (elements, 6, write_quadratic_mesh_ply)] {
        let mut file = Vec::new();
        write(&mut file, evaluator.solution().scene(), &mesh, &provenance).unwrap();
        let (header, body) = header_and_body(&file);
        let count = |what: &str| -> usize {
            header.lines().find_map(|line| line.strip_prefix(&format!("element {what} "))).unwrap().parse().unwrap()
        };
        assert_eq!((count("face"), count("vertex")), (faces, nodes));
        let size = 1 + 4 * corners + NUMBERS;
        assert_eq!(body.len(), nodes * VERTEX + faces * size);

        // Around each face, counter-clockwise; all faces together have the area of the surfaces.
        let vertex = |number: u32| -> [f64; 3] {
            std::array::from_fn(|k| f64::from_le_bytes(body[number as usize * VERTEX + 8 * k..][..8].try_into().unwrap()))
        };
        let (mut covered, mut face) = (0.0, &body[nodes * VERTEX..]);
        while !face.is_empty() {
            assert_eq!(usize::from(face[0]), corners);
            let number = |k: usize| u32::from_le_bytes(face[1 + 4 * k..][..4].try_into().unwrap());
            let around: Vec<[f64; 3]> = (0..corners).map(|k| vertex(number(k))).collect();
            covered += (1..corners - 1).map(|k| fan_area(&around, k)).sum::<f64>();
            face = &face[size..];
        }
        assert!((covered / area - 1.0).abs() < 1e-6, "{covered} of {area}");
    }
}

type Writer = fn(&mut Vec<u8>, &Scene, &LitMesh, &Provenance) -> io::Result<()>;

/// Bytes of a vertex: a place, and three channels.
const VERTEX: usize = 3 * 8 + 3 * 4;

/// Bytes of the numbers of a face: of its surface, and of the face, the material, the object and the group of the input.
const NUMBERS: usize = 5 * 4;

fn header_and_body(file: &[u8]) -> (String, &[u8]) {
    let end = file.windows(11).position(|text| text == b"end_header\n").unwrap() + 11;
    (String::from_utf8(file[..end].to_vec()).unwrap(), &file[end..])
}
