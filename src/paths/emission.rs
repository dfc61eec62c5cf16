//! Random points on emitters, by what these emit.

use glam::DVec3;

use crate::geometry::{sampling, streams};
use crate::scene::{Scene, SurfaceId};

/// The emitters of a scene, by power.
pub(super) struct Emission<'a> {
    scene: &'a Scene,
    emitters: Vec<SurfaceId>,
    /// The power in W of the emitters up to each, all channels added.
    up_to: Vec<f64>,
}

impl<'a> Emission<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let surfaces = (0..scene.surfaces().len() as u32).map(SurfaceId);
        let emitters: Vec<SurfaceId> = surfaces.filter(|&surface| scene.material_of(surface).emits()).collect();
        let mut sum = 0.0;
        let up_to = emitters.iter().map(|&emitter| {
            sum += scene.surface(emitter).polygon.area() * exitance(scene, emitter);
            sum
        });
        let up_to = up_to.collect();
        Self { scene, emitters, up_to }
    }

    /// Of all emitters, in W, all channels added.
    pub fn power(&self) -> f64 {
        self.up_to.last().copied().unwrap_or(0.0)
    }

    /// Point number `number` of `count`, drawn systematically by power; there must be an emitter.
    pub fn sampled_point(&self, number: u32, count: u32, seed: u64) -> (SurfaceId, DVec3) {
        let draw = sampling::hash(seed, streams::EMISSION + u64::from(number));
        let wanted = (f64::from(number) + sampling::unit(draw)) / f64::from(count) * self.power();
        let index = self.up_to.partition_point(|&power| power <= wanted).min(self.emitters.len() - 1);
        let emitter = self.emitters[index];
        let [u, v] = [streams::SECOND, streams::THIRD].map(|number| sampling::unit(sampling::hash(draw, number)));
        (emitter, self.scene.surface(emitter).polygon.facet().point_at(u, v))
    }

    /// The power of one of `count` particles from an emitter, by channel, in W.
    pub fn spectrum(&self, emitter: SurfaceId, count: u32) -> impl Iterator<Item = f64> {
        let per_exitance = self.power() / f64::from(count) / exitance(self.scene, emitter);
        self.scene.material_of(emitter).exitance[..self.scene.deciding()].iter().map(move |e| e * per_exitance)
    }
}

/// In W/m^2, all channels added.
fn exitance(scene: &Scene, surface: SurfaceId) -> f64 {
    scene.material_of(surface).exitance[..scene.deciding()].iter().sum()
}
