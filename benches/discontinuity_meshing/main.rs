//! Discontinuity-driven against regular subdivision: figures 4.4 and 4.5 of Lischinski 1994, on a pyramid under two small triangular lights.
//!
//! `cargo bench --bench discontinuity_meshing` prints tables as Markdown; `-- --plots docs` also draws the figures into docs/. Elements are constant, as in the
//! thesis; the exact solution is the light of the visible parts of the lights, at the vertices of a grid of 400 x 400 on the floor.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

mod exact;
mod figures;
mod ladder;
mod measure;
#[path = "../support/plot.rs"]
mod plot;

use std::path::{Path, PathBuf};

use patchlight::scene::import::{ImportOptions, read_scene};

use exact::Exact;
use ladder::{Comparison, Way};

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let mut plots = None;
    while let Some(argument) = arguments.next() {
        if argument == "--plots" {
            plots = arguments.next().map(PathBuf::from);
        }
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/pyramid.obj");
    let scene = read_scene(&file, &ImportOptions::default()).expect("a scene").scene;
    let exact = Exact::of(&scene);
    let comparisons: Vec<Comparison> = Way::ALL.iter().map(|&way| Comparison::of(way, &scene, &exact)).collect();
    comparisons.iter().for_each(Comparison::print);
    if let Some(folder) = plots {
        figures::draw(&scene, &exact, &comparisons, &folder).expect("the folder can be written");
    }
}
