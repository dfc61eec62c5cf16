//! Diffuse materials.

use serde::{Deserialize, Serialize};

use super::SceneError;

/// A diffuse material: reflectance and exitance per channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Its name in the input.
    pub name: String,
    /// Reflectance rho per channel, in [0, 1).
    pub reflectance: Vec<f64>,
    /// Exitance E per channel in W/m^2, not negative. An OBJ `Ke` is a radiance: E = pi Ke.
    pub exitance: Vec<f64>,
}

impl Material {
    /// Whether any channel emits.
    pub fn emits(&self) -> bool {
        self.exitance.iter().any(|&e| e > 0.0)
    }

    pub(super) fn validate(&self, channels: usize) -> Result<(), SceneError> {
        let bad = |reason: String| Err(SceneError::BadMaterial { name: self.name.clone(), reason });
        if self.reflectance.len() != channels || self.exitance.len() != channels {
            return bad(format!("it has {} and {} channels, the scene {channels}", self.reflectance.len(), self.exitance.len()));
        }
        if let Some(rho) = self.reflectance.iter().find(|rho| !(0.0..1.0).contains(*rho)) {
            return bad(format!("reflectance {rho} is not in [0, 1)"));
        }
        if let Some(exitance) = self.exitance.iter().find(|e| !e.is_finite() || **e < 0.0) {
            return bad(format!("exitance {exitance} W/m^2 is negative or not finite"));
        }
        Ok(())
    }
}
