//! Points, read from CSV.
//!
//! A header names the columns `x,y,z,nx,ny,nz`, in any order and in upper or lower case; then one point a line, in metres, with the unit
//! normal of the side that is meant. Other columns are kept, and written again behind the values. Text is read line by line, and no line is longer than
//! 64 KiB, so that a device that never ends is given up.

use std::io::{self, BufRead, BufReader, Read};

use thiserror::Error;

use crate::scene::SurfacePoint;

/// The columns of a point.
pub(super) const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// A normal's length may be off by this much; files with four digits are off by 1e-4.
const NORMAL_TOLERANCE: f64 = 1e-3;

/// A line is no longer than this, in bytes: what is longer is no table of points, and may never end.
const LONGEST_LINE: u64 = 1 << 16;

/// There are no more points than this: they must fit into memory.
const MOST_POINTS: usize = 1 << 27;

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
    #[error("{file}: the file is empty; its first line must name the columns x,y,z,nx,ny,nz")]
    Empty {
        /// The file.
        file: String,
    },
    /// The first line does not name each column once.
    #[error("{file}:1: the header is '{found}', it must name each of x,y,z,nx,ny,nz once")]
    Header {
        /// The file.
        file: String,
        /// What is there.
        found: String,
    },
    /// A line is longer than 65536 bytes.
    #[error("{file}:{line}: the line is longer than {LONGEST_LINE} bytes; this is no table of points")]
    LongLine {
        /// The file.
        file: String,
        /// The line.
        line: u64,
    },
    /// There are more than 2^27 points.
    #[error("{file}:{line}: more than {MOST_POINTS} points; ask for them in several runs")]
    TooMany {
        /// The file.
        file: String,
        /// The line.
        line: u64,
    },
    /// A line has not as many fields as the header.
    #[error("{file}:{line}: {found} fields instead of {expected}, as the header has")]
    ColumnCount {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// How many there are.
        found: usize,
        /// How many the header has.
        expected: usize,
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
    pub(super) rows: Vec<[f64; 6]>,
    pub(super) others: OtherColumns,
}

/// Columns that say nothing of the point, as they were read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct OtherColumns {
    pub names: Vec<String>,
    /// By point, the fields of these columns, separated by commas.
    pub rows: Vec<Box<str>>,
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

    /// Bytes that they take, made ready for values to be taken at them.
    pub fn memory_bytes(&self) -> u64 {
        const ALLOCATION: usize = 24;
        let others: usize = self.others.rows.iter().map(|row| row.len() + size_of::<Box<str>>() + ALLOCATION).sum();
        (size_of_val(&self.rows[..]) + self.rows.len() * size_of::<SurfacePoint>() + others) as u64
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
        Self { rows: points.iter().map(row).collect(), others: OtherColumns::default() }
    }
}

/// Reads points; `file` is what messages call them.
///
/// # Errors
/// See [`PointsError`]. A header alone is no error: there are no points then.
pub fn read_points(reader: impl Read, file: &str) -> Result<Points, PointsError> {
    let file = || file.to_owned();
    let mut lines = Lines { reader: BufReader::new(reader), line: 0 };
    let mut next_line = || lines.next(file());
    let Some((_, header)) = next_line()? else { return Err(PointsError::Empty { file: file() }) };
    let header = header.trim_start_matches('\u{feff}');
    let places = places_of_columns(header).ok_or_else(|| PointsError::Header { file: file(), found: shown(header) })?;
    let expected = fields(header).count();

    let other: Vec<usize> = (0..expected).filter(|place| !places.contains(place)).collect();
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let mut others = OtherColumns { names: other.iter().map(|&place| names[place].to_owned()).collect(), rows: Vec::new() };
    let mut rows = Vec::new();
    while let Some((line, text)) = next_line()? {
        if text.trim().is_empty() {
            continue;
        }
        let fields: Vec<&str> = fields(&text).collect();
        if fields.len() != expected {
            return Err(PointsError::ColumnCount { file: file(), line, found: fields.len(), expected });
        }
        if rows.len() == MOST_POINTS {
            return Err(PointsError::TooMany { file: file(), line });
        }
        let mut row = [0.0; 6];
        for ((number, place), column) in row.iter_mut().zip(places).zip(COLUMNS) {
            let parsed = fields[place].parse().ok().filter(|x: &f64| x.is_finite());
            *number = parsed.ok_or_else(|| PointsError::NotANumber { file: file(), line, column, text: shown(fields[place]) })?;
        }
        let [.., nx, ny, nz] = row;
        let length = (nx * nx + ny * ny + nz * nz).sqrt();
        if (length - 1.0).abs() > NORMAL_TOLERANCE {
            return Err(PointsError::NotUnit { file: file(), line, length });
        }
        rows.push(row);
        if !other.is_empty() {
            let written: Vec<&str> = text.split(',').map(str::trim).collect();
            let kept: Vec<&str> = other.iter().map(|&place| written[place]).collect();
            others.rows.push(kept.join(",").into());
        }
    }
    Ok(Points { rows, others })
}

/// Lines with their numbers, none longer than [`LONGEST_LINE`].
struct Lines<R> {
    reader: BufReader<R>,
    line: u64,
}

impl<R: Read> Lines<R> {
    fn next(&mut self, file: String) -> Result<Option<(u64, String)>, PointsError> {
        self.line += 1;
        let (mut bytes, line) = (Vec::new(), self.line);
        let read = self.reader.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes);
        match read {
            Err(source) => Err(PointsError::Read { file, line, source }),
            Ok(0) => Ok(None),
            Ok(_) if bytes.len() as u64 > LONGEST_LINE => Err(PointsError::LongLine { file, line }),
            Ok(_) => match String::from_utf8(bytes) {
                Ok(text) => Ok(Some((line, text))),
                Err(error) => Err(PointsError::Read { file, line, source: io::Error::new(io::ErrorKind::InvalidData, error) }),
            },
        }
    }
}

/// Where each of [`COLUMNS`] stands in a header, in upper or lower case; `None` unless each is there once.
fn places_of_columns(header: &str) -> Option<[usize; 6]> {
    let names: Vec<&str> = fields(header).collect();
    let mut places = [0; 6];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        let mut found = (0..names.len()).filter(|&index| names[index].eq_ignore_ascii_case(column));
        *place = found.next()?;
        if found.next().is_some() {
            return None;
        }
    }
    Some(places)
}

/// The beginning of what is there, for a message.
fn shown(text: &str) -> String {
    text.trim().chars().take(80).collect()
}

/// The fields of a line, without the blanks and quotation marks around them.
fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|field| field.trim().trim_matches('"'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Points, PointsError> {
        read_points(text.as_bytes(), "P.csv")
    }

    #[test]
    fn columns_stand_in_any_order_and_others_are_kept() {
        let points = read("id,NZ,Ny,nx,Z,y,\"X\",note\n7,1,0,0,3,2,1,a wall\n").unwrap();
        assert_eq!(points.rows, read("x,y,z,nx,ny,nz\n1,2,3,0,0,1\n").unwrap().rows);
        assert_eq!(points.others, OtherColumns { names: vec!["id".to_owned(), "note".to_owned()], rows: vec!["7,a wall".into()] });
        assert!(matches!(read("x,y,z,nx,ny,nz,X\n"), Err(PointsError::Header { .. })));
    }

    #[test]
    fn what_never_ends_is_given_up() {
        let error = read_points(io::repeat(0), "zero").unwrap_err().to_string();
        assert_eq!(error, "zero:1: the line is longer than 65536 bytes; this is no table of points");
        let endless = b"x,y,z,nx,ny,nz\n".chain(io::repeat(b'1'));
        assert!(matches!(read_points(endless, "ones"), Err(PointsError::LongLine { line: 2, .. })));
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
        assert_eq!(message("1,2,3,0,0,1\n"), "P.csv:1: the header is '1,2,3,0,0,1', it must name each of x,y,z,nx,ny,nz once");
        assert_eq!(message("x,y,z\n"), "P.csv:1: the header is 'x,y,z', it must name each of x,y,z,nx,ny,nz once");
        assert_eq!(message("x,y,z,nx,ny,nz\n\n1,2,3,0,1\n"), "P.csv:3: 5 fields instead of 6, as the header has");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,2,three,0,0,1\n"), "P.csv:2: z is 'three', it must be a finite number");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,NaN,3,0,0,1\n"), "P.csv:2: y is 'NaN', it must be a finite number");
        assert_eq!(message("x,y,z,nx,ny,nz\n1,2,3,0,0,1e999\n"), "P.csv:2: nz is '1e999', it must be a finite number");
        assert!(read_points(&b"x,y,z,nx,ny,nz\n\xff,2,3,0,0,1\n"[..], "P.csv").unwrap_err().to_string().starts_with("P.csv:2: "));
        assert_eq!(message("\"x\",\"y\",z,nx,ny,nz\n1,2,3,0,0,1,\n"), "P.csv:2: 7 fields instead of 6, as the header has");
    }
}
