//! Form factors through clusters at many resolutions: the experiment of Soler and Sillion 1996, section 8.2, figures 4 and 5, and other clusters beside.
//!
//! `cargo bench --bench multiresolution96` prints tables as Markdown, in some seconds; `-- --plots docs` also draws the figures into docs/. All results are
//! held against the exact form factor, with every occluder.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

mod clusters;
#[path = "../support/cpu.rs"]
mod cpu;
mod figures;
mod measure;
#[path = "../support/plot.rs"]
mod plot;
mod tables;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::PathBuf;

use clusters::Shape;
use measure::Ladder;

fn main() {
    let mut arguments = std::env::args().skip(1).skip_while(|argument| argument != "--plots").skip(1);
    let ladders: Vec<Ladder> = Shape::ALL.into_iter().map(Ladder::of).collect();
    tables::print(&ladders);
    if let Some(folder) = arguments.next().map(PathBuf::from) {
        figures::draw(&ladders, &folder).expect("the folder can be written");
    }
}
