//! In what the tolerances of links are told.

use crate::paths::Illumination;
use crate::scene::{Scene, SurfaceId};

/// In what tolerances are told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// The reflected radiosity for which a tolerance stands, in W/m^2.
    pub radiosity: f64,
    /// The area of the surfaces that count, in m^2.
    pub area: f64,
}

impl Scale {
    /// By what light meets; where that is less than particles tell, as beside a lamp that shines into the void, by what one of them brings: else no
    /// pair would ever carry little enough.
    pub fn of_illumination(illumination: &Illumination) -> Self {
        let area = illumination.lit_area;
        Self { radiosity: illumination.reflected_brightest.max(illumination.of_particle) / area, area }
    }

    /// By areas and materials alone, for the strategies of the papers: what is reflected on average if all surfaces see each other.
    pub fn of_materials(scene: &Scene) -> Self {
        let brightest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let ids = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let area: f64 = ids().map(|id| scene.surface(id).polygon.area()).sum();
        let mean = |of: &dyn Fn(SurfaceId) -> f64| ids().map(|id| scene.surface(id).polygon.area() * of(id)).sum::<f64>() / area;
        let exitance = mean(&|id| brightest(&scene.material_of(id).exitance));
        let reflectance = mean(&|id| brightest(&scene.material_of(id).reflectance)).min(0.999);
        Self { radiosity: exitance * reflectance / (1.0 - reflectance), area }
    }
}
