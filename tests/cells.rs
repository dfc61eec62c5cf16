//! The solver over cells, and the final gather, against what is known exactly.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use std::io::Cursor;
use std::path::Path;

use patchlight::form_factor::point_form_factor;
use patchlight::output::{Provenance, read_solution_from, write_solution};
use patchlight::pipeline::Evaluator;
use patchlight::scene::SurfaceId;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, SolveReport, Solver, StoppedBy};
use rooms::{Room, crowded, cube, points_of, solve, straight, two_squares, values, with_point_rays};
use triangles::Random;
use two_squares::TwoSquares;

fn over_cells(error: f64) -> SolveOptions {
    SolveOptions { error, solver: Solver::Cells, ..SolveOptions::default() }
}

#[test]
fn a_uniform_furnace_is_uniform() {
    // Every path in a closed room finds the same, so there is no noise: off are only the sweeps, which end with 1e-5 of it to come.
    for rho in [0.5, 0.9, 0.99] {
        let (evaluator, _) = solve(cube(&[rho], &[1.0]), &over_cells(0.1));
        let points: Vec<_> =
            points_of(evaluator.solution().scene(), 300, &mut Random(7)).into_iter().map(|(point, _)| point).collect();
        let expected = 1.0 / (1.0 - rho);
        let worst = values(&evaluator, &points).iter().map(|value| (value / expected - 1.0).abs()).fold(0.0, f64::max);
        println!("rho {rho}: {worst:e}");
        assert!(worst <= 2e-5, "rho {rho}: off by {worst:e}");
    }
}

/// A square that reflects, and over it one that emits, with black ones beside to dilute the part that emits, or without.
fn under_one_polygon(diluted: bool) -> Room {
    let mut room = Room::default();
    let (grey, bright, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
    room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
    room.face(&[[0.0, 0.0, 0.6], [0.2, 1.4, 0.6], [1.3, 0.8, 0.6]], bright);
    if diluted {
        room.quad([20.0, 20.0, -5.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], black);
    }
    room
}

/// A dark floor in sixteen tiles, and above it a small plate that a lamp below it lights from near by.
fn under_a_lit_plate() -> Room {
    let mut room = Room::default();
    let (dark, white, lamp) = (room.material(&[0.01], &[0.0]), room.material(&[0.8], &[0.0]), room.material(&[0.0], &[100.0]));
    for tile in 0..16 {
        let corner = [2.5 * f64::from(tile / 4), 2.5 * f64::from(tile % 4), 0.0];
        room.quad(corner, [2.5, 0.0, 0.0], [0.0, 2.5, 0.0], dark);
    }
    room.quad([4.85, 4.85, 2.0], [0.0, 0.3, 0.0], [0.3, 0.0, 0.0], white);
    room.quad([4.97, 4.97, 1.85], [0.06, 0.0, 0.0], [0.0, 0.06, 0.0], lamp);
    room
}

#[test]
fn light_from_a_small_bright_reflector_is_found() {
    // Where the lamp hides nothing of the plate, the floor gets H(x) = the integral of rho E F(y, lamp) K(x, y) over the plate; what comes
    // back from the floor is below 1e-4 of it.
    let scene = under_a_lit_plate().scene();
    let lamp = scene.surfaces()[17].polygon.clone();
    let steps = 60;
    let plate: Vec<([f64; 3], f64)> = (0..steps * steps)
        .map(|k| {
            let along = |index: i32| 4.85 + 0.3 * (f64::from(index) + 0.5) / f64::from(steps);
            let y = [along(k / steps), along(k % steps), 2.0];
            (y, 0.8 * 100.0 * point_form_factor(y, [0.0, 0.0, -1.0], &lamp))
        })
        .collect();
    let points: Vec<_> = points_of(&scene, 3000, &mut Random(5))
        .into_iter()
        .filter(|(point, surface)| *surface < 16 && (point.position[0] - 5.0).hypot(point.position[1] - 5.0) > 3.0)
        .map(|(point, _)| point)
        .collect();
    let irradiance = |x: [f64; 3]| {
        let element = (0.3 / f64::from(steps)).powi(2);
        let carried = |(y, b): &([f64; 3], f64)| {
            let distance_sq = (y[0] - x[0]).powi(2) + (y[1] - x[1]).powi(2) + 4.0;
            b * element * 4.0 / (std::f64::consts::PI * distance_sq * distance_sq)
        };
        plate.iter().map(carried).sum::<f64>()
    };
    let expected: Vec<f64> = points.iter().map(|point| 0.01 * irradiance(point.position)).collect();
    let norm_sq: f64 = expected.iter().map(|b| b * b).sum();

    let (mut bias, seeds) = (0.0, 8);
    for seed in 0..seeds {
        let (evaluator, report) = solve(under_a_lit_plate().scene(), &SolveOptions { seed, ..over_cells(0.03) });
        let found = values(&evaluator, &points);
        let error = (found.iter().zip(&expected).map(|(b, e)| (b - e).powi(2)).sum::<f64>() / norm_sq).sqrt();
        let off = found.iter().zip(&expected).map(|(b, e)| (b - e) * e).sum::<f64>() / norm_sq;
        println!("seed {seed}: {:.2}% of what the floor sends, {} rays", 100.0 * error, report.counts.rays);
        assert_eq!(report.stopped_by, StoppedBy::Error);
        bias += off / f64::from(seeds as u32);
    }
    println!("bias {:.2}%", 100.0 * bias);
    // A run is off by some 4%, nearly all of it noise, which averages out over points and seeds.
    assert!(bias.abs() < 0.01, "{bias}");
}

#[test]
fn a_point_under_one_polygon_has_its_form_factor() {
    for diluted in [false, true] {
        let scene = under_one_polygon(diluted).scene();
        let lamp = scene.surfaces()[1].polygon.clone();
        let options = SolveOptions { point_rays: Some(256), ..over_cells(0.5) };
        let (evaluator, _) = solve(scene, &options);
        let mut points = points_of(evaluator.solution().scene(), 4000, &mut Random(3));
        points.retain(|(_, surface)| *surface == 0);
        points.truncate(100);
        let places: Vec<_> = points.iter().map(|(point, _)| *point).collect();
        let exact: Vec<f64> = places.iter().map(|place| point_form_factor(place.position, place.normal, &lamp)).collect();
        if diluted {
            // A lamp, of which nothing is hidden: exact but for the rounding of values to f32.
            assert!(places.len() > 10);
            for (value, exact) in values(&evaluator, &places).iter().zip(&exact) {
                assert!((value - 0.5 * exact).abs() <= 1e-6, "{value} instead of {}", 0.5 * exact);
            }
        } else {
            // Most of the area emits: met by 256 paths, each with probability F. Evenly spread ones scatter less, so 4.5 sigma at 100 points
            // are passed with a probability of less than 1e-3.
            assert!(places.len() > 50);
            let mut sum = 0.0;
            for (value, exact) in values(&evaluator, &places).iter().zip(&exact) {
                let sigma = 0.5 * (exact * (1.0 - exact) / 256.0).sqrt();
                let off = (value - 0.5 * exact) / sigma;
                assert!(off.abs() <= 4.5, "{value} instead of {}: {off} sigma", 0.5 * exact);
                sum += off;
            }
            let mean = sum / (places.len() as f64).sqrt();
            println!("mean of {} points: {mean} sigma", places.len());
            assert!(mean.abs() <= 4.0, "{mean} sigma");
        }
    }
}

/// `||B - B_true|| / ||B_true - E||` over points of both squares.
fn error_of_two_squares(blocker: bool, seed: u64) -> (f64, SolveReport) {
    let exact = TwoSquares::new(blocker);
    let (evaluator, report) = solve(two_squares(blocker), &SolveOptions { seed, ..over_cells(0.02) });
    let mut points = points_of(evaluator.solution().scene(), 3000, &mut Random(5));
    points.retain(|(_, surface)| *surface < 2);
    let places: Vec<_> = points.iter().map(|(point, _)| *point).collect();
    let (mut error_sq, mut norm_sq) = (0.0, 0.0);
    for (value, (point, surface)) in values(&evaluator, &places).iter().zip(&points) {
        let truth = exact.at(*surface, [point.position[0], point.position[1]]);
        let exitance = if *surface == 0 { 1.0 } else { 0.0 };
        error_sq += (value - truth).powi(2);
        norm_sq += (truth - exitance).powi(2);
    }
    ((error_sq / norm_sq).sqrt(), report)
}

#[test]
fn two_squares_come_out_as_claimed() {
    for blocker in [false, true] {
        for seed in [0, 1] {
            let (error, report) = error_of_two_squares(blocker, seed);
            println!("blocker {blocker}, seed {seed}: error {error:.4}, claimed {:.4}", report.error.estimate);
            assert!(report.converged && error <= 0.02, "blocker {blocker}, seed {seed}: {error}, {report:?}");
        }
    }
}

#[test]
fn a_stored_solution_gives_the_same_values() {
    let (evaluator, _) = solve(two_squares(true), &over_cells(0.1));
    assert_eq!(evaluator.solution().solver(), Solver::Cells);
    let mut file = Cursor::new(Vec::new());
    write_solution(&mut file, evaluator.solution(), &Provenance::new(evaluator.solution().options())).unwrap();
    file.set_position(0);
    let stored = read_solution_from(file, Path::new("in memory")).unwrap();
    assert!(stored == *evaluator.solution());

    let points: Vec<_> = points_of(stored.scene(), 200, &mut Random(2)).into_iter().map(|(point, _)| point).collect();
    let again = Evaluator::new(stored, &RunOptions::default()).unwrap();
    assert_eq!(values(&evaluator, &points), values(&again, &points));
}

#[test]
fn inside_of_a_box_it_is_dark_however_bright_the_floor_around_it() {
    // A box with a cap of two sides on a floor: from below, the cap sees the backs of the sides and the floor in the box.
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.6], &[0.0]), room.material(&[0.0], &[10.0]));
    room.cuboid([0.0; 3], straight(4.0, 4.0, 2.5), true, |_, face| if face == 1 { lamp } else { grey });
    room.quad([1.5, 1.5, 0.0], [0.0, 0.0, 1.2], [0.0, 1.0, 0.0], grey);
    room.quad([2.5, 1.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.2], grey);
    room.quad([1.5, 1.5, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.2], grey);
    room.quad([1.5, 2.5, 0.0], [0.0, 0.0, 1.2], [1.0, 0.0, 0.0], grey);
    room.sheet(&[[1.5, 1.5, 1.2], [2.5, 1.5, 1.2], [2.5, 2.5, 1.2], [1.5, 2.5, 1.2]], grey);
    let (evaluator, _) = solve(room.scene(), &over_cells(0.02));

    let at = |position, normal| SurfacePoint { position, normal };
    let under = |k: usize| at([1.6 + 0.2 * (k % 5) as f64, 1.6 + 0.2 * (k / 5) as f64, 1.2], [0.0, 0.0, -1.0]);
    let dark = values(&evaluator, &(0..25).map(under).collect::<Vec<_>>());
    let floor = values(&evaluator, &[at([0.8, 0.8, 0.0], [0.0, 0.0, 1.0])])[0];
    let worst = dark.iter().copied().fold(0.0, f64::max);
    println!("{worst} under the cap, {floor} on the floor");
    // A hundredth of what the floor outside sends: of that, cells under the box must bring nothing.
    assert!(floor > 2.5 && worst < 0.01 * floor, "{worst} {floor}");
}

#[test]
fn a_white_room_absorbs_what_its_lamp_sends() {
    // The lamp shines down from a box close to a wall. A tenth of all light that arrives anywhere is absorbed.
    let room = || {
        let mut room = Room::default();
        let (white, lamp) = (room.material(&[0.9], &[0.0]), room.material(&[0.9], &[10.0]));
        room.cuboid([0.0; 3], straight(4.0, 4.0, 2.5), true, |_, _| white);
        room.cuboid([3.6, 1.5, 2.2], straight(0.35, 0.5, 0.1), false, |_, face| if face == 0 { lamp } else { white });
        room.scene()
    };
    let sent = 10.0 * 0.35 * 0.5;

    // All surfaces are rectangles: a random point in each cell of a fine grid over every one.
    let (cells, mut random) = (60, Random(12));
    let (mut points, mut areas, mut emitted) = (Vec::new(), Vec::new(), Vec::new());
    let scene = room();
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let exitance = scene.material_of(SurfaceId(index as u32)).exitance[0];
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        for cell in 0..cells * cells {
            let along = [cell % cells, cell / cells].map(|place| (f64::from(place) + random.unit()) / f64::from(cells));
            let on_edge = |axis: usize, to: usize, part: f64| part * (corners[to][axis] - corners[0][axis]);
            let position = [0, 1, 2].map(|axis| corners[0][axis] + on_edge(axis, 1, along[0]) + on_edge(axis, 3, along[1]));
            points.push(SurfacePoint { position, normal: surface.polygon.normal() });
            areas.push(surface.polygon.area() / f64::from(cells * cells));
            emitted.push(exitance);
        }
    }

    let absorbed = |options: &SolveOptions| {
        let (evaluator, report) = solve(room(), options);
        let reflected = values(&evaluator, &points).into_iter().zip(&emitted).map(|(value, emitted)| value - emitted);
        let absorbed: f64 = reflected.zip(&areas).map(|(reflected, area)| area * reflected * (0.1 / 0.9)).sum();
        let (solver, seed, claimed) = (evaluator.solution().solver(), options.seed, report.error.estimate);
        println!("{solver:?}, seed {seed}: {absorbed} W of {sent} W, claimed {claimed:?}");
        (absorbed, claimed)
    };
    let seeds = 4;
    let mut sum = 0.0;
    for seed in 0..seeds {
        let (absorbed_over_cells, _) = absorbed(&SolveOptions { seed, ..over_cells(0.02) });
        // 2% are claimed of values; of their sum, in which noise averages out, half of that is allowed, and of four runs a quarter.
        assert!((absorbed_over_cells / sent - 1.0).abs() < 0.01, "{absorbed_over_cells} of {sent}");
        sum += absorbed_over_cells;

        // Whatever solver is chosen, the sum is not off by more than values are.
        let (absorbed, claimed) = absorbed(&SolveOptions { error: 0.02, seed, ..SolveOptions::default() });
        assert!((absorbed / sent - 1.0).abs() < claimed, "{absorbed} of {sent}, claimed {claimed}");
    }
    let mean = sum / seeds as f64 / sent;
    assert!((mean - 1.0).abs() < 0.005, "{mean} of what is sent");
}

#[test]
fn noise_that_may_not_shrink_ends_a_run() {
    // With so few rays to a point no resolution of the rest reaches what is asked, so none is tried.
    let options = SolveOptions { point_rays: Some(16), ..over_cells(0.01) };
    let (_, report) = solve(two_squares(true), &options);
    println!("{} of {} asked, {} rays", report.error.measured, report.error.requested, report.counts.rays);
    assert_eq!(report.stopped_by, StoppedBy::Exhausted);
    assert!(!report.converged && report.error.measured > 0.01);
    assert!(report.counts.rays < 3_000_000, "{report:?}");
}

#[test]
fn values_by_the_irradiance_cache_are_as_good_as_others() {
    let (mut of_cached, mut of_alone) = (0.0, 0.0);
    for seed in 0..6 {
        let (evaluator, _) = solve(crowded(20, 1), &SolveOptions { seed, ..over_cells(0.1) });
        let points: Vec<_> =
            points_of(evaluator.solution().scene(), 40_000, &mut Random(9)).into_iter().map(|(point, _)| point).collect();
        let few = &points[..500];
        let (cached, alone) = (values(&evaluator, &points), values(&evaluator, few));
        let truth = values(&with_point_rays(&evaluator, 4096), few);

        // Few points use no cache, so a value does not depend on the others; many points do.
        assert_eq!(alone[..100 * 3], values(&evaluator, &few[..100]));
        let differ = (0..truth.len()).filter(|&index| cached[index] != alone[index]).count();
        assert!(differ > truth.len() / 3, "{differ} of {} values differ", truth.len());

        // Mean squares over all values.
        let error_sq = |found: &[f64]| {
            let sum_sq = found.iter().zip(&truth).map(|(found, truth)| (found - truth).powi(2)).sum::<f64>();
            sum_sq / truth.iter().map(|truth| truth * truth).sum::<f64>()
        };
        println!(
            "seed {seed}: error {:.4} alone, {:.4} among {} points",
            error_sq(&alone).sqrt(),
            error_sq(&cached).sqrt(),
            points.len()
        );
        of_cached += error_sq(&cached);
        of_alone += error_sq(&alone);
    }
    // No worse, but for the scatter of errors from 500 points of six seeds.
    assert!(of_cached.sqrt() <= 1.05 * of_alone.sqrt(), "{} instead of {}", of_cached.sqrt(), of_alone.sqrt());
}

/// Values over links where a box stands on the floor: a point there sees little but the leaf at its foot, which may be lit on one side of
/// the box and dark on the other. With the radiosities of such leaves the error would be 12%.
#[test]
fn over_links_the_feet_of_boxes_are_nearly_as_well_known_as_all_else() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
    let scene = || read_scene(&file, &ImportOptions::default()).unwrap().scene;
    let mut feet = Vec::new();
    for surface in &scene().surfaces()[12..] {
        let bottom: Vec<[f64; 3]> = surface.polygon.vertices().filter(|vertex| vertex[1] == 0.0).collect();
        if bottom.len() == 2 {
            for step in 0..24 {
                let (along, height) = ((f64::from(step) + 0.5) / 24.0, [0.0005, 0.002, 0.008][step as usize % 3]);
                let [x, z] = [0, 2].map(|axis| bottom[0][axis] + along * (bottom[1][axis] - bottom[0][axis]));
                feet.push(SurfacePoint { position: [x, height, z], normal: surface.polygon.normal() });
            }
        }
    }

    let reference = values(&with_point_rays(&solve(scene(), &over_cells(0.02)).0, 1 << 14), &feet);
    let norm_sq: f64 = reference.iter().map(|value| value * value).sum();
    let mut mean_sq = 0.0;
    for seed in 0..4 {
        let options = SolveOptions { error: 0.02, seed, solver: Solver::Links, ..SolveOptions::default() };
        let found = values(&solve(scene(), &options).0, &feet);
        let error_sq: f64 = found.iter().zip(&reference).map(|(found, value)| (found - value).powi(2)).sum();
        println!("{} points, seed {seed}: {:.4}", feet.len(), (error_sq / norm_sq).sqrt());
        mean_sq += 0.25 * error_sq / norm_sq;
    }
    assert!(mean_sq.sqrt() < 0.08, "{}", mean_sq.sqrt());
}
