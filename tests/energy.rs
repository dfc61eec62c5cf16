//! In a closed scene all power that is sent arrives: what a gather over the links loses or makes is at most what the run claims as its error.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::path::Path;

use kirchhoff::kirchhoff;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{LinkOptions, SolveOptions, Solver, Strategy, Sweep};
use rooms::{crowded, cube, solve, two_squares};

fn read(name: &str) -> Scene {
    read_scene(&Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj")), &ImportOptions::default()).unwrap().scene
}

/// Solves, and holds what is lost against the claim.
fn check(name: &str, scene: Scene, options: &SolveOptions) {
    let (_, report) = solve(scene, options);
    let (energy, claimed) = (report.energy, report.error.estimate);
    println!(
        "{name}, {:?}, {:?}, to {}: {:?} of the power lost, {claimed:.4} claimed, {:?}",
        options.strategy, options.solver, options.error, energy.imbalance, energy
    );
    let lost = energy.imbalance.expect("a closed scene");
    assert!(lost.abs() <= claimed, "{name}: {lost} of the power is lost, {claimed} is claimed");
}

fn to(error: f64) -> SolveOptions {
    SolveOptions { error, ..SolveOptions::default() }
}

#[test]
fn furnaces_lose_nothing() {
    for rho in [0.5, 0.9, 0.99] {
        for sweep in [Sweep::Jacobi, Sweep::InPlace] {
            let mut exact = SolveOptions { strategy: Strategy::Uniform, ..to(0.1) };
            exact.links.form_factor_accuracy = 0.0;
            exact.links.leaf_rays = Some(0);
            exact.links.sweep = sweep;
            let exact = SolveOptions { links: LinkOptions { sweep_tolerance: 1e-12, ..exact.links }, ..exact };
            let (_, report) = solve(cube(&[rho], &[1.0]), &exact);
            let energy = report.energy;
            // Sweeps leave 1e-12 / (1 - rho); exact form factors are good to 1e-10, and reflected again and again.
            assert!(
                energy.imbalance.unwrap().abs() <= 1e-9 && (energy.absorbed / energy.emitted - 1.0).abs() <= 1e-9,
                "{energy:?}"
            );
        }
    }
    for seed in 0..6 {
        for error in [0.1, 0.02] {
            let over_links = SolveOptions { solver: Solver::Links, ..to(error) };
            check(&format!("furnace {seed}"), kirchhoff(seed, 3).scene, &over_links);
        }
    }
}

#[test]
fn rooms_lose_no_more_than_they_claim() {
    for seed in 0..3 {
        check(&format!("crowded {seed}"), crowded(30, seed), &to(0.1));
        check(&format!("crowded {seed}"), crowded(30, seed), &SolveOptions { solver: Solver::Links, ..to(0.1) });
    }
    for strategy in [Strategy::Default, Strategy::Hanrahan91] {
        check("full office", read("full_office"), &SolveOptions { strategy, solver: Solver::Links, ..to(0.1) });
    }
    check("room", read("room"), &to(0.1));
    check("room", read("room"), &SolveOptions { solver: Solver::Links, ..to(0.2) });
}

/// What is emitted is absorbed, escapes, or is told as not accounted for; from closed rooms nothing escapes.
#[test]
fn energies_add_up() {
    let scenes = [("cube", cube(&[0.9], &[1.0]), true), ("crowded", crowded(20, 1), true), ("open", two_squares(true), false)];
    for (name, scene, is_closed) in scenes {
        for solver in [Solver::Links, Solver::Cells] {
            let (_, report) = solve(scene.clone(), &SolveOptions { solver, ..to(0.1) });
            let energy = report.energy;
            let sum = energy.absorbed + energy.escaped + energy.unaccounted;
            assert!((sum / energy.emitted - 1.0).abs() < 1e-12, "{name}, {solver:?}: {energy:?}");
            assert_eq!(energy.escaped == 0.0, is_closed, "{name}, {solver:?}: {energy:?}");
            // Links of the coarse pass are estimates.
            assert!(energy.unaccounted.abs() < 0.15 * energy.emitted, "{name}, {solver:?}: {energy:?}");
        }
    }
}

#[test]
fn an_open_scene_has_no_balance() {
    let (_, report) = solve(two_squares(true), &to(0.1));
    assert_eq!(report.energy.imbalance, None);
    assert!(report.energy.escaped > 0.0);
}
