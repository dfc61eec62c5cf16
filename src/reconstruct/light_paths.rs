//! Light paths that know nothing of links: rays to lamps and over the hemisphere, and what they find.
//!
//! A path leaves a place by the cosine. Where it ends it finds the radiosity that is resolved in the cell there, if the cell looks
//! small from where the path comes. Else, near by, the cell's one value is no good: one ray to a lamp and one over the hemisphere
//! take its place, and the path goes on.
//!
//! At reflectors rays are aimed as at lamps, if the cell that they see looks small; so paths that find such a cell bring nothing.

use glam::DVec3;

use super::lamps::{AimedRays, Lamps};
use super::lattice::Lattice;
use super::reflectors::{ReflectorRays, Reflectors, Seen, reflectors};
use crate::geometry::{Frame, sampling};
use crate::hierarchy::Hierarchy;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Radiosity;
use crate::transmittance::Rays;
use crate::visibility::{Hit, NO_PLANE, Ray, Segment};

/// A point on a surface, and the seed of the rays from there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub point: DVec3,
    pub surface: SurfaceId,
    pub seed: u64,
}

/// Those from number `first` on of the directions that a seed gives.
#[derive(Clone, Copy)]
pub(super) struct Directions {
    pub seed: u64,
    pub first: u32,
}

/// A cell looks small from so many times its size. Empirical, at 1%: with 1.5, 2 and 2.5 the square of what values are off by for believing
/// cells made up 23, 14 and 13% of what is allowed in a game level, 16, 14 and 11% in a room, for 4 and 8% more rays; with 3.5 it grew again
/// in the room, whose paths are then too noisy.
const SMALL_FROM: f64 = 2.0;

/// After so many bounces a path ends in the cell where it is, however large that looks.
const MAX_BOUNCES: u32 = 16;

/// A path of which this part or less is left ends in the next cell, however large that looks. Empirical: the error of an office with 300
/// paths a point came out at 1.45, 1.37 and 1.36% with 1/2, 1/4 and 1/10, for ever 5% more rays of the solve.
const LITTLE: f64 = 0.25;

/// What meets backs with more than this part of its rays is covered.
pub(super) const COVERED: f32 = 0.5;

/// Rays to reflectors for each ray to lamps.
const REFLECTOR_RAYS: f64 = 0.5;

/// The cell of a path that ends on none.
pub(super) const NO_CELL: u32 = u32::MAX;

/// Where paths end, path after path. One that ends where its first ray arrives brings what its cell sends.
#[derive(Default)]
pub(crate) struct Ends {
    /// By path; [`NO_CELL`] for detours too.
    pub(super) cell: Vec<u32>,
    /// By path, where in that cell.
    pub(super) point: Vec<DVec3>,
    /// By path, whether the first thing that it met was a back.
    pub(super) back: Vec<bool>,
    /// The paths that went on, in their order.
    pub(super) detours: Vec<Detour>,
    /// By detour and channel: it brings `constant + weight * (what its cell sends)`.
    pub(super) constant: Vec<f64>,
    pub(super) weight: Vec<f64>,
    /// The cells of reflectors that rays from detours see, each with the detour.
    pub(super) seen: Vec<(usize, u32)>,
    /// By what is seen and channel: it brings `weight * (what the cell sends)`.
    pub(super) seen_weight: Vec<f64>,
}

impl Ends {
    /// By place, from which `count` paths started: whether so many met a back at once that it is covered.
    pub(super) fn covered(&self, count: u32) -> Vec<bool> {
        let is_covered = |backs: &[bool]| backs.iter().filter(|&&back| back).count() as f32 > COVERED * count as f32;
        self.back.chunks(count as usize).map(is_covered).collect()
    }
}

/// A path that went on from where its first ray arrived.
pub(super) struct Detour {
    pub path: usize,
    /// Where it ends.
    pub cell: u32,
    /// Where it would have ended, had it not been told to take more bounces: where its first ray arrived, or [`NO_CELL`].
    pub shortcut: u32,
}

/// Memory that is reused from batch to batch.
#[derive(Default)]
pub(crate) struct PathScratch {
    pub(super) ends: Ends,
    /// The rays of a place in the order in which they are cast.
    order: Vec<u32>,
    looks: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Where detours are, and their numbers.
    walks: Vec<Place>,
    detour_of: Vec<usize>,
    irradiance: Vec<f64>,
    aimed: AimedRays,
    reflector_rays: ReflectorRays,
    /// What aimed rays have seen of reflectors.
    pub(super) seen: Vec<Seen>,
}

/// What a ray finds.
enum Arrival {
    /// Nothing, or what rays are aimed at.
    Nothing,
    Back,
    /// A cell that looks small, and where in it.
    Cell(u32, DVec3),
    /// Something so near that its cell looks large, or where no cell is wanted; the cell, if it looks small.
    Onward(DVec3, SurfaceId, Option<u32>),
}

/// Casts light paths through a scene.
pub(crate) struct LightPaths<'a> {
    pub(super) scene: &'a Scene,
    pub(super) lattice: Lattice,
    rays: &'a Rays<'a>,
    lamps: Lamps<'a>,
    reflectors: Reflectors<'a>,
}

impl<'a> LightPaths<'a> {
    /// Paths that end in cells of about `side` metres; `radiosity` tells which surfaces are reflectors.
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, hierarchy: &Hierarchy, radiosity: &Radiosity, side: f64) -> Self {
        let reflectors = reflectors(scene, hierarchy, radiosity);
        let lattice = Lattice::new(scene, &reflectors, side);
        let reflectors = Reflectors::new(scene, &reflectors, &lattice, SMALL_FROM);
        Self { scene, rays, lattice, lamps: Lamps::new(scene, rays), reflectors }
    }

    /// Adds the irradiance from lamps at each place, by `count` rays, place after place; `scratch` has what they see of reflectors then.
    /// Of the places `together` in a row draw lamps as one place with all of their rays would.
    pub(super) fn add_aimed(
        &self,
        places: &[Place],
        together: usize,
        count: u32,
        scratch: &mut PathScratch,
        irradiance: &mut [f64],
    ) {
        self.lamps.add_sampled_irradiance(places, together, self.rays, count, &mut scratch.aimed, irradiance);
        self.see_reflectors(places, count, scratch);
    }

    /// Fills in what the rays to reflectors see that go with `count` rays to lamps.
    pub(super) fn see_reflectors(&self, places: &[Place], count: u32, scratch: &mut PathScratch) {
        let to_reflectors = (f64::from(count) * REFLECTOR_RAYS).ceil() as u32;
        self.reflectors.see(places, self.rays, to_reflectors, &mut scratch.reflector_rays, &mut scratch.seen);
    }

    /// The cell of a place.
    pub(super) fn cell_at(&self, place: &Place) -> Option<u32> {
        self.lattice.cell_at(place.surface, place.point).map(|(cell, _)| cell)
    }

    /// The cell of a point, if it looks small from so many metres away.
    fn small_cell(&self, surface: SurfaceId, point: DVec3, distance: f64) -> Option<u32> {
        let (cell, size) = self.lattice.cell_at(surface, point)?;
        (distance >= SMALL_FROM * size).then_some(cell)
    }

    /// What a surface emits that lamp rays do not bring, by channel.
    pub(super) fn unlamped_exitance(&self, surface: SurfaceId) -> Option<&'a [f64]> {
        (!self.lamps.contains(surface)).then(|| &self.scene.material_of(surface).exitance[..])
    }

    /// The part of what a place sees, by the cosine, that is nearer than `within` metres; by `count` rays.
    pub(super) fn sampled_near(&self, place: &Place, count: u32, within: f64) -> f64 {
        let to_end = |ray: Ray| {
            let to = DVec3::from(ray.origin) + within * DVec3::from(ray.direction);
            Segment { from: ray.origin, to: to.to_array(), from_plane: ray.origin_plane, to_plane: NO_PLANE }
        };
        let segments: Vec<Segment> = self.cosine_rays(place, 0..count).map(to_end).collect();
        let mut occluded = Vec::new();
        self.rays.occluded(&segments, &mut occluded);
        occluded.iter().filter(|&&occluded| occluded).count() as f64 / f64::from(count)
    }

    /// Follows `count` paths from each place to the ends that `scratch` has then; each takes `bounces` bounces at least.
    pub(super) fn follow(&self, places: &[Place], count: u32, bounces: u32, scratch: &mut PathScratch) {
        let alone = |place: &Place| Directions { seed: place.seed, first: 0 };
        self.follow_towards(places, &places.iter().map(alone).collect::<Vec<_>>(), count, bounces, scratch);
    }

    /// The same, with the directions in which the paths of each place begin.
    pub(super) fn follow_towards(
        &self,
        places: &[Place],
        directions: &[Directions],
        count: u32,
        bounces: u32,
        scratch: &mut PathScratch,
    ) {
        let PathScratch { ends, order, looks, walks, detour_of, .. } = scratch;
        let paths = places.len() * count as usize;
        ends.cell.clear();
        ends.cell.resize(paths, NO_CELL);
        ends.point.resize(paths, DVec3::ZERO);
        ends.back.clear();
        ends.back.resize(paths, false);
        ends.detours.clear();
        ends.seen.clear();
        ends.seen_weight.clear();
        walks.clear();
        detour_of.clear();

        // The first rays, from the places.
        if order.len() != count as usize {
            *order = sampling::neighbours_in_order(count);
        }
        looks.clear();
        for (place, &Directions { seed, first }) in places.iter().zip(directions) {
            looks.extend(self.cosine_rays(&Place { seed, ..*place }, order.iter().map(|ray| first + ray)));
        }
        self.rays.first_hits(looks, &mut scratch.hits);
        for (path, (look, hit)) in looks.iter().zip(&scratch.hits).enumerate() {
            match self.arrival(places[path / count as usize].surface, look, *hit, bounces > 0) {
                Arrival::Nothing => {}
                Arrival::Back => ends.back[path] = true,
                Arrival::Cell(cell, point) => (ends.cell[path], ends.point[path]) = (cell, point),
                Arrival::Onward(point, surface, small) => {
                    let (place, ray) = (path / count as usize, path % count as usize);
                    let seed = sampling::hash(places[place].seed, ray as u64 | 1 << 32);
                    walks.push(Place { point, surface, seed });
                    detour_of.push(ends.detours.len());
                    ends.detours.push(Detour { path, cell: NO_CELL, shortcut: small.unwrap_or(NO_CELL) });
                }
            }
        }

        // Bounce by bounce, those that have not ended go on from where they are.
        let channels = self.scene.channels();
        ends.constant.clear();
        ends.constant.resize(ends.detours.len() * channels, 0.0);
        ends.weight.clear();
        ends.weight.resize(ends.detours.len() * channels, 1.0);
        for bounce in 1..=MAX_BOUNCES {
            if scratch.walks.is_empty() {
                break;
            }
            self.reflect(scratch);
            self.go_on(scratch, bounce < bounces, bounce == MAX_BOUNCES);
        }
    }

    /// Adds the light that detours find where they are, and takes from their weights what is absorbed there.
    fn reflect(&self, scratch: &mut PathScratch) {
        let PathScratch { ends, walks, detour_of, irradiance, aimed, reflector_rays, seen, .. } = scratch;
        let channels = self.scene.channels();
        irradiance.clear();
        irradiance.resize(walks.len() * channels, 0.0);
        self.lamps.add_sampled_irradiance(walks, 1, self.rays, 1, aimed, irradiance);
        for ((walk, &detour), irradiance) in walks.iter().zip(&*detour_of).zip(irradiance.chunks(channels)) {
            let material = self.scene.material_of(walk.surface);
            let exitance = self.unlamped_exitance(walk.surface);
            for channel in 0..channels {
                let own = exitance.map_or(0.0, |exitance| exitance[channel]);
                let (rho, index) = (material.reflectance[channel], detour * channels + channel);
                ends.constant[index] += ends.weight[index] * (own + rho * irradiance[channel]);
                ends.weight[index] *= rho;
            }
        }
        self.reflectors.see(walks, self.rays, 1, reflector_rays, seen);
        for seen in &*seen {
            let detour = detour_of[seen.by];
            ends.seen.push((detour, seen.cell));
            ends.seen_weight.extend(ends.weight[detour * channels..][..channels].iter().map(|left| left * seen.weight));
        }
    }

    /// Casts the next ray of each detour. Those that find a small cell end there; those of which little is left, or all with `anywhere`,
    /// end in large ones too: else a third of all paths would go to and fro between the books of a shelf until [`MAX_BOUNCES`]. With
    /// `beyond` no cell looks small.
    fn go_on(&self, scratch: &mut PathScratch, beyond: bool, anywhere: bool) {
        let PathScratch { ends, looks, hits, walks, detour_of, .. } = scratch;
        looks.clear();
        walks.iter().for_each(|walk| looks.extend(self.cosine_rays(walk, 0..1)));
        self.rays.first_hits(looks, hits);

        let channels = self.scene.channels();
        let little_is_left = |detour: usize| ends.weight[detour * channels..][..channels].iter().all(|&weight| weight <= LITTLE);
        let mut left = 0;
        for (index, (look, hit)) in looks.iter().zip(&*hits).enumerate() {
            let detour = detour_of[index];
            match self.arrival(walks[index].surface, look, *hit, beyond) {
                Arrival::Nothing | Arrival::Back => {}
                Arrival::Cell(cell, _) => ends.detours[detour].cell = cell,
                Arrival::Onward(point, surface, _) if anywhere || little_is_left(detour) => {
                    ends.detours[detour].cell = self.lattice.cell_at(surface, point).map_or(NO_CELL, |(cell, _)| cell);
                }
                Arrival::Onward(point, surface, _) => {
                    walks[left] = Place { point, surface, seed: sampling::hash(walks[index].seed, 1 << 33) };
                    detour_of[left] = detour;
                    left += 1;
                }
            }
        }
        walks.truncate(left);
        detour_of.truncate(left);
    }

    /// What a ray from a surface finds; with `beyond` no cell looks small.
    fn arrival(&self, from: SurfaceId, ray: &Ray, hit: Option<Hit>, beyond: bool) -> Arrival {
        let Some(hit) = hit else { return Arrival::Nothing };
        let direction = DVec3::from(ray.direction);
        let Some(surface) = self.scene.side_towards(SurfaceId(hit.surface), -direction) else { return Arrival::Back };
        let point = DVec3::from(ray.origin) + hit.distance * direction;
        match self.small_cell(surface, point, hit.distance) {
            Some(_) if self.reflectors.are_aimed_at(from, surface) => Arrival::Nothing,
            Some(cell) if !beyond => Arrival::Cell(cell, point),
            small => Arrival::Onward(point, surface, small),
        }
    }

    /// Rays from a place by the cosine, spread as Sobol points.
    fn cosine_rays(&self, place: &Place, indices: impl Iterator<Item = u32>) -> impl Iterator<Item = Ray> {
        let surface = self.scene.surface(place.surface);
        let frame = Frame::around(surface.polygon.facet().normal);
        let (origin, origin_plane, seed) = (place.point.to_array(), surface.plane, place.seed);
        let spread = sampling::shifted_sobol_2d(seed);
        indices.map(move |index| {
            let [u, v] = spread(index);
            Ray { origin, direction: frame.sampled_by_cosine(u, v).to_array(), origin_plane }
        })
    }
}
