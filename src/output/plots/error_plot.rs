//! The error against time: what was claimed and measured each time that it was estimated, on axes of powers of ten.

use super::canvas::{At, Canvas, Colour, TEXT_HEIGHT, text_width};
use super::look::{AXIS, BAR, GRID, INK, NEGATIVE, SOFT, short};
use crate::output::RunReport;
use crate::solve::{JudgedPart, Judgement};

const SIZE: [f64; 2] = [960.0, 640.0];
/// The frame of the plot: left, top, right and bottom.
const FRAME: [f64; 4] = [100.0, 110.0, 930.0, 560.0];
const MEASURED: Colour = [122, 128, 136];

/// An axis is from one number to so many times that at least.
const LEAST_RANGE: f64 = 6.5;

/// An axis from one number to another by their logarithms, along pixels.
struct Axis {
    range: [f64; 2],
    pixels: [f64; 2],
}

impl Axis {
    /// Around these numbers, all above 0: so wide that it has two ticks or more, which are a factor of 2.5 apart at most.
    fn around(numbers: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let (low, high) = numbers.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        let wider = (LEAST_RANGE / (high / low)).max(1.0).sqrt().max(1.3);
        Self { range: [low / wider, high * wider], pixels }
    }

    fn at(&self, number: f64) -> f64 {
        let part = (number / self.range[0]).ln() / (self.range[1] / self.range[0]).ln();
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }

    /// Powers of ten on it; where these are few, twice and five times them as well.
    fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        let is_long = high / low > 1e3;
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let digits: &[f64] = if is_long { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10_f64.powi(power)));
        all.filter(|x| (low..=high).contains(x)).collect()
    }
}

/// Draws the plot of a run.
pub(super) fn draw(report: &RunReport) -> Canvas {
    let mut canvas = Canvas::new(SIZE.map(|side| side as usize));
    let title = format!("Error against time, in the {} norm", report.options.norm);
    canvas.text(&title, [FRAME[0], 24.0], At::Left, INK);
    // What takes no time by the clock is drawn at its finest step that plots tell.
    let seconds = |judgement: &Judgement| judgement.time_s.max(1e-3);
    let known: Vec<&Judgement> = report.history.iter().filter(|at| is_known(at.claimed)).collect();
    if known.is_empty() {
        canvas.text("nothing can be said about the error of this run", [SIZE[0] / 2.0, SIZE[1] / 2.0], At::Middle, SOFT);
        return canvas;
    }
    let asked = report.options.error;
    let errors = known.iter().flat_map(|at| [at.claimed, at.measured]).filter(|&error| is_known(error)).chain([asked]);
    let x = Axis::around(known.iter().map(|at| seconds(at)), [FRAME[0], FRAME[2]]);
    let y = Axis::around(errors, [FRAME[3], FRAME[1]]);
    draw_axes(&mut canvas, &x, &y);

    // What was asked for, then what was found, point by point.
    canvas.dashes([[FRAME[0], y.at(asked)], [FRAME[2], y.at(asked)]], 2.0, NEGATIVE);
    type ErrorOf = fn(&Judgement) -> f64;
    let series: [(Colour, ErrorOf); 2] = [(MEASURED, |at| at.measured), (BAR, |at| at.claimed)];
    for (colour, error) in series {
        let place = |at: &&&Judgement| Some([x.at(seconds(at)), y.at(Some(error(at)).filter(|&error| is_known(error))?)]);
        let (of_mesh, of_values): (Vec<&&Judgement>, Vec<_>) = known.iter().partition(|at| at.of == JudgedPart::LitMesh);
        let points: Vec<[f64; 2]> = of_values.iter().filter_map(place).collect();
        points.windows(2).for_each(|pair| canvas.line([pair[0], pair[1]], 2.0, colour));
        points.iter().for_each(|&point| canvas.disc(point, 5.0, colour));
        of_mesh.iter().filter_map(place).for_each(|point| draw_ring(&mut canvas, point, colour));
    }
    draw_key(&mut canvas, known.iter().any(|at| at.of == JudgedPart::LitMesh));
    canvas
}

fn is_known(error: f64) -> bool {
    error.is_finite() && error > 0.0
}

/// The mark of the lit mesh.
fn draw_ring(canvas: &mut Canvas, place: [f64; 2], colour: Colour) {
    canvas.disc(place, 8.0, colour);
    canvas.disc(place, 5.0, [255; 3]);
}

fn draw_axes(canvas: &mut Canvas, x: &Axis, y: &Axis) {
    let [left, top, right, bottom] = FRAME;
    for value in x.ticks() {
        let at = x.at(value).round() + 0.5;
        canvas.line([[at, top], [at, bottom]], 1.0, GRID);
        canvas.text(&short(value), [at, bottom + 12.0], At::Middle, SOFT);
    }
    for value in y.ticks() {
        let at = y.at(value).round() + 0.5;
        canvas.line([[left, at], [right, at]], 1.0, GRID);
        canvas.text(&format!("{}%", short(100.0 * value)), [left - 10.0, at - TEXT_HEIGHT / 2.0], At::Right, SOFT);
    }
    canvas.line([[left, bottom], [right, bottom]], 2.0, AXIS);
    canvas.line([[left, top], [left, bottom]], 2.0, AXIS);
    canvas.text("error", [left - 10.0, top - 20.0], At::Right, INK);
    canvas.text("wall-clock time since the solve began (s)", [(left + right) / 2.0, bottom + 44.0], At::Middle, INK);
}

/// What the lines are, in a row above the frame.
fn draw_key(canvas: &mut Canvas, has_mesh: bool) {
    let y = FRAME[1] - 44.0;
    let middle = y + TEXT_HEIGHT / 2.0;
    let mut x = FRAME[0];
    for (name, colour) in [("claimed", BAR), ("measured", MEASURED), ("asked for", NEGATIVE), ("with the lit mesh", BAR)] {
        match name {
            "asked for" => canvas.dashes([[x, middle], [x + 24.0, middle]], 2.0, colour),
            "with the lit mesh" if !has_mesh => return,
            "with the lit mesh" => draw_ring(canvas, [x + 12.0, middle], colour),
            _ => {
                canvas.line([[x, middle], [x + 24.0, middle]], 2.0, colour);
                canvas.disc([x + 12.0, middle], 5.0, colour);
            }
        }
        canvas.text(name, [x + 34.0, y], At::Left, INK);
        x += 34.0 + text_width(name) + 30.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_ticks_inside_whatever_they_hold() {
        let alone = (1..100).map(|k| vec![0.013 * f64::from(k)]);
        let several = [vec![0.03, 0.2], vec![3e-4, 900.0], vec![7.0, 7.1, 9.9], vec![1e-12, 1e12]];
        for numbers in alone.chain(several) {
            let axis = Axis::around(numbers.iter().copied(), [0.0, 100.0]);
            let ticks = axis.ticks();
            assert!(ticks.len() >= 2 && ticks.len() < 30, "{numbers:?}: {ticks:?}");
            assert!(numbers.iter().chain(&ticks).all(|&x| (0.0..=100.0).contains(&axis.at(x))), "{numbers:?}: {ticks:?}");
        }
    }
}
