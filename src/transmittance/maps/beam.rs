//! The lines of one direction cell through a cluster: what part of them its surfaces block, by offset and at several resolutions.
//!
//! A direction cell holds all lines of one axis whose slopes lie in a square. In the plane through the cluster's centre, at right angles to the axis, offsets
//! are divided into cells as well. The part of the lines of a cell that are blocked is sampled: surfaces are projected along a few directions of the
//! direction cell, drawn one in each of its quarters, and a grid of offsets, shifted at random, is held against the projections, row by row. So all
//! lines of one direction are answered together, and none is a ray. Beside stands what is proved (`proof`), for cells that no polygon comes near and for
//! those that one polygon covers.

use glam::DVec3;

use super::frame::BeamFrame;
use super::line::offsets;
use super::proof::{Proof, Proved};
use crate::geometry::sampling::{hash, unit};

/// Directions are drawn in so many strips of the direction cell each way.
const STRIPS: usize = 2;

/// Along either side of an offset cell so many samples are taken for each direction.
const SAMPLES_OF_SIDE: usize = 2;

/// Lines by which the part of an offset cell is known at the finest resolution.
pub(super) const SAMPLES: usize = (STRIPS * SAMPLES_OF_SIDE).pow(2);

/// Parts of lines are kept as so many steps from 0 to 1.
const STEPS: f64 = 255.0;

/// The blocked parts of a direction cell.
#[derive(Clone, Debug)]
pub(super) struct Beam {
    /// All cells of the finest resolution, row by row, then of half of it, and so on to a single one.
    cells: Box<[Cell]>,
    frame: BeamFrame,
}

/// What is known of an offset cell of some resolution, in 255ths: the least, the mean and the largest of the parts that were sampled at the finest one, and
/// between what the mean is by proof.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    least: u8,
    mean: u8,
    most: u8,
    proved: [u8; 2],
}

/// The part of the lines about a line that is blocked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    /// The mean over the cell, 0 to 1: an estimate.
    pub mean: f64,
    /// Bounds of this mean. Where they are equal, at the finest resolution, they hold for every line.
    pub proved: [f64; 2],
    /// The least and the most that is found a resolution below the next coarser cell.
    pub range: [f64; 2],
    /// Sampled lines that the mean is over.
    pub samples: f64,
}

impl Beam {
    /// Of convex polygons, with vertices from the cluster's centre.
    pub fn of<'p>(polygons: impl Iterator<Item = &'p [DVec3]>, centre: DVec3, frame: BeamFrame, seed: u64) -> Self {
        let side = frame.cells * SAMPLES_OF_SIDE;
        let passes: Vec<Pass> = (0..STRIPS * STRIPS).map(|pass| Pass::new(&frame, side, pass, seed)).collect();
        let mut hit = vec![false; passes.len() * side * side];
        let mut projected = Vec::new();
        let (mut proof, mut local) = (Proof::of_nothing(frame), Vec::new());
        for polygon in polygons {
            local.clear();
            local.extend(polygon.iter().map(|&vertex| vertex - centre));
            proof.add(&local);
            for (pass, hit) in passes.iter().zip(hit.chunks_mut(side * side)) {
                projected.clear();
                projected.extend(local.iter().map(|&vertex| pass.on_grid(frame.axis, vertex)));
                fill(&projected, side, hit);
            }
        }

        // How many samples of each cell are hit.
        let mut counts = vec![0_usize; frame.cells * frame.cells];
        for (index, _) in hit.iter().enumerate().filter(|(_, hit)| **hit) {
            let (row, column) = (index / side % side, index % side);
            counts[row / SAMPLES_OF_SIDE * frame.cells + column / SAMPLES_OF_SIDE] += 1;
        }
        let finest = counts.iter().zip(&proof.cells).map(|(&count, &proved)| Cell::finest(count, proved)).collect();
        Self { cells: with_coarser(finest, frame.cells), frame }
    }

    /// What is blocked of the lines about a line with these offsets, at a resolution: 0 is the finest, each next one half of it.
    pub fn part(&self, offsets: [f64; 2], level: u32) -> Part {
        let levels = self.frame.cells.ilog2();
        let level = level.min(levels);
        let at = |axis: usize| {
            let place = (offsets[axis] + self.frame.reach[axis]) / (2.0 * self.frame.reach[axis]);
            ((place * self.frame.cells as f64) as usize).min(self.frame.cells - 1)
        };
        let cell_at = |level: u32| {
            let first: usize = (0..level).map(|finer| (self.frame.cells >> finer).pow(2)).sum();
            self.cells[first + (at(1) >> level) * (self.frame.cells >> level) + (at(0) >> level)]
        };
        let (cell, around) = (cell_at(level), cell_at((level + 1).min(levels)));
        let range = [around.least, around.most].map(|part| f64::from(part) / STEPS);
        let proved = cell.proved.map(|part| f64::from(part) / STEPS);
        Part { mean: f64::from(cell.mean) / STEPS, proved, range, samples: (SAMPLES << (2 * level)) as f64 }
    }

    /// Bytes of the memory that one takes with so many cells along a side.
    pub fn bytes(cells: usize) -> u64 {
        // The cells of all coarser resolutions are a third of those of the finest.
        (size_of::<Self>() + 4 * cells * cells * size_of::<Cell>() / 3) as u64
    }
}

impl Cell {
    /// One of the finest resolution, by its samples that are hit and by what is proved. A sample is of the cell's lines, so proofs agree with it but for rounding.
    fn finest(hits: usize, proved: Proved) -> Self {
        let (mean, proved) = match proved {
            Proved::Free => (0, [0, 0]),
            Proved::Blocked => (u8::MAX, [u8::MAX, u8::MAX]),
            Proved::Nothing => ((STEPS * hits as f64 / SAMPLES as f64).round() as u8, [0, u8::MAX]),
        };
        Self { least: mean, mean, most: mean, proved }
    }
}

/// The cells of the finest resolution and of all coarser ones.
fn with_coarser(finest: Vec<Cell>, side: usize) -> Box<[Cell]> {
    let (mut cells, mut first, mut side) = (finest, 0, side);
    while side > 1 {
        let half = side / 2;
        for index in 0..half * half {
            let corner = first + 2 * (index / half) * side + 2 * (index % half);
            let four = [corner, corner + 1, corner + side, corner + side + 1].map(|index| cells[index]);
            let sum: u32 = four.iter().map(|cell| u32::from(cell.mean)).sum();
            let least = four.iter().map(|cell| cell.least).min().unwrap_or_default();
            let most = four.iter().map(|cell| cell.most).max().unwrap_or_default();
            let proved = [0, 1].map(|k| four.iter().map(|cell| u32::from(cell.proved[k])).sum::<u32>());
            let proved = [(proved[0] / 4) as u8, proved[1].div_ceil(4) as u8];
            let mean = (((sum + 2) / 4) as u8).clamp(proved[0], proved[1]);
            cells.push(Cell { least, mean, most, proved });
        }
        (first, side) = (first + side * side, half);
    }
    cells.into_boxed_slice()
}

/// Samples along one direction: a grid over the offsets.
struct Pass {
    slopes: [f64; 2],
    /// Grid steps per metre, and where the offset 0 lies in steps from the first sample.
    scale: [f64; 2],
    origin: [f64; 2],
}

impl Pass {
    fn new(frame: &BeamFrame, side: usize, pass: usize, seed: u64) -> Self {
        let random = |k: usize| unit(hash(seed, (4 * pass + k) as u64));
        let strip = [pass % STRIPS, pass / STRIPS];
        let slope = |k: usize| frame.slopes[k] + frame.width * (strip[k] as f64 + random(k)) / STRIPS as f64;
        let scale = frame.reach.map(|reach| side as f64 / (2.0 * reach));
        let origin = [0, 1].map(|k| frame.reach[k] * scale[k] - random(2 + k));
        Self { slopes: [slope(0), slope(1)], scale, origin }
    }

    /// Where a point projects to, in steps from the first sample.
    fn on_grid(&self, axis: usize, point: DVec3) -> [f64; 2] {
        let offsets = offsets(axis, self.slopes, point);
        [0, 1].map(|k| offsets[k] * self.scale[k] + self.origin[k])
    }
}

/// Marks the points with whole coordinates, below `side`, in a convex polygon.
fn fill(polygon: &[[f64; 2]], side: usize, hit: &mut [bool]) {
    let below = |value: f64| value.floor().min(side as f64 - 1.0);
    let (low, high) = polygon.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[1]), high.max(p[1])));
    let (first, last) = (low.ceil().max(0.0), below(high));
    let mut row = first;
    while row <= last {
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut a = polygon[polygon.len() - 1];
        for &b in polygon {
            if (a[1] <= row) != (b[1] <= row) {
                let at = a[0] + (row - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                (left, right) = (left.min(at), right.max(at));
            }
            a = b;
        }
        let (left, right) = (left.ceil().max(0.0), below(right));
        if left <= right {
            let start = row as usize * side;
            hit[start + left as usize..=start + right as usize].fill(true);
        }
        row += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::frame_of;
    use super::*;

    #[test]
    fn a_square_fills_the_points_in_it() {
        let mut hit = vec![false; 64];
        fill(&[[1.5, 2.5], [4.5, 2.5], [4.5, 5.5], [1.5, 5.5]], 8, &mut hit);
        let inside = |index: usize| (2..=4).contains(&(index % 8)) && (3..=5).contains(&(index / 8));
        assert!((0..64).all(|index| hit[index] == inside(index)));

        // Turned the other way, beyond all sides.
        fill(&[[-3.0, 9.0], [11.0, 9.0], [11.0, -3.0], [-3.0, -3.0]], 8, &mut hit);
        assert!(hit.iter().all(|&hit| hit));
    }

    #[test]
    fn a_slab_across_half_of_a_beam_blocks_half_of_it_at_every_resolution() {
        // A large square at the centre's height that ends in the middle: lines of positive first offset pass it.
        let slab = [[-9.0, -9.0], [0.0, -9.0], [0.0, 9.0], [-9.0, 9.0]].map(|[u, v]| DVec3::new(u, v, 0.0));
        for place in [[3, 4], [0, 7]] {
            let frame = frame_of(2, place, 8, DVec3::ONE, 16);
            let beam = Beam::of([&slab[..]].into_iter(), DVec3::ZERO, frame, 5);
            for level in 0..5 {
                let [left, right] = [-0.6, 0.6].map(|offset| beam.part([offset * frame.reach[0], 0.1], level));
                let expected = if level == 4 { [0.5, 0.5] } else { [1.0, 0.0] };
                assert!((left.mean - expected[0]).abs() < 0.05 && (right.mean - expected[1]).abs() < 0.05, "{left:?} {right:?}");
                assert!(left.range[0] <= left.mean && left.mean <= left.range[1]);
                assert_eq!(left.samples, 16.0 * 4_f64.powi(level as i32));
            }
        }
    }
}
