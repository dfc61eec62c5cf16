//! A measuring plane as a picture: a square of pixels for each sensor, seen from the side that the sensors look to.

use super::{Image, Marks, MeasuringPlane};

/// Pictures are about so many pixels high.
const HEIGHT: u32 = 720;

/// Room for a legend, as wide as the widest, in pixels of letters, of which one is a pixel for each so many rows; see `output/legend`.
const LEGEND: u32 = 118;
const ROWS_OF_LETTERS: u32 = 360;

/// Where nothing is measured, and behind the legend.
const NOTHING: [u8; 3] = [24, 24, 24];

impl MeasuringPlane {
    /// A picture of what the sensors measured, a number for each, that is `per_radiance` times as large as the numbers of the picture; and of the places
    /// where there is none: where they are not a number, and at the right, where a legend has room.
    pub fn picture(&self, measured: &[f32], per_radiance: f32) -> (Image, Marks) {
        let [columns, rows] = self.counts;
        let side = (HEIGHT / rows).max(1);
        let (height, plane_width) = (side * rows, side * columns);
        let width = plane_width + LEGEND * (height / ROWS_OF_LETTERS).max(1);
        // The first row is the lowest.
        let value = |x: u32, y: u32| measured[((rows - 1 - y / side) * columns + x / side) as usize];

        let mut image = Image::black(width, height, 1);
        let mut marks = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let pixel = (y * width + x) as usize;
            match Some(()).filter(|()| x < plane_width).map(|()| value(x, y)) {
                Some(value) if !value.is_nan() => image.radiance[pixel] = value / per_radiance,
                _ => marks.push((pixel, NOTHING)),
            }
        }
        (image, Marks::of(marks))
    }
}
