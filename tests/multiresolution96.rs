//! Transmittance maps of clusters against rays, and the strategy that asks them (Soler, Sillion 1996, in three dimensions).
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/clouds.rs"]
mod clouds;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use patchlight::hierarchy::Hierarchy;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{RunOptions, SolveOptions, SolveReport, Solver, Strategy};
use patchlight::transmittance::maps::{MapOptions, MapResolution, Maps};
use patchlight::visibility::{Backend, OccluderMesh, Segment, Visibility, build};

use clouds::{Cloud, ENDS, Ends, all_ends, floor_and_ceiling, passing};
use rooms::{Room, straight};
use triangles::Random;

/// Lines of a reference.
const REFERENCE: usize = 1 << 14;

/// The part that passes between two ends, by many rays.
fn passes(ends: &Ends, scene: &Scene, visibility: &dyn Visibility, random: &mut Random) -> f64 {
    passing(&ends.lines(scene, REFERENCE, random), visibility)
}

fn seen_through(scene: &Scene) -> Box<dyn Visibility> {
    build(Backend::default(), &OccluderMesh::of_scene(scene)).unwrap()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn what_maps_say_is_off_by_no_more_than_they_say() {
    // As they are, with the lines of a coarse link; and coarse ones, with so many lines that these are off by little.
    let as_they_are = MapResolution::default();
    let coarse = MapResolution { directions: 4, offsets: 8 };
    for (resolution, lines, tolerance) in [(as_they_are, 64, 0.1), (coarse, 200, 0.1)] {
        let (mut offs, mut asked) = (Vec::new(), 0);
        for (size, seed) in [(0.06, 1), (0.09, 2), (0.04, 3), (0.06, 4), (0.02, 5)] {
            let scene = Cloud::of(size, seed).scene();
            let (hierarchy, visibility) = (Hierarchy::new(&scene), seen_through(&scene));
            let maps = Maps::new(&scene, &hierarchy, &MapOptions { resolution, seed, ..MapOptions::default() });
            let mut random = Random(100 + seed);
            for ends in all_ends(&hierarchy) {
                let truth = passes(&ends, &scene, visibility.as_ref(), &mut random);
                let lines = ends.lines(&scene, lines, &mut random);
                asked += 1;
                let Some((passes, error)) = maps.estimate(&hierarchy, ends.pair, &lines, tolerance) else { continue };
                assert!(passes.iter().all(|part| (0.0..=1.0).contains(part)) && error >= 0.0);
                let of_reference = (truth * (1.0 - truth) / REFERENCE as f64).sqrt();
                offs.push(((mean(&passes) - truth).abs(), error, of_reference));
            }
        }

        // As of a normal distribution, 68 and 95 in a hundred at least.
        let answered = offs.len();
        let within = |times: f64| {
            let held = offs.iter().filter(|(off, error, of_reference)| *off <= times * (error + of_reference)).count();
            held as f64 / answered as f64
        };
        let rms = mean(&offs.iter().map(|(off, ..)| off * off).collect::<Vec<_>>()).sqrt();
        println!(
            "{answered} of {asked} answered, {:.2} and {:.2} within one and two standard errors, {rms:.4} rms",
            within(1.0),
            within(2.0)
        );
        assert!(within(1.0) >= 0.68 && within(2.0) >= 0.95, "{resolution:?}");
        assert!(3 * answered > asked, "{answered} of {asked} answered");
    }
}

#[test]
fn no_ray_contradicts_a_bound_and_confidence_bounds_hold_as_often_as_they_say() {
    let (mut decided, mut asked, mut held, mut pairs) = ([0, 0], 0, 0, 0);
    for (size, seed) in [(0.06, 21), (0.12, 22), (0.03, 23)] {
        let scene = Cloud::of(size, seed).scene();
        let (hierarchy, visibility) = (Hierarchy::new(&scene), seen_through(&scene));
        let maps = Maps::new(&scene, &hierarchy, &MapOptions { seed, ..MapOptions::default() });
        let mut random = Random(200 + seed);
        for ends in all_ends(&hierarchy) {
            let truth = passes(&ends, &scene, visibility.as_ref(), &mut random);
            let lines = ends.lines(&scene, 64, &mut random);
            let mut occluded = vec![false; lines.len()];
            visibility.occluded(&lines, &mut occluded);
            for (line, occluded) in lines.iter().zip(occluded) {
                for most_opened in [0, 12, 1000] {
                    let [least, most] = maps.bound_passing(&hierarchy, line, most_opened);
                    let passes = if occluded { 0.0 } else { 1.0 };
                    assert!(least <= passes && passes <= most, "seed {seed}: {passes} is not in {least}..{most}");
                    assert!(most_opened < 1000 || least == most, "all is known once all is opened");
                    decided[usize::from(least == most)] += usize::from(most_opened == 12);
                }
                asked += 1;
            }
            let [least, most] = maps.sampled_bounds(&hierarchy, &lines, 1000, 0.9);
            held += usize::from((least..=most).contains(&truth));
            pairs += 1;
        }
    }
    println!("{decided:?} of {asked} undecided and decided with 12 opened; {held} of {pairs} confidence bounds hold");
    assert!(decided[1] > asked / 10, "{decided:?}");
    assert!(10 * held >= 9 * pairs, "{held} of {pairs}");
}

#[test]
fn finer_maps_are_nearer_to_the_truth() {
    let scene = Cloud::of(0.03, 7).scene();
    let (hierarchy, visibility) = (Hierarchy::new(&scene), seen_through(&scene));
    let all = all_ends(&hierarchy);
    let mut random = Random(8);
    let truths: Vec<f64> = all.iter().map(|ends| passes(ends, &scene, visibility.as_ref(), &mut random)).collect();
    let lines: Vec<_> = all.iter().map(|ends| ends.lines(&scene, 512, &mut random)).collect();
    let estimates_at = |directions: usize| {
        let resolution = MapResolution { directions, offsets: 2 * directions };
        let options = MapOptions { resolution, memory_bytes: 1 << 30, seed: 9 };
        let maps = Maps::new(&scene, &hierarchy, &options);
        // Asked for no accuracy, it takes clusters as they are.
        let estimate = |(ends, lines): (&Ends, &Vec<Segment>)| Some(mean(&maps.estimate(&hierarchy, ends.pair, lines, 1.0)?.0));
        all.iter().zip(&lines).map(estimate).collect::<Vec<Option<f64>>>()
    };

    // Over the pairs that are answered at every resolution.
    let estimates: Vec<_> = [1, 2, 4, 16].into_iter().map(estimates_at).collect();
    let answered: Vec<usize> = (0..all.len()).filter(|&pair| estimates.iter().all(|of_all| of_all[pair].is_some())).collect();
    assert!(2 * answered.len() > all.len(), "{} answered", answered.len());
    let off = |estimates: &Vec<Option<f64>>| {
        let squares: Vec<f64> = answered.iter().map(|&pair| (estimates[pair].unwrap() - truths[pair]).powi(2)).collect();
        mean(&squares).sqrt()
    };
    let errors: Vec<f64> = estimates.iter().map(off).collect();
    println!("errors by resolution: {errors:.4?}");
    assert!(errors[0] > 2.0 * errors[2] && errors[3] <= errors[2] && errors[3] < 0.03, "{errors:?}");
}

#[test]
fn where_nothing_is_between_all_passes_and_nothing_passes_a_wall() {
    let mut room = Room::default();
    let (ground, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[10.0]));
    floor_and_ceiling(&mut room, 0.5, ground, lamp);
    // A wall of tiles over the right half.
    for tile in 0..800 {
        let [x, y] = [0.05 * f64::from(tile % 40), -0.5 + 0.05 * f64::from(tile / 40)];
        room.sheet(&[[x, y, 1.5], [x + 0.05, y, 1.5], [x + 0.05, y + 0.05, 1.5], [x, y + 0.05, 1.5]], ground);
    }
    let scene = room.scene();
    let hierarchy = Hierarchy::new(&scene);
    let maps = Maps::new(&scene, &hierarchy, &MapOptions::default());
    let (mut answered, mut random) = ([0, 0], Random(3));
    for (index, ends) in all_ends(&hierarchy).iter().enumerate() {
        let passes = match (index / ENDS, index % ENDS) {
            (0..=2, 0..=2) => 1.0,
            (5.., 5..) => 0.0,
            _ => continue,
        };
        let lines = ends.lines(&scene, 16, &mut random);
        let Some((found, error)) = maps.estimate(&hierarchy, ends.pair, &lines, 0.1) else { continue };
        assert!(found.iter().all(|part| (part - passes).abs() < 1e-12) && error < 0.1, "{index}: {found:?}, {error}");
        answered[passes as usize] += 1;
    }
    assert!(!maps.is_empty() && answered[0] > 0 && answered[1] > 0, "{answered:?}");
}

#[test]
fn maps_keep_to_their_memory_and_answer_nothing_without_any() {
    let scene = Cloud::of(0.05, 11).scene();
    let hierarchy = Hierarchy::new(&scene);
    let ask_all = |memory_bytes: u64| {
        let maps = Maps::new(&scene, &hierarchy, &MapOptions { memory_bytes, ..MapOptions::default() });
        let mut random = Random(12);
        for ends in all_ends(&hierarchy) {
            maps.estimate(&hierarchy, ends.pair, &ends.lines(&scene, 16, &mut random), 0.2);
        }
        maps
    };
    let none = ask_all(0);
    assert!(none.is_empty() && none.answered() == 0);
    let few = ask_all(1_200_000);
    let overhead = none.memory_bytes();
    assert!(few.answered() > 0 && few.memory_bytes() - overhead <= 1_200_000, "{} bytes", few.memory_bytes());
}

/// A small cloud solved over coarse links.
fn lit_cloud(strategy: Strategy, transmittance_tolerance: f64, threads: usize) -> (pipeline::Evaluator, SolveReport) {
    let mut options = SolveOptions { strategy, solver: Solver::Links, error: 0.9, point_rays: Some(4), ..SolveOptions::default() };
    options.links.tolerance = Some(1.0);
    options.links.leaf_rays = Some(0);
    options.multiresolution96.transmittance_tolerance = transmittance_tolerance;
    let run = RunOptions { threads, ..RunOptions::default() };
    pipeline::solve(Cloud { leaves: 600, ..Cloud::of(0.09, 31) }.scene(), &options, &run, &Silent).unwrap()
}

/// How many segments maps have answered.
fn by_maps(report: &SolveReport) -> u64 {
    report.skipped.iter().find(|skipped| skipped.what.contains("transmittance maps")).expect("a line of the report").count
}

#[test]
fn without_tolerance_the_strategy_makes_the_links_of_1991() {
    let (with_maps, report) = lit_cloud(Strategy::Multiresolution96, 0.0, 2);
    let (by_rays, _) = lit_cloud(Strategy::Hanrahan91, 0.1, 2);
    assert_eq!(by_maps(&report), 0);
    assert!(with_maps.solution().links() == by_rays.solution().links());
}

#[test]
fn the_strategy_asks_maps_and_finds_the_light_of_rays_whatever_the_threads() {
    let (with_maps, report) = lit_cloud(Strategy::Multiresolution96, 0.2, 1);
    let answered = by_maps(&report);
    println!("{answered} segments by maps, {} rays, {} links", report.counts.rays, report.counts.links);
    assert!(answered > 1000, "{answered}");
    let (again, again_report) = lit_cloud(Strategy::Multiresolution96, 0.2, 3);
    assert!(with_maps.solution().links() == again.solution().links() && by_maps(&again_report) == answered);

    // The power that arrives, by links of either kind.
    let (by_rays, _) = lit_cloud(Strategy::Hanrahan91, 0.2, 2);
    let power = |evaluator: &pipeline::Evaluator| {
        let (scene, hierarchy, radiosity) =
            (evaluator.solution().scene(), evaluator.solution().hierarchy(), evaluator.solution().radiosity());
        let leaves = (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| !scene.material_of(id).emits());
        leaves.map(|id| scene.surface(id).polygon.area() * radiosity.of(hierarchy.node_of(id))[0]).sum::<f64>()
    };
    let (found, expected) = (power(&with_maps), power(&by_rays));
    println!("{found} W reflected, {expected} by rays");
    assert!((found / expected - 1.0).abs() < 0.03, "{found} for {expected}");
}

/// Rooms without dense clusters ask rays alone.
#[test]
fn rooms_have_no_maps() {
    let mut room = Room::default();
    let (wall, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[5.0]));
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.5), true, |_, _| wall);
    room.quad([1.5, 1.0, 2.45], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0], lamp);
    let scene = room.scene();
    let maps = Maps::new(&scene, &Hierarchy::new(&scene), &MapOptions::default());
    assert!(maps.is_empty());
}
