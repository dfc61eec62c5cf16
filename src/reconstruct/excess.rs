//! What values over the hemisphere have too much, along paths that take a bounce more than values do.
//!
//! A value believes the cell where a path arrives. The same path, followed one bounce further, tells what that cell should have sent
//! there: the difference is a sample of the error that the value makes by believing cells, free of what both have in common:
//!
//! ```text
//! H~(x) - H(x) = mean over paths p of (B~(cell_p) - E - rho (direct + what arrives by the next bounce)),
//! ```
//!
//! in the mean over all random numbers but those of the cells. What gathers lose to noise of their own is no part of it.

use super::hemisphere::{self, HemisphereGather, lamp_rays};
use super::light_paths::{LightPaths, NO_CELL, PathScratch, Place};
use super::resolved::Resolved;

/// Gathers what values have too much.
pub(crate) struct ExcessGather<'a> {
    pub paths: &'a LightPaths<'a>,
    /// What values believe.
    pub believed: &'a Resolved,
    /// Resolved from other positions by other paths, for where the additional bounce ends.
    pub onward: &'a Resolved,
}

impl ExcessGather<'_> {
    /// About what is reflected at a place, in W/m^2 in the brightest channel: what its cell sends, by the darker of both solutions.
    pub fn estimate_reflected(&self, place: &Place) -> f64 {
        let Some(cell) = self.paths.cell_at(place) else { return 0.0 };
        let sent = self.believed.of(cell).iter().zip(self.onward.of(cell)).map(|(&one, &other)| f64::from(one.min(other)));
        let exitance = self.paths.unlamped_exitance(place.surface);
        let reflected = sent.enumerate().map(|(channel, sent)| sent - exitance.map_or(0.0, |exitance| exitance[channel]));
        reflected.fold(0.0, f64::max)
    }

    /// By how much the mean of values' irradiances at each place lies above the truth, by `rays` paths, in W/m^2, place after place.
    pub fn sampled_excess(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, excess: &mut [f64]) {
        let (channels, count) = (self.paths.scene.channels(), rays.max(1));
        let together = (hemisphere::BATCH / count as usize).max(1);
        excess.fill(0.0);
        for (places, excess) in places.chunks(together).zip(excess.chunks_mut(together * channels)) {
            self.add_of_paths(places, count, scratch, excess);
            self.add_of_reflectors(places, lamp_rays(count), scratch, excess);
        }
    }

    /// Adds what paths over the hemisphere tell.
    fn add_of_paths(&self, places: &[Place], count: u32, scratch: &mut PathScratch, excess: &mut [f64]) {
        let channels = self.paths.scene.channels();
        let share = 1.0 / f64::from(count);
        self.paths.follow(places, count, 1, scratch);
        let ends = &scratch.ends;
        let covered = ends.covered(count);
        let mut add = |share: f64, resolved: &Resolved, weights: &[f64], path: usize, cell: u32| {
            let place = path / count as usize;
            let excess = excess[place * channels..].iter_mut().zip(weights);
            let sent = resolved.seen_from(covered[place], cell);
            excess.zip(sent).for_each(|((excess, weight), &sent)| *excess += share * weight * f64::from(sent));
        };

        // A path whose first cell looks small takes that cell's word instead of what it finds; one that has to go on anyway finds the
        // same, but for what is sent where it ends.
        let whole = vec![1.0; channels];
        for (detour, weights) in ends.detours.iter().zip(ends.weight.chunks(channels)) {
            if detour.shortcut != NO_CELL {
                add(share, self.believed, &whole, detour.path, detour.shortcut);
            } else if detour.cell != NO_CELL {
                add(share, self.believed, weights, detour.path, detour.cell);
            }
            if detour.cell != NO_CELL {
                add(-share, self.onward, weights, detour.path, detour.cell);
            }
        }
        for (&(detour, cell), weights) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
            let detour = &ends.detours[detour];
            if detour.shortcut == NO_CELL {
                add(share, self.believed, weights, detour.path, cell);
            }
            add(-share, self.onward, weights, detour.path, cell);
        }

        let detours = ends.detours.iter().zip(ends.constant.chunks(channels));
        for (detour, constant) in detours.filter(|(detour, _)| detour.shortcut != NO_CELL) {
            let excess = excess[detour.path / count as usize * channels..].iter_mut();
            excess.zip(constant).for_each(|(excess, constant)| *excess -= share * constant);
        }
    }

    /// Adds what rays to reflectors tell that go with `count` rays to lamps.
    fn add_of_reflectors(&self, places: &[Place], count: u32, scratch: &mut PathScratch, excess: &mut [f64]) {
        let channels = self.paths.scene.channels();
        self.paths.see_reflectors(places, count, scratch);
        let seen = std::mem::take(&mut scratch.seen);
        let onward = HemisphereGather { paths: self.paths, resolved: self.onward, bounces: 0 };
        let sent = onward.sampled_sent(places, &seen, scratch);
        for (seen, sent) in seen.iter().zip(sent.chunks(channels)) {
            let excess = &mut excess[seen.by * channels..][..channels];
            let believed = self.believed.of(seen.cell).iter().zip(sent);
            excess
                .iter_mut()
                .zip(believed)
                .for_each(|(excess, (&believed, sent))| *excess += seen.weight * (f64::from(believed) - sent));
        }
        scratch.seen = seen;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::geometry::sampling;
    use crate::hierarchy::Hierarchy;
    use crate::reconstruct::Resolution;
    use crate::scene::SurfaceId;
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::sweep::{Exposure, Radiosity};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// Few cells, so that values are wrong by much: the excess must be just what they differ from the truth by, with reflectors or without.
    #[test]
    fn the_excess_is_what_values_differ_from_the_truth_by() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let hierarchy = Hierarchy::new(&scene);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &rays, 0);
        let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let tall_box = SurfaceId(scene.surfaces().len() as u32 - 1);
        let resolution = Resolution::of_positions(&scene, 200, 4);
        for has_reflector in [false, true] {
            if has_reflector {
                radiosity.of_mut(hierarchy.node_of(tall_box)).fill(1e3);
            }
            let paths = LightPaths::new(&scene, &rays, &hierarchy, &radiosity, resolution.side);
            let [believed, onward] = [1, 2].map(|seed| Resolved::solve(&paths, &resolution, seed));
            let [value, truth] =
                [(&believed, 0), (&onward, 1)].map(|(resolved, bounces)| HemisphereGather { paths: &paths, resolved, bounces });
            let excess = ExcessGather { paths: &paths, believed: &believed, onward: &onward };

            let (mut scratch, channels, mut most) = (PathScratch::default(), scene.channels(), 0.0_f64);
            for surface in (0..scene.surfaces().len() as u32).map(SurfaceId) {
                let point = scene.surface(surface).polygon.facet().point_at(0.3, 0.7);
                let place = |seed| Place { point, surface, seed: sampling::hash(5, seed) };
                let mut found = [0, 1, 2].map(|_| vec![0.0; channels]);
                value.sampled_irradiance(&[place(1)], 1 << 16, &mut scratch, &mut found[0]);
                truth.sampled_irradiance(&[place(2)], 1 << 16, &mut scratch, &mut found[1]);
                excess.sampled_excess(&[place(3)], 1 << 16, &mut scratch, &mut found[2]);
                for channel in 0..channels {
                    let [value, truth, excess] = found.each_ref().map(|found| found[channel]);
                    assert!((value - truth - excess).abs() < 0.02 * truth, "{surface:?}: {value} - {truth} is not {excess}");
                    most = most.max(excess.abs() / truth);
                }
            }
            assert!(most > 0.03, "values are wrong by {most} at most, too little to tell");
        }
    }
}
