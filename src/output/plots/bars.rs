//! Plots of bars: how much there is of each, on a scale from 0.

use super::super::false_colours::Scale;
use super::super::legend::ticks;
use super::canvas::{At, Canvas, Colour, TEXT_HEIGHT, text_width};
use super::look::{AXIS, BAR, GRID, INK, NEGATIVE, SOFT};

/// A bar with its name, and what is written behind it.
pub(super) struct Bar {
    pub name: String,
    pub value: f64,
    pub text: String,
}

/// What bars tell.
pub(super) struct Bars<'a> {
    pub title: &'a str,
    /// What the numbers are, with their unit.
    pub axis: &'a str,
    pub bars: Vec<Bar>,
}

const WIDTH: f64 = 960.0;
const MARGIN: f64 = 24.0;
const TOP: f64 = 64.0;
const BOTTOM: f64 = 76.0;
const ROW: f64 = 40.0;
const THICK: f64 = 24.0;
const GAP: f64 = 10.0;

impl Bars<'_> {
    /// Draws them, one below the other; of a negative one its size, in another colour.
    pub fn draw(&self) -> Canvas {
        let widest = |texts: &dyn Fn(&Bar) -> f64| self.bars.iter().map(texts).fold(0.0, f64::max);
        let left = MARGIN + widest(&|bar| text_width(&bar.name)) + GAP;
        let right = WIDTH - MARGIN - widest(&|bar| text_width(&bar.text)) - GAP;
        let bottom = TOP + ROW * self.bars.len() as f64;
        let largest = widest(&|bar| bar.value.abs());
        let mut canvas = Canvas::new([WIDTH as usize, (bottom + BOTTOM) as usize]);
        canvas.text(self.title, [MARGIN, MARGIN], At::Left, INK);

        // The scale from 0, with its lines behind the bars.
        let scale = Scale::up_to(largest);
        let x_of = |value: f64| left + (right - left) * scale.position(value);
        for (value, label) in ticks(&scale) {
            let x = x_of(value).round() + 0.5;
            canvas.line([[x, TOP], [x, bottom]], 1.0, GRID);
            canvas.text(&label, [x, bottom + 12.0], At::Middle, SOFT);
        }
        canvas.text(self.axis, [(left + right) / 2.0, bottom + 16.0 + 1.5 * TEXT_HEIGHT], At::Middle, INK);

        for (number, bar) in self.bars.iter().enumerate() {
            let middle = TOP + ROW * (number as f64 + 0.5);
            let end = x_of(bar.value.abs());
            let colour: Colour = if bar.value < 0.0 { NEGATIVE } else { BAR };
            canvas.fill([[left, middle - THICK / 2.0], [end, middle + THICK / 2.0]], colour);
            canvas.text(&bar.name, [left - GAP, middle - TEXT_HEIGHT / 2.0], At::Right, INK);
            canvas.text(&bar.text, [end + GAP, middle - TEXT_HEIGHT / 2.0], At::Left, INK);
        }
        canvas.line([[left, TOP], [left, bottom]], 2.0, AXIS);
        canvas
    }
}
