//! Binary files that are read back: a frame around a body, so that a damaged or foreign file is known as one before anything in it is looked at.
//!
//! | bytes | what |
//! |---|---|
//! | 0..8 | the kind of the file |
//! | 8..12 | format version, `u32`, little-endian as all integers; a reader takes its own version only |
//! | 12..20 | length of the body in bytes, `u64`; the file ends with the body |
//! | 20..24 | CRC-32 (IEEE 802.3) of the body, `u32` |
//! | 24.. | the body, in the [postcard](https://postcard.jamesmunns.com/wire-format) encoding |

use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

const HEADER_LENGTH: usize = 24;

/// A kind of files.
pub(super) struct Frame {
    pub magic: [u8; 8],
    /// That is written and read.
    pub version: u32,
}

/// Why a framed file cannot be read.
#[derive(Debug)]
pub(super) enum FrameError {
    /// What the system said.
    Read(io::Error),
    /// It is of another kind.
    OtherKind,
    /// It has another version.
    WrongVersion(u32),
    /// It ends too early.
    CutOff { found: u64, expected: u64 },
    /// Bytes follow its end.
    TooLong,
    /// What does not fit.
    Damaged(String),
}

impl Frame {
    /// Whether the file at `path` begins like one of this kind; `false` also for a file that cannot be read.
    pub fn is_of(&self, path: &Path) -> bool {
        // To open a pipe that nobody writes to waits for ever.
        let mut magic = [0; 8];
        std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file())
            && std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok()
            && magic == self.magic
    }

    /// Writes `body` at the current position of `writer`.
    pub fn write(&self, writer: &mut (impl Write + Seek), body: &impl Serialize) -> io::Result<()> {
        // The body first: its length and checksum are known when it is written.
        let start = writer.stream_position()?;
        writer.write_all(&[0; HEADER_LENGTH])?;
        let checked = Checksummed { writer: &mut *writer, crc: crc32fast::Hasher::new(), length: 0, failure: None };
        let mut checked = BufWriter::with_capacity(1 << 16, checked);
        if let Err(error) = postcard::to_io(body, &mut checked) {
            // Of a full disk the encoder says that its buffer is full; what the system said is better.
            return Err(checked.get_mut().failure.take().unwrap_or_else(|| io::Error::other(error)));
        }
        let Checksummed { crc, length, .. } = checked.into_inner().map_err(io::IntoInnerError::into_error)?;

        let end = writer.stream_position()?;
        writer.seek(SeekFrom::Start(start))?;
        writer.write_all(&self.magic)?;
        writer.write_all(&self.version.to_le_bytes())?;
        writer.write_all(&length.to_le_bytes())?;
        writer.write_all(&crc.finalize().to_le_bytes())?;
        writer.seek(SeekFrom::Start(end)).map(drop)
    }

    /// Opens the file at `path`, if it is a regular one.
    pub fn open(path: &Path, what: &str) -> io::Result<std::fs::File> {
        if !std::fs::metadata(path)?.is_file() {
            // A pipe or a device may wait, or go on, for ever.
            return Err(io::Error::other(format!("it is not a regular file; copy the {what} into one")));
        }
        std::fs::File::open(path)
    }

    /// The body that ends with `reader`.
    pub fn read<T: DeserializeOwned>(&self, mut reader: impl Read) -> Result<T, FrameError> {
        // What the file says it is.
        let mut header = Vec::with_capacity(HEADER_LENGTH);
        reader.by_ref().take(HEADER_LENGTH as u64).read_to_end(&mut header).map_err(FrameError::Read)?;
        if !header.starts_with(&self.magic) {
            return Err(FrameError::OtherKind);
        }
        let Ok::<[u8; HEADER_LENGTH], _>(header) = header.as_slice().try_into() else {
            return Err(FrameError::CutOff { found: header.len() as u64, expected: HEADER_LENGTH as u64 });
        };
        let number = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        let (version, length, crc) = (number(8), u64::from(number(16)) << 32 | u64::from(number(12)), number(20));
        if version != self.version {
            return Err(FrameError::WrongVersion(version));
        }

        // The body, as long as announced and unchanged. One byte more is asked for, to see whether the file goes on.
        let mut body = Vec::new();
        reader.take(length.saturating_add(1)).read_to_end(&mut body).map_err(FrameError::Read)?;
        let found = body.len() as u64;
        if found < length {
            let header = HEADER_LENGTH as u64;
            return Err(FrameError::CutOff { found: header + found, expected: length.saturating_add(header) });
        }
        if found > length {
            return Err(FrameError::TooLong);
        }
        if crc32fast::hash(&body) != crc {
            return Err(FrameError::Damaged("its checksum is wrong".to_owned()));
        }

        // What it means.
        let (decoded, rest): (T, _) =
            postcard::take_from_bytes(&body).map_err(|error| FrameError::Damaged(format!("it does not decode: {error}")))?;
        match rest.len() {
            0 => Ok(decoded),
            left => Err(FrameError::Damaged(format!("{left} bytes are left over"))),
        }
    }
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
