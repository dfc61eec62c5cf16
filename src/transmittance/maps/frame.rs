//! Direction cells of a cluster, and how offsets are divided in each.

use glam::DVec3;

use super::line::across;

/// Which direction cell, and how the offsets are divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct BeamFrame {
    pub axis: usize,
    /// The least slopes; the largest are `width` more.
    pub slopes: [f64; 2],
    pub width: f64,
    /// Offsets are from minus to plus so many metres.
    pub reach: [f64; 2],
    /// Offset cells along either side at the finest resolution, a power of two.
    pub cells: usize,
}

/// The frame of a direction cell of a cluster with these half sides: slopes are divided into `turns`, counted by `place`.
pub(super) fn frame_of(axis: usize, place: [usize; 2], turns: usize, half_sides: DVec3, cells: usize) -> BeamFrame {
    let width = 2.0 / turns as f64;
    let slopes = place.map(|place| -1.0 + width * place as f64);
    let others = across(axis);
    let reach = [0, 1].map(|k| {
        let steepest = slopes[k].abs().max((slopes[k] + width).abs());
        half_sides[others[k]] + steepest * half_sides[axis]
    });
    BeamFrame { axis, slopes, width, reach, cells }
}
