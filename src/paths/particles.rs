//! Where light goes: the power that each surface reflects, by particles from the emitters (Pattanaik, Mudur 1992).
//!
//! What follows from it is what light meets, and nothing else: black things, and things that light hardly reaches, count by the little
//! that they reflect. Cost: [`PARTICLES`] paths.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::emission::{Emission, Sent, Source};
use crate::geometry::{Frame, sampling, streams};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Ray;

/// Enough to know sums over all surfaces to some percent.
const PARTICLES: u32 = 2048;

/// Particles that are still there after so many bounces are given up: of a reflectance of 0.99 half a percent of the light.
const MAX_BOUNCES: u64 = 512;

/// What light meets, all channels added.
#[derive(Clone, Debug)]
pub(crate) struct Illumination {
    /// In W: by emitters, and by lights as far as that meets anything.
    pub emitted: f64,
    /// The power of each particle, in W.
    pub of_particle: f64,
    /// What surfaces reflect, in W.
    pub reflected: f64,
    /// In the channel in which it is most, in W.
    pub reflected_brightest: f64,
    /// `(integral of b)^2 / integral of b^2` with the reflected radiosity b, in m^2: the area of the surfaces if all were equally bright, and
    /// of the bright ones if others are dark.
    pub lit_area: f64,
    /// Where particles landed.
    pub landings: Arc<[Landing]>,
}

/// Where a particle landed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Landing {
    pub surface: SurfaceId,
    pub point: DVec3,
    /// What is reflected of it, in W.
    pub power: f64,
}

/// So many landings are kept, the first ones: enough to know where light is bright.
const MOST_LANDINGS: usize = 1 << 15;

/// A particle on its way.
struct Particle {
    /// Its number.
    number: u32,
    /// Where it goes next.
    ray: Ray,
}

impl Illumination {
    /// Of what arrives on surfaces, weighted by what these reflect, so much is reflected: the light of all bounces is `1 / (1 - albedo)` times
    /// that of one.
    pub fn albedo(&self) -> f64 {
        if self.reflected > 0.0 { self.reflected / (self.emitted + self.reflected) } else { 0.0 }
    }

    /// Follows particles through the scene; once stopped, those on their way are given up.
    pub fn sampled(scene: &Scene, rays: &Rays<'_>, seed: u64, stop: Stop<'_>) -> Self {
        let areas: Vec<f64> = scene.surfaces().par_iter().map(|surface| surface.polygon.area()).collect();
        let area = areas.into_iter().sum();
        let emission = Emission::new(scene, rays);
        if emission.power() <= 0.0 {
            return Self::of_power(scene, area, &[Vec::new(), Vec::new()]);
        }

        // Half of the particles and the other half, so that their product has no noise in its mean.
        let mut halves = [0, 1].map(|_| vec![0.0; scene.surfaces().len()]);
        let sent: Vec<Sent> = (0..PARTICLES).map(|number| emission.sampled_particle(number, PARTICLES, seed)).collect();
        let mut on_way: Vec<Particle> = sent.iter().zip(0..).map(|(sent, number)| Particle { number, ray: sent.ray }).collect();
        let channels = scene.deciding();
        let (mut by_channel, mut emitted) = (vec![0.0; channels], emission.power_of_emitters());
        let mut power: Vec<f64> = sent.iter().flat_map(|sent| emission.spectrum(sent)).collect();
        let (mut directions, mut hits, mut landings) = (Vec::new(), Vec::new(), Vec::new());
        for bounce in 0..MAX_BOUNCES {
            if on_way.is_empty() || stop() {
                break;
            }
            let [seed, next] = [bounce, bounce + 1].map(|bounce| sampling::hash(seed, streams::PARTICLE_BOUNCES + bounce));
            directions.clear();
            directions.extend(on_way.iter().map(|particle| particle.ray));
            rays.first_hits(&directions, &mut hits);
            if bounce == 0 {
                let is_of_light = |sent: &Sent| matches!(sent.source, Source::Light(_));
                let from_lights = sent.iter().zip(&hits).filter(|(sent, hit)| hit.is_some() && is_of_light(sent));
                emitted += from_lights.flat_map(|(sent, _)| emission.spectrum(sent)).sum::<f64>();
            }
            let mut met = hits.iter().zip(&directions);
            on_way.retain_mut(|particle| {
                // What arrives on a front is reflected in part; with that probability the particle goes on.
                let Some((Some(hit), ray)) = met.next() else { return false };
                let direction = DVec3::from(ray.direction);
                let Some(surface) = scene.side_towards(SurfaceId(hit.surface), -direction) else { return false };
                let own = &mut power[particle.number as usize * channels..][..channels];
                let before: f64 = own.iter().sum();
                let reflectance = &scene.material_of(surface).reflectance;
                own.iter_mut().zip(reflectance).for_each(|(power, rho)| *power *= rho);
                by_channel.iter_mut().zip(&*own).for_each(|(sum, power)| *sum += power);
                let reflected: f64 = own.iter().sum();
                halves[particle.number as usize % 2][surface.index()] += reflected;
                let chance = reflected / before;
                own.iter_mut().for_each(|power| *power /= chance);
                let point = DVec3::from(ray.origin) + hit.distance * direction;
                particle.ray = ray_from(scene, (surface, point), sampling::hash(next, u64::from(particle.number)));
                if landings.len() < MOST_LANDINGS {
                    landings.push(Landing { surface, point, power: reflected });
                }
                sampling::unit(sampling::hash(seed, streams::PARTICLE_SURVIVAL + u64::from(particle.number))) < chance
            });
        }
        let reflected_brightest = by_channel.into_iter().fold(0.0, f64::max);
        let of_particle = emission.power() / f64::from(PARTICLES);
        let of_power = Self { reflected_brightest, ..Self::of_power(scene, area, &halves) };
        Self { emitted, of_particle, landings: landings.into(), ..of_power }
    }

    /// By the power in W that each surface reflects, as each half of the particles tells.
    fn of_power(scene: &Scene, area: f64, halves: &[Vec<f64>; 2]) -> Self {
        let reflected: f64 = halves.iter().flatten().sum();
        let [first, second] = halves;
        let products = first.iter().zip(second).zip(scene.surfaces());
        let square: f64 = products.map(|((first, second), surface)| 4.0 * first * second / surface.polygon.area()).sum();
        let lit_area = if square > 0.0 { (reflected * reflected / square).min(area) } else { area };
        Self { emitted: 0.0, of_particle: 0.0, reflected, reflected_brightest: 0.0, lit_area, landings: Arc::default() }
    }
}

/// A ray from a point of a surface by the cosine.
fn ray_from(scene: &Scene, (surface, point): (SurfaceId, DVec3), random: u64) -> Ray {
    let surface = scene.surface(surface);
    let [u, v] = [streams::SECOND, streams::THIRD].map(|number| sampling::unit(sampling::hash(random, number)));
    let direction = Frame::around(surface.polygon.facet().normal).sampled_by_cosine(u, v);
    Ray { origin: point.to_array(), direction: direction.to_array(), origin_plane: surface.plane }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    fn material(reflectance: f64, exitance: f64) -> Material {
        Material { name: String::new(), reflectance: vec![reflectance], exitance: vec![exitance] }
    }

    fn illumination(materials: Vec<Material>, faces: Vec<(Polygon, u32, u32)>) -> Illumination {
        let scene = Scene::new(1, materials, faces, Sides::Front).unwrap();
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        Illumination::sampled(&scene, &Rays::new(&*visibility, &scene), 3, &|| false)
    }

    /// The faces of a unit cube that look inwards.
    fn cube() -> Vec<Polygon> {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let quad = |a, b, c, d| Polygon::from_vertices(vec![a, b, c, d]).unwrap();
        let [o, x, y, z] = [corner(0.0, 0.0, 0.0), corner(1.0, 0.0, 0.0), corner(0.0, 1.0, 0.0), corner(0.0, 0.0, 1.0)];
        let [xy, xz, yz, xyz] = [x + y, x + z, y + z, x + y + z];
        vec![
            quad(o, x, xy, y),
            quad(z, yz, xyz, xz),
            quad(o, z, xz, x),
            quad(y, xy, xyz, yz),
            quad(o, y, yz, z),
            quad(x, xz, xyz, xy),
        ]
    }

    /// In a closed cube all of which emits and reflects alike, the reflected power is `rho / (1 - rho)` times the emitted, everywhere as much.
    #[test]
    fn a_furnace_is_lit_all_over() {
        let faces = cube().into_iter().enumerate().map(|(k, polygon)| (polygon, 0, k as u32)).collect();
        let found = illumination(vec![material(0.5, 2.0)], faces);
        assert_eq!(found.emitted, 12.0);
        // 2048 particles with two bounces on average scatter by 3%.
        assert!((found.reflected / 12.0 - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.albedo() - 0.5).abs() < 0.03 && found.lit_area > 5.8, "{found:?}");
    }

    /// A square above another one; a black or a far plate beside them changes nothing.
    #[test]
    fn what_light_does_not_meet_does_not_count() {
        let square = |z: f64, side: f64, up: bool| {
            let (u, v) = (side * DVec3::X, side * DVec3::Y);
            let corner = DVec3::new(0.5 - 0.5 * side, 0.5 - 0.5 * side, z);
            let corners = if up {
                [corner, corner + u, corner + u + v, corner + v]
            } else {
                [corner, corner + v, corner + u + v, corner + u]
            };
            Polygon::from_vertices(corners.to_vec()).unwrap()
        };
        let materials = || vec![material(0.0, 1.0), material(0.5, 0.0), material(0.0, 0.0)];
        let pair = || vec![(square(0.2, 1.0, false), 0, 0), (square(0.0, 1.0, true), 1, 1)];
        let alone = illumination(materials(), pair());
        let black = illumination(materials(), [pair(), vec![(square(-1.0, 1e4, true), 2, 2)]].concat());
        // Halves of the particles that differ by 3% make the square metre too large by less than a thousandth.
        assert!((alone.lit_area - 1.0).abs() < 1e-3, "{alone:?}");
        assert_eq!((alone.reflected, alone.lit_area), (black.reflected, black.lit_area));
        let grey = illumination(materials(), [pair(), vec![(square(-1.0, 1e4, true), 1, 2)]].concat());
        assert!(grey.lit_area < 4.0 * alone.lit_area, "{grey:?}");
    }
}
