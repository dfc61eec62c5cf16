//! The main algorithm on one screen: refine, gather, push-pull, good enough?

mod options;
mod report;
mod solution;

pub use options::{OptionsError, RunOptions, SolveOptions, Strategy};
pub use report::{Counts, Energy, ErrorReport, SolveReport, StageTimes, StoppedBy};
pub use solution::Solution;
