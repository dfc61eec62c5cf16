//! False colours: numbers on a scale as colours that get lighter with them.
//!
//! The colours run along a helix in Oklab (Ottosson 2020, "A perceptual color space for image processing"): lightness and hue change evenly, from a dark
//! violet through blue and green to a light yellow, and the chroma stays, at a value that all these hues have within sRGB. Distances in Oklab are
//! those that eyes see, so equal differences of the number are equal differences of the colour, everywhere on the scale; and printed in grey the
//! order remains.

use std::f64::consts::TAU;
use std::str::FromStr;

use thiserror::Error;

use super::srgb::encode_srgb;

/// Lightness in Oklab at the low and the high end of the scale.
const LIGHTNESS: [f64; 2] = [0.25, 0.93];

/// Hue in Oklab at either end, in turns: violet and yellow.
const HUE: [f64; 2] = [0.83, 0.30];

/// Chroma in Oklab.
const CHROMA: f64 = 0.095;

/// The lowest and the highest value that have colours of their own; what is beyond has the colour of the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
}

/// The text names no scale.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "scale is '{0}': write the lowest and the highest value, as in 0..500; both from -1e30 to 1e30, the first below the second by 1e-30 and a \
     millionth of either or more"
)]
pub struct ScaleError(String);

impl FromStr for Scale {
    type Err = ScaleError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bad = || ScaleError(text.to_owned());
        let (low, high) = text.split_once("..").ok_or_else(bad)?;
        let [low, high] = [low, high].map(|number| number.trim().parse::<f64>());
        let scale = Self { low: low.map_err(|_| bad())?, high: high.map_err(|_| bad())? };
        // Labels of ticks have room for a million steps, and floats for these numbers.
        let (range, largest) = (scale.high - scale.low, scale.low.abs().max(scale.high.abs()));
        if largest <= 1e30 && range >= 1e-30 && range >= 1e-6 * largest { Ok(scale) } else { Err(bad()) }
    }
}

impl Scale {
    /// From 0 to the least 1, 2 or 5 times a power of ten that is not below `largest`; to 1 if that is not above 0.
    pub fn up_to(largest: f64) -> Self {
        let largest = if largest > 0.0 { largest.clamp(1e-29, 1e29) } else { 1.0 };
        let power = 10_f64.powi(largest.log10().floor() as i32);
        let high = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|&high| high >= largest);
        Self { low: 0.0, high: high.unwrap_or(largest) }
    }

    /// The lowest value.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The highest value.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Where a value lies on the scale: 0 at the low end and below, 1 at the high end and above; 0 for what is not a number.
    pub fn position(&self, value: f64) -> f64 {
        let position = (value - self.low) / (self.high - self.low);
        if position > 0.0 { position.min(1.0) } else { 0.0 }
    }

    /// The colour of a value in 8-bit sRGB.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        colour_at(self.position(value)).map(|linear| encode_srgb(linear as f32))
    }
}

/// The colour at a position from 0 to 1, in linear sRGB.
fn colour_at(position: f64) -> [f64; 3] {
    let between = |[from, to]: [f64; 2]| from + position * (to - from);
    let (sin, cos) = (TAU * between(HUE)).sin_cos();
    linear_srgb([between(LIGHTNESS), CHROMA * cos, CHROMA * sin])
}

/// From Oklab to linear sRGB: the matrices of Ottosson 2020.
fn linear_srgb([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: usize = 256;

    fn along() -> impl Iterator<Item = f64> {
        (0..=STEPS).map(|k| k as f64 / STEPS as f64)
    }

    #[test]
    fn white_is_white_and_all_colours_are_within_srgb() {
        assert!(linear_srgb([1.0, 0.0, 0.0]).iter().all(|c| (c - 1.0).abs() < 1e-6));
        for position in along() {
            assert!(colour_at(position).iter().all(|c| (0.0..=1.0).contains(c)), "{position}: {:?}", colour_at(position));
        }
    }

    #[test]
    fn colours_get_lighter_all_along() {
        // The lightness of CIE 1976 from the luminance of Rec. 709: a measure of its own.
        let lightness = |colour: [f64; 3]| {
            let luminance = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
            if luminance > 216.0 / 24389.0 { 116.0 * luminance.cbrt() - 16.0 } else { luminance * 24389.0 / 27.0 }
        };
        let all: Vec<f64> = along().map(|position| lightness(colour_at(position))).collect();
        let steps: Vec<f64> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mean = (all[STEPS] - all[0]) / STEPS as f64;
        assert!(steps.iter().all(|step| (0.9 * mean..1.1 * mean).contains(step)), "{steps:?}");
        assert!(all[0] < 15.0 && all[STEPS] > 88.0, "{} {}", all[0], all[STEPS]);
    }

    #[test]
    fn a_value_has_the_colour_of_its_place_and_ends_hold_on() {
        let scale: Scale = "-100..300".parse().unwrap();
        assert_eq!([-100.0, 0.0, 300.0, 1e30, -1e30, f64::NAN].map(|v| scale.position(v)), [0.0, 0.25, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(scale.colour(300.0), scale.colour(f64::INFINITY));
        let other: Scale = "0..4".parse().unwrap();
        assert_eq!(scale.colour(0.0), other.colour(1.0));
        let colours: std::collections::HashSet<[u8; 3]> = along().map(|position| other.colour(4.0 * position)).collect();
        assert!(colours.len() > STEPS * 9 / 10);
    }

    #[test]
    fn a_scale_ends_at_a_round_number() {
        let high = [0.3, 1.0, 180.0, 449.0, 501.0, 0.0, -3.0, f64::NAN].map(|largest| Scale::up_to(largest).high());
        assert_eq!(high, [0.5, 1.0, 200.0, 500.0, 1000.0, 1.0, 1.0, 1.0]);
        assert!(Scale::up_to(f64::INFINITY).high() >= 1e29 && Scale::up_to(1e-300).high() > 0.0);
    }

    #[test]
    fn what_is_no_scale_is_refused() {
        for text in [
            "",
            "5",
            "0..",
            "..5",
            "0..0",
            "5..1",
            "0..inf",
            "nan..1",
            "0..x",
            "0-5",
            "-1e31..1e31",
            "0..1e-31",
            "1..1.0000001",
            "0..1..2",
        ] {
            assert_eq!(text.parse::<Scale>(), Err(ScaleError(text.to_owned())));
        }
        assert_eq!("0.5 .. 1e3".parse::<Scale>().map(|scale| [scale.low(), scale.high()]), Ok([0.5, 1000.0]));
    }
}
