//! The one-bounce residual: by how much values over cells are too bright, by paths that take one bounce more than those of values.
//!
//! A value uses the radiosity of the cell where a path ends. The same path, followed one bounce further, estimates the true
//! radiosity at that point. The difference is a sample of the value's error by its cells, without the noise that both have in
//! common:
//!
//! ```text
//! H~(x) - H(x) = mean over paths p of w_p (B~(cell_p) - E - rho (direct + what arrives by the next bounce)),
//! ```
//!
//! in expectation over all random numbers but those of the cells; w_p is the weight with which the path arrives. The noise of the values' own
//! gathers is no part of it.
//!
//! # Unresolved surfaces
//! Where a cell is as wide as its surface, as on the slat of a blind or the jamb of a slit, what one part of the scene sees of it may be bright, and what
//! another sees dark. Rows of cells and the bounce after a value's path go on from there, so only values are off by such cells, and the residual shows it.
//! The part that comes from there is told apart, by the cells of the replicate alone, without the noise of those of values: then paths of values
//! go on as well.

use crate::cells::CellRadiosities;
use crate::paths::{Course, LightPaths, NO_CELL, PathScratch, Place, ValueEnd};
use crate::scene::SurfaceId;
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

/// Residuals by place and channel, in W/m^2.
pub(crate) struct Residuals<'f> {
    pub all: &'f mut [f64],
    /// What the replicate's own cells on unresolved surfaces bring of them.
    pub of_unresolved: &'f mut [f64],
}

/// What something is a part of.
#[derive(Clone, Copy)]
enum PartOf {
    All,
    OfUnresolved,
    Both,
}

impl Residuals<'_> {
    /// Adds by channel, from a place's first on.
    fn add(&mut self, first: usize, part_of: PartOf, added: impl Iterator<Item = f64>) {
        for (channel, added) in added.enumerate() {
            if !matches!(part_of, PartOf::OfUnresolved) {
                self.all[first + channel] += added;
            }
            if !matches!(part_of, PartOf::All) {
                self.of_unresolved[first + channel] += added;
            }
        }
    }
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

    /// By how much the expected irradiance of a value at each place lies above the truth, by `rays` paths, in W/m^2.
    pub fn sampled_residual(&self, places: &[Place], rays: u32, scratch: &mut PathScratch, found: &mut Residuals<'_>) {
        let (channels, count) = (self.paths.scene.channels(), rays.max(1));
        let together = (BATCH / count as usize).max(1);
        found.all.fill(0.0);
        found.of_unresolved.fill(0.0);
        let chunks = found.all.chunks_mut(together * channels).zip(found.of_unresolved.chunks_mut(together * channels));
        for (places, (all, of_unresolved)) in places.chunks(together).zip(chunks) {
            let mut found = Residuals { all, of_unresolved };
            self.add_of_paths(places, count, scratch, &mut found);
            self.add_of_reflectors(places, emitter_rays(count), scratch, &mut found);
        }
    }

    /// Adds the residual of indirect light, by paths.
    fn add_of_paths(&self, places: &[Place], count: u32, scratch: &mut PathScratch, found: &mut Residuals<'_>) {
        let channels = self.paths.scene.channels();
        let share = 1.0 / f64::from(count);
        self.paths.follow(places, &Course::past_values(count, self.vertex_rays), scratch);
        let ends = &scratch.ends;
        let of_place = |continuation: usize| ends.continued[continuation].path / count as usize * channels;
        let behind_value = |continuation: usize| {
            let end = ends.continued[continuation].value_end.map(|number| &ends.value_ends[number]);
            end.map_or(PartOf::All, |end| self.part_behind(end.surface))
        };

        // What paths of values that end before get, less what is collected from there on.
        let value_ends = ends.value_ends.iter().zip(ends.value_weight.chunks(channels)).zip(ends.value_constant.chunks(channels));
        for ((&ValueEnd { continuation, cell, surface, .. }, weights), before) in value_ends {
            let first = of_place(continuation);
            self.add_value(found, first, (cell, surface), |channel| share * weights[channel]);
            let constant = ends.constant[continuation * channels..].iter().zip(before);
            found.add(first, self.part_behind(surface), constant.map(|(all, before)| share * (before - all)));
        }

        // Cells where paths end, and others whose light they bring, those of values too up to where these end.
        let at_ends = ends.continued.iter().zip(ends.weight.chunks(channels)).enumerate();
        let at_ends = at_ends.map(|(number, (of, weights))| (number, of.cell, of.value_end.is_none(), weights));
        let on_the_way = ends.seen.iter().zip(ends.seen_weight.chunks(channels));
        let on_the_way = on_the_way.map(|(seen, weights)| (seen.continuation, seen.cell, seen.is_of_value, weights));
        let cells = at_ends.filter(|&(_, cell, ..)| cell != NO_CELL).chain(on_the_way);
        for (continuation, cell, is_of_value, weights) in cells {
            let brought = |of: &[f32], channel: usize| share * weights[channel] * f64::from(of[channel]);
            let (of_values, onward) = (self.of_values.of(cell), self.onward.of(cell));
            if is_of_value {
                let difference = |channel| brought(of_values, channel) - brought(onward, channel);
                found.add(of_place(continuation), PartOf::All, (0..channels).map(difference));
            } else {
                let part_of = behind_value(continuation);
                found.add(of_place(continuation), part_of, (0..channels).map(|channel| -brought(onward, channel)));
            }
        }
    }

    /// What light from behind a point of a surface, where the path of a value ends, is a part of.
    fn part_behind(&self, surface: SurfaceId) -> PartOf {
        if self.paths.grids.is_unresolved(surface) { PartOf::Both } else { PartOf::All }
    }

    /// Adds what a value gets from a cell, with a weight by channel.
    fn add_value(&self, found: &mut Residuals<'_>, first: usize, (cell, surface): (u32, SurfaceId), weight: impl Fn(usize) -> f64) {
        let mut add = |part_of: PartOf, radiosities: &CellRadiosities| {
            let sent = radiosities.of(cell).iter().enumerate();
            found.add(first, part_of, sent.map(|(channel, &sent)| weight(channel) * f64::from(sent)));
        };
        add(PartOf::All, self.of_values);
        if self.paths.grids.is_unresolved(surface) {
            add(PartOf::OfUnresolved, self.onward);
        }
    }

    /// Adds the residual of light from bright reflectors, by the rays that go with `count` rays to emitters.
    fn add_of_reflectors(&self, places: &[Place], count: u32, scratch: &mut PathScratch, found: &mut Residuals<'_>) {
        let channels = self.paths.scene.channels();
        self.paths.see_reflectors(places, count, scratch);
        let seen = std::mem::take(&mut scratch.seen);
        let onward = FinalGather { paths: self.paths, radiosities: self.onward, bounces: 0, vertex_rays: self.vertex_rays };
        let sent = onward.sampled_sent(places, &seen, scratch);
        for (seen, sent) in seen.iter().zip(sent.chunks(channels)) {
            let first = seen.by * channels;
            self.add_value(found, first, (seen.cell, seen.surface), |_| seen.weight);
            found.add(first, self.part_behind(seen.surface), sent.iter().map(|sent| -seen.weight * sent));
        }
        scratch.seen = seen;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::geometry::sampling;
    use crate::paths::{BatchSums, Brightness, CellSize, Reflector, Resolution};
    use crate::scene::Scene;
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// With few cells values have large errors, and the residual must equal these, with bright reflectors or without. Guided rays find the same.
    #[test]
    fn the_residual_is_the_difference_of_values_and_truth() {
        let scene = cornell();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let tall_box = SurfaceId(scene.surfaces().len() as u32 - 1);
        let resolution = Resolution { size: CellSize { side: 0.05, past_unresolved: false, most_surfaces: usize::MAX }, rays: 4 };
        let mut unguided = Vec::new();
        for (has_reflector, vertex_rays) in [(true, 1), (false, 1), (false, 32)] {
            let mut brightness = Brightness::even(&scene);
            if has_reflector {
                brightness.reflectors = vec![Reflector { surface: tall_box, brightness: 1e3 }];
            }
            let paths = LightPaths::new(&scene, &rays, &brightness, resolution.size, &|| false);
            // Far less noisy cells onward, all of them small: two bounces away they are as good as the truth.
            let solved = |rays, seed| CellRadiosities::solve(&paths, &Resolution { rays, ..resolution }, seed, &|| false).unwrap();
            let (of_values, onward) = (solved(resolution.rays, 1), solved(1024, 2));
            let [value, truth] = [(&of_values, 0), (&onward, 2)].map(|(radiosities, bounces)| FinalGather {
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
                let mut residuals = Residuals { all: &mut found[2], of_unresolved: &mut vec![0.0; channels] };
                residual.sampled_residual(&[place(3)], 1 << 16, &mut scratch, &mut residuals);
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

    fn cornell() -> Scene {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
        read_scene(&file, &ImportOptions::default()).unwrap().scene
    }

    /// A point of each surface.
    fn places(scene: &Scene) -> Vec<Place> {
        let surfaces = (0..scene.surfaces().len() as u32).map(SurfaceId);
        let point = |surface| scene.surface(surface).polygon.facet().point_at(0.3, 0.7);
        surfaces.map(|surface| Place { point: point(surface), surface, seed: sampling::hash(7, u64::from(surface.0)) }).collect()
    }

    /// Values and residuals cast the same rays, so what is brought up to where paths of values end is just what these bring.
    #[test]
    fn longer_paths_pass_through_the_ends_of_those_of_values() {
        let scene = cornell();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let resolution = Resolution { size: CellSize { side: 0.1, past_unresolved: false, most_surfaces: usize::MAX }, rays: 4 };
        let paths = LightPaths::new(&scene, &rays, &Brightness::even(&scene), resolution.size, &|| false);
        let cells = CellRadiosities::solve(&paths, &resolution, 1, &|| false).unwrap();
        let (channels, count, places) = (scene.channels(), 64, places(&scene));
        let mut scratch = PathScratch::default();
        for vertex_rays in [1, 32] {
            let gather = FinalGather { paths: &paths, radiosities: &cells, bounces: 0, vertex_rays };
            let mut of_values = vec![0.0; places.len() * channels];
            gather.add_sampled_indirect(&places, count, &mut scratch, &mut BatchSums::whole(channels, &mut of_values));

            let mut found = vec![0.0; of_values.len()];
            paths.follow(&places, &Course::past_values(count, vertex_rays), &mut scratch);
            let ends = &scratch.ends;
            let mut add = |continuation: usize, brought: &dyn Fn(usize) -> f64| {
                let sums = &mut found[ends.continued[continuation].path / count as usize * channels..][..channels];
                sums.iter_mut().enumerate().for_each(|(channel, sum)| *sum += brought(channel) / f64::from(count));
            };
            let sent = |cell: u32, channel: usize| f64::from(cells.of(cell)[channel]);
            for (number, end) in ends.value_ends.iter().enumerate() {
                let [weight, constant] = [&ends.value_weight, &ends.value_constant].map(|of| &of[number * channels..]);
                add(end.continuation, &|channel| constant[channel] + weight[channel] * sent(end.cell, channel));
            }
            for (number, of) in ends.continued.iter().enumerate().filter(|(_, of)| of.value_end.is_none()) {
                let [weight, constant] = [&ends.weight, &ends.constant].map(|of| &of[number * channels..]);
                let at_end = |channel| if of.cell == NO_CELL { 0.0 } else { weight[channel] * sent(of.cell, channel) };
                add(number, &|channel| constant[channel] + at_end(channel));
            }
            for (seen, weight) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)).filter(|(seen, _)| seen.is_of_value) {
                add(seen.continuation, &|channel| weight[channel] * sent(seen.cell, channel));
            }
            for (found, of_value) in found.iter().zip(&of_values) {
                assert!((found / of_value - 1.0).abs() < 1e-9, "{found} for {of_value}");
            }
            assert!(ends.value_ends.iter().any(|end| ends.continued[end.continuation].path % count as usize != 0));
        }
    }

    /// Of cells that values and replicate share, all of the residual is what unresolved surfaces bring if all are, and none if none is.
    #[test]
    fn what_unresolved_surfaces_bring_is_told_apart() {
        let scene = cornell();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        for (side, is_unresolved) in [(100.0, true), (0.05, false)] {
            let resolution = Resolution { size: CellSize { side, past_unresolved: false, most_surfaces: usize::MAX }, rays: 16 };
            let paths = LightPaths::new(&scene, &rays, &Brightness::even(&scene), resolution.size, &|| false);
            let cells = CellRadiosities::solve(&paths, &resolution, 1, &|| false).unwrap();
            let gather = ResidualGather { paths: &paths, of_values: &cells, onward: &cells, vertex_rays: 1 };
            let places = places(&scene);
            let [mut all, mut of_unresolved] = [0, 1].map(|_| vec![0.0; places.len() * scene.channels()]);
            let mut found = Residuals { all: &mut all, of_unresolved: &mut of_unresolved };
            gather.sampled_residual(&places, 64, &mut PathScratch::default(), &mut found);
            for (all, of_unresolved) in all.iter().zip(&of_unresolved) {
                let expected = if is_unresolved { *all } else { 0.0 };
                assert!((of_unresolved - expected).abs() < 1e-9 * all.abs(), "{of_unresolved} for {expected}");
            }
        }
    }
}
