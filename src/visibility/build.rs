//! From the name of a backend to what answers: the one place where concrete backends are named.

use super::{
    Backend, OccluderMesh, Visibility, VisibilityError,
    brute_force::BruteForce,
    obvhs::{Obvhs, Tree},
};

/// Builds the structure that answers queries over `mesh`, on the calling thread. The mesh is not needed any more afterwards.
///
/// # Errors
/// [`VisibilityError::BadMesh`] for a mesh with a vertex that is not finite, an index out of range or lists of different lengths,
/// [`VisibilityError::NotBuilt`] where this build lacks the backend, [`VisibilityError::Native`] where the library fails, and
/// [`VisibilityError::OutOfMemory`] where the machine has no more.
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
