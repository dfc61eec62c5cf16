//! Light paths: how they go on, and where they end.
//!
//! A path leaves a place in a cosine-distributed direction, or one that is guided by what is seen of emitters (`guide`). Where its ray
//! arrives it ends in the cell there, if the cell is small as seen from where the ray started, and has a value at that point ([`OpenParts`]).
//! Else one value would be too coarse: the path goes on from the point itself, with one next-event ray and one more ray. Paths of little
//! weight go on at random, so that what they bring is right on average however often they go on ([`Ends::goes_on`]).
//!
//! A path that leaves the scene brings the light of the sky there.
//!
//! Next-event rays bring the light of emitters and lights, so a path that arrives at an emitter brings nothing of that. They bring a part of the light of
//! bright reflectors, by cells that are small, and a path that arrives in such a cell the rest.

use glam::DVec3;

use super::batch_sums::BatchSums;
use super::course::Course;
use super::direct_sums::DirectSums;
use super::emitters::Emitters;
use super::ends::{Arrival, Ends, ValueEnd};
use super::grid::Grid;
use super::grids::{CellSize, Grids};
use super::next_event::EmitterRays;
use super::open_parts::{OpenPart, OpenParts};
use super::place::{Directions, Place, Receives, cosine_rays};
use super::reflector_rays::{RAYS_OF_PATH, ReflectorRays, Reflectors, SeenCell};
use super::reflectors::Brightness;
use crate::direct::{Blockers, DirectLight, LightRays, Lights};
use crate::geometry::{sampling, streams};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// A cell is small from so many times its size. Nearer, values take more of their error from cells; farther, paths get longer.
/// Empirical.
const SMALL_FROM: f64 = 2.0;

/// After so many bounces a path ends and brings no more. Safety limit: at a reflectance of 0.99, Russian roulette leaves fewer than one
/// path in a million so long.
const MAX_BOUNCES: u32 = 2048;

/// Memory that is reused from batch to batch.
#[derive(Default)]
pub(crate) struct PathScratch {
    pub ends: Ends,
    /// Cells of reflectors that next-event rays have seen.
    pub seen: Vec<SeenCell>,
    /// The numbers of the paths of a place in the order in which they are cast.
    pub order: Vec<u32>,
    pub(super) rays: Vec<Ray>,
    pub(super) hits: Vec<Option<Hit>>,
    /// Where paths go on, and the number of each one's continuation.
    pub(super) heads: Vec<Place>,
    pub(super) continuation_of: Vec<usize>,
    irradiance: Vec<f64>,
    emitter_rays: EmitterRays,
    light_rays: LightRays,
    pub(super) direct: DirectSums,
    reflector_rays: ReflectorRays,
    /// Paths that have left the scene at their first rays: their continuations, and directions.
    pub(super) into_sky: Vec<(usize, DVec3)>,
    /// Of continuations whose first rays arrive where paths of values end.
    pub(super) value_ends: Vec<ValueEnd>,
}

/// Casts light paths through a scene.
pub(crate) struct LightPaths<'a> {
    pub scene: &'a Scene,
    pub grids: Grids,
    open_parts: OpenParts<'a>,
    pub rays: &'a Rays<'a>,
    emitters: Emitters<'a>,
    lights: Lights<'a>,
    has_sky: bool,
    reflectors: Reflectors<'a>,
    /// By surface: it sends nothing that paths could bring.
    is_black: Vec<bool>,
}

impl<'a> LightPaths<'a> {
    /// Paths that end in cells of this size. Once stopped, no rays are aimed at bright reflectors and spots.
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, brightness: &Brightness, size: CellSize, stop: Stop<'_>) -> Self {
        let grids = Grids::new(scene, brightness, size);
        let reflectors = Reflectors::new(scene, rays, brightness, &grids, SMALL_FROM, stop);
        let emitters = Emitters::new(scene, rays);
        let is_black = |surface: SurfaceId| {
            let material = scene.material_of(surface);
            material.reflectance.iter().all(|&rho| rho == 0.0) && (!material.emits() || emitters.contains(surface))
        };
        let is_black = (0..scene.surfaces().len() as u32).map(|surface| is_black(SurfaceId(surface))).collect();
        let open_parts = OpenParts::new(scene, rays, &grids);
        let (lights, has_sky) = (Lights::new(scene, rays), scene.has_sky());
        Self { scene, rays, grids, open_parts, emitters, lights, has_sky, reflectors, is_black }
    }

    /// Bytes that paths take in a scene with so many cells: grids, open parts, sources of light, and cells that rays are aimed at.
    pub fn bytes_of(scene: &Scene, cells: usize) -> u64 {
        /// An emitter, what it is while the light tree is built, and its part of the nodes.
        const OF_EMITTER: usize = 192;
        let surfaces = scene.surfaces().len();
        let emitters = scene.surfaces().iter().filter(|surface| scene.materials()[surface.material as usize].emits()).count();
        let of_grid = Grids::BYTES_OF_GRID + OpenParts::BYTES_OF_GRID;
        let of_cell = OpenParts::BYTES_OF_CELL + size_of::<u32>();
        let of_surface = Grids::BYTES_OF_SURFACE + size_of::<bool>();
        (surfaces * of_surface + surfaces.min(cells) * of_grid + cells * of_cell + emitters * OF_EMITTER) as u64
    }

    /// Next-event estimation: adds the irradiance from emitters and lights at each place, by `count` rays to each kind, and fills `scratch.seen` with what
    /// is seen of reflectors. Each `together` places in a row draw emitters as one place with all of their rays would.
    pub fn add_next_event(
        &self,
        places: &[impl Receives],
        together: usize,
        count: u32,
        scratch: &mut PathScratch,
        irradiance: &mut BatchSums<'_>,
    ) {
        self.emitters.add_sampled_irradiance(places, together, count, &mut scratch.emitter_rays, irradiance);
        self.add_lights(places, count, &mut scratch.light_rays, irradiance);
        self.see_reflectors(places, count, scratch);
    }

    /// Adds the direct irradiance from emitters and lights at each place, and fills `scratch.seen` with what is seen of reflectors, by as many rays as
    /// [`Self::add_next_event`] takes: emitters are seen exactly where that is worth it.
    pub fn add_direct(&self, places: &[impl Receives], count: u32, scratch: &mut PathScratch, irradiance: &mut BatchSums<'_>) {
        if !self.may_see_exactly(count) {
            return self.add_next_event(places, 1, count, scratch, irradiance);
        }
        scratch.direct.add_irradiance(&self.direct_light(), places, count, irradiance);
        self.see_reflectors(places, count, scratch);
    }

    /// Whether to look at all emitters costs less than so many rays.
    pub fn may_see_exactly(&self, rays: u32) -> bool {
        self.emitters.emitters.len() <= rays as usize
    }

    pub(super) fn direct_light(&self) -> DirectLight<'_> {
        let blockers = Blockers::of(self.scene, self.rays);
        DirectLight { scene: self.scene, rays: self.rays, blockers, emitters: &self.emitters.emitters }
    }

    /// Adds the irradiance from lights at each place, by `count` rays or one for each light, whichever is less; that of the sky comes by paths.
    fn add_lights(&self, places: &[impl Receives], count: u32, memory: &mut LightRays, irradiance: &mut BatchSums<'_>) {
        let receivers = places.iter().map(|place| place.receiver(self.scene));
        self.lights.add_irradiance(receivers, count, memory, |place, h, variance| {
            for (channel, (&h, &variance)) in h.iter().zip(variance).enumerate() {
                irradiance.add(place, channel, h, variance);
            }
        });
    }

    /// Fills `scratch.seen` by the rays to reflectors that go with `count` rays to emitters.
    pub fn see_reflectors(&self, places: &[impl Receives], count: u32, scratch: &mut PathScratch) {
        let to_reflectors = (f64::from(count) * RAYS_OF_PATH).ceil() as u32;
        self.see(places, to_reflectors, &mut scratch.reflector_rays, &mut scratch.seen);
    }

    /// Casts rays to reflectors; points where cells have no value are left to paths.
    fn see(&self, places: &[impl Receives], count: u32, memory: &mut ReflectorRays, seen: &mut Vec<SeenCell>) {
        self.reflectors.see(places, |place| self.is_on_target(place), count, memory, seen);
        seen.retain(|seen| self.cell_at(seen.surface, seen.point).is_some());
    }

    /// Whether a place lies in a cell to which next-event rays go. From there none goes to others: they are too close.
    fn is_on_target(&self, place: &impl Receives) -> bool {
        let point = place.receiver(self.scene).point;
        let grid = place.surface().and_then(|surface| self.grids.at(surface, point));
        grid.is_some_and(|grid| self.reflectors.is_target(grid.cell_at(point)))
    }

    /// The cell that has a value at a point.
    pub fn cell_at(&self, surface: SurfaceId, point: DVec3) -> Option<u32> {
        let grid = self.grids.at(surface, point)?;
        self.open_parts.contains(surface, grid, point).then(|| grid.cell_at(point))
    }

    /// Where cell number `index` of a surface's grid has a value; `None` if nowhere.
    pub fn open_part<'b>(&'b self, surface: SurfaceId, grid: &'b Grid, index: usize) -> Option<OpenPart<'b>> {
        self.open_parts.part_of(surface, grid, index)
    }

    /// The cell that has a value at a point, if it is small as seen from `distance` metres away.
    fn small_cell(&self, surface: SurfaceId, point: DVec3, distance: f64) -> Option<u32> {
        let is_small = distance >= SMALL_FROM * self.grids.at(surface, point)?.size();
        if is_small { self.cell_at(surface, point) } else { None }
    }

    /// The exitance of a surface by channel; `None` if next-event estimation brings it.
    pub fn unsampled_exitance(&self, surface: SurfaceId) -> Option<&'a [f64]> {
        (!self.emitters.contains(surface)).then(|| &self.scene.material_of(surface).exitance[..])
    }

    /// Follows paths from each place; fills `scratch.ends`.
    pub fn follow<P: Receives>(&self, places: &[P], course: &Course, scratch: &mut PathScratch) {
        let alone = |place: &P| Directions { seed: place.receiver(self.scene).seed, first: 0 };
        self.follow_towards(places, &places.iter().map(alone).collect::<Vec<_>>(), course, scratch);
    }

    /// The same, with the first directions of each place's paths given.
    pub fn follow_towards(&self, places: &[impl Receives], directions: &[Directions], course: &Course, scratch: &mut PathScratch) {
        self.leave(places, directions, course, scratch);

        // Bounce by bounce: direct light where the paths are, then the next ray.
        let channels = self.scene.channels();
        let ends = &mut scratch.ends;
        ends.constant.clear();
        ends.constant.resize(ends.continued.len() * channels, 0.0);
        ends.weight.clear();
        ends.guided.clear();
        for of in &ends.continued {
            let weight = ends.first_weight[of.path];
            ends.weight.extend(std::iter::repeat_n(weight, channels));
            ends.guided.push(weight);
        }
        scratch.value_ends.drain(..).for_each(|end| ends.end_value(end, channels));
        for (continuation, direction) in scratch.into_sky.drain(..) {
            let constant = &mut ends.constant[continuation * channels..][..channels];
            self.scene.add_sky_radiosity(direction, ends.guided[continuation], constant);
            ends.trail.iter_mut().for_each(|trail| trail.collect(continuation, constant));
        }
        for bounce in 1..=MAX_BOUNCES {
            if scratch.heads.is_empty() {
                break;
            }
            self.reflect(course, scratch);
            self.go_on(course, bounce, scratch);
        }
    }

    /// Adds the direct light at the points where paths go on, and multiplies their weights by the reflectances there.
    fn reflect(&self, course: &Course, scratch: &mut PathScratch) {
        let PathScratch {
            ends, heads, continuation_of, irradiance, emitter_rays, light_rays, direct, reflector_rays, seen, ..
        } = scratch;
        let channels = self.scene.channels();

        // Emitters and lights.
        irradiance.clear();
        irradiance.resize(heads.len() * channels, 0.0);
        let mut sums = BatchSums::whole(channels, irradiance);
        if course.sees_exactly() {
            direct.add_irradiance_and_guide(&self.direct_light(), heads, course.vertex_rays, &mut sums);
            ends.next_event.resize(ends.continued.len() * channels, 0.0);
        } else {
            self.emitters.add_sampled_irradiance(heads, 1, 1, emitter_rays, &mut sums);
            self.add_lights(heads, 1, light_rays, &mut sums);
        }
        for (head, (&continuation, irradiance)) in continuation_of.iter().zip(irradiance.chunks(channels)).enumerate() {
            let surface = heads[head].surface;
            let material = self.scene.material_of(surface);
            let exitance = self.unsampled_exitance(surface);
            for channel in 0..channels {
                let own = exitance.map_or(0.0, |exitance| exitance[channel]);
                let (rho, index) = (material.reflectance[channel], continuation * channels + channel);
                ends.constant[index] += ends.weight[index] * (own + rho * irradiance[channel]);
                ends.weight[index] *= rho;
                if course.sees_exactly() {
                    // As if no ray had been guided.
                    let brought_sq = (ends.weight[index] * irradiance[channel]).powi(2) / ends.guided[continuation];
                    ends.next_event[index] += direct.next_event[head] * brought_sq;
                }
            }
            if let Some(trail) = &mut ends.trail {
                let number = self.scene.surface(surface).material;
                trail.reflect(continuation, number, exitance.is_some(), irradiance);
            }
        }

        // Bright reflectors, whose radiosities are not known here.
        self.see(heads, 1, reflector_rays, seen);
        for seen in &*seen {
            let continuation = continuation_of[seen.by];
            ends.see(continuation, seen.cell);
            let left = &ends.weight[continuation * channels..][..channels];
            ends.seen_weight.extend(left.iter().map(|left| left * seen.weight));
            ends.trail.iter_mut().for_each(|trail| trail.see(continuation, seen.weight));
        }
    }

    /// Casts the next ray of each continuation, after so many bounces, which ends in a small cell; else it goes on, by Russian roulette if it has less
    /// than little weight left.
    fn go_on(&self, course: &Course, bounces: u32, scratch: &mut PathScratch) {
        let PathScratch { ends, rays, hits, heads, continuation_of, direct, .. } = scratch;
        let beyond = bounces < course.bounces;
        let little = if beyond { f64::MIN_POSITIVE } else { course.little };
        let channels = self.scene.channels();
        rays.clear();
        for (number, (head, &continuation)) in heads.iter().zip(&*continuation_of).enumerate() {
            let receiver = head.receiver(self.scene);
            if !course.sees_exactly() {
                rays.extend(cosine_rays(&receiver, 0..1));
                continue;
            }
            let (ray, weight) = direct.guides.of(number).ray(&receiver, 0);
            rays.push(ray);
            ends.weigh(continuation, channels, weight);
        }
        self.rays.first_hits(rays, hits);

        // Those that do not end stay in the lists, moved to the front.
        let (mut left, mut brought) = (0, vec![0.0; channels]);
        for (index, (ray, hit)) in rays.iter().zip(&*hits).enumerate() {
            let continuation = continuation_of[index];
            // What follows the end of a value's path is as right as the rows of cells are.
            let value_end = ends.continued[continuation].value_end;
            let (is_past, bounces_of_value) = (value_end.is_some(), value_end.map(|number| ends.value_ends[number].bounces));
            let past_unresolved = bounces_of_value.is_some_and(|of_value| of_value + 1 == bounces);
            let (arrival, weight) =
                self.arrival(&heads[index], ray, *hit, [beyond || (course.past_values && !is_past), past_unresolved]);
            ends.weigh(continuation, channels, weight);
            match arrival {
                Arrival::Nothing => {}
                Arrival::Sky(direction) => {
                    brought.fill(0.0);
                    self.scene.add_sky_radiosity(direction, 1.0, &mut brought);
                    for (channel, brought) in brought.iter().enumerate() {
                        let index = continuation * channels + channel;
                        ends.constant[index] += ends.weight[index] * brought;
                    }
                    ends.trail.iter_mut().for_each(|trail| trail.collect(continuation, &brought));
                }
                Arrival::Cell(cell, ..) => ends.continued[continuation].cell = cell,
                Arrival::Onward(point, surface, small) => {
                    if let Some(cell) = small.filter(|_| course.past_values && !is_past) {
                        ends.end_value(ValueEnd { continuation, cell, surface, bounces }, channels);
                    }
                    let draw = sampling::unit(sampling::hash(heads[index].seed, streams::ROULETTE));
                    let cell = if course.sees_exactly() { None } else { self.cell_at(surface, point) };
                    if !ends.goes_on(continuation, cell, channels, little, draw) {
                        continue;
                    }
                    heads[left] = Place { point, surface, seed: sampling::hash(heads[index].seed, streams::NEXT_BOUNCE) };
                    continuation_of[left] = continuation;
                    left += 1;
                }
            }
        }
        heads.truncate(left);
        continuation_of.truncate(left);
    }

    /// What a ray from a place finds, and the weight of that, beside what next-event rays find. With `beyond` no path may end yet, with `past_unresolved`
    /// none on an unresolved surface.
    pub(super) fn arrival(
        &self,
        from: &impl Receives,
        ray: &Ray,
        hit: Option<Hit>,
        [beyond, past_unresolved]: [bool; 2],
    ) -> (Arrival, f64) {
        let direction = DVec3::from(ray.direction);
        let Some(hit) = hit else { return (if self.has_sky { Arrival::Sky(direction) } else { Arrival::Nothing }, 1.0) };
        let surface = self.scene.side_towards(SurfaceId(hit.surface), -direction);
        let Some(surface) = surface.filter(|surface| !self.is_black[surface.index()]) else { return (Arrival::Nothing, 1.0) };
        let point = DVec3::from(ray.origin) + hit.distance * direction;
        let small = self.small_cell(surface, point, hit.distance);
        let arrival = match small {
            Some(_) if past_unresolved && self.grids.is_unresolved(surface) => Arrival::Onward(point, surface, None),
            Some(cell) if !beyond => Arrival::Cell(cell, point, surface),
            small => Arrival::Onward(point, surface, small),
        };
        let target = small.filter(|&cell| self.reflectors.is_target(cell) && !self.is_on_target(from));
        (arrival, target.map_or(1.0, |cell| self.reflectors.weight_of_path(&from.receiver(self.scene), cell, point)))
    }
}
