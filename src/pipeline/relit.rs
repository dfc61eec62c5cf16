//! Solutions that follow from one that is there: other weights of light groups, other materials. The geometry is the same, so visibility is shared.

use std::sync::{Arc, OnceLock};

use super::Evaluator;
use crate::progress::Observer;
use crate::scene::{LightGroupError, LightWeight, Material};
use crate::solve::{ErrorReport, OtherMaterialsError, Solution};

impl Evaluator {
    /// [`Solution::relit`], with the visibility and the threads of this one.
    ///
    /// # Errors
    /// See [`LightGroupError`].
    pub fn relit(&self, weights: &[LightWeight]) -> Result<Self, LightGroupError> {
        Ok(self.of_same_geometry(self.solution.relit(weights)?))
    }

    /// [`Solution::with_materials`], with the visibility and the threads of this one.
    ///
    /// # Errors
    /// See [`OtherMaterialsError`].
    pub fn with_materials(
        &self,
        materials: Vec<Material>,
        observer: &dyn Observer,
    ) -> Result<Option<(Self, ErrorReport)>, OtherMaterialsError> {
        let found = self.pool.install(|| self.solution.with_materials(materials, observer))?;
        Ok(found.map(|(solution, error)| (self.of_same_geometry(solution), error)))
    }

    fn of_same_geometry(&self, solution: Solution) -> Self {
        Self { solution, visibility: Arc::clone(&self.visibility), pool: self.pool.clone(), mesh_index: OnceLock::new() }
    }
}
