//! Lazy linking and link reduction on five rooms: the tables and figures of Holzschuch, Sillion, Drettakis 1994 for this implementation,
//! beside the paper's.
//!
//! `cargo bench --bench lazy_linking` prints them as Markdown; `-- --plots docs` draws figures 2, 5, 6, 7 into docs/ instead, and names of rooms
//! leave out the others; `-- --choose refine` and `-- --choose reduce` show how the tolerances below were chosen. All strategies share form
//! factors, visibility and 16 rays a link, on one thread; what differs is which links are made. The parameters below are the same for all
//! rooms.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
mod experiment;
mod measure;
mod paper;
mod plot;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod tables;
mod tolerances;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::PathBuf;

use patchlight::scene::Scene;
use patchlight::solve::{SolveOptions, Strategy};

use experiment::{Comparison, Measured, options_of, scene_of};
use measure::{Points, Run, run, run_default};
use paper::{PaperRoom, ROOMS};
use plot::Courses;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut names, mut plots, mut with_default, mut choosing) = (Vec::new(), None, true, None);
    let mut settings = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--plots" => plots = arguments.next().map(PathBuf::from),
            "--without-default" => with_default = false,
            "--choose" => choosing = arguments.next(),
            "--set" => settings.extend(arguments.next()),
            _ => names.push(argument),
        }
    }
    let is_chosen = |room: &&PaperRoom| names.is_empty() || names.iter().any(|name| name == room.file);
    let rooms: Vec<&'static PaperRoom> = ROOMS.iter().filter(is_chosen).collect();
    match choosing.as_deref() {
        Some("refine") => return tolerances::choose_refine(&rooms),
        Some("reduce") => return tolerances::choose_reduce(&rooms),
        _ => {}
    }
    if let Some(folder) = plots {
        let courses: Vec<Courses> = rooms.into_iter().map(courses).collect();
        return plot::draw(&courses, &folder).expect("the folder can be written");
    }
    let measured: Vec<Measured> = rooms.into_iter().map(|room| measure(room, with_default, &settings)).collect();
    tables::print(&measured);
}

/// The strategies whose course is drawn.
fn courses(room: &'static PaperRoom) -> Courses {
    let scene = scene_of(room);
    let of = |strategy| run(&scene, &SolveOptions { strategy, ..options_of(&scene) }).into();
    Courses { room, original: of(Strategy::Original94), lazy: of(Strategy::Lazy94), reduced: of(Strategy::Lazy94Reduction) }
}

fn measure(room: &'static PaperRoom, with_default: bool, settings: &[String]) -> Measured {
    let scene = scene_of(room);
    let mut options = options_of(&scene);
    for setting in settings {
        let (key, value) = setting.split_once('=').expect("--set key=value");
        options.set(key, value).expect("an option of the solver");
    }
    let of = |strategy: Strategy| run(&scene, &SolveOptions { strategy, ..options.clone() });
    let (original, culling) = (of(Strategy::Original94), of(Strategy::Culling94));
    let (lazy, reduced) = (of(Strategy::Lazy94), of(Strategy::Lazy94Reduction));

    let points = Points::of(&scene);
    let (elements, values) = (points.elements(&original), points.values(&original));
    let of_elements = |run: &Run| points.difference_of_elements(&scene, &points.elements(run), &elements);
    let of_values = |run: &Run| points.difference_of_values(&scene, &points.values(run), &values);
    let (lazy_difference, reduced_difference) = (of_elements(&lazy), of_elements(&reduced));
    let culling_difference = of_elements(&culling);
    let value_differences = [&lazy, &reduced, &culling].map(of_values);
    let default = with_default.then(|| compare(&scene, &points, &original, &reduced));
    Measured {
        room,
        original,
        culling,
        lazy,
        reduced,
        lazy_difference,
        reduced_difference,
        culling_difference,
        value_differences,
        default,
    }
}

/// Solves with the default strategy, and measures errors against a finer solution.
fn compare(scene: &Scene, points: &Points, original: &Run, reduced: &Run) -> Comparison {
    let (reference, fine, _) = run_default(scene, 0.02, 60.0);
    let (default, report, cpu_s) = run_default(scene, 0.05, 60.0);
    let truth = points.values_of(&reference);
    let error_of_elements = |run: &Run| points.difference_of_values(scene, &points.elements(run)[..truth.len()], &truth);
    Comparison {
        cpu_s,
        claimed: report.error.estimate,
        rays: report.counts.rays,
        links: report.counts.links,
        error: points.difference_of_values(scene, &points.values_of(&default), &truth),
        original_error: error_of_elements(original),
        reduced_error: error_of_elements(reduced),
        reference_claim: fine.error.estimate,
    }
}
