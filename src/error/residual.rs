//! The one-bounce residual: by how much values over cells are too bright, by paths that take one bounce more than those of values.
//!
//! A value uses the radiosity of the cell where a path ends. The same path, followed one bounce further, estimates the true
//! radiosity at that point. The difference is a sample of the value's error by its cells, without the noise that both have in
//! common:
//!
//! ```text
//! H~(x) - H(x) = mean over paths p of (B~(cell_p) - E - rho (direct + what arrives by the next bounce)),
//! ```
//!
//! in expectation over all random numbers but those of the cells. The noise of the values' own gathers is no part of it.

use crate::cells::CellRadiosities;
use crate::paths::{Course, LightPaths, NO_CELL, PathScratch, Place};
use crate::values::{BATCH, FinalGather, emitter_rays};

/// Gathers residuals at points.
pub(crate) struct ResidualGather<'a> {
    pub paths: &'a LightPaths<'a>,
    /// The cell radiosities that values use.
    pub of_values: &'a CellRadiosities,
    /// Independent cell radiosities, used where the additional bounce ends.
    pub onward: &'a CellRadiosities,
    /// See [`Course`].
    pub vertex_rays: u32,
}

impl ResidualGather<'_> {
    /// A rough estimate of the radiosity that is reflected at a place, in W/m^2 in the brightest channel, by the darker of both
    /// solutions.
    pub fn estimate_reflected(&self, place: &Place) -> f64 {
        let Some(cell) = self.paths.cell_at(place.surface, place.point) else { return 0.0 };
        let sent = self.of_values.of(cell)[..self.paths.scene.deciding()]
            .iter()
            .zip(self.onward.of(cell))
            .map(|(&one, &other)| f64::from(one.min(other)));
        let exitance = self.paths.unsampled_exitance(place.surface);
        let reflected = sent.enumerate().map(|(channel, sent)| sent - exitance.map_or(0.0, |exitance| exitance[channel]));
        reflected.fold(0.0, f64::max)
    }

    /// By how much the expected irradiance of a value at each place lies above the truth, by `rays` paths, in W/m^2, by place and
    /// channel.
    pub fn sampled_residual(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, residual: &mut [f64]) {
        let (channels, count) = (self.paths.scene.channels(), rays.max(1));
        let together = (BATCH / count as usize).max(1);
        residual.fill(0.0);
        for (places, residual) in places.chunks(together).zip(residual.chunks_mut(together * channels)) {
            self.add_of_paths(places, count, scratch, residual);
            self.add_of_reflectors(places, emitter_rays(count), scratch, residual);
        }
    }

    /// Adds the residual of indirect light, by paths.
    fn add_of_paths(&self, places: &[Place], count: u32, scratch: &mut PathScratch, residual: &mut [f64]) {
        let channels = self.paths.scene.channels();
        let share = 1.0 / f64::from(count);
        self.paths.follow(places, &Course::of_values(count, 1, self.vertex_rays), scratch);
        let ends = &scratch.ends;
        let mut add = |share: f64, radiosities: &CellRadiosities, weights: &[f64], path: usize, cell: u32| {
            let place = path / count as usize;
            let residual = residual[place * channels..].iter_mut().zip(weights);
            let sent = radiosities.of(cell);
            residual.zip(sent).for_each(|((residual, weight), &sent)| *residual += share * weight * f64::from(sent));
        };

        // What a value gets less what the longer path gets. A value's path that arrives in a small cell ends there; any other goes
        // on as this one does, and differs only in the radiosity of the cell where it ends.
        let whole = vec![1.0; channels];
        for (continuation, weights) in ends.continued.iter().zip(ends.weight.chunks(channels)) {
            if continuation.shortcut != NO_CELL {
                let share = share * ends.first_weight[continuation.path];
                add(share, self.of_values, &whole, continuation.path, continuation.shortcut);
            } else if continuation.cell != NO_CELL {
                add(share, self.of_values, weights, continuation.path, continuation.cell);
            }
            if continuation.cell != NO_CELL {
                add(-share, self.onward, weights, continuation.path, continuation.cell);
            }
        }

        // Other cells whose light paths bring, likewise.
        for (&(continuation, cell), weights) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
            let continuation = &ends.continued[continuation];
            if continuation.shortcut == NO_CELL {
                add(share, self.of_values, weights, continuation.path, cell);
            }
            add(-share, self.onward, weights, continuation.path, cell);
        }

        // Light collected on the way, where a value's path has ended before.
        let continuations = ends.continued.iter().zip(ends.constant.chunks(channels));
        for (continuation, constant) in continuations.filter(|(continuation, _)| continuation.shortcut != NO_CELL) {
            let residual = residual[continuation.path / count as usize * channels..].iter_mut();
            residual.zip(constant).for_each(|(residual, constant)| *residual -= share * constant);
        }
    }

    /// Adds the residual of light from bright reflectors, by the rays that go with `count` rays to emitters.
    fn add_of_reflectors(&self, places: &[Place], count: u32, scratch: &mut PathScratch, residual: &mut [f64]) {
        let channels = self.paths.scene.channels();
        self.paths.see_reflectors(places, count, scratch);
        let seen = std::mem::take(&mut scratch.seen);
        let onward = FinalGather { paths: self.paths, radiosities: self.onward, bounces: 0, vertex_rays: self.vertex_rays };
        let sent = onward.sampled_sent(places, &seen, scratch);
        for (seen, sent) in seen.iter().zip(sent.chunks(channels)) {
            let residual = &mut residual[seen.by * channels..][..channels];
            let of_values = self.of_values.of(seen.cell).iter().zip(sent);
            residual
                .iter_mut()
                .zip(of_values)
                .for_each(|(residual, (&of_values, sent))| *residual += seen.weight * (f64::from(of_values) - sent));
        }
        scratch.seen = seen;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::geometry::sampling;
    use crate::paths::{Brightness, CellSize, Reflector, Resolution};
    use crate::scene::SurfaceId;
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// With few cells values have large errors, and the residual must equal these, with bright reflectors or without. Guided rays find the same.
    #[test]
    fn the_residual_is_the_difference_of_values_and_truth() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let tall_box = SurfaceId(scene.surfaces().len() as u32 - 1);
        let resolution = Resolution { size: CellSize { side: 0.1, most_surfaces: usize::MAX }, rays: 4 };
        let mut unguided = Vec::new();
        for (has_reflector, vertex_rays) in [(true, 1), (false, 1), (false, 32)] {
            let mut brightness = Brightness::even(&scene);
            if has_reflector {
                brightness.reflectors = vec![Reflector { surface: tall_box, brightness: 1e3 }];
            }
            let paths = LightPaths::new(&scene, &rays, &brightness, &[], resolution.size, &|| false);
            let [of_values, onward] = [1, 2].map(|seed| CellRadiosities::solve(&paths, &resolution, seed, &|| false).unwrap());
            let [value, truth] = [(&of_values, 0), (&onward, 1)].map(|(radiosities, bounces)| FinalGather {
                paths: &paths,
                radiosities,
                bounces,
                vertex_rays,
            });
            let residual = ResidualGather { paths: &paths, of_values: &of_values, onward: &onward, vertex_rays };

            let (mut scratch, channels, mut most) = (PathScratch::default(), scene.channels(), 0.0_f64);
            let mut all_found = Vec::new();
            for surface in (0..scene.surfaces().len() as u32).map(SurfaceId) {
                let point = scene.surface(surface).polygon.facet().point_at(0.3, 0.7);
                let place = |seed| Place { point, surface, seed: sampling::hash(5, seed) };
                let mut found = [0, 1, 2].map(|_| vec![0.0; channels]);
                value.sampled_irradiance(&[place(1)], 1 << 16, &mut scratch, &mut found[0]);
                truth.sampled_irradiance(&[place(2)], 1 << 16, &mut scratch, &mut found[1]);
                residual.sampled_residual(&[place(3)], 1 << 16, &mut scratch, &mut found[2]);
                for channel in 0..channels {
                    let [value, truth, residual] = found.each_ref().map(|found| found[channel]);
                    assert!((value - truth - residual).abs() < 0.02 * truth, "{surface:?}: {value} - {truth} is not {residual}");
                    most = most.max(residual.abs() / truth);
                    all_found.extend([value, truth]);
                }
            }
            if vertex_rays > 1 {
                let off = |(&found, &unguided): (&f64, &f64)| (found / unguided - 1.0).abs();
                let most_off = all_found.iter().zip(&unguided).map(off).fold(0.0, f64::max);
                assert!(most_off < 0.02, "{most_off}");
            }
            unguided = all_found;
            assert!(most > 0.03, "values are wrong by {most} at most, too little to tell");
        }
    }
}
