//! What makes a result what it is: the inputs, to the byte, what was asked for, and what answers. Two jobs of the same identity have the
//! same results.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use patchlight::output::{Provenance, SOLUTION_FORMAT_VERSION};
use patchlight::scene::Sides;
use patchlight::solve::SolveOptions;
use patchlight::visibility::Backend;
use sha2::{Digest, Sha256};

use super::super::request::SolveRequest;
use super::plan::Job;

/// The SHA-256 of bytes, in hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    hexadecimal(Sha256::digest(bytes).as_slice())
}

/// The SHA-256 of a file, as `sha256sum` prints it.
pub fn digest_of_file(path: &Path) -> io::Result<String> {
    const PIECE: usize = 1 << 16;
    let (mut file, mut hasher, mut piece) = (File::open(path)?, Sha256::new(), vec![0; PIECE]);
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(hexadecimal(hasher.finalize().as_slice())),
            count => hasher.update(&piece[..count]),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// What a job reads, to the byte.
pub struct Inputs<'a> {
    /// The SHA-256 of the scene with its libraries and lights.
    pub scene: &'a str,
    /// That of the points.
    pub points: Option<&'a str>,
}

/// The identity of a job: a SHA-256 of all that decides its results. Names of files are no part of it.
pub fn identity(job: &Job, request: &SolveRequest, options: &SolveOptions, inputs: &Inputs<'_>) -> String {
    // The program, and what answers visibility.
    let provenance = Provenance::new(options);
    let backend = match request.run.backend {
        Backend::Auto if Backend::Embree.is_built() => Backend::Embree,
        Backend::Auto => Backend::Obvhs,
        named => named,
    };
    let mut lines = vec![format!("{} format {SOLUTION_FORMAT_VERSION} {}", provenance.software(), backend.name())];

    // What is read, and changed.
    let sides = if request.import.sides == Sides::Both { "both" } else { "front" };
    let unit = request.import.unit.map(f64::to_bits);
    lines.push(format!("scene {} {sides} {unit:?} {:?}", inputs.scene, request.import.up));
    lines.push(format!("points {}", inputs.points.unwrap_or_default()));
    lines.extend(job.changes.iter().map(|change| format!("change {}", change.identity())));

    // What is asked for.
    lines.push(format!("options {}", provenance.options()));
    lines.push(format!("limits {:?} {:?}", request.run.time_s, request.run.memory_bytes));
    let extension = |text: &str| Path::new(text).extension().map_or(String::new(), |end| end.to_string_lossy().to_lowercase());
    lines.extend(job.outputs.iter().map(|output| format!("output {} {}", output.key, extension(&output.text))));
    lines.extend(job.picture.iter().map(|flag| format!("picture {} {:?}", flag.key, flag.text)));
    digest(lines.join("\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-4, examples of NIST.
    #[test]
    fn digests_are_those_of_the_standard() {
        assert_eq!(digest(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "abc").unwrap();
        assert_eq!(digest_of_file(file.path()).unwrap(), digest(b"abc"));
    }
}
