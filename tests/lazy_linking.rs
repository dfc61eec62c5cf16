//! Lazy linking, link reduction and link culling against the algorithm that links everything.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/least_memory.rs"]
mod least_memory;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::{BTreeMap, BTreeSet};

use patchlight::form_factor::exact_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Holzschuch94Options, LinkOptions, RunOptions, Solution, SolveOptions, SolveReport, StoppedBy, Strategy};
use rooms::{Room, channels, solve, straight, turned};
use triangles::Random;

/// A closed room with boxes, a lamp and a dim one.
fn furnished(seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut room = Room::default();
    let wall = room.material(&channels(&mut random, 3, 0.3, 0.7), &[0.0; 3]);
    let lamp = room.material(&[0.1; 3], &channels(&mut random, 3, 5.0, 20.0));
    let dim = room.material(&[0.2; 3], &[0.5; 3]);
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.5), true, |_, _| wall);
    for k in 0..6 {
        let corner = [0.4 + 1.2 * f64::from(k % 3), 0.5 + 1.3 * f64::from(k / 3), 0.05];
        let grey = room.material(&channels(&mut random, 3, 0.2, 0.7), &[0.0; 3]);
        let sides = turned(random.between(0.2, 0.6), random.between(0.2, 0.6), random.between(0.2, 1.2), random.between(0.0, 0.5));
        room.cuboid(corner, sides, false, |_, _| grey);
    }
    room.quad([1.5, 1.0, 2.45], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0], lamp);
    room.face(&[[0.02, 1.0, 1.0], [0.02, 1.5, 1.0], [0.02, 1.2, 1.5]], dim);
    room.scene()
}

fn options(strategy: Strategy) -> SolveOptions {
    SolveOptions {
        strategy,
        point_rays: Some(1),
        error: 0.9,
        links: LinkOptions { tolerance: Some(0.1), min_element: 1e-4, ..LinkOptions::default() },
        holzschuch94: Holzschuch94Options { ambient: false, ..Holzschuch94Options::default() },
        ..SolveOptions::default()
    }
}

fn run(scene: &Scene, options: &SolveOptions) -> (Solution, SolveReport) {
    let (evaluator, report) = solve(scene.clone(), options);
    (evaluator.solution().clone(), report)
}

#[test]
fn lazy_linking_with_no_threshold_makes_the_links_of_the_original() {
    for seed in 1..4 {
        let scene = furnished(seed);
        let (original, report) = run(&scene, &options(Strategy::Original94));
        let mut lazily = options(Strategy::Lazy94);
        lazily.holzschuch94.link_tolerance = 0.0;
        let (lazy, lazy_report) = run(&scene, &lazily);
        assert!(report.counts.links > 5000 && lazy.links().dormant().is_empty());
        assert_eq!((report.counts.links, report.counts.elements), (lazy_report.counts.links, lazy_report.counts.elements));

        // Elements may be numbered otherwise: compare by polygons.
        let key = |solution: &Solution, node: NodeId| {
            format!("{:?} {:?}", solution.hierarchy().surface_of(node), solution.hierarchy().polygon(node))
        };
        let links = |solution: &Solution| -> BTreeSet<String> {
            let text = |(receiver, link): (NodeId, &patchlight::links::Link)| {
                format!("{} {} {:.9}", key(solution, receiver), key(solution, link.source), link.form_factor)
            };
            solution.links().iter().map(text).collect()
        };
        let (a, b) = (links(&original), links(&lazy));
        let common = a.intersection(&b).count();
        println!("seed {seed}: {} links, {common} in common", a.len());
        assert_eq!((common, common), (a.len(), b.len()));
    }
}

/// Adds up what covers each ordered pair of leaves, as tests/coverage.rs does, for links, dormant and unseen pairs.
fn assert_covered_once(solution: &Solution) -> [usize; 4] {
    let hierarchy = solution.hierarchy();
    let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let ancestry = |leaf: NodeId| -> Vec<NodeId> { std::iter::successors(Some(leaf), |&node| hierarchy.parent(node)).collect() };
    let mut kinds: BTreeMap<(NodeId, NodeId), [usize; 3]> = BTreeMap::new();
    for (receiver, link) in solution.links().iter() {
        kinds.entry((receiver, link.source)).or_default()[0] += 1;
    }
    for (kind, pairs) in [(1, solution.links().dormant()), (2, solution.links().unseen())] {
        for pair in pairs {
            kinds.entry((pair.receiver, pair.source)).or_default()[kind] += 1;
        }
    }
    let polygon = |node: NodeId| Polygon::new(&hierarchy.polygon(node)).unwrap();
    let plane = |node: NodeId| solution.scene().surface(hierarchy.surface_of(node).unwrap()).plane();
    let mut found = [0; 4];
    for &receiver in &leaves {
        let above = ancestry(receiver);
        for &source in &leaves {
            let mut count = [0; 3];
            for &r in &above {
                for s in ancestry(source) {
                    if let Some(kinds) = kinds.get(&(r, s)) {
                        (0..3).for_each(|kind| count[kind] += kinds[kind]);
                    }
                }
            }
            match count {
                [1, 0, 0] => found[0] += 1,
                [0, 1, 0] => found[1] += 1,
                [0, 0, 1] => found[2] += 1,
                [0, 0, 0] => {
                    let exchange = exact_area_form_factor(&polygon(receiver), &polygon(source));
                    assert!(plane(receiver) == plane(source) || exchange == 0.0, "{receiver:?} gets nothing from {source:?}");
                    found[3] += 1;
                }
                _ => panic!("{receiver:?} from {source:?} is covered {count:?}"),
            }
        }
    }
    found
}

#[test]
fn each_pair_once_linked_dormant_unseen_or_behind() {
    for strategy in [Strategy::Original94, Strategy::Culling94, Strategy::Lazy94, Strategy::Lazy94Reduction] {
        let scene = furnished(5);
        let mut coarse = options(strategy);
        coarse.links.tolerance = Some(1.0);
        coarse.holzschuch94.cull_form_factor = 0.01;
        let (solution, _) = run(&scene, &coarse);
        let found = assert_covered_once(&solution);
        println!("{strategy:?}: linked, dormant, unseen, behind: {found:?}");
        assert!(found[0] > 0 && found[3] > 0);
        assert_eq!(found[1] > 0, strategy != Strategy::Original94);
        assert!(found[2] > 0 || strategy != Strategy::Original94);
    }
}

#[test]
fn limits_are_kept_and_leave_pairs_dormant_or_links_unrefined() {
    for strategy in [Strategy::Original94, Strategy::Lazy94, Strategy::Lazy94Reduction] {
        for max_links in [1, 100, 3000] {
            let limited = SolveOptions { max_links: Some(max_links), error: 0.05, ..options(strategy) };
            let (solution, report) = run(&furnished(6), &limited);
            println!("{strategy:?}: {} links of at most {max_links}", report.counts.links);
            assert!(report.counts.links <= max_links && report.counts.links >= max_links / 2, "{:?}", report.counts);
            assert_eq!(report.stopped_by, StoppedBy::MaxLinks);
            assert_covered_once(&solution);
        }
        let hard = SolveOptions { error: 0.05, ..options(strategy) };
        let memory_bytes = least_memory::least_bytes(furnished(6)) + 2_000_000;
        let limits = RunOptions { memory_bytes: Some(memory_bytes), ..RunOptions::default() };
        let (evaluator, report) = pipeline::solve(furnished(6), &hard, &limits, &Silent).unwrap();
        println!("{strategy:?}: {} of {memory_bytes} bytes", report.accounted_bytes);
        assert_eq!(report.stopped_by, StoppedBy::Memory);
        assert!(report.memory_bytes < memory_bytes);
        assert_covered_once(evaluator.solution());
    }
}

/// The row sums of the surfaces, and the root mean square by which those of the leaves are off 1, by area.
fn row_sums(solution: &Solution) -> (Vec<f64>, f64) {
    let hierarchy = solution.hierarchy();
    let mut of_surfaces = vec![0.0; solution.scene().surfaces().len()];
    let (mut off, mut area) = (0.0, 0.0);
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let above = std::iter::successors(Some(leaf), |&node| hierarchy.parent(node));
        let sum: f64 = above.flat_map(|node| solution.links().of(node)).map(|link| link.occluded_form_factor()).sum();
        let surface = hierarchy.surface_of(leaf).unwrap();
        of_surfaces[surface.0 as usize] += sum * hierarchy.area(leaf) / hierarchy.area(hierarchy.node_of(surface));
        off += hierarchy.area(leaf) * (sum - 1.0) * (sum - 1.0);
        area += hierarchy.area(leaf);
    }
    (of_surfaces, (off / area).sqrt())
}

#[test]
fn reduction_keeps_row_sums_within_its_criterion() {
    // All is visible in an empty room, so the exact row sums are 1. Those of surfaces are as exact as form factors. Those of leaves are off
    // where a link is not refined, and reduction may add what its criterion admits.
    let mut room = Room::default();
    let wall = room.material(&[0.5], &[0.0]);
    let lamp = room.material(&[0.5], &[1.0]);
    room.cuboid([0.0; 3], straight(3.0, 2.0, 2.0), true, |_, face| if face == 0 { lamp } else { wall });
    let scene = room.scene();
    for reduce_tolerance in [0.05, 0.2, 0.5] {
        let mut options = options(Strategy::Lazy94Reduction);
        options.holzschuch94.reduce_tolerance = reduce_tolerance;
        options.holzschuch94.link_tolerance = 0.0;
        options.links.tolerance = Some(0.04);
        let (solution, report) = run(&scene, &options);
        let (unreduced, all) = run(&scene, &SolveOptions { strategy: Strategy::Lazy94, ..options.clone() });
        let ((sums, off), (_, unreduced_off)) = (row_sums(&solution), row_sums(&unreduced));
        println!("{reduce_tolerance}: {} links of {}: {sums:?}, {off}, {unreduced_off}", report.counts.links, all.counts.links);
        assert!(report.bounces.last().unwrap().reduced_links > 0 && report.counts.links < all.counts.links);
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() <= options.links.form_factor_accuracy), "{sums:?}");
        assert!(off <= unreduced_off + reduce_tolerance, "{off} for {unreduced_off}");
    }
}

#[test]
fn what_lazy_linking_leaves_out_is_within_what_it_reports() {
    for seed in 7..10 {
        let scene = furnished(seed);
        for link_tolerance in [0.2, 1.0] {
            let mut lazily = options(Strategy::Lazy94);
            lazily.holzschuch94.link_tolerance = link_tolerance;
            lazily.holzschuch94.iterations = 30;
            let (lazy, report) = run(&scene, &lazily);
            let (all, all_report) = run(&scene, &SolveOptions { strategy: Strategy::Original94, ..lazily.clone() });
            let missing: f64 = (0..scene.surfaces().len() as u32)
                .map(|surface| {
                    let node = lazy.hierarchy().node_of(SurfaceId(surface));
                    let sum = |solution: &Solution| solution.radiosity().of(node).iter().sum::<f64>();
                    lazy.hierarchy().area(node) * (sum(&all) - sum(&lazy)).abs()
                })
                .sum();
            let balance = report.energy_balance.unwrap();
            let incorrect = report.bounces.last().unwrap().incorrect_energy;
            println!(
                "seed {seed}, {link_tolerance}: {missing:.4} W missing, at most {:.4}, incorrect {incorrect:.4}",
                balance.held_back
            );
            assert!(balance.held_back > 0.0 && missing <= balance.held_back, "{missing} against {balance:?}");
            assert_eq!(all_report.energy_balance.unwrap().held_back, 0.0);

            // The ambient term gives some of it back, and brings the answer nearer.
            lazily.holzschuch94.ambient = true;
            let (_, with_ambient) = run(&scene, &lazily);
            let given = with_ambient.energy_balance.unwrap().ambient;
            assert!(given > 0.0 && given <= balance.held_back, "{given} of {}", balance.held_back);
        }
    }
}
