//! Next-event estimation: the irradiance from emitters at a place, by rays to them.
//!
//! Each emitter is cut into pieces that are small as seen from the place. A piece would bring its exact form factor times its
//! exitance if nothing were in between; rays go to pieces in proportion to that, so no single ray weighs much, even a millimetre
//! from an emitter. Of a piece that reaches below the horizon of the place rays go to what is above alone. Where there are fewer rays
//! than emitters, each ray first draws an emitter from the light tree, so its cost hardly grows with their number; where a place
//! has a single ray, it is drawn on the way down through ever smaller parts of its emitter as well.
//!
//! # Control variate
//! How much a piece would bring is known exactly, F; a ray samples it, s, and tells whether it is visible, v. The sample is
//!
//! ```text
//! v s + beta (F - s)
//! ```
//!
//! with beta the part of the place's rays that see emitters. Where nothing is occluded it is F, without noise; where everything is, it is 0.
//!
//! There is no bias if beta does not depend on the point that this ray goes to. Few rays take turns with two sequences of points, and beta is that of the
//! other sequence. Many share one, which spreads those to a piece so evenly that the part that sees emitters hardly depends on where one of them
//! went. This part includes the ray: without it beta would be smaller for a ray that sees an emitter than for one that does not, and places that an emitter
//! stands half hidden from would come out wrong by a part that falls as slowly as one over the number of rays. A ray that goes to its piece alone is left out.

use super::batch_sums::BatchSums;
use super::emitters::{Emitters, brightest};
use super::light_tree::Draws;
use super::place::Receives;
use crate::direct::Receiver;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Clip, Facet, Part, clip_to_front, for_each_piece, sampling, streams};
use crate::scene::{Emitter, SurfaceId};
use crate::visibility::Segment;

/// A piece is small if its radius is at most this part of its distance.
const SMALL: f64 = 0.5;

/// An emitter is cut so many times at most: pieces around a point a hundred-thousandth of the emitter away are small then.
const MAX_SPLITS: u8 = 17;

/// So many rays of a place are few: one sequence of points does not spread them evenly.
const FEW_RAYS: u32 = 15;

/// A piece of an emitter as seen from a place.
struct EmitterPiece {
    /// The index of the emitter.
    emitter: usize,
    part: Option<Part>,
    form_factor: f64,
    /// The irradiance that it brings if nothing is in between, in W/m^2 in its brightest channel.
    unoccluded: f64,
}

impl EmitterPiece {
    /// What a place sends its only ray to: without control variate and other pieces nobody asks what it would bring.
    fn of_one_ray(emitter: usize, part: Option<Part>) -> Self {
        Self { emitter, part, form_factor: 0.0, unoccluded: 1.0 }
    }
}

/// A ray to a piece of an emitter.
struct Drawn {
    place: usize,
    /// The number of the ray among those of the place.
    ray: u32,
    /// The first surface of the emitter.
    surface: SurfaceId,
    /// The piece's exact form factor, and this ray's sample of it.
    form_factor: f64,
    sampled: f64,
    /// One over the expected number of rays to the piece.
    share: f64,
    /// Whether no other ray of the place goes to the piece.
    is_alone: bool,
}

/// The rays from some places to emitters, and the pieces that the last place sees; memory that is reused.
#[derive(Default)]
pub(super) struct EmitterRays {
    draws: Draws,
    pieces: Vec<EmitterPiece>,
    /// The parts of what was drawn last, with their form factors.
    parts: Vec<(Part, f64)>,
    segments: Vec<Segment>,
    drawn: Vec<Drawn>,
    occluded: Vec<bool>,
    /// How many sequences of points the rays of a place take turns with.
    sequences: u32,
    /// By place and sequence: rays, and those of them that see an emitter.
    seeing: Vec<[u32; 2]>,
}

impl EmitterRays {
    /// Counts which rays see an emitter.
    fn count_seeing(&mut self, places: usize) {
        self.seeing.clear();
        self.seeing.resize(places * self.sequences as usize, [0, 0]);
        for (drawn, occluded) in self.drawn.iter().zip(&self.occluded) {
            let [rays, seeing] = &mut self.seeing[drawn.place * self.sequences as usize + (drawn.ray % self.sequences) as usize];
            *rays += 1;
            *seeing += u32::from(!occluded);
        }
    }

    /// The part of the place's rays that see an emitter, as far as this hardly depends on the point that one of them goes to, which `sees` it or not.
    fn part_seeing(&self, drawn: &Drawn, sees: u32) -> f64 {
        let of_place = &self.seeing[drawn.place * self.sequences as usize..][..self.sequences as usize];
        let [rays, seeing] = match *of_place {
            [[rays, seeing]] if drawn.is_alone => [rays - 1, seeing - sees],
            [all] => all,
            _ => of_place[((drawn.ray + 1) % self.sequences) as usize],
        };
        if rays > 0 { f64::from(seeing) / f64::from(rays) } else { 0.0 }
    }
}

impl Emitters<'_> {
    /// Adds the irradiance from all emitters at each place, by `count` rays from each; without bias by up to [`FEW_RAYS`], and by more with far less
    /// than their noise. Each `together` places in a row draw emitters as one place with all of their rays would.
    pub fn add_sampled_irradiance(
        &self,
        places: &[impl Receives],
        together: usize,
        count: u32,
        memory: &mut EmitterRays,
        irradiance: &mut BatchSums<'_>,
    ) {
        if self.tree.is_none() {
            return;
        }
        memory.segments.clear();
        memory.drawn.clear();
        memory.sequences = if (2..=FEW_RAYS).contains(&count) { 2 } else { 1 };
        for (first, places) in places.chunks(together).enumerate().map(|(group, places)| (group * together, places)) {
            // Systematic sampling: numbers at even steps from a random start, dealt to the places in turn. `start` is the offset of
            // the first place, in steps.
            let random = sampling::hash(places[0].receiver(self.scene).seed, streams::EMITTERS);
            let start = (sampling::hash(random, streams::SECOND) % places.len() as u64) as f64 + sampling::unit(random);
            if count > 1 && count as usize >= self.emitters.len() {
                for (number, place) in places.iter().enumerate() {
                    let start = (number as f64 + start) / places.len() as f64 % 1.0;
                    let numbers = (0..count).map(|ray| (ray, (f64::from(ray) + start) / f64::from(count)));
                    self.cast_to_all(&place.receiver(self.scene), first + number, numbers, memory);
                }
            } else {
                self.cast_to_drawn(places, first, count, start, memory);
            }
        }
        self.rays.occluded(&memory.segments, &mut memory.occluded);

        // How much each place sees, and by that the samples.
        memory.count_seeing(places.len());
        for (drawn, occluded) in memory.drawn.iter().zip(&memory.occluded) {
            let sees = u32::from(!occluded);
            let visible = f64::from(sees) * drawn.sampled + memory.part_seeing(drawn, sees) * (drawn.form_factor - drawn.sampled);
            let exitance = &self.scene.material_of(drawn.surface).exitance;
            for (h, e) in irradiance.in_turn(drawn.place, drawn.ray as usize).iter_mut().zip(exitance) {
                *h += visible * drawn.share * e;
            }
        }
    }

    /// Casts a ray from a place for each of `numbers`, rising in [0, 1), to the pieces of all emitters; with the number of each ray.
    /// `index` is the number of the place.
    fn cast_to_all(
        &self,
        receiver: &Receiver,
        index: usize,
        numbers: impl ExactSizeIterator<Item = (u32, f64)>,
        memory: &mut EmitterRays,
    ) {
        memory.pieces.clear();
        for emitter in 0..self.emitters.len() {
            self.cut(receiver, emitter, None, &mut memory.pieces);
        }
        self.cast_to_pieces(receiver, index, 1.0 / numbers.len() as f64, numbers, memory);
    }

    /// Draws an emitter from the light tree for each of the `count` rays of each place, and casts a ray to a piece of it. The
    /// places share a normal; `first` is the number of the first one, and `start` its offset in steps.
    fn cast_to_drawn(&self, places: &[impl Receives], first: usize, count: u32, start: f64, memory: &mut EmitterRays) {
        let Some(tree) = &self.tree else { return };
        let receivers = places.iter().map(|place| place.receiver(self.scene));
        let normal = places[0].receiver(self.scene).normal;
        let rays = count * places.len() as u32;
        let numbers = (0..rays).map(|ray| (f64::from(ray) + start.fract()) / f64::from(rays));
        let points = receivers.clone().map(|receiver| receiver.point);
        let unoccluded = |number: u32| {
            let emitter = &self.emitters[number as usize];
            let facet = emitter.facet(self.scene);
            let form_factors = receivers.clone().map(|receiver| self.form_factor(&receiver, emitter, &facet)).sum::<f64>();
            form_factors / places.len() as f64 * brightest(self.scene, emitter.surface)
        };
        let mut draws = std::mem::take(&mut memory.draws);
        tree.draw(points.clone(), normal, unoccluded, numbers, &mut draws);

        // Rays that drew the same emitter come one after the other; it is cut once for all such rays of a place.
        for same in draws.drawn.chunk_by(|a, b| a.number == b.number) {
            let (emitter, weight) = (same[0].number as usize, 1.0 / (f64::from(count) * same[0].probability));
            for (number, receiver) in receivers.clone().enumerate() {
                let own = same.iter().filter(|drawn| drawn.ray as usize % places.len() == (number + start as usize) % places.len());
                let Some(first_drawn) = own.clone().next() else { continue };
                memory.pieces.clear();
                let mut probability = 1.0;
                if count > 1 {
                    self.cut(&receiver, emitter, None, &mut memory.pieces);
                } else if let Some((part, of_part)) = self.drawn_part(&receiver, emitter, first_drawn.rest, &mut memory.parts) {
                    memory.pieces.push(EmitterPiece::of_one_ray(emitter, part));
                    probability = of_part;
                }
                let numbers = own.map(|drawn| (drawn.ray / places.len() as u32, drawn.rest));
                self.cast_to_pieces(&receiver, first + number, weight / probability, numbers, memory);
            }
        }
        memory.draws = draws;
    }

    /// Casts a ray for each of `numbers`, rising in [0, 1), to the piece in whose share of the sum over all pieces it falls. A ray
    /// stands for the part `weight` of all light.
    fn cast_to_pieces(
        &self,
        receiver: &Receiver,
        index: usize,
        weight: f64,
        numbers: impl Iterator<Item = (u32, f64)>,
        memory: &mut EmitterRays,
    ) {
        let EmitterRays { pieces, segments, drawn, sequences, .. } = memory;
        let &Receiver { point, normal, plane: from_plane, seed } = receiver;
        let total: f64 = pieces.iter().map(|piece| piece.unoccluded).sum();
        if total <= 0.0 {
            return;
        }
        let mut wanted = numbers.map(|(ray, number)| (ray, number * total)).peekable();
        let mut above = 0.0;
        for (number, piece) in pieces.iter().enumerate() {
            above += piece.unoccluded;
            let is_last = number + 1 == pieces.len();
            let is_in_share = |(_, wanted): &(u32, f64)| *wanted < above || is_last;
            if !wanted.peek().is_some_and(is_in_share) {
                continue;
            }

            // The rays to what of this piece is above the horizon.
            let emitter = &self.emitters[piece.emitter];
            let to_plane = self.scene.surface(emitter.surface).plane;
            let whole = emitter.facet(self.scene);
            let facet = piece.part.as_ref().map_or(whole, |part| part.facet(whole.normal));
            let above_horizon = clip_to_front(&facet, point, normal);
            let facet = if let Clip::Part(part) = &above_horizon { part.facet() } else { facet };
            let of_emitter = sampling::hash(seed, streams::EMITTER_PIECES + u64::from(emitter.surface.0));
            let of_piece = sampling::hash(of_emitter, number as u64);
            let sequence = |number: u32| sampling::shifted_sobol_2d(sampling::hash(of_piece, u64::from(number)));
            let only = sequence(0);
            let own = std::iter::from_fn(|| wanted.next_if(is_in_share));
            let first = drawn.len();
            for (sample, (ray, _)) in (0..).zip(own) {
                let [u, v] = if *sequences == 1 { only(sample) } else { sequence(ray % *sequences)(ray / *sequences) };
                let y = facet.point_at(u, v);
                let (from, to) = (point.to_array(), y.to_array());
                segments.push(Segment { from, to, from_plane, to_plane });
                drawn.push(Drawn {
                    place: index,
                    ray,
                    surface: emitter.surface,
                    form_factor: piece.form_factor,
                    sampled: facet.area * kernel(point, normal, y, facet.normal),
                    share: weight * total / piece.unoccluded,
                    is_alone: sample == 0,
                });
            }
            if drawn.len() > first + 1 {
                drawn[first].is_alone = false;
            }
        }
    }

    /// The form factor of an emitter, or a piece of one, at a receiver. None comes from the receiver's own plane, such as from the back of
    /// the same sheet: by rounding the point may lie in front of that, and would see nothing else.
    fn form_factor(&self, receiver: &Receiver, emitter: &Emitter, facet: &Facet<'_>) -> f64 {
        let is_coplanar = self.scene.surface(emitter.surface).plane == receiver.plane;
        if is_coplanar { 0.0 } else { point_to_polygon(receiver.point, receiver.normal, facet) }
    }

    /// A part of an emitter, or all of it, that is small as seen from a receiver, drawn by its form factor with a number in [0, 1), and the probability
    /// of that. It is drawn as from all pieces that [`Self::cut`] makes, since form factors of parts add up to that of the whole; but of these only the
    /// parts of what was drawn are cut. `None` if the receiver sees nothing of the emitter.
    fn drawn_part(
        &self,
        receiver: &Receiver,
        emitter: usize,
        mut number: f64,
        parts: &mut Vec<(Part, f64)>,
    ) -> Option<(Option<Part>, f64)> {
        let of = &self.emitters[emitter];
        let whole = of.facet(self.scene);
        if self.scene.surface(of.surface).plane == receiver.plane || whole.height(receiver.point) <= 0.0 {
            return None;
        }
        let (mut drawn, mut probability): (Option<Part>, f64) = (None, 1.0);
        loop {
            let facet = drawn.as_ref().map_or(whole, |part| part.facet(whole.normal));
            let splits = drawn.map_or(0, |part| part.splits);
            if is_small(&facet, receiver) || splits == MAX_SPLITS {
                return Some((drawn, probability));
            }
            parts.clear();
            for_each_piece(&facet, |corners| {
                let part = Part::new(corners, splits + 1);
                parts.push((part, self.form_factor(receiver, of, &part.facet(whole.normal))));
            });
            let total: f64 = parts.iter().map(|(_, form_factor)| form_factor).sum();
            let mut wanted = number * total;
            let is_drawn = |(_, form_factor): &&(Part, f64)| {
                wanted -= form_factor;
                wanted < 0.0
            };
            let &(part, form_factor) =
                parts.iter().find(is_drawn).or_else(|| parts.iter().rfind(|(_, form_factor)| *form_factor > 0.0))?;
            number = ((wanted + form_factor) / form_factor).clamp(0.0, 1.0 - f64::EPSILON);
            (drawn, probability) = (Some(part), probability * form_factor / total);
        }
    }

    /// Cuts an emitter, or a part of one, into pieces that are small as seen from a receiver; appends those in front of it.
    fn cut(&self, receiver: &Receiver, emitter: usize, part: Option<Part>, pieces: &mut Vec<EmitterPiece>) {
        let of = &self.emitters[emitter];
        let whole = of.facet(self.scene);
        let facet: Facet<'_> = part.as_ref().map_or(whole, |part| part.facet(whole.normal));
        let form_factor = self.form_factor(receiver, of, &facet);
        if form_factor <= 0.0 {
            return;
        }
        let splits = part.map_or(0, |part| part.splits);
        if !is_small(&facet, receiver) && splits < MAX_SPLITS {
            for_each_piece(&facet, |corners| self.cut(receiver, emitter, Some(Part::new(corners, splits + 1)), pieces));
            return;
        }
        pieces.push(EmitterPiece { emitter, part, form_factor, unoccluded: form_factor * brightest(self.scene, of.surface) });
    }
}

/// Whether a piece is small as seen from a receiver.
fn is_small(piece: &Facet<'_>, receiver: &Receiver) -> bool {
    piece.radius * piece.radius <= SMALL * SMALL * receiver.point.distance_squared(piece.centroid)
}

#[cfg(test)]
mod tests;
