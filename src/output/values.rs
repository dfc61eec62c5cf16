//! Points in, values out, as CSV.
//!
//! Points: the header `x,y,z,nx,ny,nz`, then one point a line; metres, and the unit normal of the side that is meant. Values:
//! the same columns, then the radiosity per channel in W/m^2, `B_r,B_g,B_b` for three channels, else `B_0,B_1,...`, their standard errors
//! with `se` for `B`, empty where they are not known, and where bounds are known the same with `lower` and `upper`; all empty for points
//! that lie on no surface. Numbers are the shortest that read back to the same value.

use std::fmt::{Display, LowerExp};
use std::io::{self, BufRead, BufReader, Read, Write};

use thiserror::Error;

use crate::bounds::PointBounds;
use crate::scene::SurfacePoint;
use crate::values::Values;

/// The columns of a point.
const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// A normal's length may be off by this much; files with four digits are off by 1e-4.
const NORMAL_TOLERANCE: f64 = 1e-3;

/// Why points cannot be read. Lines count from 1.
#[derive(Debug, Error)]
pub enum PointsError {
    /// The file cannot be read, or is not UTF-8.
    #[error("{file}:{line}: {source}")]
    Read {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What went wrong.
        source: io::Error,
    },
    /// There is no header.
    #[error("{file}: the file is empty; its first line must be x,y,z,nx,ny,nz")]
    Empty {
        /// The file.
        file: String,
    },
    /// The first line is another.
    #[error("{file}:1: the header is '{found}', it must be x,y,z,nx,ny,nz")]
    Header {
        /// The file.
        file: String,
        /// What is there.
        found: String,
    },
    /// A line has not six fields.
    #[error("{file}:{line}: {found} fields instead of 6 (x,y,z,nx,ny,nz)")]
    ColumnCount {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// How many there are.
        found: usize,
    },
    /// A field is no finite number.
    #[error("{file}:{line}: {column} is '{text}', it must be a finite number")]
    NotANumber {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The column.
        column: &'static str,
        /// What is there.
        text: String,
    },
    /// A normal's length is not 1 within 0.001.
    #[error("{file}:{line}: the normal nx,ny,nz has length {length}, it must be 1 (within 0.001)")]
    NotUnit {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// Its length.
        length: f64,
    },
}

/// Points as read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    rows: Vec<[f64; 6]>,
}

impl Points {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The points, normals made unit length.
    pub fn surface_points(&self) -> Vec<SurfacePoint> {
        let point = |&[x, y, z, nx, ny, nz]: &[f64; 6]| {
            let length = (nx * nx + ny * ny + nz * nz).sqrt();
            // Leave alone what is unit but for rounding.
            let scale = if (length - 1.0).abs() > 1e-12 { 1.0 / length } else { 1.0 };
            SurfacePoint { position: [x, y, z], normal: [nx * scale, ny * scale, nz * scale] }
        };
        self.rows.iter().map(point).collect()
    }
}

impl From<&[SurfacePoint]> for Points {
    fn from(points: &[SurfacePoint]) -> Self {
        let row = |p: &SurfacePoint| {
            let ([x, y, z], [nx, ny, nz]) = (p.position, p.normal);
            [x, y, z, nx, ny, nz]
        };
        Self { rows: points.iter().map(row).collect() }
    }
}

/// Reads points; `file` is what messages call them.
///
/// # Errors
/// See [`PointsError`]. A header alone is no error: there are no points then.
pub fn read_points(reader: impl Read, file: &str) -> Result<Points, PointsError> {
    let file = || file.to_owned();
    let mut lines = (1_u64..).zip(BufReader::new(reader).lines());
    let mut next_line = || -> Result<Option<(u64, String)>, PointsError> {
        let Some((line, text)) = lines.next() else { return Ok(None) };
        text.map(|text| Some((line, text))).map_err(|source| PointsError::Read { file: file(), line, source })
    };
    let Some((_, header)) = next_line()? else { return Err(PointsError::Empty { file: file() }) };
    let header = header.trim_start_matches('\u{feff}');
    if !fields(header).eq(COLUMNS) {
        return Err(PointsError::Header { file: file(), found: header.trim().to_owned() });
    }

    let mut rows = Vec::new();
    while let Some((line, text)) = next_line()? {
        if text.trim().is_empty() {
            continue;
        }
        let found = fields(&text).count();
        if found != COLUMNS.len() {
            return Err(PointsError::ColumnCount { file: file(), line, found });
        }
        let mut row = [0.0; 6];
        for ((number, text), column) in row.iter_mut().zip(fields(&text)).zip(COLUMNS) {
            let parsed = text.parse().ok().filter(|x: &f64| x.is_finite());
            *number = parsed.ok_or_else(|| PointsError::NotANumber { file: file(), line, column, text: text.to_owned() })?;
        }
        let [.., nx, ny, nz] = row;
        let length = (nx * nx + ny * ny + nz * nz).sqrt();
        if (length - 1.0).abs() > NORMAL_TOLERANCE {
            return Err(PointsError::NotUnit { file: file(), line, length });
        }
        rows.push(row);
    }
    Ok(Points { rows })
}

/// The fields of a line, without the blanks and quotation marks around them.
fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|field| field.trim().trim_matches('"'))
}

/// Writes points with their values, in the order of the points.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] if there are not `channels` values per point.
pub fn write_values(writer: &mut impl Write, points: &Points, values: &Values) -> io::Result<()> {
    write_columns(writer, points, values.channels, &[("B", &values.radiosity), ("se", &values.standard_error)])
}

/// Writes points with their values, and the bounds of these: `lower_r`, ... and `upper_r`, ... after the values.
///
/// # Errors
/// As [`write_values`].
pub fn write_bounded_values(writer: &mut impl Write, points: &Points, values: &Values, bounds: &PointBounds) -> io::Result<()> {
    let columns: [(&str, &[f32]); 4] =
        [("B", &values.radiosity), ("se", &values.standard_error), ("lower", &bounds.lower), ("upper", &bounds.upper)];
    write_columns(writer, points, values.channels, &columns)
}

/// Writes points, and after them groups of columns, each with a number per point and channel; empty where it is not known.
fn write_columns(writer: &mut impl Write, points: &Points, channels: usize, groups: &[(&str, &[f32])]) -> io::Result<()> {
    if channels == 0 || groups.iter().any(|(_, numbers)| numbers.len() != channels * points.len()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "there are more or fewer values than points and channels"));
    }
    let names: Vec<String> = groups.iter().flat_map(|(name, _)| channel_columns(name, channels)).collect();
    writeln!(writer, "{},{}", COLUMNS.join(","), names.join(","))?;
    for (index, row) in points.rows.iter().enumerate() {
        let mut separator = "";
        for number in row {
            write!(writer, "{separator}")?;
            write_number(writer, *number, number.abs())?;
            separator = ",";
        }
        for number in groups.iter().flat_map(|(_, numbers)| &numbers[index * channels..][..channels]) {
            write!(writer, ",")?;
            if !number.is_nan() {
                write_number(writer, *number, f64::from(number.abs()))?;
            }
        }
        writeln!(writer)?;
    }
    Ok(())
}

/// The shortest decimal number that reads back to the same value, with an exponent where there would be many zeros.
fn write_number(writer: &mut impl Write, number: impl Display + LowerExp, magnitude: f64) -> io::Result<()> {
    if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) { write!(writer, "{number:e}") } else { write!(writer, "{number}") }
}

/// The names of the channels of a radiosity.
pub(super) fn radiosity_columns(channels: usize) -> Vec<String> {
    channel_columns("B", channels)
}

fn channel_columns(name: &str, channels: usize) -> Vec<String> {
    if channels == 3 {
        ["r", "g", "b"].map(|channel| format!("{name}_{channel}")).to_vec()
    } else {
        (0..channels).map(|channel| format!("{name}_{channel}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let values = Values { channels: 3, radiosity: vec![0.1, 1e-9, 2.5, nan, nan, nan], standard_error, missed: 1, error: None };
        let mut text = Vec::new();
        write_values(&mut text, &points, &values).unwrap();
        let expected = "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b\n\
            0.1,-2,300000,0,0,1,0.1,1e-9,2.5,0.01,0,0.5\n1,2,3,0.6,0.8,0,,,,,,\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn other_channel_counts_are_numbered() {
        let points = read("x,y,z,nx,ny,nz\n0,0,0,0,0,1\n").unwrap();
        let mut text = Vec::new();
        let values =
            |radiosity: Vec<f32>| Values { channels: 2, standard_error: radiosity.clone(), radiosity, missed: 0, error: None };
        write_values(&mut text, &points, &values(vec![1.0, 2.0])).unwrap();
        assert!(String::from_utf8(text).unwrap().starts_with("x,y,z,nx,ny,nz,B_0,B_1,se_0,se_1\n"));
        assert!(write_values(&mut Vec::new(), &points, &values(vec![1.0])).is_err());
    }

    #[test]
    fn bounds_stand_beside_the_values() {
        let points = read("x,y,z,nx,ny,nz\n0,0,0,0,0,1\n").unwrap();
        let values =
            Values { channels: 3, radiosity: vec![1.0, 2.0, 3.0], standard_error: vec![f32::NAN; 3], missed: 0, error: None };
        let bounds = PointBounds { channels: 3, lower: vec![0.5, 1.5, 2.5], upper: vec![1.5, 2.5, f32::NAN] };
        let mut text = Vec::new();
        write_bounded_values(&mut text, &points, &values, &bounds).unwrap();
        let expected = "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,lower_r,lower_g,lower_b,upper_r,upper_g,upper_b\n\
             0,0,0,0,0,1,1,2,3,,,,0.5,1.5,2.5,1.5,2.5,\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn every_number_reads_back_to_the_same_bits() {
        let numbers = [f64::MIN_POSITIVE, 1.0 / 3.0, 123_456_789.123_456_78, -5e-324, f64::MAX];
        let rows: Vec<SurfacePoint> =
            numbers.iter().map(|&x| SurfacePoint { position: [x, -x, 0.0], normal: [0.0, 1.0, 0.0] }).collect();
        let points = Points::from(rows.as_slice());
        let radiosity = vec![f32::MIN_POSITIVE, f32::MAX, 0.1, 1.0 / 3.0, 16_777_217.0];
        let values = Values { channels: 1, standard_error: radiosity.clone(), radiosity, missed: 0, error: None };
        let mut text = Vec::new();
        write_values(&mut text, &points, &values).unwrap();
        let mut reader = csv::Reader::from_reader(text.as_slice());
        for ((record, row), b) in reader.records().zip(&points.rows).zip(&values.radiosity) {
            let record = record.unwrap();
            assert_eq!(record[0].parse::<f64>().unwrap().to_bits(), row[0].to_bits());
            assert_eq!(record[6].parse::<f32>().unwrap().to_bits(), b.to_bits());
        }
    }

    #[test]
    fn a_header_alone_is_no_point_and_nothing_at_all_is_an_error() {
        assert!(read("x,y,z,nx,ny,nz\n").unwrap().is_empty());
        assert!(read("\u{feff}x,y,z,nx,ny,nz").unwrap().is_empty());
        assert!(matches!(read(""), Err(PointsError::Empty { .. })));
    }

    #[test]
    fn normals_are_made_unit_within_the_tolerance_only() {
        let normal = read("x,y,z,nx,ny,nz\n0,0,0,0.5774,0.5774,0.5774\n").unwrap().surface_points()[0].normal;
        assert!((normal.iter().map(|n| n * n).sum::<f64>() - 1.0).abs() < 1e-14);
        let error = read("x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,0,0,0,0,2\n").unwrap_err();
        assert_eq!(error.to_string(), "P.csv:3: the normal nx,ny,nz has length 2, it must be 1 (within 0.001)");
        assert!(matches!(read("x,y,z,nx,ny,nz\n0,0,0,0,0,0\n"), Err(PointsError::NotUnit { line: 2, .. })));
    }

    #[test]
    fn errors_name_file_and_line() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(message("1,2,3,0,0,1\n"), "P.csv:1: the header is '1,2,3,0,0,1', it must be x,y,z,nx,ny,nz");
        assert_eq!(message("x,y,z\n"), "P.csv:1: the header is 'x,y,z', it must be x,y,z,nx,ny,nz");
        assert_eq!(message("x,y,z,nx,ny,nz\n\n1,2,3,0,1\n"), "P.csv:3: 5 fields instead of 6 (x,y,z,nx,ny,nz)");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,2,three,0,0,1\n"), "P.csv:2: z is 'three', it must be a finite number");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,NaN,3,0,0,1\n"), "P.csv:2: y is 'NaN', it must be a finite number");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,2,3,0,0,1e999\n"), "P.csv:2: nz is '1e999', it must be a finite number");
        assert!(read_points(&b"x,y,z,nx,ny,nz\n\xff,2,3,0,0,1\n"[..], "P.csv").unwrap_err().to_string().starts_with("P.csv:2: "));
        assert_eq!(message("\"x\",\"y\",z,nx,ny,nz\n1,2,3,0,0,1,\n"), "P.csv:2: 7 fields instead of 6 (x,y,z,nx,ny,nz)");
    }
}
