//! Random rays of what emitters and lights send, by power.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Frame, sampling, streams};
use crate::scene::{Light, LightShape, Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{NO_PLANE, Ray};

/// Directions by which the power of a light is sampled.
const PROBES: u32 = 64;

/// What sends light in a scene, by power.
pub(super) struct Emission<'a> {
    scene: &'a Scene,
    /// A ball around the scene: light from afar is what meets it.
    ball: (DVec3, f64),
    /// With the power of each in W, all channels added.
    sources: Vec<(Source, f64)>,
    /// The power in W of the sources up to each, all channels added.
    up_to: Vec<f64>,
}

/// What sends light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Emitter(SurfaceId),
    /// The number of a light.
    Light(usize),
}

/// A particle that has just been sent.
pub(super) struct Sent {
    pub ray: Ray,
    pub source: Source,
    /// Its power in W for each unit of what its source sends per channel: of exitance, or strength.
    power: f64,
}

impl<'a> Emission<'a> {
    pub fn new(scene: &'a Scene, rays: &Rays<'_>) -> Self {
        let ball = rays.ball();
        let surfaces = (0..scene.surfaces().len() as u32).into_par_iter().map(SurfaceId);
        let emitters: Vec<SurfaceId> = surfaces.filter(|&surface| scene.material_of(surface).emits()).collect();
        let lights = (0..scene.lights().len()).filter(|&light| scene.lights()[light].is_on());
        let sources = emitters.into_iter().map(Source::Emitter).chain(lights.map(Source::Light));
        let mut emission = Self { scene, ball, sources: Vec::new(), up_to: Vec::new() };
        let mut sum = 0.0;
        for source in sources {
            let power = emission.power_of(source);
            sum += power;
            emission.sources.push((source, power));
            emission.up_to.push(sum);
        }
        emission
    }

    /// Of all sources, in W, all channels added: of light from afar all that meets a ball around the scene.
    pub fn power(&self) -> f64 {
        self.up_to.last().copied().unwrap_or(0.0)
    }

    /// That of the emitters alone.
    pub fn power_of_emitters(&self) -> f64 {
        let emitters = self.sources.partition_point(|(source, _)| matches!(source, Source::Emitter(_)));
        if emitters > 0 { self.up_to[emitters - 1] } else { 0.0 }
    }

    /// The power of a source in W, all channels added; of a light sampled.
    fn power_of(&self, source: Source) -> f64 {
        let sent: f64 = self.sent_by(source).iter().sum();
        match source {
            Source::Emitter(surface) => self.scene.surface(surface).polygon.area() * sent,
            Source::Light(light) => {
                let light = &self.scene.lights()[light];
                let sobol = sampling::shifted_sobol_2d(0);
                sent * (0..PROBES).map(|probe| sampled_ray(light, self.ball, sobol(probe), [0.5; 2]).1).sum::<f64>()
                    / f64::from(PROBES)
            }
        }
    }

    /// What a source sends, by channel: exitance, or strength.
    fn sent_by(&self, source: Source) -> &'a [f64] {
        let all = match source {
            Source::Emitter(surface) => &self.scene.material_of(surface).exitance,
            Source::Light(light) => &self.scene.lights()[light].strength,
        };
        &all[..self.scene.deciding()]
    }

    /// Particle number `number` of `count`, drawn systematically by power; something must send light.
    pub fn sampled_particle(&self, number: u32, count: u32, seed: u64) -> Sent {
        let draw = sampling::hash(seed, streams::EMISSION + u64::from(number));
        let wanted = (f64::from(number) + sampling::unit(draw)) / f64::from(count) * self.power();
        let index = self.up_to.partition_point(|&power| power <= wanted).min(self.sources.len() - 1);
        let (source, own) = self.sources[index];
        let numbers = |draw| [streams::SECOND, streams::THIRD].map(|stream| sampling::unit(sampling::hash(draw, stream)));
        let of_direction = sampling::hash(sampling::hash(seed, streams::PARTICLE_BOUNCES), u64::from(number));
        let (place, at) = (numbers(draw), numbers(of_direction));
        let each = self.power() / f64::from(count);
        let (ray, power) = match source {
            Source::Emitter(surface) => {
                let surface = self.scene.surface(surface);
                let facet = surface.polygon.facet();
                let direction = Frame::around(facet.normal).sampled_by_cosine(at[0], at[1]).to_array();
                let origin = facet.point_at(place[0], place[1]).to_array();
                (Ray { origin, direction, origin_plane: surface.plane() }, each / self.sent_by(source).iter().sum::<f64>())
            }
            Source::Light(light) => {
                let (ray, power) = sampled_ray(&self.scene.lights()[light], self.ball, at, place);
                (ray, each * power / own)
            }
        };
        Sent { ray, source, power }
    }

    /// The power of a particle by channel, in W.
    pub fn spectrum(&self, sent: &Sent) -> impl Iterator<Item = f64> + use<'a> {
        let power = sent.power;
        self.sent_by(sent.source).iter().map(move |sent| power * sent)
    }
}

/// A ray of a light, of the direction number `at` and, where light comes from afar, the place number `place` in the disc of a ball that faces it; with
/// the power that the light would have for each unit of strength if all of its rays were like this one, in m^2 or sr.
fn sampled_ray(light: &Light, (centre, radius): (DVec3, f64), at: [f64; 2], place: [f64; 2]) -> (Ray, f64) {
    let [u, v] = at;
    let (towards, irradiance) = match &light.shape {
        LightShape::Point(point) => {
            let (direction, power) = point.sampled_direction(u, v);
            let (origin, direction) = (point.position.to_array(), direction.to_array());
            return (Ray { origin, direction, origin_plane: NO_PLANE }, power);
        }
        LightShape::Sun(sun) => (sun.sampled_direction(u, v), 1.0),
        LightShape::Sky(sky) => {
            let (towards, solid_angle) = sky.sampled_direction(u, v);
            (towards, sky.radiosity(towards) / PI * solid_angle)
        }
    };
    let ([s, t], frame) = (place, Frame::around(towards));
    let (r, (sin, cos)) = (radius * s.sqrt(), (TAU * t).sin_cos());
    let origin = centre + frame.to_world(DVec3::new(r * cos, r * sin, 2.0 * radius));
    (Ray { origin: origin.to_array(), direction: (-towards).to_array(), origin_plane: NO_PLANE }, PI * radius * radius * irradiance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, PointLight, Sides, Sky, Sun};
    use crate::visibility::{Backend, OccluderMesh, build};

    /// A square on the ground, under one light.
    fn power_on_ground(shape: LightShape) -> f64 {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let ground = Polygon::from_vertices(corners.to_vec()).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let light = Light { name: "light".to_owned(), strength: vec![3.0], shape };
        let scene = Scene::new(1, vec![material], vec![(ground, 0, 0)], Sides::Front).unwrap().with_lights(vec![light]).unwrap();
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emission = Emission::new(&scene, &rays);
        let (count, mut hits) = (1 << 16, Vec::new());
        let sent: Vec<Sent> = (0..count).map(|number| emission.sampled_particle(number, count, 5)).collect();
        rays.first_hits(&sent.iter().map(|sent| sent.ray).collect::<Vec<_>>(), &mut hits);
        let arrived = sent.iter().zip(&hits).filter(|(sent, hit)| hit.is_some() && sent.ray.direction[2] < 0.0);
        arrived.map(|(sent, _)| emission.spectrum(sent).sum::<f64>()).sum()
    }

    /// What arrives on four square metres: by an irradiance of 3 W/m^2 through the cosine of a sun at 60 degrees, whole from a sky; from a point light as
    /// high as half a side a sixth of the sphere. 65,536 particles of which a quarter arrives know that to 1%.
    #[test]
    fn particles_bring_what_lights_send() {
        let towards = DVec3::new(0.5, 0.0, 0.75_f64.sqrt());
        let expected = 3.0 * 4.0 * 0.75_f64.sqrt();
        for diameter in [0.0, 0.01] {
            let found = power_on_ground(LightShape::Sun(Sun::new(towards.to_array(), diameter).unwrap()));
            assert!((found / expected - 1.0).abs() < 0.03, "{found} for {expected}");
        }
        let found = power_on_ground(LightShape::Sky(Sky::uniform([0.0, 0.0, 1.0]).unwrap()));
        assert!((found / 12.0 - 1.0).abs() < 0.03, "{found}");
        let found = power_on_ground(LightShape::Point(PointLight::uniform([0.0, 0.0, 1.0])));
        assert!((found / (3.0 * 4.0 * PI / 6.0) - 1.0).abs() < 0.03, "{found}");
    }
}
