//! What pairs without a link hold back is never more than what is reported: held against runs in which no pair sleeps.
//!
//! Scenes by others lie beside the repository, in ../shared/scenes: `cargo test --test held_back -- --ignored`.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::HashSet;
use std::path::Path;

use kirchhoff::kirchhoff;
use patchlight::form_factor::estimate_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::links::Pair;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Holzschuch94Options, LinkOptions, Solution, SolveOptions, Solver, Strategy};
use patchlight::visibility::{Backend, OccluderMesh, Segment, build};
use rooms::{crowded, point_of, solve};
use triangles::Random;

fn read(file: &str) -> Scene {
    read_scene(&Path::new(env!("CARGO_MANIFEST_DIR")).join(file), &ImportOptions::default()).unwrap().scene
}

fn shared(name: &str) -> Scene {
    read(&format!("../shared/scenes/{name}/scene.obj"))
}

/// Links and sweeps alone: leaves are left as the links make them, points take one ray.
fn by_links(strategy: Strategy, tolerance: f64) -> SolveOptions {
    SolveOptions {
        strategy,
        solver: Solver::Links,
        point_rays: Some(1),
        error: 0.9,
        links: LinkOptions {
            tolerance: Some(tolerance),
            min_element: 1e-4,
            leaf_rays: Some(0),
            sweep_tolerance: 1e-6,
            ..LinkOptions::default()
        },
        holzschuch94: Holzschuch94Options { iterations: 20, ambient: false, ..Holzschuch94Options::default() },
        ..SolveOptions::default()
    }
}

/// `sum of A |B - B'|` over surfaces, in W, all channels added.
fn difference(a: &Solution, b: &Solution) -> f64 {
    let of_surface = |surface: u32| {
        let of = |solution: &Solution| {
            let node = solution.hierarchy().node_of(SurfaceId(surface));
            (solution.hierarchy().area(node), solution.radiosity().of(node).to_vec())
        };
        let ((area, a), (_, b)) = (of(a), of(b));
        area * a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>()
    };
    (0..a.scene().surfaces().len() as u32).map(of_surface).sum()
}

/// Lazy linking against linking all pairs.
fn check_lazily(name: &str, scene: &Scene, tolerance: f64, link_tolerance: f64) {
    let mut lazy = by_links(Strategy::Lazy94, tolerance);
    lazy.holzschuch94.link_tolerance = link_tolerance;
    let all = SolveOptions { strategy: Strategy::Original94, ..lazy.clone() };
    let ((lazy, lazy_report), (all, all_report)) = (solve(scene.clone(), &lazy), solve(scene.clone(), &all));
    let (lazy, all) = (lazy.solution(), all.solution());
    let (missing, held_back) = (difference(lazy, all), lazy_report.energy.held_back);
    println!(
        "{name}, eps_link {link_tolerance}: {} pairs sleep, {} links of {}: {missing:.4} W of {:.3} W missing, at most {held_back:.4}",
        lazy.links().dormant().len(),
        lazy.links().len(),
        all.links().len(),
        all_report.energy.sent - all_report.energy.emitted
    );
    assert!(!lazy.links().dormant().is_empty() && all.links().dormant().is_empty());
    assert_eq!(all_report.energy.held_back, 0.0);
    assert!(missing <= held_back, "{name}: {missing} W are missing, at most {held_back} W should");
}

/// Rays for the visibility of two leaves.
const RAYS: usize = 8;

/// `A F` between all leaves in m^2, row by row, visibility included.
fn exchange_of(scene: &Scene, hierarchy: &Hierarchy, leaves: &[NodeId]) -> Vec<f64> {
    let visibility = build(Backend::Obvhs, &OccluderMesh::of_scene(scene)).unwrap();
    let polygons: Vec<Polygon> = leaves.iter().map(|&leaf| Polygon::new(&hierarchy.polygon(leaf)).unwrap()).collect();
    let plane = |leaf: NodeId| scene.surface(hierarchy.surface_of(leaf).unwrap()).plane();
    let mut random = Random(11);
    let count = leaves.len();
    let mut exchange = vec![0.0; count * count];
    for r in 0..count {
        for s in 0..r {
            let unoccluded = estimate_area_form_factor(&polygons[r], &polygons[s], 0.02).value;
            if unoccluded == 0.0 || plane(leaves[r]) == plane(leaves[s]) {
                continue;
            }
            let mut point = |leaf: usize| point_of(&polygons[leaf], &mut random).position;
            let (from_plane, to_plane) = (plane(leaves[r]), plane(leaves[s]));
            let segments = [(); RAYS].map(|()| Segment { from: point(r), to: point(s), from_plane, to_plane });
            let mut occluded = [false; RAYS];
            visibility.occluded(&segments, &mut occluded);
            let seen = occluded.iter().filter(|occluded| !**occluded).count() as f64 / RAYS as f64;
            (exchange[r * count + s], exchange[s * count + r]) = (seen * unoccluded, seen * unoccluded);
        }
    }
    exchange
}

/// A run that a limit leaves with sleeping clusters, against what these would carry: leaf by leaf, by exact form factors and rays of the test's
/// own, reflected until nothing is left.
fn check_limited(name: &str, scene: &Scene, max_links: u64) {
    let options = SolveOptions { max_links: Some(max_links), error: 1e-3, ..by_links(Strategy::Default, 1.0) };
    let (evaluator, report) = solve(scene.clone(), &options);
    let solution = evaluator.solution();
    let hierarchy = solution.hierarchy();
    let of_clusters = |pair: &&Pair| hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source);
    let asleep = solution.links().dormant().iter().filter(of_clusters).count();

    // Which pairs of leaves sleep?
    let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let above = |leaf: NodeId| std::iter::successors(Some(leaf), |&node| hierarchy.parent(node));
    let dormant: HashSet<(NodeId, NodeId)> = solution.links().dormant().iter().map(|pair| (pair.receiver, pair.source)).collect();
    let sleeps = |receiver, source| above(receiver).any(|r| above(source).any(|s| dormant.contains(&(r, s))));
    let asleep_by_leaf: Vec<bool> = leaves.iter().flat_map(|&r| leaves.iter().map(move |&s| sleeps(r, s))).collect();

    // What arrives over sleeping pairs, and what becomes of it.
    let (exchange, count) = (exchange_of(scene, hierarchy, &leaves), leaves.len());
    let area = |leaf: usize| hierarchy.area(leaves[leaf]);
    let mut missing = 0.0;
    for channel in 0..scene.channels() {
        let rho = |leaf: usize| scene.material_of(hierarchy.surface_of(leaves[leaf]).unwrap()).reflectance[channel];
        let gather = |b: &[f64], counts: &dyn Fn(usize, usize) -> bool| -> Vec<f64> {
            let of = |r: usize| (0..count).filter(|&s| counts(r, s)).map(|s| exchange[r * count + s] * b[s]).sum::<f64>();
            (0..count).map(|r| rho(r) * of(r) / area(r)).collect()
        };
        let found: Vec<f64> = leaves.iter().map(|&leaf| solution.radiosity().of(leaf)[channel]).collect();
        let mut bounce = gather(&found, &|r, s| asleep_by_leaf[r * count + s]);
        for _ in 0..40 {
            missing += (0..count).map(|leaf| area(leaf) * bounce[leaf]).sum::<f64>();
            bounce = gather(&bounce, &|_, _| true);
        }
    }
    let (energy, reflected) = (report.energy, report.energy.sent - report.energy.emitted);
    println!(
        "{name}: {} links, {asleep} sleeping pairs of clusters: {missing:.4} W missing beside {reflected:.3} W, at most {:.4}",
        solution.links().len(),
        energy.held_back
    );
    assert!(asleep > 0 && missing > 0.0, "{name}: no cluster sleeps");
    assert!(missing <= energy.held_back, "{name}: {missing} W are missing, at most {} W should", energy.held_back);
    assert_eq!(report.error.skipped, energy.held_back / reflected);
}

#[test]
fn furnaces() {
    for seed in 0..3 {
        for link_tolerance in [0.05, 0.2] {
            check_lazily(&format!("furnace {seed}"), &kirchhoff(seed, 3).scene, 0.3, link_tolerance);
        }
    }
}

#[test]
fn rooms_of_our_own() {
    for link_tolerance in [0.05, 0.2, 1.0] {
        check_lazily("cornell", &read("scenes/cornell.obj"), 0.3, link_tolerance);
        check_lazily("12 boxes", &crowded(12, 1), 1.0, link_tolerance);
    }
    check_lazily("full office", &read("scenes/full_office.obj"), 2.0, 0.2);
}

#[test]
fn clusters_that_sleep() {
    for (boxes, seed, max_links) in [(12, 1, 60), (12, 2, 40), (30, 3, 100), (30, 4, 40)] {
        check_limited(&format!("{boxes} boxes"), &crowded(boxes, seed), max_links);
    }
}

#[test]
#[ignore = "needs ../shared/scenes: scenes by others"]
fn scenes_by_others() {
    for name in ["cornell_mcguire", "cornell_tinyobj"] {
        check_lazily(name, &shared(name), 2.0, 0.2);
    }
    check_limited("office2", &shared("office2"), 300);
}
