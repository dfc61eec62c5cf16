//! Solutions, stored and read back without trust.
//!
//! # The format
//! All integers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 0..8 | `89 50 4C 53 4F 4C 0D 0A`: the letters `PLSOL` in a frame that text transfers and other programs would break |
//! | 8..12 | format version, `u32` ([`SOLUTION_FORMAT_VERSION`]); a reader takes its own version only |
//! | 12..20 | length of the body in bytes, `u64`; the file ends with the body |
//! | 20..24 | CRC-32 (IEEE 802.3) of the body, `u32` |
//! | 24.. | the body, in the [postcard](https://postcard.jamesmunns.com/wire-format) encoding |
//!
//! The body is a text (length, then UTF-8) that states software, quantity, unit and options, one on each line, for people who open
//! the file in a text viewer, followed by the [`Solution`] as serde describes it: scene, options, hierarchy, links, exposures,
//! radiosities of nodes and, from the solver over cells, of cells, bounds, the lit mesh, the light of groups and what paths bring if these were asked for. Fields have no names in the encoding, so any change of the
//! stored types needs a new format version.
//!
//! Nothing in the file is trusted before it is checked: magic, version, length and CRC first, then the body must decode without
//! a byte left over, then [`Solution::validate`] must agree. Memory is taken as bytes arrive, not as the file announces them. Polygons are
//! stored as vertices and measured anew; of nodes and clusters all is found again that follows from them, and must be the same. What
//! passes may tell a wrong answer, but takes no more memory or time than a solution of its size does.

use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{Provenance, Quantity};
use crate::solve::Solution;

/// The version that this software writes and reads.
pub const SOLUTION_FORMAT_VERSION: u32 = 17;

const MAGIC: [u8; 8] = *b"\x89PLSOL\r\n";
const HEADER_LENGTH: usize = 24;

/// Why a solution cannot be read.
#[derive(Debug, Error)]
pub enum SolutionFileError {
    /// The file cannot be opened or read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file does not begin as a solution does.
    #[error("{}: this is no solution; give a file that 'patchlight solve -o' wrote", .0.display())]
    NotASolution(PathBuf),
    /// The file has another version.
    #[error(
        "{}: solution format {found}, this program reads format {SOLUTION_FORMAT_VERSION}; \
         solve the scene again, or use the patchlight that wrote the file", .path.display()
    )]
    WrongVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// The file ends too early.
    #[error("{}: the file is cut off: {found} of {expected} bytes are there; copy it again or solve the scene again", .path.display())]
    CutOff {
        /// The file.
        path: PathBuf,
        /// How many bytes there are.
        found: u64,
        /// How many there should be.
        expected: u64,
    },
    /// The file goes on after its end.
    #[error("{}: bytes follow the end of the solution; copy the file again or solve the scene again", .0.display())]
    TooLong(PathBuf),
    /// The file was changed or damaged.
    #[error("{}: the file is damaged ({reason}); copy it again or solve the scene again", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
}

/// Whether the file at `path` begins like a solution; `false` also for a file that cannot be read.
pub fn is_solution_file(path: &Path) -> bool {
    // To open a pipe that nobody writes to waits for ever.
    let mut magic = [0; MAGIC.len()];
    std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file())
        && std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok()
        && magic == MAGIC
}

/// Writes `solution` at the current position of `writer`.
///
/// # Errors
/// What the writer says.
pub fn write_solution(writer: &mut (impl Write + Seek), solution: &Solution, provenance: &Provenance) -> io::Result<()> {
    // The body first: its length and checksum are known when it is written.
    let start = writer.stream_position()?;
    writer.write_all(&[0; HEADER_LENGTH])?;
    let about = provenance.statements(Quantity::Radiosity).iter().map(|(key, text)| format!("{key}: {text}\n")).collect::<String>();
    let body = Checksummed { writer: &mut *writer, crc: crc32fast::Hasher::new(), length: 0, failure: None };
    let mut body = BufWriter::with_capacity(1 << 16, body);
    if let Err(error) = postcard::to_io(&(about, solution), &mut body) {
        // Of a full disk the encoder says that its buffer is full; what the system said is better.
        return Err(body.get_mut().failure.take().unwrap_or_else(|| io::Error::other(error)));
    }
    let Checksummed { crc, length, .. } = body.into_inner().map_err(io::IntoInnerError::into_error)?;

    let end = writer.stream_position()?;
    writer.seek(SeekFrom::Start(start))?;
    writer.write_all(&MAGIC)?;
    writer.write_all(&SOLUTION_FORMAT_VERSION.to_le_bytes())?;
    writer.write_all(&length.to_le_bytes())?;
    writer.write_all(&crc.finalize().to_le_bytes())?;
    writer.seek(SeekFrom::Start(end)).map(drop)
}

/// Reads the solution at `path` and validates it.
///
/// # Errors
/// See [`SolutionFileError`]: each says what to do.
pub fn read_solution(path: &Path) -> Result<Solution, SolutionFileError> {
    let failed = |source| SolutionFileError::Read { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        // A pipe or a device may wait, or go on, for ever.
        return Err(failed(io::Error::other("it is not a regular file; copy the solution into one")));
    }
    read_solution_from(std::fs::File::open(path).map_err(failed)?, path)
}

/// Reads a solution up to the end of `reader` and validates it; messages call it `path`.
///
/// # Errors
/// See [`SolutionFileError`]: each says what to do.
pub fn read_solution_from(mut reader: impl Read, path: &Path) -> Result<Solution, SolutionFileError> {
    let failed = |source| SolutionFileError::Read { path: path.to_owned(), source };
    let damaged = |reason: String| SolutionFileError::Damaged { path: path.to_owned(), reason };

    // What the file says it is.
    let mut header = Vec::with_capacity(HEADER_LENGTH);
    reader.by_ref().take(HEADER_LENGTH as u64).read_to_end(&mut header).map_err(failed)?;
    if header.len() < MAGIC.len() || header[..MAGIC.len()] != MAGIC {
        return Err(SolutionFileError::NotASolution(path.to_owned()));
    }
    let Ok::<[u8; HEADER_LENGTH], _>(header) = header.as_slice().try_into() else {
        let (found, expected) = (header.len() as u64, HEADER_LENGTH as u64);
        return Err(SolutionFileError::CutOff { path: path.to_owned(), found, expected });
    };
    let number = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let (version, length, crc) = (number(8), u64::from(number(16)) << 32 | u64::from(number(12)), number(20));
    if version != SOLUTION_FORMAT_VERSION {
        return Err(SolutionFileError::WrongVersion { path: path.to_owned(), found: version });
    }

    // The body, as long as announced and unchanged. One byte more is asked for, to see whether the file goes on.
    let mut body = Vec::new();
    reader.take(length.saturating_add(1)).read_to_end(&mut body).map_err(failed)?;
    let found = body.len() as u64;
    if found < length {
        let header = HEADER_LENGTH as u64;
        return Err(SolutionFileError::CutOff {
            path: path.to_owned(),
            found: header + found,
            expected: length.saturating_add(header),
        });
    }
    if found > length {
        return Err(SolutionFileError::TooLong(path.to_owned()));
    }
    if crc32fast::hash(&body) != crc {
        return Err(damaged("its checksum is wrong".to_owned()));
    }

    // What it means.
    let ((_, solution), rest): ((String, Solution), _) =
        postcard::take_from_bytes(&body).map_err(|error| damaged(format!("it does not decode: {error}")))?;
    if !rest.is_empty() {
        return Err(damaged(format!("{} bytes are left over", rest.len())));
    }
    solution.validate().map_err(damaged)?;
    Ok(solution)
}

/// Counts and sums what passes through.
struct Checksummed<W> {
    writer: W,
    /// What the writer said when it failed.
    failure: Option<io::Error>,
    crc: crc32fast::Hasher,
    length: u64,
}

impl<W: Write> Write for Checksummed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.writer.write(bytes).inspect_err(|error| {
            self.failure = Some(error.raw_os_error().map_or_else(|| error.kind().into(), io::Error::from_raw_os_error));
        })?;
        self.crc.update(&bytes[..written]);
        self.length += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
