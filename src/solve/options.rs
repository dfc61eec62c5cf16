//! What may be asked of a solve.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::visibility::Backend;

/// How pairs of nodes are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Brightness-weighted refinement in which the receiver's area counts: what the measurements say is best.
    #[default]
    Default,
    /// BF refinement with multigridding as in Hanrahan, Salzman, Aupperle 1991.
    Hanrahan91,
    /// Every surface split to the same depth, every pair of elements linked.
    Uniform,
}

impl Strategy {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 3] = ["default", "hanrahan91", "uniform"];
}

impl FromStr for Strategy {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "default" => Ok(Self::Default),
            "hanrahan91" => Ok(Self::Hanrahan91),
            "uniform" => Ok(Self::Uniform),
            _ => Err(OptionsError::UnknownStrategy(name.to_owned())),
        }
    }
}

/// An option outside its legal range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OptionsError {
    /// The name is none of [`Strategy::NAMES`].
    #[error("unknown strategy '{0}'; choose one of {list}", list = Strategy::NAMES.join(", "))]
    UnknownStrategy(String),
    /// A number is out of range.
    #[error("{option} is {value}, it must be {range}")]
    OutOfRange {
        /// The option's key.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is legal.
        range: &'static str,
    },
    /// `--set` names no option.
    #[error("unknown option '{0}'")]
    UnknownKey(String),
}

/// What decides the answer: kept in the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolveOptions {
    /// Requested error in the norm `||B - B_true|| / ||B_true - E||` over all surfaces, channels pooled; in (0, 1). Default 0.02.
    pub error: f64,
    /// How pairs are refined.
    pub strategy: Strategy,
    /// Seed of every random choice.
    pub seed: u64,
    /// Stop refining at this many links.
    pub max_links: Option<u64>,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self { error: 0.02, strategy: Strategy::Default, seed: 0, max_links: None }
    }
}

impl SolveOptions {
    /// Rejects values outside their range; never clamps.
    ///
    /// # Errors
    /// [`OptionsError::OutOfRange`] names the option and its range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        if self.error.is_nan() || self.error <= 0.0 || self.error >= 1.0 {
            return Err(OptionsError::OutOfRange { option: "error", value: self.error.to_string(), range: "above 0 and below 1" });
        }
        Ok(())
    }

    /// Sets one option from text, as `--set key=value` does.
    ///
    /// # Errors
    /// [`OptionsError`] for an unknown key or a value that does not parse or is out of range.
    pub fn set(&mut self, key: &str, _value: &str) -> Result<(), OptionsError> {
        Err(OptionsError::UnknownKey(key.to_owned()))
    }
}

/// How the run goes; none of it changes the answer, except that limits may end it early.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Worker threads; 0 takes one per core.
    pub threads: usize,
    /// Which code answers visibility queries.
    pub backend: Backend,
    /// Stop after this many seconds of wall time.
    pub time_s: Option<f64>,
    /// Stop when the solution would take more than this many bytes.
    pub memory_bytes: Option<u64>,
}
