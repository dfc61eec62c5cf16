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
    /// Exitance E per channel in W/m^2: 0, or from 1e-30 to 1e36. An OBJ `Ke` is a radiance: E = pi Ke.
    pub exitance: Vec<f64>,
}

/// Below this squares of radiosities vanish in f64, and with them the claimed error: in W/m^2.
const LEAST_EXITANCE: f64 = 1e-30;

impl Material {
    /// No radiosity may exceed this, in W/m^2: results are stored in f32, and noise is to fit as well.
    pub const MOST_RADIOSITY: f64 = 1e36;

    /// Whether any channel reflects.
    pub fn reflects(&self) -> bool {
        self.reflectance.iter().any(|&rho| rho > 0.0)
    }

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
        if let Some(exitance) = self.exitance.iter().find(|e| **e > 0.0 && **e < LEAST_EXITANCE) {
            return bad(format!(
                "exitance {exitance:e} W/m^2 is below {LEAST_EXITANCE:e}: make it 0, or choose another unit of light"
            ));
        }
        Ok(())
    }

    /// Rejects an exitance that surroundings of these reflectances, by channel, might reflect up to more than [`Material::MOST_RADIOSITY`]:
    /// no radiosity exceeds the largest exitance divided by `1 - rho_max`.
    pub(super) fn check_brightness(&self, highest_reflectance: &[f64]) -> Result<(), SceneError> {
        for (&exitance, rho) in self.exitance.iter().zip(highest_reflectance) {
            if exitance > Self::MOST_RADIOSITY * (1.0 - rho) {
                let most = Self::MOST_RADIOSITY;
                let reason = format!(
                    "exitance {exitance:e} W/m^2 among reflectances of up to {rho} may bring radiosities of more than {most:e} W/m^2"
                );
                return Err(SceneError::BadMaterial { name: self.name.clone(), reason });
            }
        }
        Ok(())
    }
}
