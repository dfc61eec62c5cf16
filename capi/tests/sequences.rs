//! Random sequences of calls, as the fuzz target `calls` plays them.
//!
//! For longer: `PATCHLIGHT_FUZZ_SECONDS=1800 cargo test --release -p patchlight-capi --test sequences -- --ignored --nocapture`.

#[path = "../../fuzz/harness/calls.rs"]
mod calls;

use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Makes a context, options and a scene, adds a tent and commits it, solves and reads, makes a mesh and reads that: what random bytes rarely find by themselves.
const USEFUL: &[u8] = &[
    0, 0, 0, 3, 0, 0, 2, // a context and a scene of one channel
    2, 2, 1, 1, 2, 9, 9, // materials
    2, 2, 0, 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 9, // a square
    2, 2, 2, 0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3, 9, 9, 9, 0, 0, // its triangles
    4, 2, 5, 0, 1, 0, 2, 2, // committed and solved
    6, 2, 1, 1, 60, 2, 2, 2, 0, 1, // radiosities of surfaces
    8, 2, 0, 0, // a mesh
    9, 2, 1, 255, 2, 0, 0, 1, 2, 2, 2, 0, 0, // its nodes
];

fn sequences() -> impl Strategy<Value = Vec<u8>> {
    let any_bytes = proptest::collection::vec(any::<u8>(), 0..300);
    (any::<bool>(), any_bytes).prop_map(|(is_useful, bytes)| if is_useful { [USEFUL, &bytes].concat() } else { bytes })
}

#[test]
fn any_sequence_of_calls_ends_well() {
    assert_eq!(calls::play(USEFUL), [1, 1], "a sequence that makes a solution, and a mesh");
    let config = Config { cases: 300, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    runner
        .run(&sequences(), |bytes| {
            calls::play(&bytes);
            Ok(())
        })
        .unwrap();
}

#[test]
#[ignore = "takes as long as one likes"]
fn many_sequences() {
    let seconds = std::env::var("PATCHLIGHT_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(60);
    let end = Instant::now() + Duration::from_secs(seconds);
    while Instant::now() < end {
        let mut runner = TestRunner::new(Config { cases: 1000, failure_persistence: None, ..Config::default() });
        runner
            .run(&sequences(), |bytes| {
                calls::play(&bytes);
                Ok(())
            })
            .unwrap();
    }
}
