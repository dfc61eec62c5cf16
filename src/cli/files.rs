//! Files that are read and written, checked before the long work starts.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use patchlight::output::{self, Destination, Points};
use patchlight::solve::Solution;

use super::exit::Failure;

/// Where text goes.
#[derive(Clone, Debug)]
pub enum Sink {
    /// `-`.
    Stdout,
    /// A file.
    File(Destination),
}

impl Sink {
    fn new(path: &Path) -> Result<Self, Failure> {
        if path == Path::new("-") { Ok(Self::Stdout) } else { destination(path).map(Self::File) }
    }

    /// Writes text by `encode`. A reader of stdout that went away has what it wanted.
    pub fn write(&self, encode: impl Fn(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        match self {
            Self::File(destination) => Ok(destination.write(|file| encode(file))?),
            Self::Stdout => to_stdout(encode),
        }
    }

    /// What to call it.
    pub fn name(&self) -> String {
        match self {
            Self::Stdout => "stdout".to_owned(),
            Self::File(destination) => destination.path().display().to_string(),
        }
    }
}

/// Writes to stdout by `encode`. A reader that went away has what it wanted.
pub fn to_stdout(encode: impl Fn(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut stdout = BufWriter::new(io::stdout().lock());
    match encode(&mut stdout).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::failed(format_args!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// A place that can be written, or a usage error.
fn destination(path: &Path) -> Result<Destination, Failure> {
    Destination::new(path).map_err(Failure::usage)
}

/// All that one command writes: no file twice, none that is read.
#[derive(Debug, Default)]
pub struct Outputs {
    inputs: Vec<PathBuf>,
    taken: Vec<PathBuf>,
    stdout_taken: bool,
}

impl Outputs {
    /// Outputs of a command that reads `inputs`.
    pub fn beside(inputs: &[&Path]) -> Self {
        Self { inputs: inputs.iter().filter_map(|path| fs::canonicalize(path).ok()).collect(), ..Self::default() }
    }

    /// A file to write.
    pub fn file(&mut self, path: &Path) -> Result<Destination, Failure> {
        let destination = destination(path)?;
        self.claim(&destination)?;
        Ok(destination)
    }

    /// A file to write, or stdout for `-`.
    pub fn sink(&mut self, path: &Path) -> Result<Sink, Failure> {
        let sink = Sink::new(path)?;
        match &sink {
            Sink::Stdout if self.stdout_taken => return Err(Failure::usage("two outputs cannot both go to stdout")),
            Sink::Stdout => self.stdout_taken = true,
            Sink::File(destination) => self.claim(destination)?,
        }
        Ok(sink)
    }

    /// Checks that none of what the scene turned out to read is written as well.
    pub fn check_unread(&self, read: &[PathBuf]) -> Result<(), Failure> {
        let read: Vec<PathBuf> = read.iter().filter_map(|path| fs::canonicalize(path).ok()).collect();
        match self.taken.iter().find(|taken| read.contains(taken)) {
            Some(path) => Err(is_read(path)),
            None => Ok(()),
        }
    }

    fn claim(&mut self, destination: &Destination) -> Result<(), Failure> {
        let target = destination.target();
        let path = destination.path();
        if self.inputs.iter().any(|input| input == target) {
            return Err(is_read(path));
        }
        if target.is_file() || !target.exists() {
            let key = std::path::absolute(target).unwrap_or_else(|_| target.to_owned());
            if self.taken.contains(&key) {
                return Err(Failure::usage(format_args!("two outputs cannot both be {}", path.display())));
            }
            self.taken.push(key);
        }
        Ok(())
    }
}

fn is_read(path: &Path) -> Failure {
    Failure::usage(format_args!("{} is read by this command, it cannot be written as well", path.display()))
}

/// Reads points from a file, or from stdin for `-`.
pub fn read_points(path: &Path) -> Result<Points, Failure> {
    if path == Path::new("-") {
        return output::read_points(io::stdin().lock(), "stdin").map_err(Failure::bad_input);
    }
    let name = path.display().to_string();
    let file = File::open(path).map_err(|error| Failure::bad_input(format_args!("{name}: {error}")))?;
    output::read_points(file, &name).map_err(Failure::bad_input)
}

/// Reads a solution.
pub fn read_solution(path: &Path) -> Result<Solution, Failure> {
    output::read_solution(path).map_err(Failure::bad_input)
}
