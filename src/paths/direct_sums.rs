//! Direct light with its own variance, as sums over batches.

use super::batch_sums::BatchSums;
use super::guide::Guides;
use super::place::Receives;
use crate::direct::{DirectEffort, DirectLight, DirectScratch, Method, Receiver};

/// Directions around which the first rays of a place are guided: so many that some are near all edges of a slot that is long as seen from there.
const AXES: usize = 16;

/// Direct irradiance at a place; memory that is reused.
#[derive(Default)]
pub(super) struct DirectSums {
    scratch: DirectScratch,
    irradiance: Vec<f64>,
    variance: Vec<f64>,
    /// By place of the last call that finds them: the variance that a single next-event ray has, relative to the square of the irradiance. It finds all that the place would get with
    /// nothing in between, U, or nothing, and on average the irradiance H: U / H - 1.
    pub next_event: Vec<f64>,
    /// By place of the last call that finds them: how rays leave it.
    pub guides: Guides,
}

impl DirectSums {
    /// Adds the direct irradiance at each place: exactly, or by rays, of which there are about `count`.
    pub fn add_irradiance(
        &mut self,
        direct: &DirectLight<'_>,
        places: &[impl Receives],
        count: u32,
        irradiance: &mut BatchSums<'_>,
    ) {
        self.scratch.towards.want(0);
        for (number, place) in places.iter().enumerate() {
            self.find(direct, &place.receiver(direct.scene), count);
            self.add(number, irradiance);
        }
        self.note_steps(direct);
    }

    /// The same, which finds as well how a ray leaves each place, and what a next-event ray would vary by.
    pub fn add_irradiance_and_guide(
        &mut self,
        direct: &DirectLight<'_>,
        places: &[impl Receives],
        count: u32,
        irradiance: &mut BatchSums<'_>,
    ) {
        self.scratch.towards.want(1);
        self.guides.clear();
        self.next_event.clear();
        for (number, place) in places.iter().enumerate() {
            let of_emitters = self.find(direct, &place.receiver(direct.scene), count);
            self.next_event.push(if of_emitters > 0.0 { (self.scratch.unoccluded / of_emitters - 1.0).max(0.0) } else { 0.0 });
            self.guides.push(self.scratch.towards.drawn());
            self.add(number, irradiance);
        }
        self.note_steps(direct);
    }

    /// Finds how rays leave each place.
    pub fn guide(&mut self, direct: &DirectLight<'_>, places: &[impl Receives], count: u32) {
        self.scratch.towards.want(AXES);
        self.guides.clear();
        for place in places {
            self.find(direct, &place.receiver(direct.scene), count);
            self.guides.push(self.scratch.towards.drawn());
        }
        self.note_steps(direct);
    }

    /// Finds the direct irradiance at a place; gives that of emitters in the brightest channel.
    fn find(&mut self, direct: &DirectLight<'_>, receiver: &Receiver, count: u32) -> f64 {
        for sums in [&mut self.irradiance, &mut self.variance] {
            sums.clear();
            sums.resize(direct.scene.channels(), 0.0);
        }
        let effort = DirectEffort { rays: count, method: Method::Cheaper };
        direct.add_irradiance(receiver, effort, &mut self.scratch, &mut self.irradiance, &mut self.variance);
        let of_emitters = self.irradiance.iter().copied().fold(0.0, f64::max);
        direct.add_lights(receiver, count, &mut self.scratch, &mut self.irradiance, &mut self.variance);
        of_emitters
    }

    /// Adds what was found last.
    fn add(&self, number: usize, irradiance: &mut BatchSums<'_>) {
        for (channel, (&h, &variance)) in self.irradiance.iter().zip(&self.variance).enumerate() {
            irradiance.add(number, channel, h, variance);
        }
    }

    fn note_steps(&mut self, direct: &DirectLight<'_>) {
        direct.rays.note_exact(std::mem::take(&mut self.scratch.steps));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::direct::Blockers;
    use crate::geometry::{Polygon, sampling};
    use crate::paths::emitters::Emitters;
    use crate::paths::next_event::EmitterRays;
    use crate::scene::{Material, Scene, Sides};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, NO_PLANE, OccluderMesh, build};

    /// A small emitter, nine tenths of it hidden: a ray finds a tenth of the time ten times the light.
    #[test]
    fn the_variance_of_next_event_rays_is_foreseen() {
        let square =
            |z: f64, [low, high]: [f64; 2]| Polygon::new(&[[low, 0.0, z], [low, 0.1, z], [high, 0.1, z], [high, 0.0, z]]).unwrap();
        let material = |exitance: f64| Material { name: String::new(), reflectance: vec![0.5], exitance: vec![exitance] };
        let faces = vec![(square(2.0, [0.0, 0.1]), 1, 0), (square(1.0, [0.005, 0.2]), 0, 1)];
        let scene = Scene::new(1, vec![material(0.0), material(100.0)], faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);
        let direct =
            DirectLight { scene: &scene, rays: &rays, blockers: Blockers::of(&scene, &rays), emitters: &emitters.emitters };
        let place = |seed| Receiver { point: DVec3::new(0.0, 0.05, 0.0), normal: DVec3::Z, plane: NO_PLANE, seed };

        let (mut sums, mut exact) = (DirectSums::default(), [0.0]);
        sums.add_irradiance_and_guide(&direct, &[place(0)], 32, &mut BatchSums::whole(1, &mut exact));
        let count = 20_000;
        let places: Vec<Receiver> = (0..count).map(|seed| place(sampling::hash(1, seed))).collect();
        let mut sampled = vec![0.0; places.len()];
        emitters.add_sampled_irradiance(&places, 1, 1, &mut EmitterRays::default(), &mut BatchSums::whole(1, &mut sampled));
        let mean = sampled.iter().sum::<f64>() / count as f64;
        let variance = sampled.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / count as f64;
        assert!((mean / exact[0] - 1.0).abs() < 0.1, "{mean} for {exact:?}");
        let (foreseen, found) = (sums.next_event[0], variance / exact[0].powi(2));
        assert!((foreseen / found - 1.0).abs() < 0.1, "{foreseen} for {found}");
    }
}
