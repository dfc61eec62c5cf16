//! `cargo fuzz run meshes`: see the harness.
#![no_main]

#[path = "../harness/mod.rs"]
mod harness;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| harness::read_mesh(bytes));
