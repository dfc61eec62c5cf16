//! Radiosity at points: methods A to D of Lischinski 1994, section 4.3.3, beside the library's own, on global solutions from coarse to
//! fine: figure 4.10 and tables 4.1 and 4.4 for this implementation, beside what the thesis says of its own.
//!
//! `cargo bench --bench local_pass` prints tables as Markdown, in about a minute; `-- --plots docs` also draws the figures into docs/;
//! names of scenes leave out the others. Errors are those of radiosities at points uniform by area against a fine solution over links,
//! which is itself held against one over cells.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
mod curves;
mod figures;
mod measure;
#[path = "../support/plot.rs"]
mod plot;
#[path = "../support/points.rs"]
mod points;
mod tables;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::PathBuf;

use measure::measure;

/// Where the methods are compared; of larger scenes a reference so good takes hours.
const SCENES: [&str; 1] = ["exhibit_room"];

/// Scenes whose discontinuities are counted.
const COUNTED: [&str; 4] = ["exhibit_room", "sunlit_room", "gallery", "panelled_room"];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut names, mut plots) = (Vec::new(), None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--plots" => plots = arguments.next().map(PathBuf::from),
            _ => names.push(argument),
        }
    }
    let is_chosen = |name: &&str| names.is_empty() || names.iter().any(|chosen| chosen == name);
    for name in SCENES.into_iter().filter(is_chosen) {
        let ladder = measure(name);
        tables::print(&ladder);
        if let Some(folder) = &plots {
            figures::draw(&ladder, folder).expect("the folder can be written");
        }
    }
    curves::print(COUNTED.into_iter().filter(is_chosen));
}
