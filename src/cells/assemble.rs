//! Makes the equations of cell radiosities from light paths.
//!
//! The paths from a cell's position make its row. The points where they arrive become view points of the cells there, from which
//! next-event estimation adds direct light.

use std::ops::Range;

use rayon::prelude::*;

use super::equations::{BATCH, Equations, ReflectorTerms};
use super::positions::starts_of_paths;
use super::view_points::{Arrival, bytes_of_view_points, view_point_count, view_points};
use crate::geometry::{sampling, streams};
use crate::paths::{BatchSums, Course, Directions, Ends, LightPaths, NO_CELL, PathScratch, Place, SeenOnTheWay};
use crate::progress::Stop;

/// A path of an equation goes on at random from this weight on. Terms of Russian roulette may be negative, but by less than this: sweeps converge.
const LITTLE: f64 = 0.25;

/// The rows of a batch of cells, while they are filled in.
struct Rows<'a> {
    /// By cell and channel.
    constant: &'a mut [f64],
    /// By cell and path, the cell where the path ends.
    end: &'a mut [u32],
    /// By cell, path and channel.
    weight: &'a mut [f32],
}

/// The positions in a batch of cells.
pub(super) struct Positions<'a> {
    paths: &'a LightPaths<'a>,
    /// Paths from each position.
    count: usize,
    /// By position, the index of its cell in the batch.
    pub cells: Vec<usize>,
    pub places: Vec<Place>,
}

/// Bytes of the equations of so many cells with so many paths from each, and of what is needed to make them, or to solve them, whichever is more.
pub(super) fn bytes_to_assemble(cells: usize, paths: usize, channels: usize) -> u64 {
    let (number, weight) = (size_of::<f64>(), size_of::<f32>());
    let equation = channels * number + paths * (size_of::<u32>() + channels * weight);

    // Terms of reflectors: of next-event rays from view points, half as many as paths, and of continuations.
    let terms = paths * (size_of::<(usize, u32)>() + channels * weight);

    // The place, where paths arrive, these once more in order with their beginnings, and view points; or the iterates.
    let arriving = paths * (size_of::<Arrival>() + size_of::<([f32; 2], f32)>()) + 2 * size_of::<u32>();
    let making = size_of::<Option<Place>>() + arriving + bytes_of_view_points(paths);
    let solving = 4 * channels * number;
    (cells * (equation + terms + making.max(solving))) as u64
}

/// The positions of some cells; first, for each, the index of its cell.
fn indexed(cells: &[Option<Place>]) -> (Vec<usize>, Vec<Place>) {
    cells.iter().enumerate().filter_map(|(index, place)| Some((index, (*place)?))).unzip()
}

impl Equations {
    /// Follows `count` paths from the position of each cell, and casts as many next-event rays from its view points. `None` if stopped before
    /// all is done.
    pub fn of_paths(paths: &LightPaths<'_>, cells: &[Option<Place>], count: u32, seed: u64, stop: Stop<'_>) -> Option<Self> {
        let mut equations = Self::empty(cells.len(), count as usize, [paths.scene.channels(), paths.scene.deciding()]);
        let arrivals = equations.follow(paths, cells, seed, stop);
        if stop() {
            return None;
        }
        let seed = sampling::hash(seed, streams::VIEW_POINTS);
        let points = view_points(cells.len(), view_point_count(count as usize), arrivals, seed);
        equations.add_next_event(paths, cells, &points, stop);
        (!stop()).then_some(equations)
    }

    /// Follows the paths from all positions and fills in the rows; returns where paths arrive.
    fn follow(&mut self, paths: &LightPaths<'_>, cells: &[Option<Place>], seed: u64, stop: Stop<'_>) -> Vec<Vec<Arrival>> {
        let (channels, count, share) = (self.channels, self.paths, paths.rays.share());
        let Self { constant, end, weight, .. } = self;
        let batches = cells
            .par_chunks(BATCH)
            .zip(constant.par_chunks_mut(BATCH * channels))
            .zip(end.par_chunks_mut(BATCH * count))
            .zip(weight.par_chunks_mut(BATCH * count * channels))
            .enumerate();
        let (of_reflectors, mut arrivals): (_, Vec<Vec<Arrival>>) = batches
            .map_init(PathScratch::default, |scratch, (number, (((batch, constant), end), weight))| {
                if stop() || !share.has(number) {
                    return Default::default();
                }
                let from = Positions::of(batch, paths, count);
                from.follow(seed, scratch);
                let mut rows = Rows { constant, end, weight };
                from.fill_first_ends(&mut rows, &scratch.ends);
                from.fill_continuations(&mut rows, &scratch.ends);
                (from.reflector_terms(&scratch.ends), from.arrivals(&scratch.ends, cells))
            })
            .unzip();
        share.exchange_chunks(end, BATCH * count);
        share.exchange_chunks(weight, BATCH * count * channels);
        share.exchange(&mut arrivals);
        self.of_reflectors = of_reflectors;
        arrivals
    }

    /// Casts as many next-event rays from the view points of each cell as paths left it, and adds the light to the rows.
    fn add_next_event(&mut self, paths: &LightPaths<'_>, cells: &[Option<Place>], points: &[Box<[[f32; 2]]>], stop: Stop<'_>) {
        let (channels, count, share) = (self.channels, self.paths, paths.rays.share());
        let of_cell = view_point_count(count);
        let Self { constant, end, weight, of_reflectors, .. } = self;
        let batches = cells
            .par_chunks(BATCH)
            .zip(points.par_chunks(BATCH))
            .zip(constant.par_chunks_mut(BATCH * channels))
            .zip(end.par_chunks(BATCH * count))
            .zip(weight.par_chunks(BATCH * count * channels))
            .zip(&mut *of_reflectors)
            .enumerate();
        batches.for_each_init(PathScratch::default, |scratch, (number, (((((batch, points), constant), end), weight), terms))| {
            if stop() || !share.has(number) {
                return;
            }
            // View points.
            let Positions { cells: indices, places, .. } = &Positions::of(batch, paths, count);
            let starts = starts(paths, (indices, places), points, of_cell);
            let mut irradiance = vec![0.0; starts.len() * channels];
            let mut sums = BatchSums::whole(channels, &mut irradiance);
            paths.add_next_event(&starts, of_cell, count.div_ceil(of_cell) as u32, scratch, &mut sums);

            // A cell gets the mean over its view points.
            let part = 1.0 / of_cell as f64;
            for (number, irradiance) in irradiance.chunks(channels).enumerate() {
                let position = number / of_cell;
                let reflectance = &paths.scene.material_of(places[position].surface).reflectance;
                let constant = constant[indices[position] * channels..].iter_mut();
                constant.zip(irradiance).zip(reflectance).for_each(|((constant, h), rho)| *constant += part * rho * h);
            }
            for seen in &scratch.seen {
                let position = seen.by / of_cell;
                let reflectance = &paths.scene.material_of(places[position].surface).reflectance;
                terms.add(indices[position], seen.cell, std::iter::repeat(part * seen.weight), reflectance);
            }
            terms.limit_row_sums(end, weight, count, channels);
        });
        share.exchange_chunks(constant, BATCH * channels);
        share.exchange(of_reflectors);
    }
}

impl<'a> Positions<'a> {
    /// Those of a batch of cells, with so many paths from each.
    pub fn of(batch: &[Option<Place>], paths: &'a LightPaths<'a>, count: usize) -> Self {
        let (cells, places) = indexed(batch);
        Self { paths, count, cells, places }
    }

    /// Follows all paths, each from a point of its own in its cell.
    pub fn follow(&self, seed: u64, scratch: &mut PathScratch) {
        let Self { paths, count, .. } = *self;
        let order = sampling::neighbours_in_order(count as u32);
        let from_cell = |position: &Place| {
            let Directions { seed, first } = directions(paths, position, count as u64, seed);
            let towards = order.iter().map(move |ray| Directions { seed, first: first + ray });
            starts_of_paths(paths, *position, count).zip(towards)
        };
        let (starts, directions): (Vec<Place>, Vec<Directions>) = self.places.iter().flat_map(from_cell).unzip();
        let course = Course { count: 1, bounces: 0, past_values: false, little: LITTLE, past_unresolved: true, vertex_rays: 1 };
        paths.follow_towards(&starts, &directions, &course, scratch);
    }

    /// The indices of a position's paths.
    fn paths_of(&self, position: usize) -> Range<usize> {
        position * self.count..(position + 1) * self.count
    }

    /// Fills in the exitance at positions, and the paths that end where their first rays arrive.
    fn fill_first_ends(&self, rows: &mut Rows<'_>, ends: &Ends) {
        let Self { paths, count, .. } = *self;
        let channels = paths.scene.channels();
        for (position, (&index, place)) in self.cells.iter().zip(&self.places).enumerate() {
            let own = self.paths_of(position);
            rows.end[index * count..][..count].copy_from_slice(&ends.cell[own.clone()]);

            // The row: each path brings its share of the reflected light.
            let material = paths.scene.material_of(place.surface);
            let exitance = paths.unsampled_exitance(place.surface);
            for channel in 0..channels {
                let rho = material.reflectance[channel];
                let weights = rows.weight[index * count * channels..][..count * channels].iter_mut();
                let of_paths = weights.skip(channel).step_by(channels).zip(&ends.first_weight[own.clone()]);
                of_paths.for_each(|(weight, first)| *weight = (rho * first / count as f64) as f32);
                rows.constant[index * channels + channel] = exitance.map_or(0.0, |exitance| exitance[channel]);
            }
        }
    }

    /// Where in their cells the paths arrive that end where their first rays arrive.
    pub fn arrivals(&self, ends: &Ends, cells: &[Option<Place>]) -> Vec<Arrival> {
        let Self { paths, .. } = *self;
        let mut arrivals = Vec::with_capacity(self.places.len() * self.count);
        for (position, place) in self.places.iter().enumerate() {
            let arriving = self.paths_of(position).filter(|&path| ends.cell[path] != NO_CELL);
            arrivals.extend(arriving.filter_map(|path| {
                let there = cells[ends.cell[path] as usize]?;
                let at = paths.grids.within_cell(there.surface, ends.point[path])?.map(|along| along as f32);
                Some(Arrival { cell: ends.cell[path], at, weight: paths.grids.cell_area(place.surface, place.point)? as f32 })
            }));
        }
        arrivals
    }

    /// Fills in the paths that went on: where they end, and the light that they collected before.
    fn fill_continuations(&self, rows: &mut Rows<'_>, ends: &Ends) {
        let Self { paths, count, .. } = *self;
        let channels = paths.scene.channels();
        for (number, continuation) in ends.continued.iter().enumerate() {
            let (position, path) = (continuation.path / count, continuation.path % count);
            let (index, material) = (self.cells[position], paths.scene.material_of(self.places[position].surface));
            rows.end[index * count + path] = continuation.cell;
            for channel in 0..channels {
                let share = material.reflectance[channel] / count as f64;
                rows.constant[index * channels + channel] += share * ends.constant[number * channels + channel];
                rows.weight[(index * count + path) * channels + channel] =
                    (share * ends.weight[number * channels + channel]) as f32;
            }
        }
    }

    /// The terms of reflectors that next-event rays of continuations see.
    fn reflector_terms(&self, ends: &Ends) -> ReflectorTerms {
        let channels = self.paths.scene.channels();
        let mut terms = ReflectorTerms::default();
        for (&SeenOnTheWay { continuation, cell, .. }, weights) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
            let position = ends.continued[continuation].path / self.count;
            let reflectance = &self.paths.scene.material_of(self.places[position].surface).reflectance;
            terms.add(self.cells[position], cell, weights.iter().map(|weight| weight / self.count as f64), reflectance);
        }
        terms
    }
}

/// The first directions of a position's paths. Neighbouring positions, along the Morton curve, take consecutive blocks of one Sobol
/// sequence, so that together they sample all directions evenly. That lowers the error common to many cells, which adds up from
/// bounce to bounce.
fn directions(paths: &LightPaths<'_>, position: &Place, count: u64, seed: u64) -> Directions {
    let points = u64::from(sampling::SOBOL_2D_POINTS);
    let first = u64::from(paths.grids.along_curve(position.surface, position.point)) * count;
    let of_surface = sampling::hash(seed, streams::POSITION_DIRECTIONS + u64::from(position.surface.0));
    Directions { seed: sampling::hash(of_surface, first / points), first: (first % points) as u32 }
}

/// Where next-event rays start: at so many view points of each of some cells, given by index in the batch and position.
pub(super) fn starts(
    paths: &LightPaths<'_>,
    (indices, places): (&[usize], &[Place]),
    points: &[Box<[[f32; 2]]>],
    of_cell: usize,
) -> Vec<Place> {
    let all = indices.iter().zip(places).flat_map(|place| (0..of_cell).map(move |number| (place, number)));
    all.map(|((&index, place), number)| at_view_point(paths, place, number, points[index].get(number).copied())).collect()
}

/// View point `number` of the cell around `position`, at the coordinates `at` of the cell; the position itself if there are none,
/// or if they lie beside the surface.
fn at_view_point(paths: &LightPaths<'_>, position: &Place, number: usize, at: Option<[f32; 2]>) -> Place {
    let facet = paths.scene.surface(position.surface).polygon.facet();
    let [u, v] = at.unwrap_or_default().map(f64::from);
    let point = at.and_then(|_| paths.grids.point_beside(position.surface, position.point, u, v));
    let point = point.filter(|&point| facet.contains(point)).unwrap_or(position.point);
    Place { point, seed: sampling::hash(position.seed, streams::VIEW_POINT + number as u64), ..*position }
}

#[cfg(test)]
mod tests {
    use super::super::CellRadiosities;
    use super::*;
    use crate::geometry::Polygon;
    use crate::paths::{Brightness, CellSize, Resolution};
    use crate::scene::{Material, Scene, Sides, SurfaceId};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// A screen sees no lamp through a slit, only the jamb of that, which is lit at its other end. With one cell across, what the screen gets from there is
    /// as right as with ten.
    #[test]
    fn cells_lit_past_a_jamb_do_not_hang_on_how_many_cells_are_across_it() {
        let quad = |corner: [f64; 3], u: [f64; 3], v: [f64; 3]| {
            let at = |s: f64, t: f64| [0, 1, 2].map(|k| corner[k] + s * u[k] + t * v[k]);
            Polygon::new(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).unwrap()
        };
        let (x, z) = ([1.0, 0.0, 0.0], |height: f64| [0.0, 0.0, height]);
        let lamp = quad([0.0, -0.3, 0.2], z(0.3), x);
        let wall = quad([0.0, 0.0, 0.05], x, z(0.45));
        let jamb = quad([0.0, 0.0, 0.0], x, [0.0, 0.1, 0.0]);
        let screen = quad([0.0, 0.6, 0.0], x, z(0.5));
        let material = |rho: f64, exitance: f64| Material { name: String::new(), reflectance: vec![rho], exitance: vec![exitance] };
        let materials = vec![material(0.0, 1.0), material(0.0, 0.0), material(0.8, 0.0), material(0.5, 0.0)];
        let faces = (0..4).zip([lamp, wall, jamb, screen]).map(|(k, face)| (face, k, k)).collect();
        let scene = Scene::new(1, materials, faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);

        // The mean radiosity of the screen, over cells and seeds.
        let of_screen = |(side, seeds): (f64, u64)| {
            let size = CellSize { side, past_unresolved: false, most_surfaces: usize::MAX };
            let paths = LightPaths::new(&scene, &rays, &Brightness::even(&scene), size, &|| false);
            let grid = paths.grids.of(SurfaceId(3)).unwrap();
            let solved = |seed| CellRadiosities::solve(&paths, &Resolution { size, rays: 64 }, seed, &|| false).unwrap();
            let mean = |cells: &CellRadiosities| {
                (0..grid.len()).map(|cell| f64::from(cells.of(grid.first + cell as u32)[0])).sum::<f64>() / grid.len() as f64
            };
            (0..seeds).map(|seed| mean(&solved(seed))).sum::<f64>() / seeds as f64
        };
        let [coarse, fine] = [(0.1, 300), (0.01, 3)].map(of_screen);
        assert!((coarse / fine - 1.0).abs() < 0.05, "{coarse} for {fine}");
    }
}
