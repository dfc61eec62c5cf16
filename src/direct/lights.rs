//! Direct light of lights that are no surfaces.
//!
//! A light at a point, or parallel light, takes one ray, which tells exactly whether it is seen. A sun that is a disc takes rays by its share of the
//! light. Where there are fewer rays than lights that send something, each ray draws one of these by what it would bring. Skies are seen by rays over the
//! hemisphere.
//!
//! Rays come in pairs where chance has a part in them: half the square of their difference tells the variance of either.

use glam::DVec3;

use super::receiver::Receiver;
use crate::geometry::{Frame, sampling, streams};
use crate::scene::{Light, LightShape, Scene};
use crate::transmittance::Rays;
use crate::visibility::{NO_PLANE, Segment};

/// A scene's lights, with rays to them.
#[derive(Clone, Copy)]
pub(crate) struct Lights<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
}

/// What a ray brings if it is not blocked.
struct Drawn {
    /// The number of the light.
    light: usize,
    /// The irradiance for each unit of strength.
    irradiance: f64,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// It is exact.
    Exact,
    /// It is the first of a pair, or the second one.
    First,
    Second,
    /// It is a sample alone, of unknown variance.
    Alone,
}

/// Rays from some receivers to lights; memory that is reused.
#[derive(Default)]
pub(crate) struct LightRays {
    /// By light that the receiver at work sees with nothing in between: its number, and what it would bring in its brightest channel.
    seen: Vec<(usize, f64)>,
    segments: Vec<Segment>,
    drawn: Vec<Drawn>,
    /// Rays up to the end of each receiver's.
    up_to: Vec<usize>,
    occluded: Vec<bool>,
    irradiance: Vec<f64>,
    variance: Vec<f64>,
}

impl<'a> Lights<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>) -> Self {
        Self { scene, rays }
    }

    /// Hands to `add` the irradiance from all lights but skies at each receiver and its variance, by channel in W/m^2 and squared, by about `count` rays
    /// or one for each light, whichever is less; without bias.
    pub fn add_irradiance(
        &self,
        receivers: impl Iterator<Item = Receiver>,
        count: u32,
        memory: &mut LightRays,
        mut add: impl FnMut(usize, &[f64], &[f64]),
    ) {
        if self.scene.lights().is_empty() {
            return;
        }
        memory.segments.clear();
        memory.drawn.clear();
        memory.up_to.clear();
        for receiver in receivers {
            self.draw(&receiver, count, memory);
            memory.up_to.push(memory.drawn.len());
        }
        self.rays.occluded(&memory.segments, &mut memory.occluded);

        let LightRays { drawn, up_to, occluded, irradiance, variance, .. } = memory;
        let mut below = 0;
        for (place, &end) in up_to.iter().enumerate() {
            for sums in [&mut *irradiance, &mut *variance] {
                sums.clear();
                sums.resize(self.scene.channels(), 0.0);
            }
            self.sum(&drawn[below..end], &occluded[below..end], irradiance, variance);
            add(place, irradiance, variance);
            below = end;
        }
    }

    /// Adds what the rays of a receiver bring.
    fn sum(&self, drawn: &[Drawn], occluded: &[bool], irradiance: &mut [f64], variance: &mut [f64]) {
        let brings = |number: usize, channel: usize| {
            let drawn = &drawn[number];
            if occluded[number] { 0.0 } else { drawn.irradiance * self.scene.lights()[drawn.light].strength[channel] }
        };
        for (number, ray) in drawn.iter().enumerate() {
            for (channel, (h, variance)) in irradiance.iter_mut().zip(&mut *variance).enumerate() {
                *h += brings(number, channel);
                if ray.kind == Kind::Second {
                    *variance += (brings(number, channel) - brings(number - 1, channel)).powi(2);
                }
            }
        }
    }

    /// Draws the rays of a receiver.
    fn draw(&self, receiver: &Receiver, count: u32, memory: &mut LightRays) {
        let seen = &mut memory.seen;
        seen.clear();
        let lights = self.scene.lights().iter().enumerate().filter(|(_, light)| light.is_on());
        seen.extend(lights.map(|(number, light)| (number, unoccluded(receiver, light))).filter(|(_, brings)| *brings > 0.0));
        if count as usize >= seen.len() {
            self.draw_all(receiver, count, memory);
        } else {
            self.draw_some(receiver, count.max(1), memory);
        }
    }

    /// Draws a ray to each light; to a disc pairs of them by its share of `count`, or a single one if there is no other.
    fn draw_all(&self, receiver: &Receiver, count: u32, LightRays { seen, segments, drawn, .. }: &mut LightRays) {
        let total: f64 = seen.iter().map(|(_, brings)| brings).sum();
        let seed = sampling::hash(receiver.seed, streams::LIGHTS);
        for &(light, brings) in &*seen {
            let pairs = (0.5 * f64::from(count) * brings / total).round().max(1.0);
            let (rays, kinds) = match (self.scene.lights()[light].shape.is_point(), count) {
                (true, _) => (1, [Kind::Exact; 2]),
                (false, 1) => (1, [Kind::Alone; 2]),
                (false, _) => (2 * pairs as u32, [Kind::First, Kind::Second]),
            };
            let sobol = sampling::shifted_sobol_2d(sampling::hash(seed, light as u64));
            for ray in 0..rays {
                let Some((segment, irradiance)) = self.segment(receiver, light, sobol(ray)) else { continue };
                segments.push(segment);
                drawn.push(Drawn { light, irradiance: irradiance / f64::from(rays), kind: kinds[ray as usize % 2] });
            }
        }
    }

    /// Draws lights by what they would bring: two in each of equal shares of that, or a single one.
    fn draw_some(&self, receiver: &Receiver, count: u32, LightRays { seen, segments, drawn, .. }: &mut LightRays) {
        let total: f64 = seen.iter().map(|(_, brings)| brings).sum();
        let seed = sampling::hash(receiver.seed, streams::LIGHTS);
        let (shares, kinds): (u32, &[Kind]) =
            if count == 1 { (1, &[Kind::Alone]) } else { (count.div_ceil(2), &[Kind::First, Kind::Second]) };
        let rays = shares * kinds.len() as u32;
        let (mut first, mut below) = (0, 0.0);
        for share in 0..shares {
            // Lights before `first` lie below this share.
            let part = |of: f64| (f64::from(share) + of) / f64::from(shares) * total;
            while first + 1 < seen.len() && below + seen[first].1 <= part(0.0) {
                below += seen[first].1;
                first += 1;
            }
            for (ray, &kind) in (0..).zip(kinds) {
                let random = sampling::hash(seed, u64::from(2 * share + ray));
                let wanted = part(sampling::unit(random));
                let (mut index, mut above) = (first, below + seen[first].1);
                while index + 1 < seen.len() && above <= wanted {
                    index += 1;
                    above += seen[index].1;
                }
                let (light, brings) = seen[index];
                let at = [streams::SECOND, streams::THIRD].map(|stream| sampling::unit(sampling::hash(random, stream)));
                let Some((segment, irradiance)) = self.segment(receiver, light, at) else { continue };
                segments.push(segment);
                drawn.push(Drawn { light, irradiance: irradiance * total / (f64::from(rays) * brings), kind });
            }
        }
    }

    /// The segment from a receiver to a light, or to point number `at` of one, and the irradiance that it brings for each unit of strength,
    /// 0 from behind.
    fn segment(&self, receiver: &Receiver, light: usize, at: [f64; 2]) -> Option<(Segment, f64)> {
        let seen = self.scene.lights()[light].shape.seen_from(receiver.point, at)?;
        let cos = receiver.normal.dot(seen.towards).max(0.0);
        let distance = if seen.distance.is_finite() { seen.distance } else { self.rays.beyond(receiver.point) };
        let to = receiver.point + distance * seen.towards;
        let (from, to) = (receiver.point.to_array(), to.to_array());
        Some((Segment { from, to, from_plane: receiver.plane, to_plane: NO_PLANE }, cos * seen.irradiance))
    }

    /// Adds the irradiance from skies at a receiver by `count` rays over the hemisphere, and its variance, by channel.
    pub fn add_sky(&self, receiver: &Receiver, count: u32, memory: &mut LightRays, irradiance: &mut [f64], variance: &mut [f64]) {
        if !self.scene.has_sky() {
            return;
        }
        // Rays in pairs, by the cosine.
        let rays = count.div_ceil(2).max(1) * 2;
        let sobol = sampling::shifted_sobol_2d(sampling::hash(receiver.seed, streams::SKY));
        let (frame, distance) = (Frame::around(receiver.normal), self.rays.beyond(receiver.point));
        let directions: Vec<DVec3> = (0..rays).map(|ray| frame.sampled_by_cosine(sobol(ray)[0], sobol(ray)[1])).collect();
        let segment = |direction: &DVec3| Segment {
            from: receiver.point.to_array(),
            to: (receiver.point + distance * direction).to_array(),
            from_plane: receiver.plane,
            to_plane: NO_PLANE,
        };
        let LightRays { segments, occluded, irradiance: both, .. } = memory;
        segments.clear();
        segments.extend(directions.iter().map(segment));
        self.rays.occluded(segments, occluded);

        let channels = irradiance.len();
        for (directions, occluded) in directions.chunks(2).zip(occluded.chunks(2)) {
            both.clear();
            both.resize(2 * channels, 0.0);
            for ((direction, occluded), brought) in directions.iter().zip(occluded).zip(both.chunks_mut(channels)) {
                if !occluded {
                    self.scene.add_sky_radiosity(*direction, 1.0 / f64::from(rays), brought);
                }
            }
            for channel in 0..channels {
                let [first, second] = [both[channel], both[channels + channel]];
                irradiance[channel] += first + second;
                variance[channel] += (first - second).powi(2);
            }
        }
    }
}

/// What a light would bring to a receiver with nothing in between, in W/m^2 in its brightest channel: of a disc that is partly below the horizon, at least
/// as much as any part of it.
fn unoccluded(receiver: &Receiver, light: &Light) -> f64 {
    let Some(seen) = (match &light.shape {
        LightShape::Sun(sun) => {
            let cos = receiver.normal.dot(sun.towards) + (0.5 * sun.diameter).sin();
            return cos.max(0.0) * light.brightest();
        }
        LightShape::Point(_) => light.shape.seen_from(receiver.point, [0.0; 2]),
        LightShape::Sky(_) => None,
    }) else {
        return 0.0;
    };
    receiver.normal.dot(seen.towards).max(0.0) * seen.irradiance * light.brightest()
}
