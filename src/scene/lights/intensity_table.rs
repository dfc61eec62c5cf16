//! Measured intensities over a sphere: a table over polar and azimuth angles, bilinear between them, 0 beyond the first and the last polar angle.
//!
//! In a cell of the table the intensity is `a + b p` in the polar angle p once it is averaged over the azimuths, so what it sends between two polar
//! angles is the integral of `(a + b p) sin p`, in closed form. By that a polar angle is drawn, then an azimuth at that angle: directions are even
//! over what is sent, exactly.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::LightError;

/// Intensities by polar angle and azimuth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Measured", into = "Measured")]
pub struct IntensityTable {
    measured: Measured,
    /// At each polar angle, the integral over the azimuths.
    rings: Vec<f64>,
    /// What is sent up to each polar angle, from 0 to all of it, in sr.
    up_to: Vec<f64>,
}

/// What a table is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Measured {
    polar: Vec<f64>,
    azimuths: Vec<f64>,
    /// All polar angles at the first azimuth, then at the next.
    values: Vec<f64>,
}

impl TryFrom<Measured> for IntensityTable {
    type Error = LightError;

    fn try_from(measured: Measured) -> Result<Self, Self::Error> {
        Self::new(measured.polar, measured.azimuths, measured.values)
    }
}

impl From<IntensityTable> for Measured {
    fn from(table: IntensityTable) -> Self {
        table.measured
    }
}

impl IntensityTable {
    /// A table over two or more rising polar angles, from 0 to pi, and two or more rising azimuths, from 0 to 2 pi; all of them in radians. `values`, 0 or
    /// more, are those of all polar angles at the first azimuth, then at the next; those at the last azimuth are those at the first.
    ///
    /// # Errors
    /// Says what of this does not hold, or that nothing is sent.
    pub fn new(polar: Vec<f64>, azimuths: Vec<f64>, values: Vec<f64>) -> Result<Self, LightError> {
        let rises = |angles: &[f64]| angles.len() >= 2 && angles.windows(2).all(|pair| pair[0] < pair[1]);
        if !rises(&polar) || !(0.0..=PI).contains(&polar[0]) || !(0.0..=PI + 1e-12).contains(&polar[polar.len() - 1]) {
            return Err(LightError("its polar angles do not rise from 0 to 180 degrees"));
        }
        if !rises(&azimuths) || azimuths[0] != 0.0 || (azimuths[azimuths.len() - 1] - TAU).abs() > 1e-12 {
            return Err(LightError("its azimuths do not rise from 0 to 360 degrees"));
        }
        if polar.len().checked_mul(azimuths.len()) != Some(values.len()) {
            return Err(LightError("it has not as many intensities as its angles ask for"));
        }
        if !values.iter().all(|value| (0.0..=1e30).contains(value)) {
            return Err(LightError("an intensity is negative or no number below 1e30"));
        }
        if values[..polar.len()] != values[values.len() - polar.len()..] {
            return Err(LightError("its intensities at 360 degrees are not those at 0"));
        }

        // Rings, and the flux of what is between them.
        let measured = Measured { polar, azimuths, values };
        let rings: Vec<f64> = (0..measured.polar.len()).map(|row| measured.ring(row)).collect();
        let mut up_to = vec![0.0];
        for row in 0..rings.len() - 1 {
            let band = Band::of(&measured.polar, &rings, row);
            up_to.push(up_to[row] + band.sent_up_to(band.end).max(0.0));
        }
        if up_to[up_to.len() - 1] <= 0.0 {
            return Err(LightError("it sends no light"));
        }
        Ok(Self { measured, rings, up_to })
    }

    /// The largest intensity.
    pub fn peak(&self) -> f64 {
        self.measured.values.iter().copied().fold(0.0, f64::max)
    }

    /// The integral over all directions: the flux, if values are intensities.
    pub fn flux(&self) -> f64 {
        self.up_to[self.up_to.len() - 1]
    }

    /// The same with all intensities multiplied.
    ///
    /// # Errors
    /// As for [`IntensityTable::new`].
    pub fn scaled(&self, factor: f64) -> Result<Self, LightError> {
        let Measured { polar, azimuths, values } = &self.measured;
        Self::new(polar.clone(), azimuths.clone(), values.iter().map(|value| factor * value).collect())
    }

    /// The intensity at a polar angle from 0 to pi and an azimuth from 0 to 2 pi.
    pub fn at(&self, polar: f64, azimuth: f64) -> f64 {
        let Measured { polar: angles, azimuths, .. } = &self.measured;
        if polar < angles[0] || polar > angles[angles.len() - 1] {
            return 0.0;
        }
        let (row, along) = interval(angles, polar);
        let (column, across) = interval(azimuths, azimuth);
        let of_column = |column: usize| self.measured.between(column, row, along);
        of_column(column) + (of_column(column + 1) - of_column(column)) * across
    }

    /// The polar angle and the azimuth of the light number `u`, `v` in the unit square, even over what is sent.
    pub(super) fn sampled(&self, u: f64, v: f64) -> [f64; 2] {
        // The band by its flux; bands without any have no part.
        let sent = u * self.flux();
        let row = (self.up_to.partition_point(|&up_to| up_to <= sent).max(1) - 1).min(self.rings.len() - 2);
        let band = Band::of(&self.measured.polar, &self.rings, row);
        let polar = band.where_sent(sent - self.up_to[row]);

        // The azimuth by the intensity at that angle.
        let along = (polar - band.start) / (band.end - band.start);
        let at = |column: usize| self.measured.between(column, row, along);
        let azimuths = &self.measured.azimuths;
        let sector = |column: usize| 0.5 * (at(column) + at(column + 1)) * (azimuths[column + 1] - azimuths[column]);
        let ring: f64 = (0..azimuths.len() - 1).map(sector).sum();
        let mut left = v * ring;
        let last = (0..azimuths.len() - 1).rev().find(|&column| sector(column) > 0.0).unwrap_or(0);
        let mut column = 0;
        while column < last && left >= sector(column) {
            left -= sector(column);
            column += 1;
        }
        let width = azimuths[column + 1] - azimuths[column];
        [polar, azimuths[column] + width * where_linear(at(column), at(column + 1), left / width)]
    }
}

impl Measured {
    /// The intensity between two polar angles at an azimuth of the table.
    fn between(&self, column: usize, row: usize, along: f64) -> f64 {
        let values = &self.values[column * self.polar.len() + row..];
        values[0] + (values[1] - values[0]) * along
    }

    /// The integral over the azimuths at a polar angle of the table.
    fn ring(&self, row: usize) -> f64 {
        let at = |column: usize| self.values[column * self.polar.len() + row];
        (1..self.azimuths.len())
            .map(|column| 0.5 * (at(column - 1) + at(column)) * (self.azimuths[column] - self.azimuths[column - 1]))
            .sum()
    }
}

/// What is between two polar angles: `(a + b (p - start)) sin p` at p.
struct Band {
    start: f64,
    end: f64,
    a: f64,
    b: f64,
}

impl Band {
    fn of(polar: &[f64], rings: &[f64], row: usize) -> Self {
        let (start, end) = (polar[row], polar[row + 1]);
        Self { start, end, a: rings[row], b: (rings[row + 1] - rings[row]) / (end - start) }
    }

    /// What is sent from the start up to a polar angle.
    fn sent_up_to(&self, polar: f64) -> f64 {
        // 2 sin sin for the difference of cosines, so that narrow bands keep their digits.
        let (middle, half) = (0.5 * (self.start + polar), 0.5 * (polar - self.start));
        let even = 2.0 * middle.sin() * half.sin();
        // Of (p - s) sin p: sin p - sin s - (p - s) cos p.
        let rising = 2.0 * middle.cos() * half.sin() - 2.0 * half * polar.cos();
        self.a * even + self.b * rising
    }

    /// The polar angle up to which so much is sent, by bisection: what is sent only rises.
    fn where_sent(&self, sent: f64) -> f64 {
        let (mut low, mut high) = (self.start, self.end);
        // Beyond that the middle is one of the ends.
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if self.sent_up_to(middle) <= sent {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The interval that a number lies in, and the part of it below the number.
fn interval(angles: &[f64], angle: f64) -> (usize, f64) {
    let number = (angles.partition_point(|&start| start <= angle).max(1) - 1).min(angles.len() - 2);
    let (start, end) = (angles[number], angles[number + 1]);
    (number, ((angle - start) / (end - start)).clamp(0.0, 1.0))
}

/// The part of an interval of length 1 over which a function from `start` to `end` along a line has the integral `area`.
fn where_linear(start: f64, end: f64, area: f64) -> f64 {
    let root = (start * start + 2.0 * (end - start) * area).max(0.0).sqrt();
    if start + root > 0.0 { (2.0 * area / (start + root)).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(polar: &[f64], values: &[f64]) -> IntensityTable {
        let radians = polar.iter().map(|angle| angle.to_radians()).collect();
        IntensityTable::new(radians, vec![0.0, TAU], [values, values].concat()).unwrap()
    }

    #[test]
    fn fluxes_are_those_of_closed_forms() {
        // Even over the sphere, over half of it, and as 1 - p / (pi / 2): the integral of that times sin p is 1 - 2 / pi.
        assert!((table(&[0.0, 180.0], &[3.0, 3.0]).flux() - 12.0 * PI).abs() < 1e-13);
        assert!((table(&[90.0, 135.0, 180.0], &[1.0; 3]).flux() - TAU).abs() < 1e-13);
        assert!((table(&[0.0, 90.0], &[1.0, 0.0]).flux() - TAU * (1.0 - 2.0 / PI)).abs() < 1e-14);
        // A finer table of the same.
        let polar: Vec<f64> = (0..=90).map(f64::from).collect();
        let values: Vec<f64> = polar.iter().map(|angle| 1.0 - angle / 90.0).collect();
        assert!((table(&polar, &values).flux() - TAU * (1.0 - 2.0 / PI)).abs() < 1e-14);
    }

    #[test]
    fn values_lie_on_lines_between_those_of_the_table() {
        let values = [4.0, 2.0, 1.0, 4.0, 6.0, 5.0, 4.0, 2.0, 1.0];
        let table = IntensityTable::new(vec![0.0, 1.0, 2.0], vec![0.0, PI, TAU], values.to_vec()).unwrap();
        for (polar, azimuth, expected) in [
            (0.0, 1.0, 4.0),
            (1.0, 0.0, 2.0),
            (1.0, PI, 6.0),
            (2.0, TAU, 1.0),
            (1.5, 0.5 * PI, 3.5),
            (0.5, 1.5 * PI, 4.0),
            (2.1, 0.0, 0.0),
        ] {
            assert!((table.at(polar, azimuth) - expected).abs() < 1e-14, "{polar} {azimuth}: {}", table.at(polar, azimuth));
        }
        assert_eq!(table.peak(), 6.0);
        assert_eq!(table.scaled(0.5).unwrap().at(1.0, PI), 3.0);
    }

    /// What is drawn below an angle is what is sent below it.
    #[test]
    fn what_is_drawn_is_what_is_sent() {
        let table = table(&[0.0, 20.0, 40.0, 60.0, 90.0], &[0.0, 0.0, 3.0, 0.0, 0.0]);
        for u in [0.0, 1e-9, 0.1, 0.5, 0.9, 1.0 - 1e-12] {
            let [polar, azimuth] = table.sampled(u, 0.25);
            assert!((azimuth - 0.25 * TAU).abs() < 1e-13 && (20.0..=60.0).contains(&polar.to_degrees()));
            let row = if polar.to_degrees() < 40.0 { 1 } else { 2 };
            let found = table.up_to[row] + Band::of(&table.measured.polar, &table.rings, row).sent_up_to(polar);
            assert!((found - u * table.flux()).abs() < 1e-13 * table.flux(), "{u}");
        }
    }

    #[test]
    fn tables_are_checked_also_where_they_are_read_back() {
        let new = |polar: &[f64], azimuths: &[f64], values: &[f64]| {
            IntensityTable::new(polar.to_vec(), azimuths.to_vec(), values.to_vec()).is_ok()
        };
        let round = [0.0, TAU];
        assert!(new(&[0.0, 1.0], &round, &[1.0; 4]));
        for (polar, azimuths, values) in [
            (&[0.0][..], &round[..], &[1.0; 2][..]),
            (&[1.0, 0.0], &round, &[1.0; 4]),
            (&[0.0, 4.0], &round, &[1.0; 4]),
            (&[0.0, f64::NAN], &round, &[1.0; 4]),
            (&[0.0, 1.0], &[0.0, 1.0], &[1.0; 4]),
            (&[0.0, 1.0], &round, &[1.0; 3]),
            (&[0.0, 1.0], &round, &[1.0, 2.0, 1.0, 3.0]),
            (&[0.0, 1.0], &round, &[-1.0, 2.0, -1.0, 2.0]),
            (&[0.0, 1.0], &round, &[0.0; 4]),
        ] {
            assert!(!new(polar, azimuths, values), "{polar:?} {azimuths:?} {values:?}");
        }
        let good = table(&[0.0, 90.0], &[1.0, 0.5]);
        let text = serde_json::to_string(&good).unwrap();
        assert_eq!(serde_json::from_str::<IntensityTable>(&text).unwrap(), good);
        assert!(serde_json::from_str::<IntensityTable>(&text.replace("0.5", "-0.5")).is_err());
    }
}
