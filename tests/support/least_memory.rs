//! The least memory with which a scene is solved at all.

use patchlight::pipeline::{self, PipelineError};
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::solve::{RunOptions, SolveOptions};

/// What a solve says that it needs at least, in bytes, if it is given next to nothing.
pub fn least_bytes(scene: Scene) -> u64 {
    let run = RunOptions { memory_bytes: Some(1), ..RunOptions::default() };
    match pipeline::solve(scene, &SolveOptions::default(), &run, &Silent) {
        Err(PipelineError::Memory { needed, given: 1 }) => needed,
        other => panic!("{:?}", other.map(|_| "solved in one byte")),
    }
}
