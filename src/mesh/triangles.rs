//! The triangulation of a polygon by itself, in plain numbers: what the fuzz harness looks at.

use glam::DVec2;

use super::line::Line;
use super::triangulation::triangulate;

/// The corners of the first triangles of a convex polygon, counter-clockwise, along some lines within it; no triangle is larger than `largest` m^2.
/// A line is its two ends, and whether light may have a step there.
#[doc(hidden)]
pub fn triangulated(polygon: &[[f64; 2]], lines: &[([[f64; 2]; 2], bool)], largest: f64) -> Vec<[[f64; 2]; 3]> {
    let corners: Vec<DVec2> = polygon.iter().copied().map(DVec2::from).collect();
    let lines: Vec<Line> = lines.iter().map(|&(ends, is_step)| Line { ends: ends.map(DVec2::from), is_step }).collect();
    let triangles = triangulate(&corners, &lines, largest, 0.0);
    (0..triangles.triangles.len() as u32).map(|triangle| triangles.corners(triangle).map(|corner| corner.to_array())).collect()
}
