//! The choice of a backend: the one place where concrete backends are named.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{
    OccluderMesh, Visibility,
    brute_force::BruteForce,
    obvhs::{Obvhs, Tree},
};

/// Which code answers visibility queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// Embree where it was built in, else obvhs.
    #[default]
    Auto,
    /// The installed Embree 3 or 4 through wrapper/ (feature `embree`).
    Embree,
    /// The pure-Rust obvhs, with the tree that was the faster one wherever it was measured: the eight-way one.
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

    /// Whether this build has it. If so, [`build`] never answers [`VisibilityError::NotBuilt`].
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
    /// The native library reported an error.
    #[error("{backend} failed: {message}")]
    Native {
        /// Its name.
        backend: &'static str,
        /// What it said.
        message: String,
    },
}

/// Builds the structure that answers queries over `mesh`, on the calling thread. The mesh is not needed any more afterwards.
///
/// # Errors
/// [`VisibilityError::BadMesh`] for a mesh with a vertex that is not finite, an index out of range or lists of different lengths,
/// [`VisibilityError::NotBuilt`] where this build lacks the backend, [`VisibilityError::Native`] where the library fails.
pub fn build(backend: Backend, mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    mesh.validate()?;
    match backend {
        Backend::Auto if Backend::Embree.is_built() => embree(mesh),
        Backend::Embree => embree(mesh),
        Backend::Auto | Backend::Obvhs => Ok(Box::new(Obvhs::new(mesh, Tree::CwBvh))),
        Backend::ObvhsBvh2 => Ok(Box::new(Obvhs::new(mesh, Tree::Bvh2))),
        Backend::BruteForce => Ok(Box::new(BruteForce::new(mesh))),
        Backend::Embree4Sys => embree4_sys(mesh),
    }
}

#[cfg(has_embree)]
fn embree(mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    Ok(Box::new(super::embree::Embree::new(mesh)?))
}

#[cfg(not(has_embree))]
fn embree(_mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    let reason = if cfg!(feature = "embree") {
        "Embree was not found when it was built; install it (apt-get install libembree-dev libclang-dev) and build again, or use obvhs"
    } else {
        "it was built without the feature 'embree'; build it with that feature, or use obvhs"
    };
    Err(VisibilityError::NotBuilt { backend: Backend::Embree.name(), reason })
}

#[cfg(feature = "embree4-sys")]
fn embree4_sys(mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    Ok(Box::new(super::embree4_sys::Embree4Sys::new(mesh)?))
}

#[cfg(not(feature = "embree4-sys"))]
fn embree4_sys(_mesh: &OccluderMesh) -> Result<Box<dyn Visibility>, VisibilityError> {
    let reason = "it was built without the feature 'embree4-sys', which needs Embree 4; build it with that feature, or use embree";
    Err(VisibilityError::NotBuilt { backend: Backend::Embree4Sys.name(), reason })
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

    #[test]
    fn a_backend_is_built_or_says_what_to_do() {
        for backend in Backend::ALL {
            match build(backend, &OccluderMesh::default()) {
                Ok(_) => assert!(backend.is_built()),
                Err(VisibilityError::NotBuilt { backend: name, reason }) => {
                    assert!(!backend.is_built());
                    assert_eq!(name, backend.name());
                    assert!(reason.contains("build"), "{reason}");
                }
                Err(error) => panic!("{error}"),
            }
        }
    }
}
