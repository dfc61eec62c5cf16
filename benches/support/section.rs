//! The sections of BENCHMARKS.md that benchmarks write, and numbers in them.

use std::io;
use std::path::Path;

/// Puts the text between the marks of a benchmark.
pub fn write(file: &Path, benchmark: &str, text: &str) -> io::Result<()> {
    let begin = format!("<!-- {benchmark}: from here on written by `make bench-error` -->\n");
    let end = format!("<!-- {benchmark}: up to here -->\n");
    let old = std::fs::read_to_string(file)?;
    let missing = || io::Error::new(io::ErrorKind::InvalidData, "the marks are missing");
    let (before, rest) = old.split_once(&begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    std::fs::write(file, format!("{before}{begin}\n{text}\n{end}{after}"))
}

/// `0.0123` as `1.23%`.
pub fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

/// The middle one, of an even number the larger of the two in the middle; not a number if there are none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
