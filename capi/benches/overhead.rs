//! What the C interface costs: a thousand small solves by it and by the Rust library in turns, and two at once on two threads.
//!
//! ```text
//! cargo bench -p patchlight-capi [-- SOLVES]
//! ```
#![allow(clippy::print_stdout, reason = "a benchmark tells what it measured")]

#[path = "../tests/support/calls.rs"]
mod support;

use std::ffi::CString;
use std::ptr::null_mut;
use std::time::Instant;

use patchlight::pipeline::{Workers, solve_on};
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use patchlight_capi::patchlight_items::PATCHLIGHT_SURFACES;
use patchlight_capi::patchlight_real::PATCHLIGHT_RADIOSITY;
use patchlight_capi::*;
use rustix::time::{ClockId, clock_gettime};
use support::{context, done, info, options, reals};

const CORNELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell.obj");

/// What a program in C has.
#[derive(Clone, Copy)]
struct InC {
    context: *mut patchlight_context,
    scene: *mut patchlight_scene,
    options: *mut patchlight_options,
}

// SAFETY: Handles are numbers, and any thread may use any of them.
unsafe impl Send for InC {}

impl InC {
    fn new() -> Self {
        let (context, mut scene) = (context(1), null_mut());
        let path = CString::new(CORNELL).expect("a path without a zero");
        // SAFETY: A place for a handle, and a text that ends in a zero.
        unsafe {
            done(patchlight_scene_create(context, 3, 0, &mut scene));
            done(patchlight_scene_add_file(scene, path.as_ptr(), 0));
            done(patchlight_scene_commit(scene));
        }
        Self { context, scene, options: options(&[("error", "0.1")]) }
    }

    fn solve(self) -> f64 {
        let mut solution = null_mut();
        // SAFETY: A struct with its size, and a place for a handle.
        done(unsafe { patchlight_solve(self.context, self.scene, &info(self.options), &mut solution) });
        let first = reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY)[0];
        done(patchlight_solution_release(solution));
        first
    }

    fn release(self) {
        done(patchlight_options_release(self.options));
        done(patchlight_scene_release(self.scene));
        done(patchlight_context_release(self.context));
    }
}

fn solve_in_rust(workers: &Workers, scene: &Scene) -> f64 {
    let options = SolveOptions { error: 0.1, ..SolveOptions::default() };
    let (lit, _) = solve_on(workers.clone(), scene.clone(), &options, &RunOptions::default(), &Silent).expect("legal options");
    let (lit, hierarchy) = (lit.solution(), lit.solution().hierarchy());
    lit.radiosity().of(hierarchy.node_of(patchlight::scene::SurfaceId(0)))[0]
}

fn cpu_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The quantile of numbers.
fn quantile(numbers: &mut [f64], part: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[((numbers.len() - 1) as f64 * part).round() as usize]
}

/// By C and by Rust in turns, so that other work on the machine is shared by both.
fn overhead(solves: usize) {
    let (in_c, workers) = (InC::new(), Workers::new(1).expect("a thread"));
    let scene = read_scene(CORNELL.as_ref(), &ImportOptions::default()).expect("a scene that comes along").scene;
    assert_eq!(in_c.solve(), solve_in_rust(&workers, &scene), "both ways give the same");
    let (mut by_c, mut by_rust) = (Vec::new(), Vec::new());
    for turn in 0..solves {
        for way in [turn % 2, 1 - turn % 2] {
            let start = cpu_s();
            let times = if way == 0 {
                in_c.solve();
                &mut by_c
            } else {
                solve_in_rust(&workers, &scene);
                &mut by_rust
            };
            times.push(1e3 * (cpu_s() - start));
        }
    }
    in_c.release();
    let [c, rust] = [by_c.iter().sum::<f64>(), by_rust.iter().sum()];
    println!("{solves} solves of Cornell at 10%, one thread, CPU time in ms\n");
    println!("| way | 10% | median | 90% | sum |\n|---|---|---|---|---|");
    for (name, times) in [("C", &mut by_c), ("Rust", &mut by_rust)] {
        let [low, median, high] = [0.1, 0.5, 0.9].map(|part| quantile(times, part));
        println!("| {name} | {low:.3} | {median:.3} | {high:.3} | {:.0} |", times.iter().sum::<f64>());
    }
    let medians = quantile(&mut by_c, 0.5) / quantile(&mut by_rust, 0.5);
    println!("\noverhead of C: {:.2}% by medians, {:.2}% by sums\n", 100.0 * (medians - 1.0), 100.0 * (c / rust - 1.0));
}

/// One thread, and two threads at once, each with a context of one worker. By wall-clock time it needs two idle cores; by CPU time it tells
/// what the solves cost each other, whatever else runs.
fn at_once(solves: usize) {
    let seconds_of = |threads: usize| {
        let hosts: Vec<InC> = (0..threads).map(|_| InC::new()).collect();
        let (start, cpu) = (Instant::now(), cpu_s());
        std::thread::scope(|scope| {
            for &host in &hosts {
                scope.spawn(move || {
                    let host = { host };
                    for _ in 0..solves {
                        host.solve();
                    }
                });
            }
        });
        let seconds = [start.elapsed().as_secs_f64(), cpu_s() - cpu];
        hosts.into_iter().for_each(InC::release);
        seconds
    };
    let runs: Vec<[[f64; 2]; 2]> = (0..9).map(|_| [seconds_of(1), seconds_of(2)]).collect();
    let mut wall: Vec<f64> = runs.iter().map(|[one, two]| 2.0 * one[0] / two[0]).collect();
    let mut cpu: Vec<f64> = runs.iter().map(|[one, two]| 2.0 * 2.0 * one[1] / two[1]).collect();
    for (name, gains) in [("wall-clock", &mut wall), ("CPU", &mut cpu)] {
        let [low, median, high] = [0.0, 0.5, 1.0].map(|part| quantile(gains, part));
        println!("two solves at once do {median:.2} times what one does by {name} time (median of 9; {low:.2} to {high:.2})");
    }
}

fn main() {
    let solves = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(1000);
    overhead(solves);
    at_once(solves.div_ceil(20));
}
