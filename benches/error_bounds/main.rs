//! Bounds, error estimates and error-driven refinement on three simple scenes: figures 5.4 to 5.10 of Lischinski 1994 for this
//! implementation, beside what the thesis says of its own.
//!
//! `cargo bench --bench error_bounds` prints tables as Markdown, in about ten minutes; `-- --plots docs` also draws the figures into docs/, letters of
//! scenes (a, b, c) leave out the others, and `--links-only` all but figure 5.10. The floor is compared at 128 x 128 points with a reference that shares nothing with
//! the solver but form factors from points.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

mod configurations;
#[path = "../support/cpu.rs"]
mod cpu;
mod figures;
mod measure;
mod measured;
#[path = "../support/plot.rs"]
mod plot;
mod reference;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod tables;
mod thesis;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::PathBuf;

use patchlight::bounds::FormFactorRule;
use patchlight::solve::{Bounds, Interest, SolveOptions, Strategy, UniformOptions};

use configurations::Configuration;
use cpu::cpu_seconds;
use measure::{claimed, leaves_under_probes, measured, options, solve, violations};
use measured::{Ladder, Measured, Profile, Rung, Size};
use reference::{PROBES, Reference};

/// Elements on each side of the floor, where all elements have one size.
const PER_SIDE: [u32; 5] = [1, 2, 4, 8, 16];

/// Where refinement is compared: tolerances from coarse to fine, each this part of the one before.
const FIRST_TOLERANCE: f64 = 0.5;
const NEXT_TOLERANCE: f64 = 0.4;
const RUNGS: i32 = 7;

/// A ladder ends with the first rung of so many links, or that took so many CPU seconds.
const MOST_LINKS: u64 = 30_000;
const MOST_CPU_S: f64 = 20.0;

/// The smallest element of these, as a part of the area of all surfaces. Brightness-weighted refinement spends most of its links in
/// corners, where form factors are large however small elements are; so it is given elements no smaller than 1/32 as well.
const MIN_ELEMENT: f64 = 1e-5;
const LARGER_MIN_ELEMENT: f64 = 3e-4;
const LARGER_ELEMENTS: &str = "brightness-weighted, larger elements";

/// Tolerances of the two solutions whose bounds are drawn.
const PROFILES: [f64; 2] = [0.5, 0.05];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut letters, mut plots, mut links_only) = (String::new(), None, false);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--plots" => plots = arguments.next().map(PathBuf::from),
            "--links-only" => links_only = true,
            _ => letters += &argument,
        }
    }
    let is_chosen = |configuration: &Configuration| letters.is_empty() || letters.contains(configuration.letter());
    for configuration in Configuration::ALL.into_iter().filter(is_chosen) {
        let measured = measure(configuration, links_only);
        tables::print(&measured);
        if let Some(folder) = &plots {
            figures::draw(&measured, folder).expect("the folder can be written");
        }
    }
}

fn measure(configuration: Configuration, links_only: bool) -> Measured {
    let (reference, reference_error) = Reference::of_floor(configuration);
    let floor = || Interest::Material("floor".to_owned());
    let ways = [
        ("brightness-weighted", Strategy::Hanrahan91, Interest::Total, Bounds::Estimate),
        (LARGER_ELEMENTS, Strategy::Hanrahan91, Interest::Total, Bounds::Estimate),
        ("area-weighted (default)", Strategy::Default, Interest::Total, Bounds::Estimate),
        ("error-driven", Strategy::ErrorDriven, Interest::Total, Bounds::Estimate),
        ("error-driven, floor alone", Strategy::ErrorDriven, floor(), Bounds::Estimate),
        ("error-driven, guaranteed", Strategy::ErrorDriven, Interest::Total, Bounds::Guaranteed),
    ];
    let ladders = ways.into_iter().map(|(name, strategy, importance, bounds)| {
        let min_element = if name == LARGER_ELEMENTS { LARGER_MIN_ELEMENT } else { MIN_ELEMENT };
        let mut options = SolveOptions { strategy, importance, bounds, ..options() };
        options.links.min_element = min_element;
        Ladder { name, rungs: rungs(configuration, &options, &reference) }
    });
    let (per_side, tolerances): (&[u32], &[f64]) = if links_only { (&[], &[]) } else { (&PER_SIDE, &PROFILES) };
    Measured {
        configuration,
        reference_error,
        mean: reference.iter().sum::<f64>() / reference.len() as f64,
        profile: reference[PROBES / 2 * PROBES..][..PROBES].to_vec(),
        sizes: per_side.iter().map(|&per_side| size(configuration, per_side, &reference)).collect(),
        profiles: tolerances.iter().map(|&tolerance| profile(configuration, tolerance, &reference)).collect(),
        ladders: ladders.collect(),
    }
}

fn size(configuration: Configuration, per_side: u32, reference: &[f64]) -> Size {
    let element_area = Some(f64::from(per_side).powi(-2));
    let (evaluator, report) =
        solve(configuration, &SolveOptions { strategy: Strategy::Uniform, uniform: UniformOptions { element_area }, ..options() });
    let solution = evaluator.solution();
    let (bounds, _) = evaluator.bound(FormFactorRule::QuasiConcave);
    Size {
        per_side,
        links: report.counts.links,
        measured: measured(solution, reference),
        estimated: claimed(solution, &evaluator.estimate_ranges(), reference),
        bound: claimed(solution, &bounds, reference),
        outside: violations(solution, &bounds, reference),
    }
}

fn profile(configuration: Configuration, tolerance: f64, reference: &[f64]) -> Profile {
    let mut options = SolveOptions { strategy: Strategy::ErrorDriven, bounds: Bounds::Guaranteed, ..options() };
    options.links.tolerance = Some(tolerance);
    options.links.min_element = MIN_ELEMENT;
    let (evaluator, report) = solve(configuration, &options);
    let (bounds, found) = evaluator.bound(FormFactorRule::QuasiConcave);
    let under = leaves_under_probes(evaluator.solution().hierarchy());
    Profile {
        links: report.counts.links,
        sweeps: found.sweeps,
        bounds: under[PROBES / 2 * PROBES..][..PROBES].iter().map(|&leaf| [bounds.lower(leaf)[0], bounds.upper(leaf)[0]]).collect(),
        outside: violations(evaluator.solution(), &bounds, reference),
    }
}

fn rungs(configuration: Configuration, options: &SolveOptions, reference: &[f64]) -> Vec<Rung> {
    let mut rungs = Vec::new();
    for step in 0..RUNGS {
        let tolerance = Some(FIRST_TOLERANCE * NEXT_TOLERANCE.powi(step));
        let start = cpu_seconds();
        let mut options = options.clone();
        options.links.tolerance = tolerance;
        let (evaluator, report) = solve(configuration, &options);
        let cpu_s = cpu_seconds() - start;
        let links = report.counts.links;
        let estimated = report.link_error.map(|error| error.estimated_error / error.reflected);
        rungs.push(Rung { links, l1: measured(evaluator.solution(), reference).l1, estimated, cpu_s });
        if links > MOST_LINKS || cpu_s > MOST_CPU_S {
            break;
        }
    }
    rungs
}
