//! A picture to draw plots on: smooth lines, discs, boxes and texts.

use super::super::glyphs::{ADVANCE, HEIGHT, for_each_pixel};

/// Pixels of the picture for one of a letter.
const GRAIN: usize = 2;

/// How high a line of text is, and how wide a character with the gap behind it, in pixels.
pub(super) const TEXT_HEIGHT: f64 = (GRAIN * HEIGHT) as f64;
pub(super) const TEXT_ADVANCE: f64 = (GRAIN * ADVANCE) as f64;

pub(super) type Colour = [u8; 3];

/// Which point of a text is given: the left end, the middle or the right end of its upper edge.
#[derive(Clone, Copy)]
pub(super) enum At {
    Left,
    Middle,
    Right,
}

/// RGB pixels, row after row, white at first; places are in pixels from the top left.
pub(super) struct Canvas {
    pub size: [usize; 2],
    pub pixels: Vec<u8>,
}

impl Canvas {
    pub fn new(size: [usize; 2]) -> Self {
        Self { size, pixels: vec![255; 3 * size[0] * size[1]] }
    }

    /// Mixes a colour into the pixels of a box, by the part of each that `coverage` finds for its middle.
    fn paint(&mut self, [low, high]: [[f64; 2]; 2], colour: Colour, coverage: impl Fn([f64; 2]) -> f64) {
        let range = |axis: usize| {
            let last = self.size[axis] as f64;
            low[axis].floor().clamp(0.0, last) as usize..high[axis].ceil().clamp(0.0, last) as usize
        };
        for (y, x) in range(1).flat_map(|y| range(0).map(move |x| (y, x))) {
            let part = coverage([x as f64 + 0.5, y as f64 + 0.5]).clamp(0.0, 1.0);
            for (channel, value) in colour.into_iter().enumerate() {
                let pixel = &mut self.pixels[3 * (y * self.size[0] + x) + channel];
                *pixel = (f64::from(*pixel) + part * (f64::from(value) - f64::from(*pixel))).round() as u8;
            }
        }
    }

    /// A filled box.
    pub fn fill(&mut self, [low, high]: [[f64; 2]; 2], colour: Colour) {
        self.paint([low.map(f64::round), high.map(f64::round)], colour, |_| 1.0);
    }

    /// A straight line so many pixels wide.
    pub fn line(&mut self, [from, to]: [[f64; 2]; 2], width: f64, colour: Colour) {
        let [along_x, along_y] = [to[0] - from[0], to[1] - from[1]];
        let length_sq = along_x * along_x + along_y * along_y;
        let distance = |[x, y]: [f64; 2]| {
            let part = if length_sq > 0.0 { ((x - from[0]) * along_x + (y - from[1]) * along_y) / length_sq } else { 0.0 };
            let part = part.clamp(0.0, 1.0);
            (x - from[0] - part * along_x).hypot(y - from[1] - part * along_y)
        };
        let reach = width / 2.0 + 1.0;
        let low = [0, 1].map(|axis| from[axis].min(to[axis]) - reach);
        let high = [0, 1].map(|axis| from[axis].max(to[axis]) + reach);
        self.paint([low, high], colour, |pixel| width / 2.0 + 0.5 - distance(pixel));
    }

    /// A line of dashes.
    pub fn dashes(&mut self, [from, to]: [[f64; 2]; 2], width: f64, colour: Colour) {
        const DASH: f64 = 8.0;
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let at = |along: f64| {
            let part = (along / length).min(1.0);
            [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]))
        };
        (0..(length / (2.0 * DASH)).ceil() as usize).map(|k| 2.0 * DASH * k as f64).for_each(|along| {
            self.line([at(along), at(along + DASH)], width, colour);
        });
    }

    /// A filled disc.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, colour: Colour) {
        let reach = radius + 1.0;
        self.paint([[x - reach, y - reach], [x + reach, y + reach]], colour, |pixel| {
            radius + 0.5 - (pixel[0] - x).hypot(pixel[1] - y)
        });
    }

    /// A text on one line, at this point of its upper edge.
    pub fn text(&mut self, text: &str, [x, y]: [f64; 2], at: At, colour: Colour) {
        let width = text_width(text);
        let left = match at {
            At::Left => x,
            At::Middle => x - width / 2.0,
            At::Right => x - width,
        };
        let (left, top) = (left.round().max(0.0) as usize, y.round().max(0.0) as usize);
        for_each_pixel(text, |column, row| {
            let low = [left + GRAIN * column, top + GRAIN * row].map(|x| x as f64);
            self.fill([low, low.map(|x| x + GRAIN as f64)], colour);
        });
    }
}

/// How wide a text is.
pub(super) fn text_width(text: &str) -> f64 {
    TEXT_ADVANCE * text.chars().count() as f64 - GRAIN as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_beyond_the_picture_is_left_out() {
        let mut canvas = Canvas::new([20, 10]);
        canvas.line([[-50.0, 5.0], [50.0, 5.0]], 2.0, [0; 3]);
        canvas.disc([20.0, 10.0], 4.0, [9, 0, 0]);
        canvas.text("E", [18.0, 4.0], At::Left, [0, 0, 9]);
        let at = |x: usize, y: usize| &canvas.pixels[3 * (20 * y + x)..][..3];
        assert!((0..16).all(|x| at(x, 4) == [0; 3] && at(x, 5) == [0; 3] && at(x, 2) == [255; 3]));
        assert_eq!((at(18, 9), at(19, 5)), (&[0, 0, 9][..], &[0, 0, 9][..]));
    }
}
