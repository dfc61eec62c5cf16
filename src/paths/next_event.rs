//! Next-event estimation: the irradiance from emitters at a place, by rays to them.
//!
//! Each emitter is cut into pieces that are small as seen from the place. A piece would bring its exact form factor times its
//! exitance if nothing were in between; rays go to pieces in proportion to that, so no single ray weighs much, even a millimetre
//! from an emitter. Where there are fewer rays than emitters, each ray first draws an emitter from the light tree, so its cost
//! hardly grows with their number.
//!
//! # Control variate
//! How much a piece would bring is known exactly, F; a ray samples it, s, and tells whether it is visible, v. The sample is
//!
//! ```text
//! v s + beta (F - s)
//! ```
//!
//! with beta the part of the place's other rays that see emitters, which does not depend on this ray, so that there is no bias. Where nothing
//! is occluded it is F, without noise; where everything is, it is 0.

use glam::DVec3;

use super::batch_sums::BatchSums;
use super::emitters::{Emitters, brightest};
use super::light_tree::Draws;
use super::place::Place;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Facet, Part, for_each_piece, sampling, streams};
use crate::scene::SurfaceId;
use crate::visibility::Segment;

/// A piece is small if its radius is at most this part of its distance.
const SMALL: f64 = 0.5;

/// An emitter is cut so many times at most: pieces around a point a hundred-thousandth of the emitter away are small then.
const MAX_SPLITS: u8 = 17;

/// A piece of an emitter as seen from a place.
struct EmitterPiece {
    emitter: SurfaceId,
    part: Option<Part>,
    form_factor: f64,
    /// The irradiance that it brings if nothing is in between, in W/m^2 in its brightest channel.
    unoccluded: f64,
}

/// A ray to a piece of an emitter.
struct Drawn {
    place: usize,
    /// The number of the ray among those of the place.
    ray: u32,
    emitter: SurfaceId,
    /// The piece's exact form factor, and this ray's sample of it.
    form_factor: f64,
    sampled: f64,
    /// One over the expected number of rays to the piece.
    share: f64,
}

/// The rays from some places to emitters, and the pieces that the last place sees; memory that is reused.
#[derive(Default)]
pub(super) struct EmitterRays {
    draws: Draws,
    pieces: Vec<EmitterPiece>,
    segments: Vec<Segment>,
    drawn: Vec<Drawn>,
    occluded: Vec<bool>,
    /// By place: its rays, and those that see an emitter.
    seeing: Vec<[u32; 2]>,
}

impl Emitters<'_> {
    /// Adds the irradiance from all emitters at each place, by `count` rays from each; without bias for any number of rays. Each
    /// `together` places in a row draw emitters as one place with all of their rays would.
    pub fn add_sampled_irradiance(
        &self,
        places: &[Place],
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
        for (first, places) in places.chunks(together).enumerate().map(|(group, places)| (group * together, places)) {
            // Systematic sampling: numbers at even steps from a random start, dealt to the places in turn. `start` is the offset of
            // the first place, in steps.
            let random = sampling::hash(places[0].seed, streams::EMITTERS);
            let start = (sampling::hash(random, streams::SECOND) % places.len() as u64) as f64 + sampling::unit(random);
            if count as usize >= self.surfaces.len() {
                for (number, place) in places.iter().enumerate() {
                    let start = (number as f64 + start) / places.len() as f64 % 1.0;
                    let numbers = (0..count).map(|ray| (ray, (f64::from(ray) + start) / f64::from(count)));
                    self.cast_to_all(place, first + number, numbers, memory);
                }
            } else {
                self.cast_to_drawn(places, first, count, start, memory);
            }
        }
        self.rays.occluded(&memory.segments, &mut memory.occluded);

        // How much each place sees, and by that the samples.
        memory.seeing.clear();
        memory.seeing.resize(places.len(), [0, 0]);
        for (drawn, occluded) in memory.drawn.iter().zip(&memory.occluded) {
            let [rays, seeing] = &mut memory.seeing[drawn.place];
            *rays += 1;
            *seeing += u32::from(!occluded);
        }
        for (drawn, occluded) in memory.drawn.iter().zip(&memory.occluded) {
            let sees = u32::from(!occluded);
            let [rays, seeing] = memory.seeing[drawn.place];
            let beta = if rays > 1 { f64::from(seeing - sees) / f64::from(rays - 1) } else { 0.0 };
            let visible = f64::from(sees) * drawn.sampled + beta * (drawn.form_factor - drawn.sampled);
            let exitance = &self.scene.material_of(drawn.emitter).exitance;
            for (h, e) in irradiance.in_turn(drawn.place, drawn.ray as usize).iter_mut().zip(exitance) {
                *h += visible * drawn.share * e;
            }
        }
    }

    /// Casts a ray from a place for each of `numbers`, rising in [0, 1), to the pieces of all emitters; with the number of each ray.
    /// `index` is the number of the place.
    fn cast_to_all(
        &self,
        place: &Place,
        index: usize,
        numbers: impl ExactSizeIterator<Item = (u32, f64)>,
        memory: &mut EmitterRays,
    ) {
        memory.pieces.clear();
        let normal = self.scene.surface(place.surface).polygon.facet().normal;
        for &emitter in &self.surfaces {
            self.cut(place.point, normal, emitter, None, &mut memory.pieces);
        }
        self.cast_to_pieces(place, index, 1.0 / numbers.len() as f64, numbers, memory);
    }

    /// Draws an emitter from the light tree for each of the `count` rays of each place, and casts a ray to a piece of it. The
    /// places share a normal; `first` is the number of the first one, and `start` its offset in steps.
    fn cast_to_drawn(&self, places: &[Place], first: usize, count: u32, start: f64, memory: &mut EmitterRays) {
        let Some(tree) = &self.tree else { return };
        let normal = self.scene.surface(places[0].surface).polygon.facet().normal;
        let rays = count * places.len() as u32;
        let numbers = (0..rays).map(|ray| (f64::from(ray) + start.fract()) / f64::from(rays));
        let points = places.iter().map(|place| place.point);
        let unoccluded = |number: u32| {
            let emitter = SurfaceId(number);
            let facet = self.scene.surface(emitter).polygon.facet();
            let form_factors = points.clone().map(|point| point_to_polygon(point, normal, &facet)).sum::<f64>();
            form_factors / places.len() as f64 * brightest(self.scene, emitter)
        };
        let mut draws = std::mem::take(&mut memory.draws);
        tree.draw(points.clone(), normal, unoccluded, numbers, &mut draws);

        // Rays that drew the same emitter come one after the other; it is cut once for all such rays of a place.
        for same in draws.drawn.chunk_by(|a, b| a.number == b.number) {
            let weight = 1.0 / (f64::from(count) * same[0].probability);
            for (number, place) in places.iter().enumerate() {
                let own = same.iter().filter(|drawn| drawn.ray as usize % places.len() == (number + start as usize) % places.len());
                if own.clone().next().is_none() {
                    continue;
                }
                memory.pieces.clear();
                self.cut(place.point, normal, SurfaceId(same[0].number), None, &mut memory.pieces);
                let numbers = own.map(|drawn| (drawn.ray / places.len() as u32, drawn.rest));
                self.cast_to_pieces(place, first + number, weight, numbers, memory);
            }
        }
        memory.draws = draws;
    }

    /// Casts a ray for each of `numbers`, rising in [0, 1), to the piece in whose share of the sum over all pieces it falls. A ray
    /// stands for the part `weight` of all light.
    fn cast_to_pieces(
        &self,
        place: &Place,
        index: usize,
        weight: f64,
        numbers: impl Iterator<Item = (u32, f64)>,
        memory: &mut EmitterRays,
    ) {
        let EmitterRays { pieces, segments, drawn, .. } = memory;
        let receiver = self.scene.surface(place.surface);
        let normal = receiver.polygon.facet().normal;
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

            // The rays to this piece.
            let emitter = self.scene.surface(piece.emitter);
            let whole = emitter.polygon.facet();
            let facet = piece.part.as_ref().map_or(whole, |part| part.facet(whole.normal));
            let of_emitter = sampling::hash(place.seed, streams::EMITTER_PIECES + u64::from(piece.emitter.0));
            let sobol = sampling::shifted_sobol_2d(sampling::hash(of_emitter, number as u64));
            let own = std::iter::from_fn(|| wanted.next_if(is_in_share));
            for (sample, (ray, _)) in (0..).zip(own) {
                let [u, v] = sobol(sample);
                let y = facet.point_at(u, v);
                let (from, to) = (place.point.to_array(), y.to_array());
                segments.push(Segment { from, to, from_plane: receiver.plane, to_plane: emitter.plane });
                drawn.push(Drawn {
                    place: index,
                    ray,
                    emitter: piece.emitter,
                    form_factor: piece.form_factor,
                    sampled: facet.area * kernel(place.point, normal, y, facet.normal),
                    share: weight * total / piece.unoccluded,
                });
            }
        }
    }

    /// Cuts an emitter, or a part of one, into pieces that are small as seen from `point`; appends those in front of it.
    fn cut(&self, point: DVec3, normal: DVec3, emitter: SurfaceId, part: Option<Part>, pieces: &mut Vec<EmitterPiece>) {
        let whole = self.scene.surface(emitter).polygon.facet();
        let facet: Facet<'_> = part.as_ref().map_or(whole, |part| part.facet(whole.normal));
        let form_factor = point_to_polygon(point, normal, &facet);
        if form_factor <= 0.0 {
            return;
        }
        let splits = part.map_or(0, |part| part.splits);
        if facet.radius * facet.radius > SMALL * SMALL * point.distance_squared(facet.centroid) && splits < MAX_SPLITS {
            for_each_piece(&facet, |corners| self.cut(point, normal, emitter, Some(Part::new(corners, splits + 1)), pieces));
            return;
        }
        pieces.push(EmitterPiece { emitter, part, form_factor, unoccluded: form_factor * brightest(self.scene, emitter) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// A floor and `count` small emitters above it, turned every way, some behind others.
    fn emitters_over_a_floor(count: u64) -> Scene {
        let material = |reflectance: f64, exitance: f64| Material {
            name: format!("{exitance}"),
            reflectance: vec![reflectance],
            exitance: vec![exitance],
        };
        let quad = |corner: DVec3, u: DVec3, v: DVec3| {
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let mut faces = vec![(quad(DVec3::ZERO, 10.0 * DVec3::X, 10.0 * DVec3::Y), 0, 0)];
        for emitter in 0..count {
            let random = |draw| sampling::unit(sampling::hash(emitter, draw));
            let direction = |draw| (DVec3::new(random(draw), random(draw + 1), random(draw + 2)) - 0.5).normalize();
            let normal = (direction(10) - 0.6 * DVec3::Z).normalize();
            let u = normal.cross(direction(20)).normalize();
            let corner = DVec3::new(10.0 * random(1), 10.0 * random(2), 0.5 + 3.0 * random(3));
            faces.push((quad(corner, 0.1 * u, 0.1 * normal.cross(u)), 1 + (emitter % 3) as u32, 1 + emitter as u32));
        }
        let materials = vec![material(0.5, 0.0), material(0.0, 1.0), material(0.0, 5.0), material(0.0, 20.0)];
        Scene::new(1, materials, faces, Sides::Front).unwrap()
    }

    fn places(seed: u64) -> Vec<Place> {
        let place = |k: u64| {
            let coordinate = |draw| 10.0 * sampling::unit(sampling::hash(k, draw));
            let point = DVec3::new(coordinate(40), coordinate(41), 0.0);
            Place { point, surface: SurfaceId(0), seed: sampling::hash(seed, k) }
        };
        (0..20).map(place).collect()
    }

    #[test]
    fn emitters_from_the_tree_bring_what_all_bring() {
        let scene = emitters_over_a_floor(1000);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);

        // With more rays than emitters every emitter gets its share of rays. 16 rays draw emitters, a thousand times: for each
        // place alone, or for four places together, which lie metres apart.
        let mut expected = vec![0.0; 20];
        let mut memory = EmitterRays::default();
        emitters.add_sampled_irradiance(&places(1), 1, 50_000, &mut memory, &mut BatchSums::whole(1, &mut expected));
        for together in [1, 4] {
            let (mut sum, mut sum_sq) = (vec![0.0; 20], vec![0.0; 20]);
            let rounds = 1000;
            for round in 0..rounds {
                let mut found = vec![0.0; 20];
                emitters.add_sampled_irradiance(
                    &places(100 + round),
                    together,
                    16,
                    &mut memory,
                    &mut BatchSums::whole(1, &mut found),
                );
                found.iter().zip(sum.iter_mut().zip(sum_sq.iter_mut())).for_each(|(h, (sum, sum_sq))| {
                    *sum += h;
                    *sum_sq += h * h;
                });
            }
            for (place, expected) in expected.iter().enumerate() {
                let n = rounds as f64;
                let mean = sum[place] / n;
                let sigma = ((sum_sq[place] / n - mean * mean) / n).sqrt();
                // What is expected has noise of its own, less than 0.3% with 50 rays to an emitter on average.
                let off = (mean - expected).abs();
                assert!(off <= 4.5 * sigma + 0.003 * expected, "{together}, place {place}: {mean} +- {sigma}, not {expected}");
                let scatter = sigma * n.sqrt() / mean;
                assert!(scatter < 1.0 || together > 1, "place {place}: a single sample scatters by {scatter}");
            }
        }
    }

    #[test]
    fn an_emitter_beside_a_place_is_drawn_by_what_it_sends_however_large_its_group() {
        // Emitters far apart, and places a hand's breadth from each of them.
        let scene = emitters_over_a_floor(200);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);
        for &beside in &emitters.surfaces {
            let facet = scene.surface(beside).polygon.facet();
            let (point, normal) = (facet.centroid + 0.1 * facet.normal, -facet.normal);
            let sends = |number: u32| {
                let emitter = SurfaceId(number);
                point_to_polygon(point, normal, &scene.surface(emitter).polygon.facet()) * brightest(&scene, emitter)
            };
            let mut draws = Draws::default();
            let numbers = (0..64).map(|k| (f64::from(k) + 0.5) / 64.0);
            emitters.tree.as_ref().unwrap().draw(std::iter::once(point), normal, sends, numbers, &mut draws);

            // Every ray stands for at most a few times all that arrives.
            let all: f64 = emitters.surfaces.iter().map(|emitter| sends(emitter.0)).sum();
            for emitter in draws.drawn {
                assert!(
                    sends(emitter.number) / emitter.probability <= 4.0 * all,
                    "{:?} of {all} by {}",
                    sends(emitter.number),
                    emitter.probability
                );
            }
        }
    }

    #[test]
    fn rays_do_not_grow_with_the_number_of_emitters() {
        for count in [1, 16, 17, 1000] {
            let scene = emitters_over_a_floor(count);
            let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let (emitters, memory) = (Emitters::new(&scene, &rays), &mut EmitterRays::default());
            emitters.add_sampled_irradiance(&places(1), 1, 24, memory, &mut BatchSums::whole(1, &mut [0.0; 20]));
            let cast = rays.segments().count();
            assert!(cast + rays.spared() <= 20 * 24, "{count} emitters: {cast} rays");
        }
    }

    #[test]
    fn places_together_draw_the_emitters_of_one_place_with_all_of_their_rays() {
        let scene = emitters_over_a_floor(1000);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);
        let drawn = |places: &[Place], together: usize, count: u32| {
            let mut memory = EmitterRays::default();
            let mut irradiance = vec![0.0; places.len()];
            emitters.add_sampled_irradiance(places, together, count, &mut memory, &mut BatchSums::whole(1, &mut irradiance));
            let mut drawn: Vec<u32> = memory.drawn.iter().map(|drawn| drawn.emitter.0).collect();
            drawn.sort_unstable();
            drawn
        };
        for place in places(3) {
            assert_eq!(drawn(&[place; 4], 4, 4), drawn(&[place], 1, 16));
        }
    }
}
