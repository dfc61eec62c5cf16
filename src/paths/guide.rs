//! Path guiding: rays around where emitters are seen.
//!
//! What stands beside an emitter in the view is bright as a rule, and small: the edges of a slot through which it is seen, the end of a tube,
//! a shade. Hardly a cosine-distributed ray arrives there. So a part of the rays from a place leaves around directions towards emitters, at an
//! angle that is as likely between one and two degrees as between ten and twenty.
//!
//! # Multiple importance sampling
//! Directions have the density `p = (1 - PART) cos / pi + PART q`, with q the mean of what goes around each of some directions, and rays the weight
//! `cos / pi / p`, whatever these directions are (the balance heuristic: Veach, Guibas 1995). It is at most `1 / (1 - PART)`, so what guides
//! nowhere costs little (Hesterberg 1995).

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::direct::{Receiver, Towards};
use crate::geometry::{Frame, sampling, streams};
use crate::visibility::Ray;

/// One of so many rays is guided: the noise of what other rays find grows by a third at most.
const EVERY: u32 = 4;
const PART: f64 = 1.0 / EVERY as f64;

/// Around an emitter's own solid angle directions are dense alike; that is taken to be at least this, in sr: of a lamp of 1 cm 300 m away.
const LEAST_SOLID_ANGLE: f64 = 1e-9;

/// Around which directions rays leave some places; memory that is reused.
#[derive(Default)]
pub(super) struct Guides {
    axes: Vec<Axis>,
    /// By place: where its axes end.
    ends: Vec<usize>,
}

/// Around which directions the rays of a place leave, if any.
#[derive(Clone, Copy)]
pub(super) struct Guide<'a> {
    axes: &'a [Axis],
}

/// Directions around one: alike up to an angle, from there with the square of the distance of the unit vectors as likely in each octave.
#[derive(Clone, Copy)]
struct Axis {
    frame: Frame,
    /// Half of the square of the distance of unit vectors, 1 less the cosine, at that angle.
    core: f64,
    /// The density in the core, in 1/sr.
    density: f64,
}

impl Guides {
    pub fn clear(&mut self) {
        self.axes.clear();
        self.ends.clear();
    }

    /// Those of the next place.
    pub fn push(&mut self, towards: &[Towards]) {
        self.axes.extend(towards.iter().map(Axis::new));
        self.ends.push(self.axes.len());
    }

    /// Those of a place; none if none were pushed for it.
    pub fn of(&self, place: usize) -> Guide<'_> {
        let Some(&end) = self.ends.get(place) else { return Guide { axes: &[] } };
        let first = if place > 0 { self.ends[place - 1] } else { 0 };
        Guide { axes: &self.axes[first..end] }
    }
}

impl Guide<'_> {
    /// Ray number `index` of a receiver, and its weight.
    pub fn ray(&self, receiver: &Receiver, index: u32) -> (Ray, f64) {
        let &Receiver { point, normal, plane: origin_plane, seed } = receiver;
        let ray = |direction: DVec3| Ray { origin: point.to_array(), direction: direction.to_array(), origin_plane };
        let by_cosine = |index: u32| {
            let [u, v] = sampling::shifted_sobol_2d(seed)(index);
            Frame::around(normal).sampled_by_cosine(u, v)
        };
        if self.axes.is_empty() {
            return (ray(by_cosine(index)), 1.0);
        }

        // Of each few in a row one is guided, around each axis in turn, beginning anywhere; each kind goes through a sequence of its own.
        let (count, begin) = (self.axes.len() as u32, sampling::hash(seed, streams::GUIDED));
        let turn = (begin % u64::from(EVERY)) as u32 + index;
        let number = turn / EVERY;
        let direction = if turn % EVERY == EVERY - 1 {
            let number = (begin / u64::from(EVERY) % u64::from(count)) as u32 + number;
            let axis = number % count;
            let [u, v] = sampling::shifted_sobol_2d(sampling::hash(seed, streams::GUIDED + 1 + u64::from(axis)))(number / count);
            above(self.axes[axis as usize].sampled(u, v), normal)
        } else {
            by_cosine(index - number)
        };
        let by_cosine = direction.dot(normal).max(0.0) / PI;
        (ray(direction), by_cosine / ((1.0 - PART) * by_cosine + PART * self.density(direction, normal)))
    }

    /// The density of guided directions, in 1/sr: what would leave below the horizon is mirrored.
    fn density(&self, direction: DVec3, normal: DVec3) -> f64 {
        let mirrored = direction - 2.0 * direction.dot(normal) * normal;
        let sum: f64 = self.axes.iter().map(|axis| axis.density_at(direction) + axis.density_at(mirrored)).sum();
        sum / self.axes.len() as f64
    }
}

impl Axis {
    fn new(towards: &Towards) -> Self {
        let core = (towards.solid_angle / TAU).clamp(LEAST_SOLID_ANGLE / TAU, 1.0);
        Self { frame: Frame::around(towards.direction), core, density: 1.0 / (TAU * core * Self::whole(core)) }
    }

    /// The core is 1 of so much; octaves reach to the opposite direction.
    fn whole(core: f64) -> f64 {
        1.0 + (2.0 / core).ln()
    }

    /// A direction, for `u` and `v` uniform in [0, 1).
    fn sampled(&self, u: f64, v: f64) -> DVec3 {
        let part = u * Self::whole(self.core);
        let off = if part < 1.0 { self.core * part } else { (self.core * (part - 1.0).exp()).min(2.0) };
        let (radius, (sin, cos)) = ((off * (2.0 - off)).sqrt(), (TAU * v).sin_cos());
        self.frame.to_world(DVec3::new(radius * cos, radius * sin, 1.0 - off))
    }

    /// In 1/sr.
    fn density_at(&self, direction: DVec3) -> f64 {
        let off = 0.5 * direction.distance_squared(self.frame.normal);
        self.density * (self.core / off).min(1.0)
    }
}

/// A direction, mirrored if it lies below the horizon.
fn above(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * direction.dot(normal).min(0.0) * normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::NO_PLANE;

    /// Around a direction just above the horizon and one high above it.
    fn guides() -> Guides {
        let towards = |direction: DVec3, solid_angle: f64| Towards { direction: direction.normalize(), solid_angle };
        let mut guides = Guides::default();
        guides.push(&[]);
        guides.push(&[towards(DVec3::new(1.0, 0.0, 0.01), 1e-4), towards(DVec3::new(-0.2, 0.3, 1.0), 0.1)]);
        guides
    }

    const COUNT: u32 = 1 << 18;

    /// The mean of what is found in each direction, by many receivers of so many rays.
    fn mean(rays: u32, found: impl Fn(DVec3) -> f64) -> f64 {
        let guides = guides();
        let receiver = |seed| Receiver { point: DVec3::ZERO, normal: DVec3::Z, plane: NO_PLANE, seed: sampling::hash(3, seed) };
        let of = |number: u32| {
            let (ray, weight) = guides.of(1).ray(&receiver(u64::from(number / rays)), number % rays);
            weight * found(ray.direction.into())
        };
        (0..COUNT).map(of).sum::<f64>() / f64::from(COUNT)
    }

    #[test]
    fn weighted_rays_are_distributed_by_the_cosine() {
        for rays in [1, 64] {
            assert!((mean(rays, |_| 1.0) - 1.0).abs() < 0.003, "{}", mean(rays, |_| 1.0));
            // The mean of z over cosine-distributed directions is 2/3, that of x^2 is 1/4.
            assert!((mean(rays, |direction| direction.z) * 1.5 - 1.0).abs() < 0.003);
            assert!((mean(rays, |direction| direction.x * direction.x) * 4.0 - 1.0).abs() < 0.005);
            assert!(mean(rays, |direction| direction.x).abs() < 0.003);
        }
    }

    /// A disc of a hundredth of a radian beside the first direction: a cosine-distributed ray meets it once in half a million times.
    #[test]
    fn what_stands_beside_an_emitter_is_met_often() {
        let (middle, angle) = (DVec3::new(1.0, 0.02, 0.02).normalize(), 0.01_f64);
        let is_met = |direction: DVec3| f64::from(u8::from(direction.dot(middle) > angle.cos()));
        let form_factor = angle.sin().powi(2) * middle.z;
        let found = mean(64, is_met);
        assert!((found / form_factor - 1.0).abs() < 0.05, "{found} for {form_factor}");
    }

    #[test]
    fn what_guides_nowhere_is_plain() {
        let receiver = Receiver { point: DVec3::ZERO, normal: DVec3::X, plane: NO_PLANE, seed: 5 };
        let guides = guides();
        for place in [0, 2] {
            let (ray, weight) = guides.of(place).ray(&receiver, 7);
            let plain = super::super::place::cosine_rays(&receiver, 7..8).next().unwrap();
            assert!(weight == 1.0 && ray.direction == plain.direction);
        }
    }
}
