//! The legend of a picture in false colours: a bar with its colours, ticks with their numbers, and the unit.

use super::false_colours::Scale;
use super::glyphs::{ADVANCE, HEIGHT, for_each_pixel};

/// Pictures with a legend are at least so wide and high, in pixels: the widest legend leaves a third of that width.
pub const LEAST_SIZE_WITH_LEGEND: [u32; 2] = [176, 120];

/// Letters grow with the picture: a pixel of theirs is one pixel in pictures up to twice this high.
const HEIGHT_OF_UNIT: usize = 360;

/// At most so many steps from tick to tick.
const MOST_STEPS: f64 = 8.0;

/// All in pixels of letters.
const MARGIN: usize = 4;
const BAR: usize = 12;
const TICK: usize = 3;

const DARK: [u8; 3] = [24, 24, 24];
const LIGHT: [u8; 3] = [236, 236, 236];

/// The ticks of a scale, ascending, and their labels: all multiples of 1, 2 or 5 times a power of ten that lie on it.
pub(super) fn ticks(scale: &Scale) -> Vec<(f64, String)> {
    let least = (scale.high() - scale.low()) / MOST_STEPS;
    let power = least.log10().floor() as i32;
    let (digit, power) = [(1, power), (2, power), (5, power), (1, power + 1)]
        .into_iter()
        .find(|&(digit, power)| f64::from(digit) * 10_f64.powi(power) >= least * (1.0 - 1e-9))
        .unwrap_or((1, power + 1));
    let step = f64::from(digit) * 10_f64.powi(power);
    // A tick at an end counts, whatever rounding says.
    let first = (scale.low() / step - 1e-9).ceil() as i64;
    let last = (scale.high() / step + 1e-9).floor() as i64;
    let largest = scale.low().abs().max(scale.high().abs());
    (first..=last).map(|k| (k as f64 * step, label(k * i64::from(digit), power, largest))).collect()
}

/// The number `digits * 10^power`, with an exponent where numbers up to `largest` would be long.
fn label(digits: i64, power: i32, largest: f64) -> String {
    let value = digits as f64 * 10_f64.powi(power);
    if digits == 0 {
        "0".to_owned()
    } else if largest < 1e6 && power >= -5 {
        format!("{value:.*}", usize::try_from(-power).unwrap_or(0))
    } else {
        // As many places as tell this tick from the next.
        let places = digits.unsigned_abs().ilog10() as usize;
        format!("{value:.places$e}")
    }
}

/// Draws the legend over the right of a picture of `size`, RGB, row after row.
pub(super) fn draw(pixels: &mut [u8], [width, height]: [usize; 2], scale: &Scale, unit: &str) {
    let grain = (height / HEIGHT_OF_UNIT).max(1);
    let ticks = ticks(scale);
    let unit = unit.replace("^2", "²");
    let longest = ticks.iter().map(|(_, label)| label.chars().count()).chain([unit.chars().count()]).max().unwrap_or(0);
    let panel = grain * (MARGIN + BAR + TICK + 2 + longest * ADVANCE + MARGIN);
    let left = width.saturating_sub(panel);
    let mut paint = |[x, y]: [usize; 2], [dx, dy]: [usize; 2], colour: [u8; 3]| {
        for row in y.min(height)..(y + dy).min(height) {
            for column in x.min(width)..(x + dx).min(width) {
                pixels[3 * (row * width + column)..][..3].copy_from_slice(&colour);
            }
        }
    };

    // The panel, the unit, and the bar with the high end above.
    paint([left, 0], [panel, height], DARK);
    let write = |text: &str, [x, y]: [usize; 2], paint: &mut dyn FnMut([usize; 2], [usize; 2], [u8; 3])| {
        for_each_pixel(text, |column, row| paint([x + grain * column, y + grain * row], [grain; 2], LIGHT));
    };
    write(&unit, [left + grain * MARGIN, grain * MARGIN], &mut paint);
    let bar = left + grain * MARGIN;
    let top = grain * (2 * MARGIN + HEIGHT + HEIGHT / 2);
    let length = height.saturating_sub(top + grain * (MARGIN + HEIGHT / 2)).max(1);
    for row in 0..length {
        let position = 1.0 - (row as f64 + 0.5) / length as f64;
        paint([bar, top + row], [grain * BAR, 1], scale.colour(scale.low() + position * (scale.high() - scale.low())));
    }
    for (value, label) in &ticks {
        let row = top + ((1.0 - scale.position(*value)) * length as f64).round() as usize;
        paint([bar + grain * BAR, row], [grain * TICK, grain], LIGHT);
        let x = bar + grain * (BAR + TICK + 2);
        write(label, [x, row.saturating_sub(grain * (HEIGHT / 2))], &mut paint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_that_cover_the_scale() {
        for text in [
            "0..500",
            "0..1",
            "0..7",
            "-3..11",
            "0.001..0.0013",
            "99..101",
            "0..1e-7",
            "1e7..3e8",
            "2..2.00001",
            "0.001..0.0135",
            "-1e-29..1e-29",
        ] {
            let scale: Scale = text.parse().unwrap();
            let ticks = ticks(&scale);
            assert!((3..=9).contains(&ticks.len()), "{text}: {ticks:?}");
            let (range, step) = (scale.high() - scale.low(), ticks[1].0 - ticks[0].0);
            // Within the scale, less than a step from both ends, evenly spaced.
            let room = 1e-6 * range;
            assert!(ticks.iter().all(|(v, _)| (scale.low() - room..=scale.high() + room).contains(v)), "{text}: {ticks:?}");
            assert!(
                ticks[0].0 - scale.low() < step + room && scale.high() - ticks[ticks.len() - 1].0 < step + room,
                "{text}: {ticks:?}"
            );
            assert!(ticks.windows(2).all(|pair| (pair[1].0 - pair[0].0 - step).abs() < room), "{text}: {ticks:?}");
            // The step is 1, 2 or 5 times a power of ten.
            let first = format!("{step:.3e}");
            assert!(["1.000e", "2.000e", "5.000e"].iter().any(|round| first.starts_with(round)), "{text}: {first}");
            // Labels tell the value to a thousandth of a step, and are short.
            for (value, label) in &ticks {
                assert!(
                    (label.parse::<f64>().unwrap() - value).abs() < 1e-3 * step && label.len() <= 13,
                    "{text}: {label} {value}"
                );
            }
        }
    }

    #[test]
    fn labels_are_plain_where_they_are_short() {
        let labels = |text: &str| ticks(&text.parse().unwrap()).into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" ");
        assert_eq!(labels("0..500"), "0 100 200 300 400 500");
        assert_eq!(labels("0..1"), "0 0.2 0.4 0.6 0.8 1.0");
        assert_eq!(labels("-3..11"), "-2 0 2 4 6 8 10");
        assert_eq!(labels("0..3e-7"), "0 5e-8 1.0e-7 1.5e-7 2.0e-7 2.5e-7 3.0e-7");
    }

    #[test]
    fn the_bar_has_the_colour_of_each_value_beside_its_tick() {
        let scale: Scale = "0..500".parse().unwrap();
        let size = [300, 240];
        let mut pixels = vec![7; 3 * size[0] * size[1]];
        draw(&mut pixels, size, &scale, "lx");
        let at = |x: usize, y: usize| <[u8; 3]>::try_from(&pixels[3 * (y * size[0] + x)..][..3]).unwrap();
        // The picture begins to be covered at a straight border.
        let left = (0..size[0]).find(|&x| at(x, 120) != [7; 3]).unwrap();
        assert!(left > size[0] / 2 && (0..size[1]).all(|y| at(left, y) == DARK && at(left - 1, y) == [7; 3]));
        // Along the column of ticks, from below: each is beside its colour, to the step of one row.
        let (bar, tick) = (left + MARGIN, left + MARGIN + BAR);
        let rows: Vec<usize> = (0..size[1]).rev().filter(|&y| at(tick, y) == LIGHT).collect();
        assert_eq!(rows.len(), 6);
        for (row, value) in rows.into_iter().zip([0.0, 100.0, 200.0, 300.0, 400.0, 500.0]) {
            let near = [row - 1, row].map(|y| at(bar, y));
            let off = |colour: [u8; 3]| (0..3).map(|k| scale.colour(value)[k].abs_diff(colour[k])).max().unwrap();
            assert!(near.into_iter().any(|colour| off(colour) <= 3), "{value}: {near:?} {:?}", scale.colour(value));
        }
    }
}
