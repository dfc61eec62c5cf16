//! The equations of resolved radiosities: one a cell, a random row each, and how they are solved.
//!
//! The paths of a position make its row; where they arrive tells the spots of other cells, from which aimed rays bring direct light.

use rayon::prelude::*;

use super::light_paths::{COVERED, Directions, LightPaths, NO_CELL, PathScratch, Place};
use super::resolved::Resolution;
use super::spots::{SPOTS, View, spots};
use crate::geometry::sampling;

/// What a cell takes from all others, reflected, is less than this part of the brightest of them.
const MOST_TAKEN: f32 = 0.99;

/// Positions whose paths are followed together.
const BATCH: usize = 256;

/// Positions take their radiosities from one another until all changes still to come are below this part of the brightest, at most
/// so often.
const TOLERANCE: f64 = 1e-5;
const MAX_SWEEPS: u32 = 5000;

/// The ratio of changes is steady if what is still to come by it is known to this part.
const STEADY: f64 = 0.02;

/// What is known of one cell before the radiosities are.
#[derive(Clone, Copy)]
pub(super) enum Cell {
    /// It does not meet the surface.
    Empty,
    Position(Place),
}

/// One equation a cell: what it sends follows from what its paths' ends send.
pub(super) struct Equations {
    channels: usize,
    paths: usize,
    /// By cell and channel.
    constant: Vec<f64>,
    /// By cell and path.
    end: Vec<u32>,
    /// By cell, path and channel; the reflectance and `1 / paths` are in it.
    weight: Vec<f32>,
    /// The part of each cell's paths that meet a back at once.
    backs: Vec<f32>,
    /// What aimed rays see of reflectors, by [`BATCH`] of cells.
    seen: Vec<Seen>,
}

/// The cells of reflectors that are seen from the positions of a batch, and from the detours of their paths.
#[derive(Default)]
struct Seen {
    /// By whom, counted in the batch, and what.
    cells: Vec<(usize, u32)>,
    /// By what is seen and channel; reflectance and number of rays are in it.
    weight: Vec<f32>,
}

impl Seen {
    fn add(&mut self, by: usize, cell: u32, weights: impl Iterator<Item = f64>, reflectance: &[f64]) {
        self.cells.push((by, cell));
        self.weight.extend(weights.zip(reflectance).map(|(weight, rho)| (rho * weight) as f32));
    }

    /// Noise may make more of what is seen than there is room for beside what paths bring, and light would grow from sweep to sweep: what
    /// a cell takes from all others stays below [`MOST_TAKEN`]. `end` and `weight` are those of the batch's paths, `count` from each cell.
    fn tame(&mut self, end: &[u32], weight: &[f32], count: usize, channels: usize) {
        if self.cells.is_empty() {
            return;
        }
        let cells = end.len() / count;
        let (mut of_paths, mut seen) = (vec![0.0_f32; cells * channels], vec![0.0_f32; cells * channels]);
        let add = |sums: &mut [f32], cell: usize, weights: &[f32]| {
            sums[cell * channels..][..channels].iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight);
        };
        let ending = end.iter().zip(weight.chunks(channels)).enumerate().filter(|(_, (end, _))| **end != NO_CELL);
        ending.for_each(|(path, (_, weights))| add(&mut of_paths, path / count, weights));
        self.cells.iter().zip(self.weight.chunks(channels)).for_each(|(&(by, _), weights)| add(&mut seen, by, weights));
        for (&(by, _), weights) in self.cells.iter().zip(self.weight.chunks_mut(channels)) {
            for (channel, weight) in weights.iter_mut().enumerate() {
                let sum = by * channels + channel;
                let room = (MOST_TAKEN - of_paths[sum]).max(0.0);
                if seen[sum] > room {
                    *weight *= room / seen[sum];
                }
            }
        }
    }
}

impl Equations {
    /// Follows the paths of all positions, and casts aimed rays from the spots of their cells.
    pub fn of_paths(paths: &LightPaths<'_>, cells: &[Cell], resolution: &Resolution, seed: u64) -> Self {
        let (channels, count) = (paths.scene.channels(), resolution.rays as usize);
        let mut equations = Self {
            channels,
            paths: count,
            constant: vec![0.0; cells.len() * channels],
            end: vec![NO_CELL; cells.len() * count],
            weight: vec![0.0; cells.len() * count * channels],
            backs: vec![0.0; cells.len()],
            seen: Vec::new(),
        };
        let views = equations.follow(paths, cells, seed);
        let spots = spots(cells.len(), &views, sampling::hash(seed, 0x5907));
        equations.aim(paths, cells, &spots);
        equations
    }

    /// Follows the paths of all positions; where they arrive.
    fn follow(&mut self, paths: &LightPaths<'_>, cells: &[Cell], seed: u64) -> Vec<Vec<View>> {
        let (channels, count) = (self.channels, self.paths);
        let Self { constant, end, weight, backs, .. } = self;
        let batches = cells
            .par_chunks(BATCH)
            .zip(constant.par_chunks_mut(BATCH * channels))
            .zip(end.par_chunks_mut(BATCH * count))
            .zip(weight.par_chunks_mut(BATCH * count * channels))
            .zip(backs.par_chunks_mut(BATCH));
        let (seen, views) = batches
            .map_init(PathScratch::default, |scratch, ((((batch, constant), end), weight), backs)| {
                let (indices, places) = positions(batch);
                let directions: Vec<Directions> = places.iter().map(|place| directions(paths, place, count as u64, seed)).collect();
                paths.follow_towards(&places, &directions, count as u32, 0, scratch);
                let ends = &scratch.ends;

                // What is sent by the place itself, and by the ends of paths that arrive there at once.
                let mut views = Vec::with_capacity(places.len() * count);
                for (number, (&index, place)) in indices.iter().zip(&places).enumerate() {
                    let own = number * count..(number + 1) * count;
                    end[index * count..][..count].copy_from_slice(&ends.cell[own.clone()]);
                    backs[index] = ends.back[own.clone()].iter().filter(|&&back| back).count() as f32 / count as f32;
                    let material = paths.scene.material_of(place.surface);
                    let exitance = paths.unlamped_exitance(place.surface);
                    for channel in 0..channels {
                        let rho = material.reflectance[channel];
                        let weights = weight[index * count * channels..][..count * channels].iter_mut();
                        weights.skip(channel).step_by(channels).for_each(|weight| *weight = (rho / count as f64) as f32);
                        constant[index * channels + channel] = exitance.map_or(0.0, |exitance| exitance[channel]);
                    }

                    // Who is covered sees what others do not.
                    let arrivals = own.filter(|&path| backs[index] <= COVERED && ends.cell[path] != NO_CELL);
                    views.extend(arrivals.filter_map(|path| {
                        let Cell::Position(there) = cells[ends.cell[path] as usize] else { return None };
                        let at = paths.lattice.within_cell(there.surface, ends.point[path])?.map(|along| along as f32);
                        Some(View { cell: ends.cell[path], at, weight: paths.lattice.cell_area(place.surface)? as f32 })
                    }));
                }

                // What detours bring instead.
                for (number, detour) in ends.detours.iter().enumerate() {
                    let (place, path) = (detour.path / count, detour.path % count);
                    let (index, material) = (indices[place], paths.scene.material_of(places[place].surface));
                    end[index * count + path] = detour.cell;
                    for channel in 0..channels {
                        let share = material.reflectance[channel] / count as f64;
                        constant[index * channels + channel] += share * ends.constant[number * channels + channel];
                        weight[(index * count + path) * channels + channel] =
                            (share * ends.weight[number * channels + channel]) as f32;
                    }
                }

                // Reflectors, as the detours see them.
                let mut seen = Seen::default();
                for (&(detour, cell), weights) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
                    let place = ends.detours[detour].path / count;
                    let reflectance = &paths.scene.material_of(places[place].surface).reflectance;
                    seen.add(indices[place], cell, weights.iter().map(|weight| weight / count as f64), reflectance);
                }
                (seen, views)
            })
            .unzip();
        self.seen = seen;
        views
    }

    /// Casts as many aimed rays over each cell as paths were followed.
    fn aim(&mut self, paths: &LightPaths<'_>, cells: &[Cell], spots: &[Option<[[f32; 2]; SPOTS]>]) {
        let (channels, count) = (self.channels, self.paths);
        let Self { constant, end, weight, backs, seen, .. } = self;
        let batches = cells
            .par_chunks(BATCH)
            .zip(spots.par_chunks(BATCH))
            .zip(constant.par_chunks_mut(BATCH * channels))
            .zip(end.par_chunks(BATCH * count))
            .zip(weight.par_chunks(BATCH * count * channels))
            .zip(backs.par_chunks(BATCH))
            .zip(seen);
        batches.for_each_init(PathScratch::default, |scratch, ((((((batch, spots), constant), end), weight), backs), from)| {
            let (indices, places) = positions(batch);
            let starts: Vec<Place> = indices
                .iter()
                .zip(&places)
                .flat_map(|(&index, place)| {
                    let spots = spots[index].filter(|_| backs[index] <= COVERED);
                    (0..SPOTS).map(move |spot| at_spot(paths, place, spot, spots.map(|spots| spots[spot])))
                })
                .collect();
            let mut irradiance = vec![0.0; starts.len() * channels];
            paths.add_aimed(&starts, SPOTS, count.div_ceil(SPOTS) as u32, scratch, &mut irradiance);

            // What spots find is their part of what their cell does.
            let part = 1.0 / SPOTS as f64;
            for (start, irradiance) in
                starts.iter().zip(irradiance.chunks(channels)).enumerate().map(|(number, of)| (number / SPOTS, of.1))
            {
                let reflectance = &paths.scene.material_of(places[start].surface).reflectance;
                let constant = constant[indices[start] * channels..].iter_mut();
                constant.zip(irradiance).zip(reflectance).for_each(|((constant, h), rho)| *constant += part * rho * h);
            }
            for seen in &scratch.seen {
                let place = seen.by / SPOTS;
                let reflectance = &paths.scene.material_of(places[place].surface).reflectance;
                from.add(indices[place], seen.cell, std::iter::repeat(part * seen.weight), reflectance);
            }
            from.tame(end, weight, count, channels);
        });
    }

    /// Lets each path end in the cell that stands in for its own, as seen by those who are not covered and by those who are.
    pub fn redirect(&mut self, stand_in: &[Vec<u32>; 2]) {
        let Self { paths, end, backs, seen, .. } = self;
        let seen_by = |backs: f32, cell: &mut u32| *cell = stand_in[usize::from(backs > COVERED)][*cell as usize];
        for (ends, &backs) in end.chunks_mut(*paths).zip(&*backs) {
            ends.iter_mut().filter(|end| **end != NO_CELL).for_each(|end| seen_by(backs, end));
        }
        for (seen, backs) in seen.iter_mut().zip(backs.chunks(BATCH)) {
            seen.cells.iter_mut().for_each(|(by, cell)| seen_by(backs[*by], cell));
        }
    }

    /// Whether a position is covered: most of its paths meet a back at once.
    pub fn is_covered(&self, cell: usize) -> bool {
        self.backs[cell] > COVERED
    }

    /// What every position sends.
    ///
    /// Changes that fall by a steady ratio are a geometric series, and what is still to come of it is taken at once (Aitken): else a
    /// reflectance of 0.999 takes ten thousand sweeps. Two sweeps make one step, because light that goes to and fro between two
    /// surfaces changes the one and the other in turns.
    pub fn solve(&self) -> Vec<f64> {
        let mut values = self.constant.clone();
        let (mut between, mut next) = (vec![0.0; values.len()], vec![0.0; values.len()]);
        let (mut previous, mut previous_ratio) = (f64::INFINITY, f64::INFINITY);
        let mut slowest: f64 = 0.0;
        let mut before_leap: Option<(f64, Vec<f64>)> = None;
        for _ in 0..MAX_SWEEPS / 2 {
            self.sweep(&values, &mut between);
            self.sweep(&between, &mut next);
            let changes = next.par_iter().zip(&values).map(|(new, old)| ((new - old).abs(), *new));
            let (change, brightest) = changes.reduce(|| (0.0, 0.0), |a, b| (f64::max(a.0, b.0), f64::max(a.1, b.1)));

            // A leap that did not come nearer is taken back.
            if let Some((change_before, values_before)) = before_leap.take()
                && change > change_before
            {
                values = values_before;
                (previous, previous_ratio) = (f64::INFINITY, f64::INFINITY);
                continue;
            }
            std::mem::swap(&mut values, &mut next);
            let ratio = if previous.is_finite() { (change / previous).min(0.9999) } else { 0.9999 };
            // After a leap faster changes hide the slow ones that are left.
            let slow = ratio.max(slowest);
            if change * slow <= TOLERANCE * brightest * (1.0 - slow) {
                break;
            }

            if (ratio - previous_ratio).abs() <= STEADY * (1.0 - ratio) {
                slowest = slowest.max(ratio);
                before_leap = Some((change, values.clone()));
                let to_come = ratio / (1.0 - ratio);
                values.par_iter_mut().zip(&next).with_min_len(1024).for_each(|(new, old)| *new += to_come * (*new - old));
                (previous, previous_ratio) = (f64::INFINITY, f64::INFINITY);
            } else {
                (previous, previous_ratio) = (change, ratio);
            }
        }
        values
    }

    /// What every position sends, if the ends of its paths send `values`.
    fn sweep(&self, values: &[f64], next: &mut [f64]) {
        let (channels, paths) = (self.channels, self.paths);
        let add = |next: &mut [f64], cell: u32, weight: &[f32]| {
            let sent = &values[cell as usize * channels..][..channels];
            next.iter_mut().zip(weight).zip(sent).for_each(|((next, weight), sent)| *next += f64::from(*weight) * sent);
        };
        let batches = next.par_chunks_mut(BATCH * channels).zip(&self.seen).with_min_len(4).enumerate();
        batches.for_each(|(batch, (next, seen))| {
            for (cell, next) in (batch * BATCH..).zip(next.chunks_mut(channels)) {
                next.copy_from_slice(&self.constant[cell * channels..][..channels]);
                let ends = &self.end[cell * paths..][..paths];
                let weights = self.weight[cell * paths * channels..].chunks(channels);
                ends.iter().zip(weights).filter(|(end, _)| **end != NO_CELL).for_each(|(&end, weight)| add(next, end, weight));
            }
            for (&(by, cell), weight) in seen.cells.iter().zip(seen.weight.chunks(channels)) {
                add(&mut next[by * channels..][..channels], cell, weight);
            }
        });
    }
}

/// The positions of some cells, and the number of each one's cell among them.
fn positions(cells: &[Cell]) -> (Vec<usize>, Vec<Place>) {
    let position = |(index, cell): (usize, &Cell)| match cell {
        Cell::Position(place) => Some((index, *place)),
        Cell::Empty => None,
    };
    cells.iter().enumerate().filter_map(position).unzip()
}

/// The directions of a position's paths: neighbours share a sequence, one block after the other, so that all around is met by them together
/// as evenly as by one. (What cells get of each other in all was off by less: in two white rooms with 80,000 paths, where it adds up from
/// bounce to bounce, radiosities scattered by 1.0% from seed to seed instead of 1.6%.)
fn directions(paths: &LightPaths<'_>, position: &Place, count: u64, seed: u64) -> Directions {
    let points = u64::from(sampling::SOBOL_2D_POINTS);
    let first = u64::from(paths.lattice.along_curve(position.surface, position.point)) * count;
    let of_surface = sampling::hash(seed, 0xd1 + u64::from(position.surface.0));
    Directions { seed: sampling::hash(of_surface, first / points), first: (first % points) as u32 }
}

/// Where aimed rays start from a spot of the cell around `position`: there itself, if the spot is not known or lies beside the surface.
fn at_spot(paths: &LightPaths<'_>, position: &Place, number: usize, spot: Option<[f32; 2]>) -> Place {
    let facet = paths.scene.surface(position.surface).polygon.facet();
    let [u, v] = spot.unwrap_or_default().map(f64::from);
    let point = spot.and_then(|_| paths.lattice.point_beside(position.surface, position.point, u, v));
    let point = point.filter(|&point| facet.contains(point)).unwrap_or(position.point);
    Place { point, seed: sampling::hash(position.seed, 0x90 + number as u64), ..*position }
}
