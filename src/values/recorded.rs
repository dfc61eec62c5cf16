//! What gathers over cells bring, term by term.

use super::final_gather::emitter_rays;
use crate::geometry::{sampling, streams};
use crate::paths::{BatchSums, Brought, Course, LightPaths, PathScratch, Place, SeenCell, UNREFLECTED};
use crate::scene::EmissionApart;

/// Records gathers of paths whose scene keeps emission apart. Their trails are kept in the scratch memory, which must have one.
pub(crate) struct GatherRecorder<'a> {
    pub paths: &'a LightPaths<'a>,
    pub apart: &'a EmissionApart,
}

/// A term of the irradiance at a place: product, what it is in proportion to, and weight.
type Visit<'v> = &'v mut dyn FnMut(usize, u32, Brought, f64);

impl GatherRecorder<'_> {
    /// Visits the terms of the irradiance at a place that [`FinalGather`](super::FinalGather) finds for values, by `rays` paths.
    pub fn irradiance_of_value(&self, place: Place, rays: u32, scratch: &mut PathScratch, visit: Visit<'_>) {
        let (places, direct) = ([place], emitter_rays(rays));
        let add_direct =
            |scratch: &mut PathScratch, sums: &mut BatchSums<'_>| self.paths.add_direct(&places, direct, scratch, sums);
        self.irradiance(&places, (Vec::new(), rays.max(1)), add_direct, scratch, visit);
    }

    /// Visits the terms of the radiosities of reflectors at the points that rays from `place` have `seen`, by the number of the point, as
    /// [`FinalGather::sampled_sent`](super::FinalGather::sampled_sent) finds them.
    pub fn sent(&self, place: &Place, seen: &[SeenCell], scratch: &mut PathScratch, visit: Visit<'_>) {
        let there = |(number, seen): (usize, &SeenCell)| {
            let seed = sampling::hash(place.seed, streams::ON_REFLECTORS + number as u64);
            Place { point: seen.point, surface: seen.surface, seed }
        };
        let there: Vec<Place> = seen.iter().enumerate().map(there).collect();
        let material = |place: &Place| self.paths.scene.surface(place.surface).material;
        let Some(trail) = &mut scratch.ends.trail else { return };
        let begin = there.iter().map(|place| trail.times(UNREFLECTED, material(place))).collect();
        let add_direct =
            |scratch: &mut PathScratch, sums: &mut BatchSums<'_>| self.paths.add_next_event(&there, 1, 1, scratch, sums);
        self.irradiance(&there, (begin, 1), add_direct, scratch, visit);
        for (number, place) in there.iter().enumerate() {
            if self.paths.unsampled_exitance(place.surface).is_some() {
                visit(number, UNREFLECTED, Brought::Emission(material(place)), 1.0);
            }
        }
    }

    /// Visits the terms of the irradiance at places by so many paths from each, times the products that these begin with, and by direct light.
    fn irradiance(
        &self,
        places: &[Place],
        (begin, rays): (Vec<u32>, u32),
        add_direct: impl Fn(&mut PathScratch, &mut BatchSums<'_>),
        scratch: &mut PathScratch,
        visit: Visit<'_>,
    ) {
        let (count, share) = (rays as usize, 1.0 / f64::from(rays));
        if let Some(trail) = &mut scratch.ends.trail {
            trail.begin.clone_from(&begin);
        }
        self.paths.follow(places, &Course::of_values(rays, 0, 1), scratch);
        scratch.ends.for_each_term(count, |term| visit(term.path / count, term.product, term.what, share * term.weight));
        if let Some(trail) = &mut scratch.ends.trail {
            trail.begin.clear();
        }

        // Direct light.
        let channels = self.paths.scene.channels();
        let product = |place: usize| begin.get(place).copied().unwrap_or(UNREFLECTED);
        let mut irradiance = vec![0.0; places.len() * channels];
        add_direct(scratch, &mut BatchSums::whole(channels, &mut irradiance));
        for (place, irradiance) in irradiance.chunks(channels).enumerate() {
            for (source, weight) in self.apart.sources_of(irradiance) {
                visit(place, product(place), Brought::Emission(source), weight);
            }
        }
        for seen in &scratch.seen {
            visit(seen.by, product(seen.by), Brought::Seen(seen.cell), seen.weight);
        }
    }
}
