//! How the tolerances of the experiment are chosen: by what they do to the answer, never by how much they save.
//!
//! - eps_refine: the largest of a series whose original solution lies within [`CLOSE`] of that of the next finer one, in every room.
//! - eps_reduce: the largest of a series with which lazy linking and reduction stay within [`CLOSE`] of the original, in every room.
//!
//! Both by values at points, the same for all rooms.

use patchlight::scene::Scene;
use patchlight::solve::{SolveOptions, Strategy};

use super::experiment::{REFINE_TOLERANCE, options_of, scene_of};
use super::measure::{Points, Run, run};
use super::paper::PaperRoom;
use super::tables::percent;

/// How far from each other two solutions may be: the part of what is reflected, at points.
const CLOSE: f64 = 0.02;

/// What is tried, falling and rising.
const REFINE_SERIES: [f64; 4] = [0.1, 0.05, 0.02, 0.01];
const REDUCE_SERIES: [f64; 5] = [0.2, 0.3, 0.4, 0.5, 0.6];

/// Tries the series for eps_refine on rooms, prints what each step does, and which of them the rule takes.
pub fn choose_refine(rooms: &[&PaperRoom]) {
    println!("\n| room | eps_refine | k links | CPU-s | from the next finer: values | elements |\n|---|---|---|---|---|---|");
    let mut allowed = [true; REFINE_SERIES.len() - 1];
    for room in rooms {
        refine_series(room, &mut allowed);
    }
    print_choice("eps_refine", REFINE_SERIES.iter().zip(allowed).find(|(_, allowed)| *allowed));
}

/// The same for eps_reduce, with the eps_refine of the experiment.
pub fn choose_reduce(rooms: &[&PaperRoom]) {
    println!(
        "\n| room | eps_reduce | k links | ratio | CPU-s | ratio | from the original: values | elements |\n|---|---|---|---|---|---|---|---|"
    );
    let mut allowed = [true; REDUCE_SERIES.len()];
    for room in rooms {
        reduce_series(room, &mut allowed);
    }
    print_choice("eps_reduce", REDUCE_SERIES.iter().zip(allowed).rev().find(|(_, allowed)| *allowed));
}

fn print_choice(name: &str, chosen: Option<(&f64, bool)>) {
    match chosen {
        Some((tolerance, _)) => println!("\n{name} by the rule, in these rooms: {tolerance}"),
        None => println!("\n{name}: none of the series keeps the rule in these rooms"),
    }
}

fn refine_series(room: &PaperRoom, allowed: &mut [bool]) {
    let scene = scene_of(room);
    let points = Points::of(&scene);
    let solve = |tolerance| {
        let mut options = SolveOptions { strategy: Strategy::Original94, ..options_of(&scene) };
        options.links.tolerance = Some(tolerance);
        let run = run(&scene, &options);
        let (links, seconds) = cost(&run);
        (links, seconds, points.values(&run), points.elements(&run))
    };
    let mut coarser = solve(REFINE_SERIES[0]);
    for (step, tolerance) in REFINE_SERIES[1..].iter().enumerate() {
        let finer = solve(*tolerance);
        let [values, elements] = differences(&scene, &points, (&coarser.2, &coarser.3), (&finer.2, &finer.3));
        let (links, seconds) = (coarser.0, coarser.1);
        println!(
            "| {} | {} | {links:.0} | {seconds:.1} | {} | {} |",
            room.name,
            REFINE_SERIES[step],
            percent(values),
            percent(elements)
        );
        allowed[step] &= values <= CLOSE;
        coarser = finer;
    }
}

fn reduce_series(room: &PaperRoom, allowed: &mut [bool]) {
    let scene = scene_of(room);
    let points = Points::of(&scene);
    let mut options = options_of(&scene);
    options.links.tolerance = Some(REFINE_TOLERANCE);
    let original = run(&scene, &SolveOptions { strategy: Strategy::Original94, ..options.clone() });
    let (all_links, all_seconds) = cost(&original);
    let truth = (points.values(&original), points.elements(&original));
    drop(original);
    for (reduce_tolerance, allowed) in REDUCE_SERIES.into_iter().zip(allowed) {
        let mut options = SolveOptions { strategy: Strategy::Lazy94Reduction, ..options.clone() };
        options.holzschuch94.reduce_tolerance = reduce_tolerance;
        let reduced = run(&scene, &options);
        let (links, seconds) = cost(&reduced);
        let found = (points.values(&reduced), points.elements(&reduced));
        let [values, elements] = differences(&scene, &points, (&found.0, &found.1), (&truth.0, &truth.1));
        println!(
            "| {} | {reduce_tolerance} | {links:.0} | {:.1} | {seconds:.1} | {:.1} | {} | {} |",
            room.name,
            all_links / links,
            all_seconds / seconds,
            percent(values),
            percent(elements)
        );
        *allowed &= values <= CLOSE;
    }
}

/// Thousands of links, and CPU seconds, of all iterations.
fn cost(run: &Run) -> (f64, f64) {
    (run.report.counts.links as f64 * 1e-3, run.cpu_s.last().copied().unwrap_or_default())
}

/// Of values and of elements.
fn differences(scene: &Scene, points: &Points, found: (&[f64], &[f64]), truth: (&[f64], &[f64])) -> [f64; 2] {
    [points.difference_of_values(scene, found.0, truth.0), points.difference_of_elements(scene, found.1, truth.1)]
}
