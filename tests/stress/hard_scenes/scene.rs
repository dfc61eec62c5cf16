//! A scene and what is known about its light.

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};

use crate::rooms::Room;

/// B at a point of a surface.
type Truth = Box<dyn Fn(&SurfacePoint, usize) -> f64>;

/// A scene and what is known about it.
pub struct HardScene {
    pub name: String,
    pub scene: Scene,
    pub truth: Option<Truth>,
}

impl HardScene {
    pub fn new(name: impl Into<String>, scene: Scene, truth: impl Fn(&SurfacePoint, usize) -> f64 + 'static) -> Self {
        Self { name: name.into(), scene, truth: Some(Box::new(truth)) }
    }

    /// Everything has radiosity 1.
    pub fn uniform(name: impl Into<String>, room: Room) -> Self {
        Self::new(name, room.scene(), |_, _| 1.0)
    }

    /// Nothing reflects any light that arrives.
    pub fn emitted_alone(name: impl Into<String>, room: Room) -> Self {
        let scene = room.scene();
        let exitances: Vec<f64> = exitances(&scene).collect();
        Self::new(name, scene, move |_, surface| exitances[surface])
    }

    /// Light comes from lamps alone, and nothing is in front of them.
    pub fn direct(name: impl Into<String>, room: Room) -> Self {
        let scene = room.scene();
        let exitances = exitances(&scene);
        let lamps: Vec<(f64, Polygon)> =
            exitances.zip(scene.surfaces()).map(|(e, surface)| (e, surface.polygon.clone())).filter(|(e, _)| *e > 0.0).collect();
        let materials: Vec<[f64; 2]> = (0..scene.surfaces().len() as u32)
            .map(|id| scene.material_of(SurfaceId(id)))
            .map(|material| [material.reflectance[0], material.exitance[0]])
            .collect();
        Self::new(name, scene, move |point, surface| {
            let irradiance = |(e, lamp): &(f64, Polygon)| e * point_form_factor(point.position, point.normal, lamp);
            let [rho, exitance] = materials[surface];
            exitance + if rho > 0.0 { rho * lamps.iter().map(irradiance).sum::<f64>() } else { 0.0 }
        })
    }
}

fn exitances(scene: &Scene) -> impl Iterator<Item = f64> {
    (0..scene.surfaces().len() as u32).map(|id| scene.material_of(SurfaceId(id)).exitance[0])
}
