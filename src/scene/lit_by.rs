//! The lights of a scene.

use glam::DVec3;

use super::{Light, LightShape, Scene, SceneError, Sky};

impl Scene {
    /// Its lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The same surfaces under these lights, without light groups.
    ///
    /// # Errors
    /// [`SceneError::BadLight`] for one that does not fit the scene's channels, or whose numbers are out of range.
    pub fn with_lights(self, lights: Vec<Light>) -> Result<Self, SceneError> {
        let scene = Self { lights, light_groups: None, ..self };
        scene.check_lights()?;
        Ok(scene)
    }

    /// Every light must have as many channels as the scene, with values in range.
    pub(super) fn check_lights(&self) -> Result<(), SceneError> {
        self.lights.iter().try_for_each(|light| light.validate(self.channels))
    }

    /// Whether nothing in it sends light.
    pub(crate) fn is_dark(&self) -> bool {
        let emits = self.surfaces.iter().any(|surface| self.materials[surface.material as usize].emits());
        !emits && !self.lights.iter().any(Light::is_on)
    }

    /// Adds `weight` times the radiance of the skies in a direction, times pi, by channel in W/m^2.
    pub(crate) fn add_sky_radiosity(&self, direction: DVec3, weight: f64, sum: &mut [f64]) {
        for (sky, light) in self.skies() {
            let weight = weight * sky.radiosity(direction);
            sum.iter_mut().zip(&light.strength).for_each(|(sum, strength)| *sum += weight * strength);
        }
    }

    /// Whether there is a sky, and on.
    pub(crate) fn has_sky(&self) -> bool {
        self.skies().next().is_some()
    }

    /// The irradiance on open level ground under its skies, by channel in W/m^2, without that of suns; `None` where no sky is on.
    pub fn irradiance_of_skies(&self) -> Option<Vec<f64>> {
        let mut sum = vec![0.0; self.channels];
        self.skies().for_each(|(_, light)| sum.iter_mut().zip(&light.strength).for_each(|(sum, strength)| *sum += strength));
        self.has_sky().then_some(sum)
    }

    /// Whether skies send all light that there is.
    pub fn is_lit_by_skies_alone(&self) -> bool {
        let emits = self.surfaces.iter().any(|surface| self.materials[surface.material as usize].emits());
        let is_sky = |light: &Light| matches!(light.shape, LightShape::Sky(_));
        !emits && self.has_sky() && self.lights.iter().filter(|light| light.is_on()).all(is_sky)
    }

    /// The lights that are skies, and on.
    fn skies(&self) -> impl Iterator<Item = (&Sky, &Light)> {
        self.lights.iter().filter(|light| light.is_on()).filter_map(|light| match &light.shape {
            LightShape::Sky(sky) => Some((sky, light)),
            LightShape::Point(_) | LightShape::Sun(_) => None,
        })
    }
}
