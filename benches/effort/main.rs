//! The powers of the law of effort (`src/solve/effort.rs`), fitted over many scenes.
//!
//! `cargo bench --bench effort` prints, scene by scene, with which power of what is spent on it each part of the square of the error falls, and
//! how large that part is where the law puts it for an error of 2%; then the medians and the range over all scenes. Names of scenes may be
//! given: `cargo bench --bench effort -- room`. Scenes beside the repository take part where they are. `-- pieces` prints instead what a Cornell
//! box takes whose polygons are cut into pieces, with black things around and far below.
//!
//! Values are compared at points, uniform by area, and told relative to the reflected light there. References are values over cells, by another
//! seed and from four times as many positions as the most that is measured.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program that prints tables and tells how far it is")]

#[path = "../support/cpu.rs"]
mod cpu;
mod measure;
mod pieces;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod scenes;
mod table;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use measure::Measured;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    if wanted == ["pieces"] {
        return pieces::print();
    }
    let mut all: Vec<(String, Measured)> = Vec::new();
    for (name, scene) in scenes::all() {
        if wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str())) {
            eprintln!("{name}: {} surfaces", scene.surfaces().len());
            all.push((name, Measured::of(&scene)));
        }
    }
    table::print(&all);
}
