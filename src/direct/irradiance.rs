//! Direct irradiance at a point: exact where that costs less than rays, else by rays with a variance.
//!
//! ```text
//! H(x) = sum over emitters s of E_s F(x, visible part of s)
//! ```
//!
//! # What is exact
//! A caller says how many rays it would cast from a point. An emitter has a share n of them by what it would bring with nothing in between. If
//! that is a ray or more, its visible part is looked for exactly, and given up for rays to what is undecided once that has cost more than it is
//! worth. The variance of n stratified rays to what has edges falls with n^-3/2 (Mitchell 1996): one ray more takes away a part 3/(2n) of it. So
//! to have none at all is worth what 2n/3 rays more cost, and the n rays that are not cast:
//!
//! ```text
//! worth of an exact part = (1 + 2/3) n rays
//! ```
//!
//! What a part will cost is not known beforehand. To give up at its worth costs at most twice what the better choice does (ski rental; Karlin,
//! Manasse, Rudolph, Sleator 1988). Emitters whose share is less than a ray share rays.

use super::blockers::Blockers;
use super::lights::{LightRays, Lights};
use super::receiver::Receiver;
use super::towards::DrawnTowards;
use super::undecided::UndecidedRays;
use super::view::View;
use super::visible_part::VisiblePart;
use crate::form_factor::point_to_polygon;
use crate::geometry::{Facet, sampling, streams};
use crate::scene::{Emitter, Scene};
use crate::transmittance::{Rays, STEPS_PER_RAY};

/// What an exact part is worth, in the rays that it spares: see above.
const WORTH: f64 = 1.0 + 2.0 / 3.0;

/// How visible parts are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Exactly, or by rays where these are cheaper.
    #[default]
    Cheaper,
    /// Exactly, whatever it costs.
    Exact,
    /// By rays.
    Rays,
}

/// How much work a point may take.
#[derive(Clone, Copy, Debug)]
pub struct DirectEffort {
    /// Rays from a point, about, if all of its light is found by them; 0 counts as one. Exact parts may cost as much time.
    pub rays: u32,
    /// How visible parts are found.
    pub method: Method,
}

/// The direct light of some emitters, and of all lights.
pub(crate) struct DirectLight<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// All of the scene's.
    pub blockers: Blockers<'a>,
    pub emitters: &'a [Emitter],
}

/// An emitter as a point sees it with nothing in between.
struct Seen {
    /// Its index among the emitters.
    emitter: usize,
    form_factor: f64,
    /// The irradiance that it brings in its brightest channel, in W/m^2.
    unoccluded: f64,
}

/// Memory that is reused from point to point.
#[derive(Default)]
pub(crate) struct DirectScratch {
    seen: Vec<Seen>,
    part: VisiblePart,
    undecided: UndecidedRays,
    lights: LightRays,
    /// What the last point would get of emitters with nothing in between, in their brightest channels, in W/m^2.
    pub unoccluded: f64,
    /// Work on exact parts so far.
    pub steps: u64,
    /// Directions in which the light of the last point comes.
    pub towards: DrawnTowards,
}

/// Sums by channel.
struct Sums<'a> {
    irradiance: &'a mut [f64],
    variance: &'a mut [f64],
}

impl DirectLight<'_> {
    /// Adds the irradiance from emitters at a point, in W/m^2 by channel, and its variance.
    pub fn add_irradiance(
        &self,
        receiver: &Receiver,
        effort: DirectEffort,
        scratch: &mut DirectScratch,
        irradiance: &mut [f64],
        variance: &mut [f64],
    ) {
        let mut sums = Sums { irradiance, variance };
        let mut seen = std::mem::take(&mut scratch.seen);
        scratch.towards.restart(receiver.seed);
        let total = self.see_unoccluded(receiver, &mut seen, &mut scratch.towards);
        scratch.undecided.restart();
        scratch.unoccluded = total;

        // Emitters with a ray or more of their own; of others, where nothing can stand between.
        let own = |seen: &Seen| f64::from(effort.rays.max(1)) * seen.unoccluded / total;
        seen.retain(|seen| {
            let is_alone = own(seen) >= 1.0 || effort.method == Method::Exact || self.is_clear(receiver, seen.emitter);
            if is_alone {
                let form_factor = self.decide(receiver, seen, (effort.method, own(seen)), scratch);
                let exitance = &self.scene.material_of(self.emitters[seen.emitter].surface).exitance;
                sums.irradiance.iter_mut().zip(exitance).for_each(|(h, e)| *h += form_factor * e);
            }
            !is_alone
        });

        // Emitters that share rays.
        let shared: f64 = seen.iter().map(own).sum();
        self.draw_shared(receiver, &seen, shared, &mut scratch.undecided);
        self.add_undecided(&mut scratch.undecided, &mut sums);
        scratch.seen = seen;
    }

    /// Adds the irradiance from all lights but skies at a point, and its variance, by about so many rays or one for each light, whichever is less.
    pub fn add_lights(
        &self,
        receiver: &Receiver,
        rays: u32,
        scratch: &mut DirectScratch,
        irradiance: &mut [f64],
        variance: &mut [f64],
    ) {
        let add = |_: usize, h: &[f64], of_h: &[f64]| {
            irradiance.iter_mut().zip(h).for_each(|(sum, h)| *sum += h);
            variance.iter_mut().zip(of_h).for_each(|(sum, variance)| *sum += variance);
        };
        Lights::new(self.scene, self.rays).add_irradiance(std::iter::once(*receiver), rays, &mut scratch.lights, add);
    }

    /// Adds the irradiance from skies at a point by so many rays, and its variance, likewise.
    pub fn add_sky(
        &self,
        receiver: &Receiver,
        rays: u32,
        scratch: &mut DirectScratch,
        irradiance: &mut [f64],
        variance: &mut [f64],
    ) {
        Lights::new(self.scene, self.rays).add_sky(receiver, rays, &mut scratch.lights, irradiance, variance);
    }

    /// The form factor of the visible part of a source, any convex polygon in the plane with number `source_plane`: exact, whatever it
    /// costs. 0 from its back and from its plane.
    pub fn visible_form_factor(
        &self,
        receiver: &Receiver,
        source: Facet<'_>,
        source_plane: u32,
        scratch: &mut DirectScratch,
    ) -> f64 {
        if source.height(receiver.point) <= self.blockers.contact {
            return 0.0;
        }
        scratch.part.find(&self.view(receiver, source, source_plane), &self.blockers, u64::MAX).form_factor
    }

    fn view<'v>(&self, receiver: &Receiver, source: Facet<'v>, source_plane: u32) -> View<'v> {
        let &Receiver { point, normal, plane, .. } = receiver;
        View { point, normal, plane, source, source_plane }
    }

    fn view_of(&self, receiver: &Receiver, emitter: usize) -> View<'_> {
        let emitter = &self.emitters[emitter];
        self.view(receiver, emitter.facet(self.scene), self.scene.surface(emitter.surface).plane())
    }

    fn is_clear(&self, receiver: &Receiver, emitter: usize) -> bool {
        self.rays.is_clear_between([receiver.plane, self.scene.surface(self.emitters[emitter].surface).plane()])
    }

    /// Lists the emitters that the point would see with nothing in between; gives what they would bring together.
    fn see_unoccluded(&self, receiver: &Receiver, seen: &mut Vec<Seen>, towards: &mut DrawnTowards) -> f64 {
        seen.clear();
        let mut total = 0.0;
        for (emitter, of) in self.emitters.iter().enumerate() {
            if self.scene.surface(of.surface).plane() == receiver.plane {
                continue;
            }
            let form_factor = point_to_polygon(receiver.point, receiver.normal, &of.facet(self.scene));
            let brightest = self.scene.material_of(of.surface).exitance.iter().copied().fold(0.0, f64::max);
            if form_factor > 0.0 {
                let unoccluded = form_factor * brightest;
                towards.offer_hidden(unoccluded, of.facet(self.scene).vertices.iter().map(|&corner| corner - receiver.point));
                seen.push(Seen { emitter, form_factor, unoccluded });
                total += unoccluded;
            }
        }
        total
    }

    /// The form factor of an emitter as far as it is exact; what is undecided gets rays, about `own`.
    fn decide(&self, receiver: &Receiver, seen: &Seen, (method, own): (Method, f64), scratch: &mut DirectScratch) -> f64 {
        let view = self.view_of(receiver, seen.emitter);
        if self.is_clear(receiver, seen.emitter) {
            scratch.towards.offer_whole(seen.unoccluded, view.source.vertices.iter().map(|&corner| corner - view.point));
            return seen.form_factor;
        }
        let most_steps = match method {
            Method::Exact => return self.visible_form_factor(receiver, view.source, view.source_plane, scratch),
            Method::Cheaper => (own * WORTH * STEPS_PER_RAY as f64) as u64,
            Method::Rays => 0,
        };
        let visible = scratch.part.find(&view, &self.blockers, most_steps);
        scratch.steps += scratch.part.steps();
        let brings = seen.unoccluded * visible.form_factor / seen.form_factor;
        scratch.towards.offer_seen(brings, scratch.part.pieces());
        if visible.is_decided {
            return visible.form_factor;
        }
        let surface = self.emitters[seen.emitter].surface;
        let seed = sampling::hash(receiver.seed, streams::EMITTER_PIECES + u64::from(surface.0));
        scratch.undecided.draw_to_pieces(&view, surface, scratch.part.pieces(), own.round() as u32, seed);
        0.0
    }

    /// Draws about `count` rays to emitters by what they would bring: two in each of equal shares of that.
    fn draw_shared(&self, receiver: &Receiver, seen: &[Seen], count: f64, undecided: &mut UndecidedRays) {
        if seen.is_empty() {
            return;
        }
        let pairs = (0.5 * count).ceil().max(1.0);
        let total: f64 = seen.iter().map(|seen| seen.unoccluded).sum();
        let seed = sampling::hash(receiver.seed, streams::EMITTERS);
        let group = undecided.start_group();
        let (mut current, mut below) = (0, 0.0);
        for pair in 0..pairs as u32 {
            // Emitters before `current` lie below this share.
            let least = f64::from(pair) / pairs * total;
            while current + 1 < seen.len() && below + seen[current].unoccluded <= least {
                below += seen[current].unoccluded;
                current += 1;
            }
            for ray in 0..2 {
                let random = sampling::hash(seed, u64::from(2 * pair + ray));
                let drawn = (f64::from(pair) + sampling::unit(random)) / pairs * total;
                let (mut index, mut above) = (current, below + seen[current].unoccluded);
                while index + 1 < seen.len() && above <= drawn {
                    index += 1;
                    above += seen[index].unoccluded;
                }
                let Seen { emitter, form_factor, unoccluded } = seen[index];
                let view = self.view_of(receiver, emitter);
                let share = total / (2.0 * pairs * unoccluded);
                let surface = self.emitters[emitter].surface;
                undecided.draw(&view, surface, &view.source, (form_factor, share, group), sampling::hash(random, streams::THIRD));
            }
        }
    }

    /// Casts the rays, and adds what they find.
    fn add_undecided(&self, undecided: &mut UndecidedRays, sums: &mut Sums<'_>) {
        if undecided.is_empty() {
            return;
        }
        undecided.cast(self.rays, |emitters, form_factors| {
            let [first, second] = emitters.map(|emitter| &self.scene.material_of(emitter).exitance);
            for (channel, (first, second)) in first.iter().zip(second).enumerate() {
                let [first, second] = [form_factors[0] * first, form_factors[1] * second];
                sums.irradiance[channel] += first + second;
                sums.variance[channel] += (first - second).powi(2);
            }
        });
    }
}
