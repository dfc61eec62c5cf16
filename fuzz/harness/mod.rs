//! What fuzzers feed with bytes: each function takes any bytes whatever and panics only where patchlight is at fault.
//!
//! The targets of cargo-fuzz call them (`fuzz/fuzz_targets`), and so does the seeded driver that needs no nightly compiler (`tests/fuzz.rs`).
#![allow(dead_code, unused_imports, reason = "each target calls one of them")]

mod bake;
mod bytes;
mod glb;
mod lights;
mod meshes;
mod obj;
mod options;
mod points;
mod solution;
mod solve;
mod triangulation;

pub use bake::read_bake;
pub use glb::read_glb;
pub use lights::read_light_file;
pub use meshes::read_mesh;
pub use obj::read_obj;
pub use options::set_options;
pub use points::read_csv;
pub use solution::{read_solution, small_solution};
pub use solve::solve_scene;
pub use triangulation::triangulate;
