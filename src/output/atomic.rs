//! Files are replaced whole or not at all: written beside their place under another name, then renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why a file cannot be written.
#[derive(Debug, Error)]
pub enum DestinationError {
    /// The path is a directory.
    #[error("cannot write {}: it is a directory", .0.display())]
    IsDirectory(PathBuf),
    /// No file can be made in the directory of the path.
    #[error("cannot write {}: no file can be made in {}: {source}", .path.display(), .directory.display())]
    Directory {
        /// The file.
        path: PathBuf,
        /// Where it would be.
        directory: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Writing failed, as on a full disk.
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// A place where a file can be written, as far as that can be known beforehand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    path: PathBuf,
    /// Where the bytes end up: symbolic links are followed.
    target: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A regular file, or none yet: replaced by renaming.
    File,
    /// A device or a pipe: must not be replaced, has no old content to lose.
    Stream,
}

impl Destination {
    /// Checks that `path` can be written, by making a file in its directory and removing it again. What is there stays as it is.
    ///
    /// # Errors
    /// [`DestinationError::IsDirectory`] or [`DestinationError::Directory`].
    pub fn new(path: &Path) -> Result<Self, DestinationError> {
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let kind = match fs::metadata(&target) {
            Ok(metadata) if metadata.is_dir() => return Err(DestinationError::IsDirectory(path.to_owned())),
            Ok(metadata) if !metadata.is_file() => Kind::Stream,
            _ => Kind::File,
        };
        let destination = Self { path: path.to_owned(), target, kind };
        if kind == Kind::File {
            destination.temporary_file()?;
        }
        Ok(destination)
    }

    /// The path as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where the bytes end up: the path with symbolic links followed, where something is there already.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes the file by `encode`. If anything fails, what was there before is still there, and nothing else.
    ///
    /// # Errors
    /// [`DestinationError::Directory`] or [`DestinationError::Write`].
    pub fn write(&self, encode: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), DestinationError> {
        let failed = |source| DestinationError::Write { path: self.path.clone(), source };
        match self.kind {
            Kind::File => {
                let temporary = self.temporary_file()?;
                let mut writer = BufWriter::new(temporary.as_file().try_clone().map_err(failed)?);
                encode(&mut writer).and_then(|()| writer.flush()).map_err(failed)?;
                // The bytes must be on the disk before the name is: a crash in between would leave an empty file.
                temporary.as_file().sync_data().map_err(failed)?;
                temporary.persist(&self.target).map(drop).map_err(|error| failed(error.error))
            }
            Kind::Stream => {
                // Encoders seek, streams cannot: encode to a nameless file first.
                let mut writer = BufWriter::new(tempfile::tempfile().map_err(failed)?);
                encode(&mut writer).map_err(failed)?;
                let mut encoded = writer.into_inner().map_err(|error| failed(error.into_error()))?;
                let mut stream = File::options().write(true).open(&self.target).map_err(failed)?;
                encoded.rewind().and_then(|()| io::copy(&mut encoded, &mut stream)).map(drop).map_err(failed)
            }
        }
    }

    /// A file in the same directory, which vanishes unless it is renamed. It gets the permissions of the file that it replaces, or
    /// those that any new file gets.
    fn temporary_file(&self) -> Result<NamedTempFile, DestinationError> {
        let directory = match self.target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let failed = |source| DestinationError::Directory { path: self.path.clone(), directory: directory.to_owned(), source };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".patchlight-").suffix(".partial");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let temporary = builder.tempfile_in(directory).map_err(failed)?;
        if let Ok(existing) = fs::metadata(&self.target) {
            temporary.as_file().set_permissions(existing.permissions()).map_err(failed)?;
        }
        Ok(temporary)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(directory: &Path) -> Vec<String> {
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_written_and_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        for text in ["first", "second, longer", "3"] {
            Destination::new(&path).unwrap().write(|file| file.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names_in(directory.path()), ["a.txt"]);
    }

    #[test]
    fn an_existing_file_survives_an_encoder_that_fails() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        fs::write(&path, "precious").unwrap();
        let result = Destination::new(&path).unwrap().write(|file| {
            file.write_all(&[0; 100_000])?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(result.unwrap_err().to_string(), format!("cannot write {}: disk full", path.display()));
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
        assert_eq!(names_in(directory.path()), ["a.txt"]);
    }

    #[test]
    fn checking_leaves_nothing_behind() {
        let directory = tempfile::tempdir().unwrap();
        Destination::new(&directory.path().join("new.txt")).unwrap();
        assert!(names_in(directory.path()).is_empty());
    }

    #[test]
    fn directories_are_no_files_and_missing_directories_are_named() {
        let directory = tempfile::tempdir().unwrap();
        assert!(matches!(Destination::new(directory.path()), Err(DestinationError::IsDirectory(_))));
        let error = Destination::new(&directory.path().join("missing/a.txt")).unwrap_err().to_string();
        assert!(error.contains("missing") && error.contains("no file can be made"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_other_files_and_links_are_followed() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let directory = tempfile::tempdir().unwrap();
        let [path, plain, link] = ["a.txt", "plain.txt", "link.txt"].map(|name| directory.path().join(name));
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        fs::write(&plain, "").unwrap();
        Destination::new(&path).unwrap().write(|file| file.write_all(b"1")).unwrap();
        assert_eq!(mode(&path), mode(&plain));

        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        Destination::new(&link).unwrap().write(|file| file.write_all(b"2")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), mode(&path)), ("2", 0o640));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_to_and_stay() {
        Destination::new(Path::new("/dev/null")).unwrap().write(|file| file.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
