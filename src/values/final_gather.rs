//! The final gather: `B(x) = E + rho (direct(x) + mean over paths from x of what they bring)`.
//!
//! Next-event estimation brings direct light, and paths all other, by the radiosities of the cells where they end. No link is read,
//! so the cost of a point is that of its rays, however many surfaces there are.

use crate::cells::CellRadiosities;
use crate::geometry::{sampling, streams};
use crate::paths::{LightPaths, NO_CELL, PathScratch, Place, SeenCell};

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
}

/// About how many paths are followed together: their rays fit into the processor's cache.
pub(crate) const BATCH: usize = 2048;

impl FinalGather<'_> {
    /// The irradiance H at each place by `rays` paths, in W/m^2, by place and channel. The result at a place does not depend on the
    /// others.
    pub fn sampled_irradiance(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        irradiance.fill(0.0);
        self.add_sampled_indirect(places, rays, scratch, irradiance);
        self.add_sampled_direct(places, rays, scratch, irradiance);
    }

    /// Adds the direct irradiance from emitters and bright reflectors at each place, by the next-event rays that go with `rays`
    /// paths.
    pub fn add_sampled_direct(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        let emitter_rays = emitter_rays(rays);
        let together = (BATCH / emitter_rays as usize).max(1);
        let batches = places.chunks(together).zip(irradiance.chunks_mut(together * self.paths.scene.channels()));
        batches.for_each(|(places, irradiance)| self.add_next_event(places, emitter_rays, scratch, irradiance));
    }

    /// The same by `count` next-event rays.
    fn add_next_event(&self, places: &[Place], count: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        self.paths.add_next_event(places, 1, count, scratch, irradiance);
        self.add_seen(places, scratch, irradiance);
    }

    /// Adds the light of reflectors that rays have seen: by the radiosities of their cells, or by gathers at the points that were
    /// seen.
    fn add_seen(&self, places: &[Place], scratch: &mut PathScratch, irradiance: &mut [f64]) {
        let channels = self.paths.scene.channels();
        let mut add = |seen: &SeenCell, sent: &mut dyn Iterator<Item = f64>| {
            let irradiance = &mut irradiance[seen.by * channels..][..channels];
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
    pub(crate) fn sampled_sent(&self, places: &[Place], seen: &[SeenCell], scratch: &mut PathScratch) -> Vec<f64> {
        let channels = self.paths.scene.channels();
        // The irradiance at these points.
        let there = |(number, seen): (usize, &SeenCell)| {
            let seed = sampling::hash(places[seen.by].seed, streams::ON_REFLECTORS + number as u64);
            Place { point: seen.point, surface: seen.surface, seed }
        };
        let there: Vec<Place> = seen.iter().enumerate().map(there).collect();
        let mut sent = vec![0.0; there.len() * channels];
        self.add_sampled_indirect(&there, 1, scratch, &mut sent);
        self.add_next_event(&there, 1, scratch, &mut sent);

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
    pub fn add_sampled_indirect(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        let count = rays.max(1);
        let together = (BATCH / count as usize).max(1);
        let batches = places.chunks(together).zip(irradiance.chunks_mut(together * self.paths.scene.channels()));
        batches.for_each(|(places, irradiance)| self.add_sampled_indirect_of_batch(places, count, scratch, irradiance));
    }

    fn add_sampled_indirect_of_batch(&self, places: &[Place], count: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
        let channels = self.paths.scene.channels();
        let share = 1.0 / f64::from(count);
        self.paths.follow(places, count, self.bounces, scratch);
        let ends = &scratch.ends;

        // Paths that end where their first rays arrive.
        for (cells, irradiance) in ends.cell.chunks(count as usize).zip(irradiance.chunks_mut(channels)) {
            for &cell in cells.iter().filter(|&&cell| cell != NO_CELL) {
                irradiance.iter_mut().zip(self.radiosities.of(cell)).for_each(|(h, &sent)| *h += share * f64::from(sent));
            }
        }

        // Paths that went on: the direct light on the way, and the cell at the end.
        for (number, continuation) in ends.continued.iter().enumerate() {
            let own = number * channels..(number + 1) * channels;
            let place = continuation.path / count as usize;
            let irradiance = &mut irradiance[place * channels..][..channels];
            irradiance.iter_mut().zip(&ends.constant[own.clone()]).for_each(|(h, constant)| *h += share * constant);
            if continuation.cell != NO_CELL {
                let sent = self.radiosities.of(continuation.cell).iter().zip(&ends.weight[own]);
                irradiance.iter_mut().zip(sent).for_each(|(h, (&sent, weight))| *h += share * weight * f64::from(sent));
            }
        }

        // Other cells whose light they bring.
        for (&(continuation, cell), weight) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
            let place = ends.continued[continuation].path / count as usize;
            let sent = self.radiosities.of(cell).iter().zip(weight);
            let irradiance = &mut irradiance[place * channels..][..channels];
            irradiance.iter_mut().zip(sent).for_each(|(h, (&sent, weight))| *h += share * weight * f64::from(sent));
        }
    }
}
