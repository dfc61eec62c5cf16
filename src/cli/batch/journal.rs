//! What is done: a line for each job that has ended, on the disk before the next one is told of.
//!
//! A process that is killed leaves whole lines, and perhaps the beginning of one, which is passed over. Each shard has a journal of its
//! own, so that processes on many machines never write to one file.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::super::exit::Failure;

/// How a job ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The name of the job.
    pub name: String,
    /// Its identity, unless it failed.
    pub identity: Option<String>,
    /// The exit code that `patchlight solve` would have ended with.
    pub exit: u8,
    /// Columns of the table of results, as they are written.
    pub figures: Figures,
    /// Files that were written, relative to the folder of results, with their SHA-256.
    pub files: BTreeMap<String, String>,
    /// What it took.
    pub cost: Cost,
}

/// What the table of results tells; empty where it is not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Why the solve ended.
    pub stopped_by: String,
    /// The norm of errors.
    pub norm: String,
    /// The error that was asked for.
    pub requested: String,
    /// The error that is claimed.
    pub claimed: String,
    /// The probability with which the claim holds.
    pub confidence: String,
    /// How many points lie on no surface.
    pub points_missed: String,
    /// Why it failed.
    pub message: String,
}

/// What a job took; not the same in every run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// CPU seconds of all its threads, without reading of the scene.
    pub cpu_s: Option<f64>,
    /// Seconds, with reading of the scene where it was the first to need it.
    pub wall_s: f64,
    /// How often it was tried.
    pub attempts: u32,
}

impl Record {
    /// Whether there are results.
    pub fn has_results(&self) -> bool {
        self.identity.is_some()
    }
}

/// The journal of this process.
pub struct Journal {
    file: Mutex<File>,
    path: PathBuf,
}

impl Journal {
    /// Opens the journal at `path`, empty if it is begun `anew`.
    ///
    /// # Errors
    /// Another process works with it, or it cannot be written.
    pub fn open(path: PathBuf, anew: bool) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::usage(format_args!("cannot write {}: {error}", path.display()));
        let mut file = File::options().read(true).append(true).create(true).open(&path).map_err(failed)?;
        if is_taken(&file) {
            return Err(Failure::usage(format_args!("{}: another process is at work on these jobs", path.display())));
        }
        if anew {
            file.set_len(0).map_err(failed)?;
        } else if !ends_a_line(&mut file).map_err(failed)? {
            // What a killed process began to write gets a line of its own.
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self { file: Mutex::new(file), path })
    }

    /// Adds a record; it is on the disk afterwards.
    pub fn add(&self, record: &Record) -> Result<(), Failure> {
        let failed = |error: io::Error| Failure::failed(format_args!("cannot write {}: {error}", self.path.display()));
        let mut line = serde_json::to_vec(record).map_err(|error| failed(error.into()))?;
        line.push(b'\n');
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(&line).and_then(|()| file.sync_data()).map_err(failed)
    }
}

/// Whether another process holds the file. Where the file system knows no locks, nobody can tell.
#[cfg(unix)]
fn is_taken(file: &File) -> bool {
    use rustix::fs::{FlockOperation, flock};
    flock(file, FlockOperation::NonBlockingLockExclusive) == Err(rustix::io::Errno::WOULDBLOCK)
}

#[cfg(not(unix))]
fn is_taken(_file: &File) -> bool {
    false
}

fn ends_a_line(file: &mut File) -> io::Result<bool> {
    if file.metadata()?.len() == 0 {
        return Ok(true);
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1))?;
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

/// The name of a journal: that of shard `index` of `count`.
pub fn name(stem: &str, [index, count]: [usize; 2]) -> String {
    format!("{stem}.{index}-of-{count}.journal")
}

/// All that journals in this folder tell of the jobs of this name, by the names of the jobs: the last record of each; one with results
/// before one without.
pub fn read_all(folder: &Path, stem: &str) -> Result<BTreeMap<String, Record>, Failure> {
    let failed = |error: io::Error| Failure::bad_input(format_args!("{}: {error}", folder.display()));
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.strip_prefix(stem).is_some_and(|rest| rest.starts_with('.') && rest.ends_with(".journal") && rest.contains("-of-"))
        {
            paths.push(entry.path());
        }
    }
    paths.sort();
    let mut records = BTreeMap::new();
    for path in paths {
        let bytes = fs::read(&path).map_err(|error| Failure::bad_input(format_args!("{}: {error}", path.display())))?;
        for record in records_in(&bytes) {
            let is_better = records.get(&record.name).is_none_or(|known: &Record| record.has_results() || !known.has_results());
            if is_better {
                records.insert(record.name.clone(), record);
            }
        }
    }
    Ok(records)
}

/// The lines that are whole.
fn records_in(bytes: &[u8]) -> impl Iterator<Item = Record> {
    bytes.split(|&byte| byte == b'\n').filter_map(|line| serde_json::from_slice(line).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(name: &str, identity: Option<&str>) -> Record {
        Record { name: name.to_owned(), identity: identity.map(str::to_owned), ..Record::default() }
    }

    #[test]
    fn what_was_added_is_read_wherever_a_writer_is_killed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name("jobs", [0, 1]));
        let journal = Journal::open(path.clone(), true).unwrap();
        journal.add(&record("a", Some("1"))).unwrap();
        let first = fs::read(&path).unwrap().len();
        journal.add(&record("b", Some("2"))).unwrap();
        drop(journal);
        let whole = fs::read(&path).unwrap();
        for length in 0..=whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            // Whoever goes on writes a line of its own.
            let journal = Journal::open(path.clone(), false).unwrap();
            journal.add(&record("c", Some("3"))).unwrap();
            let names = Vec::from_iter(read_all(folder.path(), "jobs").unwrap().into_keys());
            let expected: &[&str] = if length + 1 >= whole.len() {
                &["a", "b", "c"]
            } else if length + 1 >= first {
                &["a", "c"]
            } else {
                &["c"]
            };
            assert_eq!(names, expected, "{length}");
        }
    }

    #[test]
    fn the_last_record_with_results_counts() {
        let folder = tempfile::tempdir().unwrap();
        let open = |index| Journal::open(folder.path().join(name("jobs", [index, 2])), true).unwrap();
        let [first, second] = [open(0), open(1)];
        let all = [(&first, None), (&first, Some("1")), (&first, Some("2")), (&second, None)];
        all.into_iter().for_each(|(journal, identity)| journal.add(&record("a", identity)).unwrap());
        second.add(&record("b", None)).unwrap();
        fs::write(folder.path().join("jobs.x.journal"), "").unwrap();
        let found = read_all(folder.path(), "jobs").unwrap();
        assert_eq!(found["a"].identity.as_deref(), Some("2"));
        assert_eq!((found["b"].identity.as_deref(), found.len()), (None, 2));
    }

    #[cfg(unix)]
    #[test]
    fn two_processes_do_not_share_a_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.journal");
        let _held = Journal::open(path.clone(), false).unwrap();
        let failure = Journal::open(path, false).err().unwrap();
        assert!(failure.message.contains("another process is at work"), "{}", failure.message);
    }
}
