//! `cargo fuzz run calls`: see the harness.
#![no_main]

#[path = "../harness/calls.rs"]
mod calls;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    calls::play(bytes);
});
