//! The names of backends, and why one cannot be had.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Which code answers visibility queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// Embree where it was built in, else obvhs.
    #[default]
    Auto,
    /// The installed Embree 3 or 4 through wrapper/ (feature `embree`).
    Embree,
    /// The pure-Rust obvhs, with its eight-way tree.
    Obvhs,
    /// obvhs with its binary tree, for the benchmark.
    ObvhsBvh2,
    /// Every triangle, in f64: the reference, for tests and tiny scenes.
    BruteForce,
    /// Embree 4 through the crate embree4-sys (feature `embree4-sys`), for the benchmark. It answers occlusion; first hits are
    /// asked of obvhs, because the crate's declaration of `RTCRayHit` is too small for Embree 4.3 and later.
    Embree4Sys,
}

impl Backend {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 6] = ["auto", "embree", "obvhs", "obvhs-bvh2", "brute-force", "embree4-sys"];

    /// All backends that can be named, in the order of [`Self::NAMES`].
    pub const ALL: [Self; 6] = [Self::Auto, Self::Embree, Self::Obvhs, Self::ObvhsBvh2, Self::BruteForce, Self::Embree4Sys];

    /// The name, as typed on the command line.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Whether this build has it. If so, [`build`](super::build) never answers [`VisibilityError::NotBuilt`].
    pub const fn is_built(self) -> bool {
        match self {
            Self::Auto | Self::Obvhs | Self::ObvhsBvh2 | Self::BruteForce => true,
            Self::Embree => cfg!(has_embree),
            Self::Embree4Sys => cfg!(feature = "embree4-sys"),
        }
    }
}

impl FromStr for Backend {
    type Err = VisibilityError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let index = Self::NAMES.iter().position(|&known| known == name);
        index.map(|index| Self::ALL[index]).ok_or_else(|| VisibilityError::UnknownBackend(name.to_owned()))
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
    /// The mesh is inconsistent, or a vertex is not finite.
    #[error("the triangles that occlude cannot be used: {0}")]
    BadMesh(String),
    /// The machine has no memory left for it.
    #[error("out of memory: {backend} cannot be built over this scene")]
    OutOfMemory {
        /// Its name.
        backend: &'static str,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_parsed_and_printed() {
        for (name, backend) in Backend::NAMES.into_iter().zip(Backend::ALL) {
            assert_eq!(name.parse::<Backend>(), Ok(backend));
            assert_eq!(backend.name(), name);
        }
        assert!(matches!("embree5".parse::<Backend>(), Err(VisibilityError::UnknownBackend(_))));
    }
}
