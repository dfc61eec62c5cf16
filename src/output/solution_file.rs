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
//! the file in a text viewer, followed by the [`Solution`] as serde describes it: scene, options, hierarchy, links, exposures, radiosities of
//! nodes and, from the solver over cells, of cells, bounds, the lit mesh, the light of groups and what paths bring if these were asked for.
//! Fields have no names in the encoding, so any change of the stored types needs a new format version.
//!
//! Nothing in the file is trusted before it is checked: magic, version, length and CRC first, then the body must decode without a byte left
//! over, then `Solution::restored` must agree. Memory is taken as bytes arrive, not as the file announces them. What follows from the scene
//! and the leaves, such as sizes of nodes and what clusters send, is not stored but found again. What passes may tell a wrong answer, but takes
//! no more memory or time than a solution of its size does.

use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use thiserror::Error;

use super::framed::{Frame, FrameError};
use super::{Provenance, Quantity};
use crate::solve::{Solution, StoredSolution};

/// The version that this software writes and reads.
pub const SOLUTION_FORMAT_VERSION: u32 = 26;

const FRAME: Frame = Frame { magic: *b"\x89PLSOL\r\n", version: SOLUTION_FORMAT_VERSION };

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
    FRAME.is_of(path)
}

/// Writes `solution` at the current position of `writer`.
///
/// # Errors
/// What the writer says.
pub fn write_solution(writer: &mut (impl Write + Seek), solution: &Solution, provenance: &Provenance) -> io::Result<()> {
    FRAME.write(writer, &(provenance.lines(Quantity::Radiosity), solution))
}

/// The body of a file.
#[derive(Deserialize)]
struct Body {
    _provenance: String,
    #[serde(with = "StoredSolution")]
    solution: Solution,
}

/// Reads the solution at `path` and validates it.
///
/// # Errors
/// See [`SolutionFileError`]: each says what to do.
pub fn read_solution(path: &Path) -> Result<Solution, SolutionFileError> {
    let failed = |source| SolutionFileError::Read { path: path.to_owned(), source };
    read_solution_from(Frame::open(path, "solution").map_err(failed)?, path)
}

/// Reads a solution up to the end of `reader` and validates it; messages call it `path`.
///
/// # Errors
/// See [`SolutionFileError`]: each says what to do.
pub fn read_solution_from(reader: impl Read, path: &Path) -> Result<Solution, SolutionFileError> {
    let path = || path.to_owned();
    let damaged = |reason| SolutionFileError::Damaged { path: path(), reason };
    let Body { solution, .. } = FRAME.read(reader).map_err(|error| match error {
        FrameError::Read(source) => SolutionFileError::Read { path: path(), source },
        FrameError::OtherKind => SolutionFileError::NotASolution(path()),
        FrameError::WrongVersion(found) => SolutionFileError::WrongVersion { path: path(), found },
        FrameError::CutOff { found, expected } => SolutionFileError::CutOff { path: path(), found, expected },
        FrameError::TooLong => SolutionFileError::TooLong(path()),
        FrameError::Damaged(reason) => damaged(reason),
    })?;
    solution.restored().map_err(damaged)
}
