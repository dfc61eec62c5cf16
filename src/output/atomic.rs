//! Files are replaced whole or not at all: written beside their place under another name, then renamed.
//!
//! A process that is killed leaves such a file behind. The next one that writes into that folder removes it: every writer holds a lock on its
//! file, which the system takes away with the process. (A file without a name, O_TMPFILE, would leave nothing; but it cannot replace
//! another by linkat, and not all file systems have it.)
//!
//! What cannot be replaced is found out beforehand: a file that must not be written, a link to nothing, a name that is too long, a pipe that
//! nobody reads. Pipes and devices are opened then, and stay open.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why a file cannot be written.
#[derive(Debug, Error)]
pub enum DestinationError {
    /// The path is a directory.
    #[error("cannot write {}: it is a directory", .0.display())]
    IsDirectory(PathBuf),
    /// The path is a link that leads nowhere.
    #[error("cannot write {}: it is a link to something that does not exist; remove the link, or make what it leads to", .0.display())]
    DanglingLink(PathBuf),
    /// What is there must not be written, or cannot be opened.
    #[error("cannot write {}: {source}", .path.display())]
    Closed {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The path is a pipe that nobody reads.
    #[error("cannot write {}: nobody reads this pipe; start its reader first", .0.display())]
    NoReader(PathBuf),
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
#[derive(Clone, Debug)]
pub struct Destination {
    path: PathBuf,
    /// Where the bytes end up: symbolic links are followed.
    target: PathBuf,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A regular file, or none yet: replaced by renaming.
    File,
    /// A device or a pipe, opened: must not be replaced, has no old content to lose.
    Stream(Arc<File>),
}

impl Destination {
    /// Checks that `path` can be written, by making a file in its directory and removing it again. What is there stays as it is.
    ///
    /// # Errors
    /// All of [`DestinationError`] but [`DestinationError::Write`].
    pub fn new(path: &Path) -> Result<Self, DestinationError> {
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let closed = |source| DestinationError::Closed { path: path.to_owned(), source };
        let kind = match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err(DestinationError::IsDirectory(path.to_owned())),
            Ok(metadata) if !metadata.is_file() => Kind::Stream(Arc::new(open_stream(path)?)),
            Ok(metadata) if metadata.permissions().readonly() => return Err(closed(io::ErrorKind::PermissionDenied.into())),
            // Whether it may be written is found out by opening it, which changes nothing.
            Ok(_) => File::options().append(true).open(path).map(|_| Kind::File).map_err(closed)?,
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(closed(error)),
            Err(_) if fs::symlink_metadata(path).is_ok() => return Err(DestinationError::DanglingLink(path.to_owned())),
            Err(_) => Kind::File,
        };
        let destination = Self { path: path.to_owned(), target, kind };
        if let Kind::File = destination.kind {
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
        match &self.kind {
            Kind::File => {
                remove_abandoned(self.directory());
                let temporary = self.temporary_file()?;
                let mut writer = BufWriter::new(temporary.as_file().try_clone().map_err(failed)?);
                encode(&mut writer).and_then(|()| writer.flush()).map_err(failed)?;
                // The bytes must be on the disk before the name is: a crash in between would leave an empty file.
                temporary.as_file().sync_data().map_err(failed)?;
                temporary.persist(&self.target).map(drop).map_err(|error| failed(error.error))
            }
            Kind::Stream(stream) => {
                // Encoders seek, streams cannot: encode to a nameless file first.
                let mut writer = BufWriter::new(tempfile::tempfile().map_err(failed)?);
                encode(&mut writer).map_err(failed)?;
                let mut encoded = writer.into_inner().map_err(|error| failed(error.into_error()))?;
                encoded.rewind().and_then(|()| io::copy(&mut encoded, &mut &**stream)).map(drop).map_err(failed)
            }
        }
    }

    /// Where the file is, or will be.
    fn directory(&self) -> &Path {
        match self.target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        }
    }

    /// A file in the same directory, which vanishes unless it is renamed. It gets the permissions of the file that it replaces, or
    /// those that any new file gets.
    fn temporary_file(&self) -> Result<NamedTempFile, DestinationError> {
        let directory = self.directory();
        let failed = |source| DestinationError::Directory { path: self.path.clone(), directory: directory.to_owned(), source };
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let temporary = builder.tempfile_in(directory).map_err(failed)?;
        lock(temporary.as_file());
        if let Ok(existing) = fs::metadata(&self.target) {
            temporary.as_file().set_permissions(existing.permissions()).map_err(failed)?;
        }
        Ok(temporary)
    }
}

/// Names of files that are not complete yet.
const PREFIX: &str = ".patchlight-";
const SUFFIX: &str = ".partial";

/// A file that has not changed for so long is past the moment between being made and being locked.
#[cfg(unix)]
const SETTLED: std::time::Duration = std::time::Duration::from_secs(60);

/// Locks a file for as long as it is open; `false` if another process has it, or the file system knows no locks.
#[cfg(unix)]
fn lock(file: &File) -> bool {
    rustix::fs::flock(file, rustix::fs::FlockOperation::NonBlockingLockExclusive).is_ok()
}

#[cfg(not(unix))]
fn lock(_file: &File) -> bool {
    false
}

/// Removes what killed processes left in a folder. Where anything fails it stays, and does no more harm than before.
#[cfg(unix)]
fn remove_abandoned(directory: &Path) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        if !is_ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let age = |file: &File| file.metadata().ok()?.modified().ok()?.elapsed().ok();
        if File::open(entry.path()).is_ok_and(|file| age(&file).is_some_and(|age| age >= SETTLED) && lock(&file)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(not(unix))]
fn remove_abandoned(_directory: &Path) {}

/// Opens a pipe or a device for writing, without waiting for a reader.
fn open_stream(path: &Path) -> Result<File, DestinationError> {
    let mut options = File::options();
    options.write(true);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(OFlags::NONBLOCK.bits() as i32);
        let closed = |source| DestinationError::Closed { path: path.to_owned(), source };
        let stream = match options.open(path) {
            Err(error) if error.raw_os_error() == Some(rustix::io::Errno::NXIO.raw_os_error()) => {
                return Err(DestinationError::NoReader(path.to_owned()));
            }
            other => other.map_err(closed)?,
        };
        // From here on it waits for its reader, as long as that is there.
        let flags = rustix::fs::fcntl_getfl(&stream).map_err(|error| closed(error.into()))?;
        rustix::fs::fcntl_setfl(&stream, flags - OFlags::NONBLOCK).map_err(|error| closed(error.into()))?;
        Ok(stream)
    }
    #[cfg(not(unix))]
    options.open(path).map_err(|source| DestinationError::Closed { path: path.to_owned(), source })
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
    fn what_must_not_be_replaced_is_refused_beforehand() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let [closed, link, pipe] = ["closed", "link", "pipe"].map(|name| directory.path().join(name));
        fs::write(&closed, "precious").unwrap();
        let mut permissions = fs::metadata(&closed).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&closed, permissions).unwrap();
        assert!(matches!(Destination::new(&closed), Err(DestinationError::Closed { .. })));
        symlink("nowhere", &link).unwrap();
        assert!(matches!(Destination::new(&link), Err(DestinationError::DanglingLink(_))));
        assert!(matches!(Destination::new(&directory.path().join("x".repeat(300))), Err(DestinationError::Closed { .. })));

        // A pipe waits for no reader, and is written to once it has one.
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(matches!(Destination::new(&pipe), Err(DestinationError::NoReader(_))));
        let path = pipe.clone();
        let reader = std::thread::spawn(move || fs::read_to_string(path).unwrap());
        let destination = loop {
            match Destination::new(&pipe) {
                Err(DestinationError::NoReader(_)) => std::thread::sleep(std::time::Duration::from_millis(5)),
                other => break other.unwrap(),
            }
        };
        destination.write(|file| file.write_all(b"read")).unwrap();
        drop(destination);
        assert_eq!(reader.join().unwrap(), "read");
    }

    #[cfg(unix)]
    #[test]
    fn what_killed_processes_left_is_removed_and_what_others_write_is_not() {
        let directory = tempfile::tempdir().unwrap();
        let old = std::time::SystemTime::now() - 2 * SETTLED;
        let partial = |name: &str| {
            let file = File::create(directory.path().join(name)).unwrap();
            file.set_modified(old).unwrap();
            file
        };
        drop(partial(".patchlight-abandoned.partial"));
        drop(partial(".other.partial"));
        let at_work = partial(".patchlight-at-work.partial");
        assert!(lock(&at_work));
        File::create(directory.path().join(".patchlight-new.partial")).unwrap();
        Destination::new(&directory.path().join("a")).unwrap().write(|file| file.write_all(b"a")).unwrap();
        let mut names = names_in(directory.path());
        names.sort();
        assert_eq!(names, [".other.partial", ".patchlight-at-work.partial", ".patchlight-new.partial", "a"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_called_so() {
        let full = Destination::new(Path::new("/dev/full")).unwrap();
        let error = full.write(|file| file.write_all(b"lost")).unwrap_err().to_string();
        assert!(error.contains("No space left on device"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_to_and_stay() {
        Destination::new(Path::new("/dev/null")).unwrap().write(|file| file.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
