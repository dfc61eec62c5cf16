//! Lines on surfaces, drawn over a picture where nothing hides them.

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{NO_PLANE, Segment};

/// Lines drawn over a picture: pixels with a colour of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// Row after row from the top left, and 8-bit sRGB.
    pixels: Vec<(usize, [u8; 3])>,
}

/// A line on a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub ends: [DVec3; 2],
    pub surface: SurfaceId,
    /// In 8-bit sRGB.
    pub colour: [u8; 3],
}

/// A point that a pixel shows if nothing hides it.
struct Dot {
    pixel: usize,
    point: DVec3,
}

impl Marks {
    /// Of pixels, row after row from the top left, with their colours.
    pub(super) fn of(pixels: Vec<(usize, [u8; 3])>) -> Self {
        Self { pixels }
    }

    /// The number of each pixel, row after row from the top left, and its colour; of a pixel that comes again the last counts.
    pub fn pixels(&self) -> impl Iterator<Item = (usize, [u8; 3])> {
        self.pixels.iter().copied()
    }
}

/// Draws lines in their order, one pixel wide, where the fronts of their surfaces are seen. `None` if stopped.
pub(crate) fn draw_lines(
    scene: &Scene,
    lines: &[Line],
    visibility: &Rays<'_>,
    (camera, size): (&CameraRays, [u32; 2]),
    stop: Stop<'_>,
) -> Option<Marks> {
    let of_line = |line: &Line| {
        let plane = scene.surface(line.surface).plane();
        let facet = scene.surface(line.surface).polygon.facet();
        if stop() || facet.height(camera.eye()) <= 0.0 {
            return Vec::new();
        }
        let dots = dots(camera, size, line.ends);
        let to =
            |dot: &Dot| Segment { from: camera.eye().to_array(), to: dot.point.to_array(), from_plane: NO_PLANE, to_plane: plane };
        let (segments, mut occluded) = (dots.iter().map(to).collect::<Vec<Segment>>(), Vec::new());
        visibility.occluded(&segments, &mut occluded);
        let seen = dots.iter().zip(occluded).filter(|(_, is_hidden)| !is_hidden);
        seen.map(|(dot, _)| (dot.pixel, line.colour)).collect()
    };
    let pixels: Vec<_> = lines.par_iter().flat_map_iter(of_line).collect();
    (!stop()).then_some(Marks { pixels })
}

/// The points of a segment that are seen through pixels, one for each row or column that it crosses.
fn dots(camera: &CameraRays, [width, height]: [u32; 2], [a, b]: [DVec3; 2]) -> Vec<Dot> {
    /// What is nearer than this part of the segment's length to the plane of the eye is left out.
    const NEAREST: f64 = 1e-3;
    let nearest = NEAREST * a.distance(b);
    let depths = [a, b].map(|end| camera.depth(end) - nearest);
    let crossing = a.lerp(b, depths[0] / (depths[0] - depths[1]));
    let [a, b] = match depths.map(|depth| depth > 0.0) {
        [true, true] => [a, b],
        [true, false] => [a, crossing],
        [false, true] => [crossing, b],
        [false, false] => return Vec::new(),
    };

    // The part from `low` to `high` of the way in the picture lies within it.
    let [p, q] = [a, b].map(|end| camera.position(end));
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for (from, to, size) in [(p.0, q.0, f64::from(width)), (p.1, q.1, f64::from(height))] {
        for (at_start, at_end) in [(from, to), (size - from, size - to)] {
            let part = at_start / (at_start - at_end);
            match (at_start >= 0.0, at_end >= 0.0) {
                (true, true) => {}
                (true, false) => high = high.min(part),
                (false, true) => low = low.max(part),
                (false, false) => return Vec::new(),
            }
        }
    }
    if low >= high {
        return Vec::new();
    }

    // Equal steps in the picture are steps in space by the depths of both ends.
    let [near, far] = [a, b].map(|end| camera.depth(end));
    let steps = ((q.0 - p.0).abs().max((q.1 - p.1).abs()) * (high - low)).ceil().max(1.0);
    let dot = |step: f64| {
        let s = low + (high - low) * (step + 0.5) / steps;
        let (column, row) = (p.0 + s * (q.0 - p.0), p.1 + s * (q.1 - p.1));
        let pixel = (row as usize).min(height as usize - 1) * width as usize + (column as usize).min(width as usize - 1);
        Dot { pixel, point: a.lerp(b, s * near / (s * near + (1.0 - s) * far)) }
    };
    (0..steps as u32).map(|step| dot(f64::from(step))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Camera;
    use super::*;

    #[test]
    fn dots_lie_on_the_segment_and_in_the_pixels_that_show_it() {
        let camera = Camera {
            eye: [0.2, 0.1, 5.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            field_of_view_degrees: 50.0,
            width: 90,
            height: 60,
        };
        let (rays, size) = (camera.rays().unwrap(), [camera.width, camera.height]);
        let point = |k: u64| {
            let unit = |k: u64| crate::geometry::sampling::unit(crate::geometry::sampling::hash(k, 5));
            DVec3::new(12.0 * unit(3 * k) - 6.0, 12.0 * unit(3 * k + 1) - 6.0, 12.0 * unit(3 * k + 2) - 6.0)
        };
        let (mut drawn, mut count) = (0, 0);
        for k in 0..300 {
            let ends = [point(2 * k), point(2 * k + 1)];
            let dots = dots(&rays, size, ends);
            drawn += usize::from(!dots.is_empty());
            count += dots.len();
            for dot in &dots {
                let along = ends[1] - ends[0];
                assert!((dot.point - ends[0]).cross(along).length() < 1e-9 * along.length());
                let (column, row) = (dot.pixel % 90, dot.pixel / 90);
                let (x, y) = rays.position(dot.point);
                assert!(
                    (x - column as f64 - 0.5).abs() < 0.5 + 1e-6 && (y - row as f64 - 0.5).abs() < 0.5 + 1e-6,
                    "{x} {y} {column} {row}"
                );
                let through = DVec3::from(rays.through(x, y).direction);
                assert!(through.cross(dot.point - rays.eye()).length() < 1e-9 * dot.point.distance(rays.eye()));
            }
            // Neighbours touch.
            for pair in dots.windows(2) {
                let apart = |n: usize, m: usize| n.abs_diff(m) <= 1;
                assert!(apart(pair[0].pixel % 90, pair[1].pixel % 90) && apart(pair[0].pixel / 90, pair[1].pixel / 90));
            }
        }
        assert!(drawn > 100 && count > 2000, "{drawn} {count}");
    }
}
