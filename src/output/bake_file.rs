//! What a bake leaves for a later one, stored and read back without trust.
//!
//! The file is a frame like that of [solutions](super::solution_file), its kind `89 50 4C 42 41 4B 0D 0A`: the letters `PLBAK` between bytes that
//! text transfers and other programs would break. The body is a text that states software, quantity, unit and options, followed by the [`BakeRecord`].

use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::framed::{Frame, FrameError};
use super::{Provenance, Quantity};
use crate::bake::BakeRecord;

/// The version that this software writes and reads.
const VERSION: u32 = 2;

const FRAME: Frame = Frame { magic: *b"\x89PLBAK\r\n", version: VERSION };

/// Why what a bake left cannot be read.
#[derive(Debug, Error)]
pub enum BakeFileError {
    /// The file cannot be opened or read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is something else, or damaged.
    #[error("{}: {reason}; bake the scene again with --keep", .path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
}

/// Writes what a bake leaves at the current position of `writer`.
///
/// # Errors
/// What the writer says.
pub fn write_bake_record(writer: &mut (impl Write + Seek), record: &BakeRecord, provenance: &Provenance) -> io::Result<()> {
    FRAME.write(writer, &(provenance.lines(Quantity::Radiosity), record))
}

/// Reads what a bake left at `path`, and validates it.
///
/// # Errors
/// See [`BakeFileError`]: each says what to do.
pub fn read_bake_record(path: &Path) -> Result<BakeRecord, BakeFileError> {
    let unfit = |reason: String| BakeFileError::Unfit { path: path.to_owned(), reason };
    let failed = |source: io::Error| BakeFileError::Read { path: path.to_owned(), source };
    let file = Frame::open(path, "bake").map_err(failed)?;
    let (_, record): (String, BakeRecord) = FRAME.read(file).map_err(|error| match error {
        FrameError::Read(source) => failed(source),
        FrameError::OtherKind => unfit("this is nothing that a bake left".to_owned()),
        FrameError::WrongVersion(found) => unfit(format!("it has format {found}, this program reads format {VERSION}")),
        FrameError::CutOff { found, expected } => unfit(format!("the file is cut off: {found} of {expected} bytes are there")),
        FrameError::TooLong => unfit("bytes follow its end".to_owned()),
        FrameError::Damaged(reason) => unfit(format!("the file is damaged ({reason})")),
    })?;
    record.validate().map_err(|reason| unfit(format!("the file is damaged ({reason})")))?;
    Ok(record)
}
