//! Bottom-up refinement: tables 1 to 3 of Chang, Shih 1998 for this implementation beside the paper's, with how far all links are
//! from what is exact, and top-down linking beside it.
//!
//! `cargo bench --bench bottom_up` prints them as Markdown; with `four_polygons` or `living_room` after `--` only those of that
//! scene. All runs share samples, visibility, elements and the tolerance F_eps, on one thread; what differs is which links are
//! made.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
mod exact;
mod four_polygons;
mod living_room;
mod paper;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod run;
mod table;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

fn main() {
    let names: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let is_chosen = |name: &str| names.is_empty() || names.iter().any(|chosen| chosen == name);
    if is_chosen("four_polygons") {
        four_polygons::tables();
    }
    if is_chosen("living_room") {
        living_room::tables();
    }
}
