//! Radiosities resolved at positions: one in every cell of the lattice, found by light paths alone.
//!
//! From a random position in each cell a few paths are followed to the cells where they end. What they find there is not known yet;
//! so the paths are kept, and the positions take their radiosities from one another until nothing changes:
//!
//! ```text
//! B_i = E_i + rho_i (direct_i + mean over paths p of (constant_p + weight_p B_end(p)))
//! ```
//!
//! That is the radiosity equation with random rows instead of integrals, each unbiased. Its solution is noisy at a single position,
//! which gathers over many positions average out; biased is it only where a path comes back to its own position, which few do.
//!
//! Where lamps are many, some are near, and what they bring varies much over a cell. There aimed rays start from all quarters of the cell
//! instead of its position. (In a game level at 2%, with as many rays, that left a third of the square of what values are off by for
//! believing cells; at 1% a quarter, most of which was of one seed in eight.)
//!
//! The light that lamp rays bring is left out of what a cell sends.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::lattice::Grid;
use super::light_paths::{COVERED, LightPaths, NO_CELL, PathScratch, Place};
use crate::geometry::sampling;
use crate::scene::{DistinctChannels, Scene};

/// How finely radiosities are resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Resolution {
    /// The size of a cell, in metres.
    pub side: f64,
    /// Paths from each position, and as many rays to lamps.
    pub rays: u32,
}

impl Resolution {
    /// About `positions` cells over the surfaces of a scene.
    pub fn of_positions(scene: &Scene, positions: usize, rays: u32) -> Self {
        let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
        Self { side: (area / positions.max(1) as f64).sqrt(), rays }
    }

    /// The same cells for the looks of an error estimate, which may be noisier than values.
    pub fn for_looks(&self) -> Self {
        Self { side: self.side, rays: self.rays.div_ceil(2) }
    }

    /// Whether the numbers are in range.
    pub fn is_valid(&self) -> bool {
        self.side.is_finite() && self.side > 0.0 && self.rays > 0
    }
}

/// What every cell sends, by channel: its radiosity in W/m^2, less what lamp rays bring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Resolved {
    channels: usize,
    /// By cell, as found at its position.
    values: Vec<f32>,
    /// By cell, the one that stands for it where it is seen: a cell whose position is covered is seen where it is not.
    stand_in: Vec<u32>,
}

/// What a cell takes from all others, reflected, is less than this part of the brightest of them.
const MOST_TAKEN: f32 = 0.99;

/// The quarters of a cell.
const QUARTERS: u32 = 4;

/// Positions whose paths are followed together.
const BATCH: usize = 256;

/// Points tried in a cell until one lies on the surface.
const TRIES: u64 = 8;

/// Positions take their radiosities from one another until all changes still to come are below this part of the brightest, at most
/// so often.
const TOLERANCE: f64 = 1e-5;
const MAX_SWEEPS: u32 = 5000;

/// The ratio of changes is steady if what is still to come by it is known to this part.
const STEADY: f64 = 0.02;

/// What is known of one cell before the radiosities are.
#[derive(Clone, Copy)]
enum Cell {
    /// It does not meet the surface.
    Empty,
    Position(Place),
}

impl Resolved {
    /// Solves for what every cell sends.
    pub fn solve(paths: &LightPaths<'_>, resolution: &Resolution, seed: u64) -> Self {
        let cells = spread_positions(paths, seed);
        let mut equations = Equations::of_paths(paths, &cells, resolution);
        let mut stand_in = stand_ins(paths, &cells, &equations);

        // Who is covered sees the covered parts of cells, all others what is not.
        let Equations { paths: count, end, backs, seen, .. } = &mut equations;
        for (ends, _) in end.chunks_mut(*count).zip(&*backs).filter(|(_, backs)| **backs <= COVERED) {
            ends.iter_mut().filter(|end| **end != NO_CELL).for_each(|end| *end = stand_in[*end as usize]);
        }
        for (seen, backs) in seen.iter_mut().zip(backs.chunks(BATCH)) {
            seen.cells.iter_mut().filter(|(by, _)| backs[*by] <= COVERED).for_each(|(_, cell)| *cell = stand_in[*cell as usize]);
        }
        let channels = paths.scene.channels();
        let mut values: Vec<f32> = equations.solve().into_iter().map(|value| value as f32).collect();

        // Cells without a position have no value of their own.
        for (cell, _) in cells.iter().enumerate().filter(|(_, cell)| matches!(cell, Cell::Empty)) {
            let from = stand_in[cell] as usize * channels;
            values.copy_within(from..from + channels, cell * channels);
            stand_in[cell] = cell as u32;
        }
        Self { channels, values, stand_in }
    }

    /// The same for all channels, from those that were solved.
    pub fn spread(&self, channels: &DistinctChannels) -> Self {
        Self { channels: channels.count(), values: channels.spread(&self.values), stand_in: self.stand_in.clone() }
    }

    /// What a cell sends, by channel, where it is not covered.
    pub fn of(&self, cell: u32) -> &[f32] {
        self.at_position(self.stand_in[cell as usize])
    }

    /// What a cell sends, by channel, at its position, which may be covered.
    pub fn at_position(&self, cell: u32) -> &[f32] {
        &self.values[cell as usize * self.channels..][..self.channels]
    }

    /// What a cell sends to a place, by channel: who is covered sees the covered parts of cells, all others what is not.
    pub fn seen_from(&self, covered: bool, cell: u32) -> &[f32] {
        if covered { self.at_position(cell) } else { self.of(cell) }
    }

    /// Whether it fits a number of cells and channels, and holds only numbers; in the dark noise may take them below 0.
    pub fn is_valid(&self, cells: usize, channels: usize) -> bool {
        let fits = self.channels == channels && self.values.len() == cells * channels && self.stand_in.len() == cells;
        fits && self.values.iter().all(|value| value.is_finite()) && self.stand_in.iter().all(|&cell| (cell as usize) < cells)
    }

    /// Bytes that the values take.
    pub fn memory_bytes(&self) -> u64 {
        Self::bytes_of(self.stand_in.len(), self.channels)
    }

    /// Bytes that the values of so many cells take.
    pub fn bytes_of(cells: usize, channels: usize) -> u64 {
        (cells * (channels * size_of::<f32>() + size_of::<u32>())) as u64
    }
}

/// A random position in every cell that meets its surface.
fn spread_positions(paths: &LightPaths<'_>, seed: u64) -> Vec<Cell> {
    let grids: Vec<_> = paths.lattice.grids().collect();
    let of_grid = |(surface, grid): &(_, &Grid)| -> Vec<Cell> {
        let facet = paths.scene.surface(*surface).polygon.facet();
        let mut cells: Vec<Cell> = (0..grid.len())
            .map(|index| {
                let seed = sampling::hash(seed, u64::from(grid.first) + index as u64);
                let tries = (0..TRIES).map(|attempt| sampling::hash(seed, attempt));
                let mut points =
                    tries.map(|draw| grid.point_in(index, sampling::unit(draw), sampling::unit(sampling::hash(draw, 1))));
                let inside = points.find(|&point| facet.contains(point));
                inside.map_or(Cell::Empty, |point| Cell::Position(Place { point, surface: *surface, seed }))
            })
            .collect();

        // A sliver may slip through; then any point of the surface will do.
        if cells.iter().all(|cell| matches!(cell, Cell::Empty)) {
            let seed = sampling::hash(seed, u64::from(grid.first));
            let point = facet.point_at(sampling::unit(seed), sampling::unit(sampling::hash(seed, 1)));
            cells[0] = Cell::Position(Place { point, surface: *surface, seed });
        }
        cells
    };
    grids.par_iter().with_min_len(64).flat_map_iter(of_grid).collect()
}

/// One equation a cell: what it sends follows from what its paths' ends send.
struct Equations {
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
    /// Follows the paths of all positions.
    fn of_paths(paths: &LightPaths<'_>, cells: &[Cell], resolution: &Resolution) -> Self {
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
        let Self { constant, end, weight, backs, .. } = &mut equations;
        let batches = cells
            .par_chunks(BATCH)
            .zip(constant.par_chunks_mut(BATCH * channels))
            .zip(end.par_chunks_mut(BATCH * count))
            .zip(weight.par_chunks_mut(BATCH * count * channels))
            .zip(backs.par_chunks_mut(BATCH));
        let seen = batches.map_init(PathScratch::default, |scratch, ((((cells, constant), end), weight), backs)| {
            let position = |(index, cell): (usize, &Cell)| match cell {
                Cell::Position(place) => Some((index, *place)),
                Cell::Empty => None,
            };
            let (indices, places): (Vec<usize>, Vec<Place>) = cells.iter().enumerate().filter_map(position).unzip();
            let mut irradiance = vec![0.0; places.len() * channels];
            paths.follow(&places, resolution.rays, 0, scratch);
            add_aimed(paths, &places, resolution.rays, scratch, &mut irradiance);
            let PathScratch { ends, seen, .. } = &*scratch;

            // What is sent by the place itself, and by the ends of paths that arrive there at once.
            for (number, (&index, place)) in indices.iter().zip(&places).enumerate() {
                let own = number * count..(number + 1) * count;
                end[index * count..][..count].copy_from_slice(&ends.cell[own.clone()]);
                backs[index] = ends.back[own].iter().filter(|&&back| back).count() as f32 / count as f32;
                let material = paths.scene.material_of(place.surface);
                let exitance = paths.unlamped_exitance(place.surface);
                for channel in 0..channels {
                    let rho = material.reflectance[channel];
                    let weights = weight[index * count * channels..][..count * channels].iter_mut();
                    weights.skip(channel).step_by(channels).for_each(|weight| *weight = (rho / count as f64) as f32);
                    let emitted = exitance.map_or(0.0, |exitance| exitance[channel]);
                    constant[index * channels + channel] = emitted + rho * irradiance[number * channels + channel];
                }
            }

            // What detours bring instead.
            for (number, detour) in ends.detours.iter().enumerate() {
                let (place, path) = (detour.path / count, detour.path % count);
                let (index, material) = (indices[place], paths.scene.material_of(places[place].surface));
                end[index * count + path] = detour.cell;
                for channel in 0..channels {
                    let share = material.reflectance[channel] / count as f64;
                    constant[index * channels + channel] += share * ends.constant[number * channels + channel];
                    weight[(index * count + path) * channels + channel] = (share * ends.weight[number * channels + channel]) as f32;
                }
            }

            // Reflectors, as the places and the detours see them.
            let mut from = Seen::default();
            let mut add = |number: usize, cell: u32, weights: &mut dyn Iterator<Item = f64>| {
                let reflectance = &paths.scene.material_of(places[number].surface).reflectance;
                from.cells.push((indices[number], cell));
                from.weight.extend(weights.zip(reflectance).map(|(weight, rho)| (rho * weight) as f32));
            };
            seen.iter().for_each(|seen| add(seen.by, seen.cell, &mut std::iter::repeat(seen.weight)));
            for (&(detour, cell), weights) in ends.seen.iter().zip(ends.seen_weight.chunks(channels)) {
                add(ends.detours[detour].path / count, cell, &mut weights.iter().map(|weight| weight / count as f64));
            }
            from.tame(end, weight, count, channels);
            from
        });
        equations.seen = seen.collect();
        equations
    }

    /// Whether a position is covered: most of its paths meet a back at once.
    fn is_covered(&self, cell: usize) -> bool {
        self.backs[cell] > COVERED
    }

    /// What every position sends.
    ///
    /// Changes that fall by a steady ratio are a geometric series, and what is still to come of it is taken at once (Aitken): else a
    /// reflectance of 0.999 takes ten thousand sweeps. Two sweeps make one step, because light that goes to and fro between two
    /// surfaces changes the one and the other in turns.
    fn solve(&self) -> Vec<f64> {
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

/// Adds the irradiance from lamps over the cell of each position, by `count` rays, position after position; `scratch` has what they see of
/// reflectors then.
fn add_aimed(paths: &LightPaths<'_>, positions: &[Place], count: u32, scratch: &mut PathScratch, irradiance: &mut [f64]) {
    if !paths.has_many_lamps() || count < QUARTERS {
        paths.add_aimed(positions, 1, count, scratch, irradiance);
        return;
    }
    let together = QUARTERS as usize;
    let quarters: Vec<Place> = positions
        .iter()
        .flat_map(|&position| (0..QUARTERS).map(move |quarter| spot_in_quarter(paths, position, quarter)))
        .collect();
    let channels = paths.scene.channels();
    let mut of_quarters = vec![0.0; quarters.len() * channels];
    paths.add_aimed(&quarters, together, count / QUARTERS, scratch, &mut of_quarters);

    // What quarters find is a quarter of what their cell does.
    let part = 1.0 / f64::from(QUARTERS);
    for (irradiance, of_quarters) in irradiance.chunks_mut(channels).zip(of_quarters.chunks(together * channels)) {
        for of_quarter in of_quarters.chunks(channels) {
            irradiance.iter_mut().zip(of_quarter).for_each(|(h, of_quarter)| *h += part * of_quarter);
        }
    }
    for seen in &mut scratch.seen {
        (seen.by, seen.weight) = (seen.by / together, part * seen.weight);
    }
}

/// A random place in a quarter of the cell of a position; the position itself if that lies beside the surface.
fn spot_in_quarter(paths: &LightPaths<'_>, position: Place, quarter: u32) -> Place {
    let seed = sampling::hash(position.seed, 0x90 + u64::from(quarter));
    let within = |number: u32, draw| 0.5 * (f64::from(number) + sampling::unit(sampling::hash(seed, draw)));
    let (u, v) = (within(quarter % 2, 1), within(quarter / 2, 2));
    let facet = paths.scene.surface(position.surface).polygon.facet();
    let spot = paths.lattice.point_beside(position.surface, position.point, u, v).filter(|&spot| facet.contains(spot));
    Place { point: spot.unwrap_or(position.point), seed, ..position }
}

/// For every cell the nearest one of its surface that has a position which is not covered: itself, for most.
fn stand_ins(paths: &LightPaths<'_>, cells: &[Cell], equations: &Equations) -> Vec<u32> {
    let mut stand_in: Vec<u32> = (0..cells.len() as u32).collect();
    for (_, grid) in paths.lattice.grids() {
        let first = grid.first as usize;
        let serves = |cell: usize| matches!(cells[cell], Cell::Position(_)) && !equations.is_covered(cell);
        let mut open: Vec<usize> = (first..first + grid.len()).filter(|&cell| !serves(cell)).collect();
        if open.is_empty() || open.len() == grid.len() {
            // Nothing to do; or all is covered, and no path from outside ends here but by rounding.
            let any = (first..first + grid.len()).find(|&cell| matches!(cells[cell], Cell::Position(_))).unwrap_or(first);
            open.into_iter().filter(|&cell| matches!(cells[cell], Cell::Empty)).for_each(|cell| stand_in[cell] = any as u32);
            continue;
        }

        // The known spreads from cell to cell, a step in every round.
        let columns = grid.columns as usize;
        let mut is_open = vec![false; grid.len()];
        open.iter().for_each(|cell| is_open[cell - first] = true);
        while !open.is_empty() {
            let found: Vec<(usize, u32)> = open
                .iter()
                .filter_map(|&cell| {
                    let (index, column) = (cell - first, (cell - first) % columns);
                    let left = (column > 0).then(|| index - 1);
                    let right = (column + 1 < columns).then_some(index + 1);
                    let (below, above) = (index.checked_sub(columns), (index + columns < grid.len()).then_some(index + columns));
                    let neighbours = [left, right, below, above].into_iter().flatten();
                    neighbours.into_iter().find(|&near| !is_open[near]).map(|near| (cell, stand_in[first + near]))
                })
                .collect();
            for &(cell, by) in &found {
                stand_in[cell] = by;
                is_open[cell - first] = false;
            }
            open.retain(|cell| is_open[cell - first]);
        }
    }
    stand_in
}
