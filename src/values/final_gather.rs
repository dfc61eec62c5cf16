//! The final gather: `B(x) = E + rho (direct(x) + mean over paths from x of what they bring)`.
//!
//! Direct light comes from emitters that are seen exactly, or by next-event estimation; all other by paths, by the radiosities of the cells where
//! they end. No link is read, so the cost of a point is that of its rays, however many surfaces there are.

use crate::cells::CellRadiosities;
use crate::geometry::{sampling, streams};
use crate::paths::{
    BatchSums, Continuation, Course, Ends, LightPaths, NO_CELL, NO_SURFACE, PathScratch, Place, Receives, SeenCell, SeenOnTheWay,
};
use crate::scene::SurfaceId;

/// Next-event rays for each path. Empirical.
const EMITTER_RAYS: f64 = 0.5;

/// The least number of next-event rays at a point.
const LEAST_EMITTER_RAYS: u32 = 4;

/// How many next-event rays go with `rays` paths.
pub(crate) fn emitter_rays(rays: u32) -> u32 {
    ((f64::from(rays.max(1)) * EMITTER_RAYS) as u32).max(LEAST_EMITTER_RAYS)
}

/// The final gather at points.
pub(crate) struct FinalGather<'a> {
    pub paths: &'a LightPaths<'a>,
    pub radiosities: &'a CellRadiosities,
    /// The least number of bounces before a path ends in a cell: 0 for values, more where their error is estimated.
    pub bounces: u32,
    /// See [`Course`].
    pub vertex_rays: u32,
}

/// About how many paths are followed together: their rays fit into the processor's cache.
pub(crate) const BATCH: usize = 2048;

impl FinalGather<'_> {
    /// The irradiance H at each place by `rays` paths, in W/m^2, by place and channel. The result at a place does not depend on the
    /// others.
    pub fn sampled_irradiance(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        irradiance.fill(0.0);
        let mut sums = BatchSums::whole(self.paths.scene.channels(), irradiance);
        self.add_sampled_indirect(places, rays, scratch, &mut sums);
        self.add_sampled_direct(places, rays, scratch, &mut sums);
    }

    /// Adds the direct irradiance from emitters and bright reflectors at each place: exactly, or by the next-event rays that go with `rays`
    /// paths.
    pub fn add_sampled_direct(
        &self,
        places: &[impl Receives],
        rays: u32,
        scratch: &mut PathScratch,
        irradiance: &mut BatchSums<'_>,
    ) {
        let emitter_rays = emitter_rays(rays);
        let together = (BATCH / emitter_rays as usize).max(1);
        let batches = places.chunks(together).zip(irradiance.chunks(together));
        batches.for_each(|(places, mut irradiance)| {
            self.paths.add_direct(places, emitter_rays, scratch, &mut irradiance);
            irradiance.note_straight();
            self.add_seen(places, scratch, &mut irradiance);
        });
    }

    /// Adds the irradiance from bright reflectors at each place, by the next-event rays that go with `rays` paths.
    pub fn add_sampled_from_reflectors(
        &self,
        places: &[Place],
        rays: u32,
        scratch: &mut PathScratch,
        irradiance: &mut BatchSums<'_>,
    ) {
        self.paths.see_reflectors(places, emitter_rays(rays), scratch);
        self.add_seen(places, scratch, irradiance);
    }

    /// Adds the direct irradiance from emitters and bright reflectors at each place by `count` next-event rays.
    fn add_next_event(&self, places: &[Place], count: u32, scratch: &mut PathScratch, irradiance: &mut BatchSums<'_>) {
        self.paths.add_next_event(places, 1, count, scratch, irradiance);
        self.add_seen(places, scratch, irradiance);
    }

    /// Adds the light of reflectors that rays have seen: by the radiosities of their cells, or by gathers at the points that were
    /// seen.
    fn add_seen(&self, places: &[impl Receives], scratch: &mut PathScratch, irradiance: &mut BatchSums<'_>) {
        let channels = self.paths.scene.channels();
        self.note_seen_emitters(&scratch.seen, irradiance);
        let mut add = |seen: &SeenCell, sent: &mut dyn Iterator<Item = f64>| {
            let irradiance = irradiance.in_turn(seen.by, seen.ray as usize);
            irradiance.iter_mut().zip(sent).for_each(|(h, sent)| *h += seen.weight * sent);
        };
        if self.bounces == 0 {
            scratch.seen.iter().for_each(|seen| add(seen, &mut self.radiosities.of(seen.cell).iter().map(|&sent| f64::from(sent))));
            return;
        }

        let seen = std::mem::take(&mut scratch.seen);
        let sent = Self { bounces: self.bounces - 1, ..*self }.sampled_sent(places, &seen, scratch);
        seen.iter().zip(sent.chunks(channels)).for_each(|(seen, sent)| add(seen, &mut sent.iter().copied()));
        scratch.seen = seen;
    }

    /// The radiosities of reflectors at the points that rays from `places` have `seen`, by channel: a gather of one path and one
    /// next-event ray at each.
    pub(crate) fn sampled_sent(&self, places: &[impl Receives], seen: &[SeenCell], scratch: &mut PathScratch) -> Vec<f64> {
        let channels = self.paths.scene.channels();
        // The irradiance at these points.
        let there = |(number, seen): (usize, &SeenCell)| {
            let seed = sampling::hash(places[seen.by].receiver(self.paths.scene).seed, streams::ON_REFLECTORS + number as u64);
            Place { point: seen.point, surface: seen.surface, seed }
        };
        let there: Vec<Place> = seen.iter().enumerate().map(there).collect();
        let mut sent = vec![0.0; there.len() * channels];
        let mut sums = BatchSums::whole(channels, &mut sent);
        self.add_sampled_indirect(&there, 1, scratch, &mut sums);
        self.add_next_event(&there, 1, scratch, &mut sums);

        // Reflect it, and add the exitance that next-event estimation leaves to paths.
        for (seen, sent) in seen.iter().zip(sent.chunks_mut(channels)) {
            let reflectance = &self.paths.scene.material_of(seen.surface).reflectance;
            sent.iter_mut().zip(reflectance).for_each(|(sent, rho)| *sent *= rho);
            if let Some(exitance) = self.paths.unsampled_exitance(seen.surface) {
                sent.iter_mut().zip(exitance).for_each(|(sent, exitance)| *sent += exitance);
            }
        }
        sent
    }

    /// Adds the indirect irradiance at each place, by `rays` paths.
    pub fn add_sampled_indirect(
        &self,
        places: &[impl Receives],
        rays: u32,
        scratch: &mut PathScratch,
        irradiance: &mut BatchSums<'_>,
    ) {
        let count = rays.max(1);
        let together = (BATCH / count as usize).max(1);
        let batches = places.chunks(together).zip(irradiance.chunks(together));
        batches.for_each(|(places, mut irradiance)| self.add_sampled_indirect_of_batch(places, count, scratch, &mut irradiance));
    }

    fn add_sampled_indirect_of_batch(
        &self,
        places: &[impl Receives],
        count: u32,
        scratch: &mut PathScratch,
        irradiance: &mut BatchSums<'_>,
    ) {
        let channels = self.paths.scene.channels();
        let (count, share) = (count as usize, 1.0 / f64::from(count));
        self.paths.follow(places, &Course::of_values(count as u32, self.bounces, self.vertex_rays), scratch);
        let PathScratch { ends, order, .. } = &*scratch;
        self.note_met_emitters(ends, count, irradiance);
        note_sky(ends, count, irradiance);
        let mut of_path = |path: usize, add: &dyn Fn(usize) -> f64| {
            let irradiance = irradiance.in_runs(path / count, order[path % count] as usize, count);
            irradiance.iter_mut().enumerate().for_each(|(channel, h)| *h += share * add(channel));
        };
        let sent = |cell: u32, channel: usize| f64::from(self.radiosities.of(cell)[channel]);

        // Paths that end where their first rays arrive.
        for (path, &cell) in ends.cell.iter().enumerate().filter(|(_, cell)| **cell != NO_CELL) {
            of_path(path, &|channel| ends.first_weight[path] * sent(cell, channel));
        }

        // Paths that went on: the direct light on the way, and the cell at the end.
        let continued = ends.continued.iter().zip(ends.constant.chunks(channels)).zip(ends.weight.chunks(channels));
        for ((&Continuation { path, cell, .. }, constant), weight) in continued {
            if cell == NO_CELL {
                of_path(path, &|channel| constant[channel]);
            } else {
                of_path(path, &|channel| constant[channel] + weight[channel] * sent(cell, channel));
            }
        }

        // Other cells whose light they bring.
        for (&SeenOnTheWay { continuation, cell, .. }, weight) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
            of_path(ends.continued[continuation].path, &|channel| weight[channel] * sent(cell, channel));
        }

        // The squares of what each cell brings, sampled by the paths that end there.
        for (path, &cell) in ends.cell.iter().enumerate().filter(|(_, cell)| **cell != NO_CELL) {
            let Some(by_cells_sq) = irradiance.by_cells_sq(path / count) else { break };
            let of_cell = share * ends.first_weight[path] * ends.form_factor[path];
            by_cells_sq.iter_mut().enumerate().for_each(|(channel, sum)| *sum += of_cell * sent(cell, channel).powi(2));
        }
    }

    /// Adds how much more the variance of the irradiance at a place by `rays` paths would be if these saw emitters by next-event rays, by channel; emitters are
    /// looked for exactly.
    pub fn add_next_event_variance(&self, place: &Place, rays: u32, scratch: &mut PathScratch, variance: &mut [f64]) {
        self.paths.follow(&[*place], &Course::of_values(rays, self.bounces, self.vertex_rays), scratch);
        for of_path in scratch.ends.next_event.chunks(variance.len()) {
            variance.iter_mut().zip(of_path).for_each(|(sum, of_path)| *sum += of_path / f64::from(rays).powi(2));
        }
    }

    /// Notes what of the light of reflectors that rays have seen is their own.
    fn note_seen_emitters(&self, seen: &[SeenCell], irradiance: &mut BatchSums<'_>) {
        for seen in seen {
            let Some(straight) = irradiance.straight(seen.by) else { break };
            if let Some(exitance) = self.paths.unsampled_exitance(seen.surface) {
                straight.iter_mut().zip(exitance).for_each(|(h, e)| *h += seen.weight * e);
            }
        }
    }

    /// Notes what paths bring of emitters that they meet first; `count` of them leave each place.
    fn note_met_emitters(&self, ends: &Ends, count: usize, irradiance: &mut BatchSums<'_>) {
        for (path, &surface) in ends.surface.iter().enumerate().filter(|(_, surface)| **surface != NO_SURFACE) {
            let Some(straight) = irradiance.straight(path / count) else { break };
            if let Some(exitance) = self.paths.unsampled_exitance(SurfaceId(surface)) {
                let share = ends.first_weight[path] / count as f64;
                straight.iter_mut().zip(exitance).for_each(|(h, e)| *h += share * e);
            }
        }
    }
}

/// Notes what paths bring of the sky where they see it first; `count` of them leave each place.
fn note_sky(ends: &Ends, count: usize, irradiance: &mut BatchSums<'_>) {
    let channels = irradiance.channels();
    for (continuation, constant) in ends.continued.iter().zip(ends.constant.chunks(channels)).filter(|(of, _)| of.is_of_sky) {
        let Some(straight) = irradiance.straight(continuation.path / count) else { break };
        straight.iter_mut().zip(constant).for_each(|(h, brought)| *h += brought / count as f64);
    }
}
