//! Values at points, as CSV.
//!
//! The columns of the points, `x,y,z,nx,ny,nz`, then the radiosity per channel in W/m^2, `B_r,B_g,B_b` for three channels, else
//! `B_0,B_1,...`, their standard errors with `se` for `B`, empty where they are not known, and where bounds are known the same with `lower`
//! and `upper`, and `face`, the number of the face in the input, from 1; all empty for points that lie on no surface. Behind them follow the other
//! columns that the points came with, as they were, but for those of these names. Numbers are the shortest that read back to the same value.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};

use super::points::{COLUMNS, Points};
use crate::bounds::PointBounds;
use crate::values::Values;

/// What columns of values are called.
const VALUE_COLUMNS: [&str; 5] = ["B", "H", "se", "lower", "upper"];

/// What the column of faces is called.
const FACE: &str = "face";

/// Writes points with their values, in the order of the points.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] if there are not `channels` values per point.
pub fn write_values(writer: &mut impl Write, points: &Points, values: &Values) -> io::Result<()> {
    write_groups(writer, points, values, &[("B", &values.radiosity), ("se", &values.standard_error)])
}

/// Writes points with their values, and the bounds of these: `lower_r`, ... and `upper_r`, ... after the values.
///
/// # Errors
/// As [`write_values`].
pub fn write_bounded_values(writer: &mut impl Write, points: &Points, values: &Values, bounds: &PointBounds) -> io::Result<()> {
    let columns: [(&str, &[f32]); 4] =
        [("B", &values.radiosity), ("se", &values.standard_error), ("lower", &bounds.lower), ("upper", &bounds.upper)];
    write_groups(writer, points, values, &columns)
}

/// Writes points, and after them groups of columns, each with a number per point and channel, and the faces of the values.
fn write_groups(writer: &mut impl Write, points: &Points, values: &Values, groups: &[(&str, &[f32])]) -> io::Result<()> {
    let columns = |&(name, numbers)| Columns { names: channel_columns(name, values.channels), numbers };
    write_columns(writer, points, &groups.iter().map(columns).collect::<Vec<Columns<'_>>>(), Some(&values.faces))
}

/// Columns that belong together.
pub(super) struct Columns<'a> {
    pub names: Vec<String>,
    /// By point and column; NaN where it is not known.
    pub numbers: &'a [f32],
}

/// Writes points, and after them columns, empty where a number is not known, and `face`, from 1, where points have faces.
pub(super) fn write_columns(
    writer: &mut impl Write,
    points: &Points,
    columns: &[Columns<'_>],
    faces: Option<&[Option<u32>]>,
) -> io::Result<()> {
    let is_whole = |of: &Columns<'_>| !of.names.is_empty() && of.numbers.len() == of.names.len() * points.len();
    if !columns.iter().all(is_whole) || faces.is_some_and(|faces| faces.len() != points.len()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "there are more or fewer values than points and channels"));
    }
    let names: Vec<&str> = columns.iter().flat_map(|of| &of.names).map(String::as_str).collect();
    let is_kept = |other: &String| !(is_value(other) || faces.is_some() && other.trim_matches('"') == FACE);
    let is_kept: Vec<bool> = points.others.names.iter().map(is_kept).collect();
    let others = || points.others.names.iter().zip(&is_kept).filter(|(_, is_kept)| **is_kept);
    write!(writer, "{},{}", COLUMNS.join(","), names.join(","))?;
    faces.map_or(Ok(()), |_| write!(writer, ",{FACE}"))?;
    others().try_for_each(|(name, _)| write!(writer, ",{name}"))?;
    writeln!(writer)?;
    for (index, row) in points.rows.iter().enumerate() {
        let mut separator = "";
        for number in row {
            write!(writer, "{separator}")?;
            write_number(writer, *number, number.abs())?;
            separator = ",";
        }
        for number in columns.iter().flat_map(|of| &of.numbers[index * of.names.len()..][..of.names.len()]) {
            write!(writer, ",")?;
            if !number.is_nan() {
                write_number(writer, *number, f64::from(number.abs()))?;
            }
        }
        if let Some(faces) = faces {
            write!(writer, ",")?;
            faces[index].map_or(Ok(()), |face| write!(writer, "{}", u64::from(face) + 1))?;
        }
        if let Some(others) = points.others.rows.get(index) {
            let mut kept = others.split(',').zip(&is_kept).filter(|(_, is_kept)| **is_kept);
            kept.try_for_each(|(field, _)| write!(writer, ",{field}"))?;
        }
        writeln!(writer)?;
    }
    Ok(())
}

/// Whether a column bears the name of values, whatever the channel.
fn is_value(name: &str) -> bool {
    let name = name.trim_matches('"');
    let channel = VALUE_COLUMNS.iter().find_map(|value| name.strip_prefix(value)?.strip_prefix('_'));
    name == "lux" || channel.is_some_and(|channel| matches!(channel, "r" | "g" | "b" | "lux") || channel.parse::<u32>().is_ok())
}

/// The shortest decimal number that reads back to the same value, with an exponent where there would be many zeros.
fn write_number(writer: &mut impl Write, number: impl Display + LowerExp, magnitude: f64) -> io::Result<()> {
    if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) { write!(writer, "{number:e}") } else { write!(writer, "{number}") }
}

/// The names of the channels of a radiosity.
pub(super) fn radiosity_columns(channels: usize) -> Vec<String> {
    channel_columns("B", channels)
}

pub(super) fn channel_columns(name: &str, channels: usize) -> Vec<String> {
    if channels == 3 {
        ["r", "g", "b"].map(|channel| format!("{name}_{channel}")).to_vec()
    } else {
        (0..channels).map(|channel| format!("{name}_{channel}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::points::{PointsError, read_points};
    use crate::scene::SurfacePoint;

    fn read(text: &str) -> Result<Points, PointsError> {
        read_points(text.as_bytes(), "P.csv")
    }

    #[test]
    fn points_are_read_and_values_written_beside_them() {
        let points = read("x,y,z,nx,ny,nz\n0.1,-2,3e5,0,0,1\n 1 , 2 , 3 , 0.6 , 0.8 , 0 \r\n").unwrap();
        assert_eq!(points.len(), 2);
        assert_eq!(points.surface_points()[1], SurfacePoint { position: [1.0, 2.0, 3.0], normal: [0.6, 0.8, 0.0] });
        let nan = f32::NAN;
        let standard_error = vec![0.01, 0.0, 0.5, nan, nan, nan];
        let values = Values {
            channels: 3,
            radiosity: vec![0.1, 1e-9, 2.5, nan, nan, nan],
            standard_error,
            faces: vec![Some(6), None],
            missed: 1,
            error: None,
        };
        let mut text = Vec::new();
        write_values(&mut text, &points, &values).unwrap();
        let expected = "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,face\n\
            0.1,-2,300000,0,0,1,0.1,1e-9,2.5,0.01,0,0.5,7\n1,2,3,0.6,0.8,0,,,,,,,\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn other_columns_are_repeated_and_earlier_values_are_not() {
        let points = read("id,x,y,z,\"B_0\",nx,ny,nz, room \n7,0,0,0,99,0,0,1,hall\n8,1,0,0,98,0,0,1, \"the, hall\n").unwrap_err();
        assert!(matches!(points, PointsError::ColumnCount { line: 3, .. }));
        let points = read("id,x,y,z,\"B_0\",\"face\",nx,ny,nz, room \n7,0,0,0,99,5,0,0,1,hall\n").unwrap();
        let values =
            Values { channels: 1, radiosity: vec![0.5], standard_error: vec![0.25], faces: vec![Some(0)], missed: 0, error: None };
        let mut text = Vec::new();
        write_values(&mut text, &points, &values).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "x,y,z,nx,ny,nz,B_0,se_0,face,id,room\n0,0,0,0,0,1,0.5,0.25,1,7,hall\n");
    }

    #[test]
    fn other_channel_counts_are_numbered() {
        let points = read("x,y,z,nx,ny,nz\n0,0,0,0,0,1\n").unwrap();
        let mut text = Vec::new();
        let values = |radiosity: Vec<f32>| Values {
            channels: 2,
            standard_error: radiosity.clone(),
            radiosity,
            faces: vec![Some(0)],
            missed: 0,
            error: None,
        };
        write_values(&mut text, &points, &values(vec![1.0, 2.0])).unwrap();
        assert!(String::from_utf8(text).unwrap().starts_with("x,y,z,nx,ny,nz,B_0,B_1,se_0,se_1,face\n"));
        assert!(write_values(&mut Vec::new(), &points, &values(vec![1.0])).is_err());
    }

    #[test]
    fn bounds_stand_beside_the_values() {
        let points = read("x,y,z,nx,ny,nz\n0,0,0,0,0,1\n").unwrap();
        let values = Values {
            channels: 3,
            radiosity: vec![1.0, 2.0, 3.0],
            standard_error: vec![f32::NAN; 3],
            faces: vec![Some(2)],
            missed: 0,
            error: None,
        };
        let bounds = PointBounds { channels: 3, lower: vec![0.5, 1.5, 2.5], upper: vec![1.5, 2.5, f32::NAN] };
        let mut text = Vec::new();
        write_bounded_values(&mut text, &points, &values, &bounds).unwrap();
        let expected = "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,lower_r,lower_g,lower_b,upper_r,upper_g,upper_b,face\n\
             0,0,0,0,0,1,1,2,3,,,,0.5,1.5,2.5,1.5,2.5,,3\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn every_number_reads_back_to_the_same_bits() {
        let numbers = [f64::MIN_POSITIVE, 1.0 / 3.0, 123_456_789.123_456_78, -5e-324, f64::MAX];
        let rows: Vec<SurfacePoint> =
            numbers.iter().map(|&x| SurfacePoint { position: [x, -x, 0.0], normal: [0.0, 1.0, 0.0] }).collect();
        let points = Points::from(rows.as_slice());
        let radiosity = vec![f32::MIN_POSITIVE, f32::MAX, 0.1, 1.0 / 3.0, 16_777_217.0];
        let values = Values {
            channels: 1,
            standard_error: radiosity.clone(),
            radiosity,
            faces: vec![None; numbers.len()],
            missed: 0,
            error: None,
        };
        let mut text = Vec::new();
        write_values(&mut text, &points, &values).unwrap();
        let mut reader = csv::Reader::from_reader(text.as_slice());
        for ((record, row), b) in reader.records().zip(&points.rows).zip(&values.radiosity) {
            let record = record.unwrap();
            assert_eq!(record[0].parse::<f64>().unwrap().to_bits(), row[0].to_bits());
            assert_eq!(record[6].parse::<f32>().unwrap().to_bits(), b.to_bits());
        }
    }
}
