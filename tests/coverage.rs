//! Every ordered pair of leaves is covered exactly once: by a link, by a dormant pair, or by a proof that no light passes.
//!
//! The test gives every pair of nodes unit weight and adds up what each pair of leaves gets, without looking at any form factor
//! (the idea of exafmm-t's list test). What gets nothing must be proved dark: the receiver reflects nothing, both lie in one plane, or the
//! exact form factor of the two leaves is 0.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/least_memory.rs"]
mod least_memory;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::path::Path;

use patchlight::form_factor::exact_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{
    LinkOptions, RunOptions, Solution, SolveOptions, SolveReport, Solver, StoppedBy, Strategy, Subdivision, UniformOptions,
};
use rooms::{Room, channels, crowded, straight, turned};
use triangles::{Random, add, cross, dot, sub, times};

/// How the ordered pairs of leaves are covered.
#[derive(Debug, Default)]
struct Coverage {
    leaves: usize,
    linked: usize,
    dormant: usize,
    black: usize,
    coplanar: usize,
    behind: usize,
}

/// Counts how often each pair is covered, and proves those that are not.
fn coverage(solution: &Solution) -> Coverage {
    let hierarchy = solution.hierarchy();
    let scene = solution.scene();

    // Number the leaves so that those below a node are a range.
    let mut leaves = Vec::new();
    let mut range = vec![0..0; hierarchy.len()];
    number_leaves(solution, NodeId::ROOT, &mut leaves, &mut range);
    let polygons: Vec<Polygon> = leaves.iter().map(|&leaf| Polygon::new(&hierarchy.polygon(leaf)).unwrap()).collect();
    let mut dormant_of = vec![Vec::new(); hierarchy.len()];
    for pair in solution.links().dormant() {
        dormant_of[pair.receiver.index()].push(pair.source);
    }

    let mut found = Coverage { leaves: leaves.len(), ..Coverage::default() };
    for (index, &receiver) in leaves.iter().enumerate() {
        // Everything that is linked to the leaf or to a node above it, and everything that sleeps there.
        let (mut linked, mut dormant) = (vec![0u32; leaves.len()], vec![0u32; leaves.len()]);
        let mut above = Some(receiver);
        while let Some(node) = above {
            for link in solution.links().of(node) {
                linked[range[link.source.index()].clone()].iter_mut().for_each(|count| *count += 1);
            }
            for source in &dormant_of[node.index()] {
                dormant[range[source.index()].clone()].iter_mut().for_each(|count| *count += 1);
            }
            above = hierarchy.parent(node);
        }

        let surface = |leaf: NodeId| hierarchy.surface_of(leaf).unwrap();
        let reflects = scene.material_of(surface(receiver)).reflectance.iter().any(|&rho| rho > 0.0);
        let plane = |surface: SurfaceId| scene.surface(surface).plane();
        for (other, &source) in leaves.iter().enumerate() {
            match (linked[other], dormant[other]) {
                (1, 0) => found.linked += 1,
                (0, 1) => found.dormant += 1,
                (0, 0) if !reflects => found.black += 1,
                (0, 0) if plane(surface(receiver)) == plane(surface(source)) => found.coplanar += 1,
                (0, 0) => {
                    let [a, b] = [&polygons[index], &polygons[other]];
                    let exchange = exact_area_form_factor(a, b);
                    let is_proved = exchange == 0.0 || is_behind(a, b) || is_behind(b, a);
                    assert!(is_proved, "receiver {receiver:?} gets nothing from {source:?} of {exchange:e}");
                    found.behind += 1;
                }
                (links, dormant) => panic!("receiver {receiver:?}, source {source:?}: {links} links, {dormant} dormant pairs"),
            }
        }
    }
    found
}

/// Whether all of a polygon is behind another but for rounding: elements that are cut where surfaces cross end in each other's planes.
fn is_behind(front: &Polygon, polygon: &Polygon) -> bool {
    let size = |polygon: &Polygon| {
        let from_centre = |vertex| sub(vertex, polygon.centroid());
        polygon.vertices().map(|vertex| dot(from_centre(vertex), from_centre(vertex)).sqrt()).fold(0.0, f64::max)
    };
    let room = 2e-12 * (size(front) + size(polygon));
    polygon.vertices().all(|vertex| dot(front.normal(), sub(vertex, front.centroid())) <= room)
}

fn number_leaves(solution: &Solution, node: NodeId, leaves: &mut Vec<NodeId>, range: &mut [std::ops::Range<usize>]) {
    let hierarchy = solution.hierarchy();
    let first = leaves.len();
    if hierarchy.is_leaf(node) {
        leaves.push(node);
    }
    hierarchy.children(node).for_each(|child| number_leaves(solution, child, leaves, range));
    range[node.index()] = first..leaves.len();
}

fn solve(scene: Scene, options: &SolveOptions, run: &RunOptions) -> (Solution, SolveReport) {
    let (evaluator, report) = pipeline::solve(scene, options, run, &Silent).unwrap();
    (evaluator.solution().clone(), report)
}

/// Options that refine to `tolerance` once, with little effort on everything that does not matter here.
fn quick(strategy: Strategy, tolerance: f64) -> SolveOptions {
    SolveOptions {
        strategy,
        point_rays: Some(1),
        error: 0.5,
        links: LinkOptions { tolerance: Some(tolerance), min_element: 1e-3, leaf_rays: Some(0), ..LinkOptions::default() },
        ..SolveOptions::default()
    }
}

/// A closed room with boxes in it, two lamps, one black box.
fn furnished(seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut room = Room::default();
    let wall = room.material(&channels(&mut random, 3, 0.2, 0.8), &[0.0; 3]);
    let lamp = room.material(&[0.0; 3], &channels(&mut random, 3, 5.0, 20.0));
    let black = room.material(&[0.0; 3], &[0.0; 3]);
    room.cuboid([0.0; 3], straight(3.0, 3.0, 2.5), true, |_, _| wall);
    for k in 0..4 {
        let corner = [0.4 + 1.3 * f64::from(k % 2), 0.5 + 1.3 * f64::from(k / 2), [0.0, 0.7][k as usize % 2]];
        let grey = room.material(&channels(&mut random, 3, 0.1, 0.9), &[0.0; 3]);
        let material = if k == 3 { black } else { grey };
        let sides = turned(random.between(0.2, 0.7), random.between(0.2, 0.7), random.between(0.2, 1.2), random.between(0.0, 0.5));
        room.cuboid(corner, sides, false, |_, _| material);
    }
    room.quad([1.0, 1.0, 2.49], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0], lamp);
    room.face(&[[0.01, 1.0, 1.0], [0.01, 1.5, 1.0], [0.01, 1.2, 1.5]], lamp);
    room.scene()
}

/// Regular polygons of 3 to 8 corners anywhere, through each other too: nothing closed, nothing tidy.
fn soup(seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut room = Room::default();
    let materials = [
        room.material(&[0.5], &[0.0]),
        room.material(&[0.8], &[1.0]),
        room.material(&[0.0], &[3.0]),
        room.material(&[0.0], &[0.0]),
    ];
    for _ in 0..24 {
        let corners = 3 + random.below(6);
        let (centre, normal, radius) = (random.point(1.0), random.direction(), random.between(0.1, 0.8));
        let across = triangles::unit(cross(normal, random.direction()));
        let up = cross(normal, across);
        let vertices: Vec<[f64; 3]> = (0..corners)
            .map(|k| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
                add(centre, add(times(across, radius * cos), times(up, radius * sin)))
            })
            .collect();
        room.face(&vertices, materials[random.below(4)]);
    }
    room.scene()
}

fn cornell() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
    read_scene(&file, &ImportOptions::default()).unwrap().scene
}

/// Every pair is covered, and as many of each kind as there should be at least.
fn check(name: &str, scene: &Scene, options: &SolveOptions) -> Coverage {
    let (solution, report) = solve(scene.clone(), options, &RunOptions::default());
    let found = coverage(&solution);
    println!("{name}, {:?}, tolerance {:?}: {found:?}, {} links", options.strategy, options.links.tolerance, report.counts.links);
    assert_eq!(found.linked + found.dormant + found.black + found.coplanar + found.behind, found.leaves * found.leaves);
    found
}

#[test]
fn each_pair_once_whatever_the_strategy_and_the_tolerance() {
    let scenes = [
        ("cornell", cornell()),
        ("furnished 1", furnished(1)),
        ("furnished 2", furnished(2)),
        ("soup 1", soup(1)),
        ("soup 2", soup(2)),
    ];
    for (name, scene) in &scenes {
        for strategy in [Strategy::Default, Strategy::Hanrahan91, Strategy::ErrorDriven] {
            let mut before = 0;
            let tolerances: &[f64] = if strategy == Strategy::ErrorDriven { &[1.0] } else { &[1.0, 0.1, 0.03] };
            for &tolerance in tolerances {
                let found = check(name, scene, &quick(strategy, tolerance));
                assert!(found.linked > 0 && found.leaves >= before, "{name}: a finer tolerance refines less");
                before = found.leaves;
            }
        }
        let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
        for elements in [1.0, 300.0] {
            let options =
                SolveOptions { uniform: UniformOptions { element_area: Some(area / elements) }, ..quick(Strategy::Uniform, 1.0) };
            check(name, scene, &options);
        }
    }
}

#[test]
fn each_pair_once_where_links_are_made_once() {
    for (name, scene) in [("cornell", cornell()), ("furnished", furnished(5)), ("soup", soup(4))] {
        for strategy in [Strategy::BottomUp98, Strategy::TopDown98] {
            let mut once = quick(strategy, 1.0);
            once.chang_shih98.bottom_area = 1.0 / 64.0;
            once.chang_shih98.bottom_samples = 2;
            for form_factor_tolerance in [1.0, 0.1, 0.02] {
                let mut options = once.clone();
                options.chang_shih98.form_factor_tolerance = form_factor_tolerance;
                let found = check(name, &scene, &options);
                assert!(found.linked > 0 && found.dormant == 0 && found.leaves > scene.surfaces().len());
            }
            let limited = SolveOptions { max_links: Some(50), error: 0.01, ..once };
            let (solution, report) = solve(scene.clone(), &limited, &RunOptions::default());
            assert_eq!(report.stopped_by, StoppedBy::MaxLinks);
            coverage(&solution);
        }
    }
}

#[test]
fn each_pair_once_along_discontinuities() {
    let area = |scene: &Scene| scene.surfaces().iter().map(|surface| surface.polygon.area()).sum::<f64>();
    for (name, scene) in [("cornell", cornell()), ("furnished", furnished(6)), ("soup", soup(5)), ("crowded", crowded(16, 9))] {
        for strategy in [Strategy::Default, Strategy::Hanrahan91, Strategy::ErrorDriven, Strategy::Uniform] {
            let element_area = Some(area(&scene) / 200.0);
            let mut options = SolveOptions { uniform: UniformOptions { element_area }, ..quick(strategy, 0.5) };
            options.links.subdivision = Subdivision::Discontinuities;
            let found = check(name, &scene, &options);
            assert!(found.linked > 0 && found.leaves > scene.surfaces().len());
        }

        // Limits are kept here, too.
        let mut limited =
            SolveOptions { max_links: Some(300), solver: Solver::Links, error: 0.01, ..quick(Strategy::Default, 0.01) };
        limited.links.subdivision = Subdivision::Discontinuities;
        let (solution, report) = solve(scene.clone(), &limited, &RunOptions::default());
        assert!(report.stopped_by == StoppedBy::MaxLinks && solution.links().len() <= 300);
        coverage(&solution);
        let memory_bytes = least_memory::least_bytes(scene.clone()) + 1_000_000;
        let run = RunOptions { memory_bytes: Some(memory_bytes), ..RunOptions::default() };
        let (solution, report) = solve(scene, &SolveOptions { max_links: None, ..limited }, &run);
        assert!(report.stopped_by == StoppedBy::Memory && report.accounted_bytes <= memory_bytes, "{report:?}");
        coverage(&solution);
    }
}

#[test]
fn each_pair_once_when_rounds_follow_rounds() {
    // Several rounds with their own tolerances split links that an earlier round has made.
    for (name, scene) in [("cornell", cornell()), ("furnished", furnished(3)), ("soup", soup(3))] {
        let options = SolveOptions {
            error: 0.1,
            point_rays: Some(16),
            links: LinkOptions { min_element: 1e-3, ..LinkOptions::default() },
            ..SolveOptions::default()
        };
        let found = check(name, &scene, &options);
        assert!(found.leaves > scene.surfaces().len());
    }
}

#[test]
fn each_pair_once_where_maps_are_asked() {
    let found = check("crowded", &crowded(80, 6), &quick(Strategy::Multiresolution96, 1.0));
    assert!(found.linked > 0);
}

#[test]
fn limits_are_kept_and_each_pair_is_covered_once() {
    for strategy in [Strategy::Default, Strategy::Hanrahan91, Strategy::Uniform] {
        for scene in [furnished(4), crowded(16, 8)] {
            let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
            let element_area = Some(area / 1000.0);
            let hard = SolveOptions {
                error: 0.05,
                solver: Solver::Links,
                uniform: UniformOptions { element_area },
                ..quick(strategy, 0.01)
            };
            for max_links in [1, 50, 2000] {
                let options = SolveOptions { max_links: Some(max_links), ..hard.clone() };
                let (solution, report) = solve(scene.clone(), &options, &RunOptions::default());
                assert_eq!(report.stopped_by, StoppedBy::MaxLinks);
                let links = solution.links().len() as u64;
                println!("{strategy:?}, {} surfaces: {links} links of at most {max_links}", scene.surfaces().len());
                assert!(links <= max_links, "{links} links of at most {max_links}");
                assert!(links >= max_links / 2 || max_links < scene.surfaces().len() as u64, "only {links} of {max_links}");
                coverage(&solution);
            }

            // Beside the links, nodes and pairs without a link count.
            let memory_bytes = least_memory::least_bytes(scene.clone()) + 1_000_000;
            let run = RunOptions { memory_bytes: Some(memory_bytes), ..RunOptions::default() };
            let (solution, report) = solve(scene.clone(), &hard, &run);
            println!("{strategy:?}: {} of {memory_bytes} bytes", report.accounted_bytes);
            assert_eq!(report.stopped_by, StoppedBy::Memory);
            assert!((memory_bytes / 2..=memory_bytes).contains(&report.accounted_bytes));
            assert_eq!(report.memory_bytes, solution.memory_bytes());
            coverage(&solution);
        }
    }
}

#[test]
fn each_pair_once_with_clusters() {
    let scene = crowded(16, 7);
    let mut cluster_links = 0;
    for tolerance in [10.0, 1.0, 0.2] {
        let (solution, _) = solve(scene.clone(), &quick(Strategy::Default, tolerance), &RunOptions::default());
        let found = coverage(&solution);
        println!("crowded, tolerance {tolerance}: {found:?}");
        assert_eq!(found.linked + found.dormant + found.black + found.coplanar + found.behind, found.leaves * found.leaves);
        let hierarchy = solution.hierarchy();
        let of_clusters = |(receiver, source): (NodeId, NodeId)| hierarchy.is_cluster(receiver) || hierarchy.is_cluster(source);
        cluster_links += solution.links().iter().filter(|(receiver, link)| of_clusters((*receiver, link.source))).count();
        assert!(solution.links().iter().all(|(receiver, link)| receiver != link.source), "a node is linked with itself");
    }
    assert!(cluster_links > 100, "clusters take no part");

    // A limit links what is left as it stands, clusters too; no cluster with itself.
    let options = SolveOptions { max_links: Some(20), solver: Solver::Links, error: 1e-6, ..quick(Strategy::Default, 0.01) };
    let (solution, report) = solve(scene, &options, &RunOptions::default());
    assert_eq!(report.stopped_by, StoppedBy::MaxLinks);
    coverage(&solution);
}

#[test]
fn one_triangle_is_covered_by_the_proof_that_it_does_not_see_itself() {
    for (reflectance, exitance) in [(0.5, 1.0), (0.5, 0.0), (0.0, 0.0)] {
        let mut room = Room::default();
        let material = room.material(&[reflectance], &[exitance]);
        room.face(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material);
        let found = check("one triangle", &room.scene(), &SolveOptions::default());
        assert_eq!((found.leaves, found.linked), (1, 0));
    }
}

#[test]
fn in_the_dark_everything_sleeps() {
    let mut room = Room::default();
    let grey = room.material(&[0.5], &[0.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| grey);
    let found = check("dark cube", &room.scene(), &SolveOptions::default());
    assert_eq!((found.leaves, found.linked, found.dormant), (6, 0, 36));
}
