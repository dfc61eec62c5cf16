//! What a measuring plane tells: illuminances with their summary, and how they compare with those outdoors.

use super::{Illuminances, Quantity};
use crate::picture::MeasuringPlane;
use crate::scene::Scene;
use crate::values::{Irradiances, Summary};

/// A measuring plane, and what its sensors measured.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPlane {
    /// What it is called, such as what was typed.
    pub name: String,
    /// Where it is.
    pub plane: MeasuringPlane,
    /// Of all its sensors in their order; not a number where nothing was measured.
    pub irradiances: Irradiances,
}

/// What a plane shows, and how it compares with open ground.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownPlane {
    /// Illuminance; or of channels of which it is not known what an eye sees, irradiance, their mean.
    pub quantity: Quantity,
    /// By sensor in its unit, with standard errors.
    pub values: Illuminances,
    /// Mean, extremes and uniformity; `None` where nothing was measured.
    pub summary: Option<Summary>,
    /// The same quantity on open level ground under the skies of the scene, without suns; `None` where no sky is on.
    pub outdoors: Option<f64>,
}

impl MeasuredPlane {
    /// What is shown of it in a scene.
    pub fn shown(&self, scene: &Scene) -> ShownPlane {
        let (quantity, values) = shown(&self.irradiances);
        let numbers = values.lux.iter().zip(&values.standard_error).map(|(&value, &error)| [value, error]);
        let summary = Summary::of(numbers);
        let outdoors = scene.irradiance_of_skies().map(|of_skies| {
            let irradiance = of_skies.iter().map(|&h| h as f32).collect();
            let standard_error = vec![0.0; of_skies.len()];
            f64::from(shown(&Irradiances { channels: of_skies.len(), irradiance, standard_error }).1.lux[0])
        });
        ShownPlane { quantity, values, summary, outdoors }
    }
}

impl ShownPlane {
    /// The daylight factor of a value, 0 to 1: what arrives over what arrives on open level ground under the same sky (EN 12665), as far as all light is
    /// that of skies; `None` without one.
    pub fn daylight_factor(&self, value: f64, scene: &Scene) -> Option<f64> {
        let outdoors = self.outdoors.filter(|&outdoors| outdoors > 0.0 && scene.is_lit_by_skies_alone())?;
        Some(value / outdoors)
    }
}

/// Illuminances, or means of irradiances over the channels.
fn shown(irradiances: &Irradiances) -> (Quantity, Illuminances) {
    if let Some(illuminances) = Illuminances::of(irradiances) {
        return (Quantity::Illuminance, illuminances);
    }
    let channels = irradiances.channels;
    let mean = |numbers: &[f32]| numbers.chunks(channels).map(|of| of.iter().sum::<f32>() / channels as f32).collect();
    let means = Illuminances { lux: mean(&irradiances.irradiance), standard_error: mean(&irradiances.standard_error) };
    (Quantity::Irradiance, means)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Light, LightShape, Material, Sides, Sky, SkyLight};

    fn scene(channels: usize, exitance: f64, sky: Option<Vec<f64>>) -> Scene {
        let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        let grey = Material { name: String::new(), reflectance: vec![0.5; channels], exitance: vec![exitance; channels] };
        let scene = Scene::new(channels, vec![grey], vec![(Polygon::new(&corners).unwrap(), 0, 0)], Sides::Front).unwrap();
        let shape = LightShape::Sky(Sky::new([0.0, 1.0, 0.0], SkyLight::Overcast, 0.0).unwrap());
        let lights = sky.map(|strength| Light { name: "sky".into(), strength, shape }).into_iter().collect();
        scene.with_lights(lights).unwrap()
    }

    fn plane(channels: usize) -> MeasuredPlane {
        let plane = MeasuringPlane { origin: [0.0; 3], edges: [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]], counts: [2, 1] };
        let irradiance = [vec![1.0; channels], vec![3.0; channels]].concat();
        let irradiances = Irradiances { channels, irradiance, standard_error: vec![0.1; 2 * channels] };
        MeasuredPlane { name: "height=0".into(), plane, irradiances }
    }

    #[test]
    fn a_daylight_factor_is_what_arrives_over_what_arrives_on_open_ground() {
        let sky = scene(3, 0.0, Some(vec![10.0; 3]));
        let shown = plane(3).shown(&sky);
        let summary = shown.summary.unwrap();
        assert!((summary.mean - 358.0).abs() < 1e-3 && (summary.uniformity() - 0.5).abs() < 1e-6, "{summary:?}");
        assert!((shown.outdoors.unwrap() - 1790.0).abs() < 1e-3);
        assert!((shown.daylight_factor(summary.mean, &sky).unwrap() - 0.2).abs() < 1e-6);
    }

    #[test]
    fn lamps_beside_the_sky_leave_no_daylight_factor() {
        let of = |scene: &Scene| plane(3).shown(scene).daylight_factor(1.0, scene);
        assert_eq!(of(&scene(3, 1.0, Some(vec![10.0; 3]))), None);
        assert_eq!(of(&scene(3, 0.0, None)), None);
        assert_eq!(of(&scene(3, 0.0, Some(vec![0.0; 3]))), None);
    }

    #[test]
    fn of_bands_the_mean_is_shown() {
        let bands = scene(2, 0.0, Some(vec![4.0, 6.0]));
        let shown = plane(2).shown(&bands);
        assert_eq!(
            (shown.quantity, shown.values.lux.as_slice(), shown.outdoors),
            (Quantity::Irradiance, &[1.0, 3.0][..], Some(5.0))
        );
    }
}
