//! Why a stage could not start or finish.

use thiserror::Error;

use crate::picture::CameraError;
use crate::scene::LightGroupError;
use crate::solve::{InterestError, OptionsError};
use crate::visibility::VisibilityError;

/// Why a stage could not start or finish.
#[derive(Debug, Error)]
pub enum PipelineError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// There is no such visibility backend, or it failed.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// The camera cannot take a picture.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The scene has nothing of what the answer is wanted for.
    #[error(transparent)]
    Interest(#[from] InterestError),
    /// Light groups with options that know none.
    #[error(transparent)]
    LightGroups(#[from] LightGroupError),
    /// Guaranteed bounds of a scene with lights.
    #[error("guaranteed bounds know light from surfaces alone: leave out the lights, or model them as surfaces that emit")]
    Lights,
    /// A limit of time for a team of processes.
    #[error(
        "several processes that solve together know no limit of time, since their clocks differ: leave it out, or solve in one process"
    )]
    TeamTime,
    /// The processes of a team were given different things to do.
    #[error(
        "the processes that solve together were not given the same scene and options: check that all machines see the same files"
    )]
    TeamDiffers,
    /// The memory budget is less than the solve takes at least; nothing was done.
    #[error(
        "the scene takes {:.3} GB at least before it is solved, and the budget is {:.3} GB: give more memory or fewer surfaces",
        *needed as f64 * 1e-9,
        *given as f64 * 1e-9
    )]
    Memory {
        /// Bytes that are needed at least.
        needed: u64,
        /// Bytes of [`RunOptions::memory_bytes`](crate::solve::RunOptions::memory_bytes).
        given: u64,
    },
    /// The threads could not be started.
    #[error("cannot start {}: {message}", if *threads == 0 { "a thread for each core".to_owned() } else { format!("{threads} threads") })]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        message: String,
    },
}
