//! Stored transport: one solve, whose materials are changed afterwards. Held against what is known exactly, and against solves of the changed scenes.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::io::Cursor;
use std::path::Path;

use patchlight::output::{Provenance, read_solution_from, write_solution};
use patchlight::pipeline::{Evaluator, PipelineError, solve};
use patchlight::progress::{Observer, Progress, Silent};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{LightGrouping, Material, Scene, SceneError, SurfacePoint};
use patchlight::solve::{
    Bounds, ErrorReport, Norm, OtherMaterialsError, RunOptions, Solution, SolveOptions, SolveReport, Solver, Strategy,
};
use rooms::{Room, cube, points_of, straight};
use triangles::Random;

/// A room with a block in it, and a black foot below that.
fn room() -> Scene {
    let (mut room, block) = Room::with_lamps();
    let foot = room.named_material("foot", &[0.0; 3], &[0.0; 3]);
    room.cuboid([1.2, 0.3, 1.0], straight(0.8, 1.1, 0.9), false, |_, _| block);
    room.cuboid([1.4, 0.0, 1.2], straight(0.4, 0.3, 0.4), false, |_, _| foot);
    room.scene()
}

fn options(error: f64) -> SolveOptions {
    SolveOptions { keep_transport: true, error, ..SolveOptions::default() }
}

fn solved(scene: Scene, options: &SolveOptions, threads: usize) -> (Evaluator, SolveReport) {
    solve(scene, options, &RunOptions { threads, ..RunOptions::default() }, &Silent).unwrap()
}

/// The materials of a scene, of which some are changed.
fn changed(scene: &Scene, change: impl Fn(&mut Material)) -> Vec<Material> {
    let mut materials = scene.materials().to_vec();
    materials.iter_mut().for_each(change);
    materials
}

fn again(solution: &Solution, materials: Vec<Material>) -> (Solution, ErrorReport) {
    solution.with_materials(materials, &Silent).unwrap().unwrap()
}

/// Random points, uniform by area.
fn points(scene: &Scene, count: usize) -> Vec<SurfacePoint> {
    points_of(scene, count, &mut Random(11)).into_iter().map(|(point, _)| point).collect()
}

fn values(solution: Solution, points: &[SurfacePoint]) -> Vec<f32> {
    Evaluator::new(solution, &RunOptions::default()).unwrap().values_at(points, &Silent).unwrap().radiosity
}

/// By energy, how far values are off others at points where `exitance` is sent, by point and channel.
fn off(found: &[f32], truth: &[f32], exitance: &[f64]) -> f64 {
    let (mut off_sq, mut light_sq) = (0.0, 0.0);
    for ((&found, &truth), e) in found.iter().zip(truth).zip(exitance) {
        off_sq += f64::from(found - truth).powi(2);
        light_sq += (f64::from(truth) - e).powi(2);
    }
    (off_sq / light_sq).sqrt()
}

fn exitance_at(scene: &Scene, count: usize) -> Vec<f64> {
    let places = points_of(scene, count, &mut Random(11));
    places
        .into_iter()
        .flat_map(|(_, surface)| scene.materials()[scene.surfaces()[surface].material as usize].exitance.clone())
        .collect()
}

#[test]
fn a_furnace_is_what_its_reflectance_says() {
    let (evaluator, report) = solved(cube(&[0.5], &[1.0]), &options(0.05), 0);
    let (solution, points) = (evaluator.solution(), points(evaluator.solution().scene(), 200));
    assert!(report.transport.is_some_and(|transport| transport.bytes > 0 && transport.terms > transport.cells));
    for (rho, exitance) in [(0.5, 1.0), (0.9, 1.0), (0.2, 3.0), (0.5, 0.0), (0.0, 2.0)] {
        let materials = changed(solution.scene(), |material| {
            (material.reflectance, material.exitance) = (vec![rho], vec![exitance]);
        });
        let (found, error) = again(solution, materials);
        let expected = exitance / (1.0 - rho);
        assert_eq!(found.validate(), Ok(()));
        for value in values(found.clone(), &points) {
            // Sweeps leave 1e-5 of the light; values and cells are f32.
            assert!((f64::from(value) - expected).abs() <= 3e-5 * expected, "{value} for {expected}");
        }
        println!("rho {rho}, E {exitance}: claimed {:e}, measured {:e}", error.estimate, error.measured);
        assert!(error.estimate < 1e-3, "{error:?}");
    }
}

#[test]
fn other_materials_are_within_their_claim_of_solves_from_scratch() {
    let (evaluator, _) = solved(room(), &SolveOptions { norm: Norm::Energy, ..options(0.05) }, 0);
    let solution = evaluator.solution();
    let points = points(solution.scene(), 600);
    let change = |wall: f64, block: [f64; 3], lamp: f64, glow: f64| {
        changed(solution.scene(), move |material| match material.name.as_str() {
            "wall" => material.reflectance.iter_mut().for_each(|rho| *rho *= wall),
            "block" => (material.reflectance, material.exitance) = (block.to_vec(), vec![glow, 0.0, 0.0]),
            "lamp" => material.exitance.iter_mut().for_each(|e| *e *= lamp),
            _ => {}
        })
    };
    for (name, materials) in [
        ("as it was", change(1.0, [0.3, 0.4, 0.5], 1.0, 0.0)),
        ("dark walls, red block", change(0.3, [0.9, 0.1, 0.1], 1.0, 0.0)),
        ("lamps off", change(1.2, [0.3, 0.4, 0.5], 0.0, 0.0)),
        ("the block glows", change(1.0, [0.3, 0.4, 0.5], 0.1, 4.0)),
    ] {
        let (found, error) = again(solution, materials.clone());
        let exact = SolveOptions { error: 0.005, norm: Norm::Energy, ..SolveOptions::default() };
        let (truth, of_truth) = solved(solution.scene().with_materials(materials).unwrap(), &exact, 0);
        let exitance = exitance_at(truth.solution().scene(), points.len());
        let truth = truth.values_at(&points, &Silent).unwrap().radiosity;
        let off = off(&values(found.clone(), &points), &truth, &exitance);
        println!(
            "{name}: off by {off:.4}, claimed {:.4}, measured {:.4}; the truth claims {:.4}",
            error.estimate, error.measured, of_truth.error.estimate
        );
        // What the truth is off, and the scatter of 600 points.
        assert!(off <= error.estimate + of_truth.error.estimate + 0.1 * error.estimate, "{name}");
        assert!(error.estimate < 0.3, "{name}: {error:?}");
        assert_eq!(found.validate(), Ok(()));

        // Elements, over the links.
        assert!(found.radiosity().values().iter().all(|b| b.is_finite()));
    }
}

#[test]
fn paint_much_brighter_than_what_was_solved_is_claimed_truly() {
    // Paths went on by the reflectances that were solved: with larger ones their weights sum to more than 1 in some rows.
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room.obj");
    let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
    let (evaluator, _) = solved(scene, &options(0.03), 0);
    let solution = evaluator.solution();
    let materials = changed(solution.scene(), |material| match material.name.as_str() {
        "wall" | "floor" | "ceiling" | "sofa" | "rug" => material.reflectance.fill(0.84),
        _ => {}
    });
    let (found, error) = again(solution, materials.clone());
    let exact = SolveOptions { error: 0.01, norm: Norm::Energy, ..SolveOptions::default() };
    let (truth, of_truth) = solved(solution.scene().with_materials(materials).unwrap(), &exact, 0);
    let (points, exitance) = (points(solution.scene(), 600), exitance_at(solution.scene(), 600));
    let off = off(&values(found, &points), &truth.values_at(&points, &Silent).unwrap().radiosity, &exitance);
    println!("off by {off:.4}, claimed {:.4} by energy; the truth claims {:.4}", error.energy.estimate, of_truth.error.estimate);
    // What the truth is off, and the scatter of 600 points.
    assert!(off <= 1.1 * error.energy.estimate + of_truth.error.estimate, "{error:?}");
    assert!((0.01..0.2).contains(&error.estimate), "{error:?}");
}

#[test]
fn it_is_the_same_for_any_number_of_threads_and_after_storing() {
    let materials =
        |solution: &Solution| changed(solution.scene(), |material| material.reflectance.iter_mut().for_each(|rho| *rho *= 0.8));
    let stored = |solution: &Solution| {
        let mut file = Cursor::new(Vec::new());
        write_solution(&mut file, solution, &Provenance::new(solution.options())).unwrap();
        file.into_inner()
    };
    let mut first: Option<(Vec<u8>, Vec<u8>)> = None;
    for threads in [1, 3] {
        let (evaluator, _) = solved(room(), &options(0.1), threads);
        let workers = patchlight::pipeline::Workers::new(threads).unwrap();
        let (solution, name) = (evaluator.solution(), Path::new("in memory"));
        let (found, error) =
            patchlight::pipeline::with_materials_on(&workers, solution, materials(solution), &Silent).unwrap().unwrap();
        let bytes = (stored(solution), stored(&found));
        assert!(first.get_or_insert_with(|| bytes.clone()) == &bytes, "{threads} threads");

        // What is read back can be solved again, as can what was solved again: numbers are those that are given, not factors.
        let read = read_solution_from(&bytes.0[..], name).unwrap();
        assert!(again(&read, materials(&read)) == (found.clone(), error));
        let back = again(&read_solution_from(&bytes.1[..], name).unwrap(), solution.scene().materials().to_vec()).0;
        let (points, unchanged) = (points(solution.scene(), 100), again(solution, solution.scene().materials().to_vec()).0);
        // Sweeps begin elsewhere, and end within their tolerance.
        for (value, expected) in values(back, &points).iter().zip(values(unchanged, &points)) {
            assert!((value - expected).abs() <= 1e-4 * expected.max(0.1), "{value} for {expected}");
        }
    }
}

#[test]
fn without_a_change_it_is_the_solution_but_for_rounding() {
    let (evaluator, report) = solved(room(), &options(0.1), 0);
    let points = points(evaluator.solution().scene(), 200);
    let (found, error) = again(evaluator.solution(), evaluator.solution().scene().materials().to_vec());
    for (value, expected) in values(found, &points).iter().zip(evaluator.values_at(&points, &Silent).unwrap().radiosity) {
        assert!((value - expected).abs() <= 1e-4 * expected.max(0.1), "{value} for {expected}");
    }
    println!("claimed {} and {}", error.estimate, report.error.estimate);
    assert!((error.estimate / report.error.estimate - 1.0).abs() < 0.25, "{error:?} for {:?}", report.error);
}

#[test]
fn what_cannot_be_solved_again_is_told() {
    let (evaluator, _) = solved(room(), &options(0.2), 0);
    let solution = evaluator.solution();
    let wrong = |change: &dyn Fn(&mut Material)| solution.with_materials(changed(solution.scene(), change), &Silent).unwrap_err();
    let of = |name: &'static str, rho: f64, e: f64| {
        move |material: &mut Material| {
            if material.name == name {
                (material.reflectance, material.exitance) = (vec![rho; 3], vec![e; 3]);
            }
        }
    };
    assert_eq!(wrong(&of("foot", 0.5, 0.0)), OtherMaterialsError::NotFollowed("foot".to_owned()));
    assert_eq!(wrong(&of("foot", 0.0, 1.0)), OtherMaterialsError::NotFollowed("foot".to_owned()));
    assert_eq!(wrong(&of("tube", 0.5, 1.0)), OtherMaterialsError::NotFollowed("tube".to_owned()));
    assert!(matches!(wrong(&of("wall", 1.5, 0.0)), OtherMaterialsError::Materials(SceneError::BadMaterial { .. })));
    let few = solution.with_materials(Vec::new(), &Silent).unwrap_err();
    assert_eq!(few, OtherMaterialsError::Materials(SceneError::Materials { given: 0, needed: 5 }));

    // A lamp may reflect nothing and shine otherwise; what is cancelled leaves nothing.
    struct Cancels;
    impl Observer for Cancels {
        fn progress(&self, _: &Progress) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let materials = changed(solution.scene(), of("tube", 0.0, 7.0));
    assert!(solution.with_materials(materials.clone(), &Silent).unwrap().is_some());
    assert!(solution.with_materials(materials, &Cancels).unwrap().is_none());

    // Without transport, and where there can be none.
    let plain = SolveOptions { keep_transport: false, ..options(0.2) };
    let (evaluator, report) = solved(room(), &plain, 0);
    let materials = evaluator.solution().scene().materials().to_vec();
    assert_eq!(evaluator.solution().with_materials(materials, &Silent).unwrap_err(), OtherMaterialsError::NoTransport);
    assert!(report.transport.is_none());
    for options in [
        SolveOptions { solver: Solver::Links, ..options(0.2) },
        SolveOptions { strategy: Strategy::Uniform, ..options(0.2) },
        SolveOptions { lit_mesh: true, ..options(0.2) },
        SolveOptions { bounds: Bounds::Guaranteed, ..options(0.2) },
    ] {
        let error = options.validate().unwrap_err().to_string();
        assert!(error.contains("keep_transport"), "{error}");
    }
    let grouped = room().with_light_groups(&LightGrouping::Materials).unwrap();
    let refused = solve(grouped, &options(0.2), &RunOptions::default(), &Silent);
    assert!(matches!(refused, Err(PipelineError::LightGroups(_))));
}
