//! Which offset cells of a direction cell are surely free, and which surely blocked: proved, for every line in them.
//!
//! A vertex projects to offsets that depend on each slope by one straight line, so over the direction cell they are extreme at its corners: outside of the
//! rectangle around all of them no line meets the polygon. A line passes an edge on the side that this tells, with a the edge's start and e its way,
//! w along the axis:
//!
//! ```text
//! side = (e_u - s_u e_w) (q_v - a_v + s_v a_w) - (e_v - s_v e_w) (q_u - a_u + s_u a_w)
//! ```
//!
//! with slopes s and offsets q. What has both slopes in it cancels, so side is of the first degree in each of the four, and extreme at the 16 corners of a
//! cell. If all edges are passed on the same side at all corners, every line of the cell meets the polygon.

use glam::DVec3;

use super::frame::BeamFrame;
use super::line::across;

/// What is proved of an offset cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Proved {
    /// No line of it is blocked.
    Free,
    /// Every line of it is blocked, by one polygon.
    Blocked,
    Nothing,
}

/// Rounding, as a part of the reach of offsets: proofs leave so much room.
const ROOM: f64 = 1e-9;

/// What is proved of all offset cells at the finest resolution, row by row.
pub(super) struct Proof {
    frame: BeamFrame,
    pub cells: Vec<Proved>,
}

impl Proof {
    /// All are free, as long as there are no polygons.
    pub fn of_nothing(frame: BeamFrame) -> Self {
        Self { frame, cells: vec![Proved::Free; frame.cells * frame.cells] }
    }

    /// Adds a convex polygon, with vertices from the cluster's centre.
    pub fn add(&mut self, polygon: &[DVec3]) {
        let BeamFrame { axis, slopes, width, reach, cells } = self.frame;
        let pitch = reach.map(|reach| 2.0 * reach / cells as f64);

        // The rectangle that it may cover.
        let others = across(axis);
        let range = [0, 1].map(|k| {
            let room = ROOM * reach[k];
            let at = |vertex: &DVec3| [slopes[k], slopes[k] + width].map(|slope| vertex[others[k]] - slope * vertex[axis]);
            let ends = polygon.iter().flat_map(at);
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], end| [low.min(end - room), high.max(end + room)])
        });
        let cell_at = |k: usize, offset: f64| (((offset + reach[k]) / pitch[k]).floor().max(0.0) as usize).min(cells - 1);
        let [columns, rows] = [0, 1].map(|k| cell_at(k, range[k][0])..=cell_at(k, range[k][1]));

        // Only what is larger than a cell can block all of one.
        let is_large = [0, 1].iter().all(|&k| range[k][1] - range[k][0] >= pitch[k]);
        for row in rows {
            for column in columns.clone() {
                let cell = &mut self.cells[row * cells + column];
                if *cell != Proved::Blocked {
                    let low = [column, row].map(|place| place as f64);
                    let low = [0, 1].map(|k| low[k] * pitch[k] - reach[k]);
                    let is_blocked = is_large && blocks_all(polygon, &self.frame, low, pitch);
                    *cell = if is_blocked { Proved::Blocked } else { Proved::Nothing };
                }
            }
        }
    }
}

/// Whether a polygon blocks every line of an offset cell that begins at `low`.
fn blocks_all(polygon: &[DVec3], frame: &BeamFrame, low: [f64; 2], pitch: [f64; 2]) -> bool {
    let [u, v] = across(frame.axis);
    let (mut is_left, mut is_right) = (true, true);
    let mut start = polygon[polygon.len() - 1];
    for &end in polygon {
        let edge = end - start;
        let room = ROOM * edge.length() * (frame.reach[0] + frame.reach[1]);
        for corner in 0..16 {
            let high = |bit: u32| f64::from(corner >> bit & 1);
            let slopes = [0, 1].map(|k| frame.slopes[k as usize] + frame.width * high(k));
            let offsets = [0, 1].map(|k| low[k as usize] + pitch[k as usize] * high(2 + k));
            let way = [edge[u] - slopes[0] * edge[frame.axis], edge[v] - slopes[1] * edge[frame.axis]];
            let beside = [0, 1].map(|k| offsets[k] - start[[u, v][k]] + slopes[k] * start[frame.axis]);
            let side = way[0] * beside[1] - way[1] * beside[0];
            is_left &= side > room;
            is_right &= side < -room;
        }
        if !is_left && !is_right {
            return false;
        }
        start = end;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::frame::frame_of;
    use super::super::line::offsets;
    use super::*;
    use crate::geometry::sampling::{hash, unit};

    /// Whether a line meets a convex polygon: in the projection along the line, the point is in the polygon.
    fn meets(polygon: &[DVec3], axis: usize, slopes: [f64; 2], at: [f64; 2]) -> bool {
        let corners: Vec<[f64; 2]> = polygon.iter().map(|&vertex| offsets(axis, slopes, vertex)).collect();
        let sides = (0..corners.len()).map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0])
        });
        let signs: Vec<bool> = sides.map(|side| side > 0.0).collect();
        signs.iter().all(|&sign| sign) || signs.iter().all(|&sign| !sign)
    }

    #[test]
    fn every_line_of_a_free_cell_misses_and_every_line_of_a_blocked_one_meets() {
        let mut proved = [0, 0];
        for seed in 0..300 {
            let number = |k: u64| unit(hash(seed, k));
            let point = |k: u64| DVec3::new(number(k), number(k + 1), number(k + 2)) * 2.0 - 1.0;
            let (axis, place) = (seed as usize % 3, [(8.0 * number(50)) as usize, (8.0 * number(51)) as usize]);
            let frame = frame_of(axis, place, 8, DVec3::ONE, 16);
            let size = if seed % 2 == 0 { 0.2 } else { 1.0 };
            let polygon = [0, 3, 6].map(|k| 0.3 * point(10) + size * point(k));
            let mut proof = Proof::of_nothing(frame);
            proof.add(&polygon);
            for (index, cell) in proof.cells.iter().enumerate() {
                let expected = match cell {
                    Proved::Nothing => continue,
                    Proved::Free => false,
                    Proved::Blocked => true,
                };
                proved[usize::from(expected)] += 1;
                for line in 0..8 {
                    let random = |k: u64| unit(hash(hash(seed, 1000 + index as u64), 4 * line + k));
                    let slopes = [0, 1].map(|k| frame.slopes[k] + frame.width * random(k as u64));
                    let cell = [index % 16, index / 16];
                    let at = [0, 1].map(|k| frame.reach[k] * ((cell[k] as f64 + random(2 + k as u64)) / 8.0 - 1.0));
                    assert_eq!(meets(&polygon, axis, slopes, at), expected, "seed {seed}, cell {index}");
                }
            }
        }
        assert!(proved[0] > 1000 && proved[1] > 100, "{proved:?}");
    }
}
