//! Colours and numbers of plots.

use super::canvas::Colour;

pub(super) const INK: Colour = [29, 31, 34];
pub(super) const SOFT: Colour = [90, 94, 100];
pub(super) const AXIS: Colour = [60, 64, 70];
pub(super) const GRID: Colour = [222, 224, 227];
pub(super) const BAR: Colour = [11, 109, 134];
pub(super) const NEGATIVE: Colour = [196, 92, 0];

/// A number by four digits at most, and an exponent where that would be long.
pub(super) fn short(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let power = number.abs().log10().floor() as i32;
    if !(-4..6).contains(&power) {
        return format!("{number:.2e}");
    }
    let text = format!("{number:.*}", usize::try_from(3 - power).unwrap_or(0));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let found = [0.0, 1.0, 0.05, 20.0, 1234.5, 99.999, -0.012_34, 1e-7, 3.2e9].map(short);
        assert_eq!(found, ["0", "1", "0.05", "20", "1234", "100", "-0.01234", "1.00e-7", "3.20e9"]);
    }
}
