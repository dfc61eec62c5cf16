//! What a solve begins with, beside the scene.

use super::interest::InitialImportance;
use crate::hierarchy::Hierarchy;

/// What a solve begins with, beside the scene.
pub(crate) struct Beginning {
    /// Clusters over the surfaces of the scene, nothing subdivided yet.
    pub hierarchy: Hierarchy,
    /// What error-driven refinement looks at, and no other.
    pub importance: InitialImportance,
}
