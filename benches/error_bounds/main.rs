//! Bounds, error estimates and error-driven refinement on three simple scenes: figures 5.4 to 5.10 of Lischinski 1994 for this
//! implementation, beside what the thesis says of its own.
//!
//! `cargo bench --bench error_bounds` prints tables as Markdown; `-- --plots docs` also draws the figures into docs/, and letters of scenes (a, b,
//! c) leave out the others. The floor is compared at 128 x 128 points with a reference that shares nothing with the solver but form
//! factors from points.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

mod configurations;
mod measure;
mod reference;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use configurations::Configuration;
use measure::{claimed, measured, options, solve, violations};
use patchlight::bounds::FormFactorRule;
use patchlight::solve::{Bounds, Interest, SolveOptions, Strategy};
use reference::Reference;
use std::time::Instant;

fn main() {
    for configuration in Configuration::ALL {
        let start = Instant::now();
        let (reference, own) = Reference::of_floor(configuration);
        println!("{configuration:?}: reference {own:e} in {:.1} s", start.elapsed().as_secs_f64());
        for level in 0..5 {
            let h = 0.5f64.powi(level);
            let start = Instant::now();
            let (evaluator, report) =
                solve(configuration, &SolveOptions { strategy: Strategy::Uniform, element_area: Some(h * h), ..options() });
            let solved = start.elapsed().as_secs_f64();
            let solution = evaluator.solution();
            let (bounds, _) = evaluator.bound(FormFactorRule::QuasiConcave);
            let bounded = start.elapsed().as_secs_f64();
            let ranges = evaluator.estimate_ranges();
            let (m, g, e) =
                (measured(solution, &reference), claimed(solution, &bounds, &reference), claimed(solution, &ranges, &reference));
            println!(
                "h 1/{:2} links {:7} L1 measured {:.4} estimated {:.4} ({:.2}) guaranteed {:.4} ({:.2}) Linf {:.3} {:.3} {:.3} out {} {}  time {:.1} {:.1} {:.1}",
                1 << level, report.counts.links, m.l1, e.l1, e.l1 / m.l1, g.l1, g.l1 / m.l1, m.l_infinity, e.l_infinity, g.l_infinity,
                violations(solution, &bounds, &reference), violations(solution, &ranges, &reference),
                solved, bounded - solved, start.elapsed().as_secs_f64() - bounded
            );
        }
        let floor = Interest::Material("floor".to_owned());
        let kinds = [
            ("BF", Strategy::Hanrahan91, Interest::Total, Bounds::Estimate),
            ("error", Strategy::ErrorDriven, Interest::Total, Bounds::Estimate),
            ("error, floor", Strategy::ErrorDriven, floor, Bounds::Estimate),
            ("error, guaranteed", Strategy::ErrorDriven, Interest::Total, Bounds::Guaranteed),
        ];
        for (name, strategy, importance, bounds) in kinds {
            for step in 0..8 {
                let tolerance = 0.5 * 0.4f64.powi(step);
                let start = Instant::now();
                let (evaluator, report) = solve(
                    configuration,
                    &SolveOptions {
                        strategy, importance: importance.clone(), bounds, tolerance: Some(tolerance), min_element: 1e-5, ..options() },
                );
                let m = measured(evaluator.solution(), &reference);
                let time = start.elapsed().as_secs_f64();
                println!("{name}: tol {tolerance:.4} links {} elements {} L1 {:.4} time {:.1} {:?}", report.counts.links, report.counts.elements, m.l1, time,
                    report.link_error.map(|e| (e.estimated_error, e.splits)));
                if time > 15.0 || report.counts.links > 60_000 {
                    break;
                }
            }
        }
    }
}
