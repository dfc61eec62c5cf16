//! The light of lamps at a place, by rays that do without links.
//!
//! Each lamp is cut into pieces that are small as seen from the place, each with its exact form factor. Rays are spread over the
//! pieces by what they carry, so no single ray weighs much, even a millimetre from a lamp. Where there are fewer rays than lamps,
//! each ray draws a lamp from a tree first: the cost of a ray does not grow with the number of lamps.

use glam::DVec3;

use super::aim_tree::{self, AimTree, Start};
use super::light_paths::Place;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Facet, Frame, Part, sampling};
use crate::hierarchy::for_each_piece;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Ray, Segment};

/// A piece is small if its radius is below this part of its distance.
const SMALL: f64 = 0.5;

/// A lamp is cut so many times at most.
const MAX_SPLITS: u8 = 6;

/// Lamps are the brightest emitters, at most this part of all area: what is larger, rays over the hemisphere find well enough.
const MOSTLY_EMITTING: f64 = 0.2;

/// That holds only if no more than this part of the rays is lost.
const OFTEN_LOST: f64 = 0.5;

/// Rays that tell how many are lost.
const PROBES: u32 = 256;

/// The emitters that are sampled by rays of their own.
pub(super) struct Lamps<'a> {
    scene: &'a Scene,
    surfaces: Vec<SurfaceId>,
    /// The exitance of the dimmest of them, in its brightest channel.
    dimmest: f64,
    /// Over the lamps, if there are any.
    tree: Option<AimTree>,
}

/// A piece of a lamp as seen from a place.
struct Piece {
    lamp: SurfaceId,
    part: Option<Part>,
    form_factor: f64,
    carried: f64,
}

/// A ray to a piece of a lamp.
struct Drawn {
    place: usize,
    lamp: SurfaceId,
    /// The piece's exact form factor, and the sample of it that this ray is.
    form_factor: f64,
    sampled: f64,
    /// How many of its kind the ray stands for: pieces are drawn by what they carry.
    share: f64,
}

/// The rays to lamps of some places, and the pieces that the last of them sees; memory that is reused.
#[derive(Default)]
pub(super) struct AimedRays {
    starts: Vec<Start>,
    lamps: Vec<aim_tree::Drawn>,
    pieces: Vec<Piece>,
    segments: Vec<Segment>,
    drawn: Vec<Drawn>,
    occluded: Vec<bool>,
}

impl<'a> Lamps<'a> {
    pub fn new(scene: &'a Scene, rays: &Rays<'_>) -> Self {
        let area = |id: SurfaceId| scene.surface(id).polygon.area();
        let all = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let mut surfaces: Vec<SurfaceId> = all().filter(|&id| scene.material_of(id).emits()).collect();

        // By reciprocity emitters are met as often as they make up of all area, unless rays leave the scene. Where they are met less often
        // because much hides them, rays to them are blocked as often. A ray that meets one scatters as the square of its exitance: so if
        // there is too much of them for lamps, the brightest are lamps.
        let total: f64 = all().map(area).sum();
        let emitting: f64 = surfaces.iter().map(|&id| area(id)).sum();
        let mut dimmest = 0.0;
        if emitting > MOSTLY_EMITTING * total && sampled_share_lost(scene, rays, total) < OFTEN_LOST {
            let mut levels: Vec<(f64, f64)> = surfaces.iter().map(|&id| (brightest(scene, id), area(id))).collect();
            levels.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut taken = 0.0;
            dimmest = f64::INFINITY;
            for level in levels.chunk_by(|a, b| a.0 == b.0) {
                taken += level.iter().map(|(_, area)| area).sum::<f64>();
                if taken > MOSTLY_EMITTING * total {
                    break;
                }
                dimmest = level[0].0;
            }
            surfaces.retain(|&id| brightest(scene, id) >= dimmest);
        }
        let tree = (!surfaces.is_empty()).then(|| AimTree::new(surfaces.iter().map(|&lamp| source(scene, lamp)).collect()));
        Self { scene, surfaces, dimmest, tree }
    }

    /// Whether the emission of a surface is sampled here, so that other rays must leave it out.
    pub fn contains(&self, surface: SurfaceId) -> bool {
        self.scene.material_of(surface).emits() && brightest(self.scene, surface) >= self.dimmest
    }

    /// Adds the irradiance from all lamps at each place, by `count` rays; without bias for any number of rays. `irradiance` has the
    /// channels of the first place first. Of the places `together` in a row draw lamps as one place with all of their rays would.
    pub fn add_sampled_irradiance(
        &self,
        places: &[Place],
        together: usize,
        rays: &Rays<'_>,
        count: u32,
        aimed: &mut AimedRays,
        irradiance: &mut [f64],
    ) {
        let Some(tree) = &self.tree else { return };
        aimed.segments.clear();
        aimed.drawn.clear();
        for (first, places) in places.chunks(together).enumerate().map(|(group, places)| (group * together, places)) {
            // Numbers at even steps from a random start, for the places in turn: `start` tells by how many steps the first place is late.
            let random = sampling::hash(places[0].seed, 5);
            let start = (sampling::hash(random, 1) % places.len() as u64) as f64 + sampling::unit(random);
            if count as usize >= self.surfaces.len() {
                for (number, place) in places.iter().enumerate() {
                    let start = (number as f64 + start) / places.len() as f64 % 1.0;
                    let numbers = (0..count).map(|ray| (f64::from(ray) + start) / f64::from(count));
                    self.aim_at_all(place, first + number, numbers, aimed);
                }
            } else {
                self.aim_at_some(tree, places, first, count, start, aimed);
            }
        }
        rays.occluded(&aimed.segments, &mut aimed.occluded);

        // What is blocked is taken from the exact form factor: there is no noise where nothing is blocked.
        let channels = self.scene.channels();
        for (drawn, occluded) in aimed.drawn.iter().zip(&aimed.occluded) {
            let visible = drawn.form_factor - if *occluded { drawn.sampled } else { 0.0 };
            let exitance = &self.scene.material_of(drawn.lamp).exitance;
            for (h, e) in irradiance[drawn.place * channels..][..channels].iter_mut().zip(exitance) {
                *h += visible * drawn.share * e;
            }
        }
    }

    /// Spreads the rays of a place over the pieces of all lamps by what they carry, systematically: one for each of `numbers`, rising in
    /// [0, 1).
    fn aim_at_all(&self, place: &Place, index: usize, numbers: impl ExactSizeIterator<Item = f64>, aimed: &mut AimedRays) {
        aimed.pieces.clear();
        let normal = self.scene.surface(place.surface).polygon.facet().normal;
        for &lamp in &self.surfaces {
            self.cut(place.point, normal, lamp, None, &mut aimed.pieces);
        }
        self.aim(place, index, 1.0 / numbers.len() as f64, numbers, aimed);
    }

    /// Draws a lamp from the tree for each of the `count` rays of each place, all with one normal, and a piece of that lamp. `first` is the
    /// index of the first place, which is late by `start` steps.
    fn aim_at_some(&self, tree: &AimTree, places: &[Place], first: usize, count: u32, start: f64, aimed: &mut AimedRays) {
        let normal = self.scene.surface(places[0].surface).polygon.facet().normal;
        let rays = count * places.len() as u32;
        let numbers = (0..rays).map(|ray| (f64::from(ray) + start.fract()) / f64::from(rays));
        let mut lamps = std::mem::take(&mut aimed.lamps);
        lamps.clear();
        let points = places.iter().map(|place| place.point);
        let unoccluded = |number: u32| {
            let lamp = SurfaceId(number);
            let facet = self.scene.surface(lamp).polygon.facet();
            let form_factors = points.clone().map(|point| point_to_polygon(point, normal, &facet)).sum::<f64>();
            form_factors / places.len() as f64 * brightest(self.scene, lamp)
        };
        tree.draw(points.clone(), normal, unoccluded, numbers, &mut aimed.starts, &mut lamps);

        // Rays that draw the same lamp come one after the other.
        for same in lamps.chunk_by(|a, b| a.number == b.number) {
            let weight = 1.0 / (f64::from(count) * same[0].probability);
            for (number, place) in places.iter().enumerate() {
                let own = same.iter().filter(|drawn| drawn.ray as usize % places.len() == (number + start as usize) % places.len());
                if own.clone().next().is_none() {
                    continue;
                }
                aimed.pieces.clear();
                self.cut(place.point, normal, SurfaceId(same[0].number), None, &mut aimed.pieces);
                self.aim(place, first + number, weight, own.map(|drawn| drawn.rest), aimed);
            }
        }
        aimed.lamps = lamps;
    }

    /// Aims a ray for each of `places_in_sum`, rising in [0, 1): at the piece in whose share of what all pieces carry it falls. A
    /// ray stands for `weight` of all light.
    fn aim(&self, place: &Place, index: usize, weight: f64, places_in_sum: impl Iterator<Item = f64>, aimed: &mut AimedRays) {
        let AimedRays { pieces, segments, drawn, .. } = aimed;
        let receiver = self.scene.surface(place.surface);
        let normal = receiver.polygon.facet().normal;
        let total: f64 = pieces.iter().map(|piece| piece.carried).sum();
        if total <= 0.0 {
            return;
        }
        let mut places_in_sum = places_in_sum.map(|place| place * total).peekable();
        let mut above = 0.0;
        for (number, piece) in pieces.iter().enumerate() {
            above += piece.carried;
            let is_last = number + 1 == pieces.len();
            let is_in_share = |place: &f64| *place < above || is_last;
            if !places_in_sum.peek().is_some_and(is_in_share) {
                continue;
            }

            // The rays to this piece.
            let lamp = self.scene.surface(piece.lamp);
            let whole = lamp.polygon.facet();
            let facet = piece.part.as_ref().map_or(whole, |part| part.facet(whole.normal));
            let spread = sampling::shifted_sobol_2d(sampling::hash(place.seed, u64::from(piece.lamp.0) << 32 | number as u64));
            for ray in (0..).take_while(|_| places_in_sum.next_if(is_in_share).is_some()) {
                let [u, v] = spread(ray);
                let y = facet.point_at(u, v);
                let (from, to) = (place.point.to_array(), y.to_array());
                segments.push(Segment { from, to, from_plane: receiver.plane, to_plane: lamp.plane });
                drawn.push(Drawn {
                    place: index,
                    lamp: piece.lamp,
                    form_factor: piece.form_factor,
                    sampled: facet.area * kernel(place.point, normal, y, facet.normal),
                    share: weight * total / piece.carried,
                });
            }
        }
    }

    /// Cuts a lamp, or a part of one, into pieces that are small as seen from `point`, and keeps those that can be seen.
    fn cut(&self, point: DVec3, normal: DVec3, lamp: SurfaceId, part: Option<Part>, pieces: &mut Vec<Piece>) {
        let whole = self.scene.surface(lamp).polygon.facet();
        let facet: Facet<'_> = part.as_ref().map_or(whole, |part| part.facet(whole.normal));
        let form_factor = point_to_polygon(point, normal, &facet);
        if form_factor <= 0.0 {
            return;
        }
        let splits = part.map_or(0, |part| part.splits);
        if facet.radius * facet.radius > SMALL * SMALL * point.distance_squared(facet.centroid) && splits < MAX_SPLITS {
            for_each_piece(&facet, |corners| self.cut(point, normal, lamp, Some(Part::new(corners, splits + 1)), pieces));
            return;
        }
        pieces.push(Piece { lamp, part, form_factor, carried: form_factor * brightest(self.scene, lamp) });
    }
}

/// A lamp as a source of rays that are drawn.
fn source(scene: &Scene, lamp: SurfaceId) -> aim_tree::Source {
    let polygon = &scene.surface(lamp).polygon;
    let power = polygon.area() * brightest(scene, lamp);
    aim_tree::Source { number: lamp.0, bounds: polygon.bounds(), normal: polygon.facet().normal, power }
}

/// The exitance of a surface in its brightest channel, in W/m^2.
fn brightest(scene: &Scene, surface: SurfaceId) -> f64 {
    scene.material_of(surface).exitance.iter().copied().fold(0.0, f64::max)
}

/// The part of rays that meets nothing, of rays from random points of all surfaces by the cosine.
fn sampled_share_lost(scene: &Scene, rays: &Rays<'_>, total_area: f64) -> f64 {
    // Points at even steps through the surfaces' areas, one ray from each.
    let mut probes = Vec::new();
    let mut below = 0.0;
    for surface in scene.surfaces() {
        let facet = surface.polygon.facet();
        let frame = Frame::around(facet.normal);
        below += facet.area;
        while f64::from(probes.len() as u32) + 0.5 < below / total_area * f64::from(PROBES) {
            let [u, v, s, t] = sampling::sobol_4d(probes.len() as u32, 0);
            let direction = frame.sampled_by_cosine(s, t).to_array();
            probes.push(Ray { origin: facet.point_at(u, v).to_array(), direction, origin_plane: surface.plane });
        }
    }

    let mut hits = Vec::new();
    rays.first_hits(&probes, &mut hits);
    hits.iter().filter(|hit| hit.is_none()).count() as f64 / probes.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    /// A floor and `count` small lamps above it, turned every way, some behind others.
    fn lamps_over_a_floor(count: u64) -> Scene {
        let material = |reflectance: f64, exitance: f64| Material {
            name: format!("{exitance}"),
            reflectance: vec![reflectance],
            exitance: vec![exitance],
        };
        let quad = |corner: DVec3, u: DVec3, v: DVec3| {
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let mut faces = vec![(quad(DVec3::ZERO, 10.0 * DVec3::X, 10.0 * DVec3::Y), 0, 0)];
        for lamp in 0..count {
            let random = |draw| sampling::unit(sampling::hash(lamp, draw));
            let direction = |draw| (DVec3::new(random(draw), random(draw + 1), random(draw + 2)) - 0.5).normalize();
            let normal = (direction(10) - 0.6 * DVec3::Z).normalize();
            let u = normal.cross(direction(20)).normalize();
            let corner = DVec3::new(10.0 * random(1), 10.0 * random(2), 0.5 + 3.0 * random(3));
            faces.push((quad(corner, 0.1 * u, 0.1 * normal.cross(u)), 1 + (lamp % 3) as u32, 1 + lamp as u32));
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
    fn lamps_from_the_tree_bring_what_all_lamps_bring() {
        let scene = lamps_over_a_floor(1000);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let lamps = Lamps::new(&scene, &rays);

        // With more rays than lamps all lamps are looked at; 16 rays choose among them, a thousand times: those of each place, or those of
        // four places together, which lie meters apart.
        let mut expected = vec![0.0; 20];
        let mut aimed = AimedRays::default();
        lamps.add_sampled_irradiance(&places(1), 1, &rays, 50_000, &mut aimed, &mut expected);
        for together in [1, 4] {
            let (mut sum, mut sum_sq) = (vec![0.0; 20], vec![0.0; 20]);
            let rounds = 1000;
            for round in 0..rounds {
                let mut found = vec![0.0; 20];
                lamps.add_sampled_irradiance(&places(100 + round), together, &rays, 16, &mut aimed, &mut found);
                found.iter().zip(sum.iter_mut().zip(sum_sq.iter_mut())).for_each(|(h, (sum, sum_sq))| {
                    *sum += h;
                    *sum_sq += h * h;
                });
            }
            for (place, expected) in expected.iter().enumerate() {
                let n = rounds as f64;
                let mean = sum[place] / n;
                let sigma = ((sum_sq[place] / n - mean * mean) / n).sqrt();
                // What is expected has noise of its own, less than 0.3% with 50 rays to a lamp on average.
                let off = (mean - expected).abs();
                assert!(off <= 4.5 * sigma + 0.003 * expected, "{together}, place {place}: {mean} +- {sigma}, not {expected}");
                let scatter = sigma * n.sqrt() / mean;
                assert!(scatter < 1.0 || together > 1, "place {place}: a single look scatters by {scatter}");
            }
        }
    }

    #[test]
    fn a_lamp_beside_a_place_is_drawn_by_what_it_sends_however_large_its_group() {
        // Lamps far apart, and places a hand's breadth from each of them.
        let scene = lamps_over_a_floor(200);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let lamps = Lamps::new(&scene, &Rays::new(&*visibility, &scene));
        for &beside in &lamps.surfaces {
            let facet = scene.surface(beside).polygon.facet();
            let (point, normal) = (facet.centroid + 0.1 * facet.normal, -facet.normal);
            let sends = |number: u32| {
                let lamp = SurfaceId(number);
                point_to_polygon(point, normal, &scene.surface(lamp).polygon.facet()) * brightest(&scene, lamp)
            };
            let mut drawn = Vec::new();
            let numbers = (0..64).map(|k| (f64::from(k) + 0.5) / 64.0);
            lamps.tree.as_ref().unwrap().draw(std::iter::once(point), normal, sends, numbers, &mut Vec::new(), &mut drawn);

            // Every ray stands for at most a few times all that arrives.
            let all: f64 = lamps.surfaces.iter().map(|lamp| sends(lamp.0)).sum();
            for lamp in drawn {
                assert!(
                    sends(lamp.number) / lamp.probability <= 4.0 * all,
                    "{:?} of {all} by {}",
                    sends(lamp.number),
                    lamp.probability
                );
            }
        }
    }

    #[test]
    fn dim_emitters_that_are_large_are_left_to_the_hemisphere_beside_bright_ones() {
        // A room under a wide sky, and a lamp in it.
        let quad = |corners: [[f64; 3]; 4]| Polygon::from_vertices(corners.map(DVec3::from).to_vec()).unwrap();
        let side = |a: [f64; 2], b: [f64; 2]| quad([[a[0], a[1], 0.0], [b[0], b[1], 0.0], [b[0], b[1], 1.0], [a[0], a[1], 1.0]]);
        let floor = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        let sky = quad([[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]);
        let lamp = quad([[0.4, 0.4, 0.9], [0.4, 0.5, 0.9], [0.5, 0.5, 0.9], [0.5, 0.4, 0.9]]);
        let walls = [([1.0, 0.0], [0.0, 0.0]), ([1.0, 1.0], [1.0, 0.0]), ([0.0, 1.0], [1.0, 1.0]), ([0.0, 0.0], [0.0, 1.0])];
        let material = |exitance: f64| Material { name: String::new(), reflectance: vec![0.5], exitance: vec![exitance] };
        let mut faces = vec![(floor, 0, 0), (sky, 1, 1), (lamp, 2, 2)];
        faces.extend(walls.map(|(a, b)| (side(a, b), 1, 3)));
        let scene = Scene::new(1, vec![material(0.0), material(1.0), material(20.0)], faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let lamps = Lamps::new(&scene, &Rays::new(&*visibility, &scene));
        assert_eq!(
            (lamps.contains(SurfaceId(0)), lamps.contains(SurfaceId(1)), lamps.contains(SurfaceId(2))),
            (false, false, true)
        );
    }

    #[test]
    fn rays_do_not_grow_with_the_number_of_lamps() {
        for count in [1, 16, 17, 1000] {
            let scene = lamps_over_a_floor(count);
            let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let (lamps, aimed) = (Lamps::new(&scene, &rays), &mut AimedRays::default());
            lamps.add_sampled_irradiance(&places(1), 1, &rays, 24, aimed, &mut [0.0; 20]);
            let cast = rays.segments().count();
            assert!(cast + rays.spared() <= 20 * 24, "{count} lamps: {cast} rays");
        }
    }

    #[test]
    fn what_does_not_meet_the_other_square_is_lost() {
        let quad = |corners: [[f64; 3]; 4]| Polygon::from_vertices(corners.map(DVec3::from).to_vec()).unwrap();
        let floor = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        let ceiling = quad([[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]);
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
        let scene = Scene::new(1, vec![material], vec![(floor, 0, 0), (ceiling, 0, 1)], Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);

        // One of two facing squares sees the other by 0.19982 (Howell C-11).
        let (lost, expected) = (sampled_share_lost(&scene, &rays, 2.0), 1.0 - 0.19982);
        let sigma = (expected * (1.0 - expected) / f64::from(PROBES)).sqrt();
        assert!((lost - expected).abs() <= 3.0 * sigma, "{lost} instead of {expected} +- {sigma}");
        assert!(Lamps::new(&scene, &rays).contains(SurfaceId(0)));
    }

    #[test]
    fn places_together_draw_the_lamps_of_one_place_with_all_of_their_rays() {
        let scene = lamps_over_a_floor(1000);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let lamps = Lamps::new(&scene, &rays);
        let drawn = |places: &[Place], together: usize, count: u32| {
            let mut aimed = AimedRays::default();
            lamps.add_sampled_irradiance(places, together, &rays, count, &mut aimed, &mut vec![0.0; places.len()]);
            let mut drawn: Vec<u32> = aimed.drawn.iter().map(|drawn| drawn.lamp.0).collect();
            drawn.sort_unstable();
            drawn
        };
        for place in places(3) {
            assert_eq!(drawn(&[place; 4], 4, 4), drawn(&[place], 1, 16));
        }
    }
}
