//! What differs from job to job: lists, ranges, and tables of rows.

use std::path::Path;

use super::super::exit::Failure;
use super::super::reader::{Entry, Said};

/// A parameter with all its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its values, as texts; of several numbers each, there are blanks between them.
    pub values: Vec<String>,
    /// Where it was said.
    pub place: String,
}

/// Parameters that vary together, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows {
    /// The names of the columns.
    pub names: Vec<String>,
    /// One value for each column.
    pub rows: Vec<Vec<String>>,
}

/// One parameter has at most so many values: more are a slip of a step.
const MOST_VALUES: usize = 1_000_000;

impl Parameter {
    /// A list, or a range: `{ from, to, step }` or `{ from, to, count }`, both ends included.
    pub fn new(entry: Entry<'_>) -> Result<Self, Failure> {
        let values = if entry.is_table() { range(entry)? } else { entry.list()?.into_iter().map(|said| said.text).collect() };
        if values.is_empty() {
            return Err(entry.wrong("it has no value, so there would be no job"));
        }
        Ok(Self { name: entry.key.to_owned(), values, place: entry.place() })
    }
}

/// The numbers of a range.
fn range(entry: Entry<'_>) -> Result<Vec<String>, Failure> {
    const KEYS: [&str; 4] = ["from", "to", "step", "count"];
    let mut numbers = [None; 4];
    entry.table(|table| {
        for end in table.entries() {
            let index = KEYS.iter().position(|&key| key == end.key).ok_or_else(|| end.unknown(&KEYS))?;
            let said = end.said()?;
            let number = said.text.parse().ok().filter(|number: &f64| number.is_finite());
            numbers[index] = Some(number.ok_or_else(|| said.wrong(format_args!("'{}' is no number", said.text)))?);
        }
        Ok(())
    })?;
    let [Some(from), Some(to), step, count] = numbers else { return Err(entry.wrong("a range has 'from' and 'to'")) };
    let (step, count) = match (step, count) {
        (Some(step), None) if step != 0.0 && (to - from) / step >= 0.0 => {
            // A step that meets the end but for a rounding includes it.
            const ROUNDING: f64 = 1e-9;
            (step, ((to - from) / step + ROUNDING).floor() + 1.0)
        }
        (None, Some(1.0)) if from == to => (0.0, 1.0),
        (None, Some(count)) if count >= 2.0 && count.fract() == 0.0 => ((to - from) / (count - 1.0), count),
        (Some(_), None) => return Err(entry.wrong("the step does not lead from 'from' to 'to'")),
        (None, Some(_)) => return Err(entry.wrong("'count' must be a whole number of at least 2")),
        _ => return Err(entry.wrong("a range has either 'step' or 'count'")),
    };
    if count > MOST_VALUES as f64 {
        return Err(entry.wrong(format_args!("it has more than {MOST_VALUES} values")));
    }
    Ok((0..count as usize).map(|k| shortest(from + k as f64 * step)).collect())
}

/// A number of a range without the roundings of its last digits, 0.3 for 0.1 + 0.2: twelve digits are kept.
fn shortest(number: f64) -> String {
    let rounded: f64 = format!("{number:.11e}").parse().unwrap_or(number);
    // Minus nothing is nothing.
    format!("{}", rounded + 0.0)
}

/// Reads a CSV file, `said` in the file of jobs and lying at `path`: names in the first line, and a row for each combination.
pub fn read_rows(said: &Said, path: &Path) -> Result<Rows, Failure> {
    let file = path.display();
    let wrong = |error: csv::Error| {
        let line = error.position().map_or(String::new(), |position| format!(":{}", position.line()));
        match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                said.wrong(format_args!("{file}{line}: there are {len} fields, and {expected_len} names in the first line"))
            }
            csv::ErrorKind::Io(error) => said.wrong(format_args!("{file}: {error}")),
            _ => said.wrong(format_args!("{file}{line}: {error}")),
        }
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(wrong)?;
    let names: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
    let row = |record: Result<csv::StringRecord, csv::Error>| Ok(record.map_err(wrong)?.iter().map(str::to_owned).collect());
    let rows: Vec<Vec<String>> = reader.records().map(row).collect::<Result<_, Failure>>()?;
    if rows.is_empty() {
        return Err(said.wrong(format_args!("{file} has no row below its names, so there would be no job")));
    }
    Ok(Rows { names, rows })
}

#[cfg(test)]
mod tests {
    use super::super::super::reader::read;
    use super::*;

    fn parameter(text: &str) -> Result<Vec<String>, String> {
        let of_first = |table: super::super::super::reader::Table<'_>| Parameter::new(table.entries()[0]);
        read(Path::new("jobs.toml"), text, of_first).map(|found| found.values).map_err(|failure| failure.message)
    }

    #[test]
    fn lists_and_ranges_become_texts() {
        let values = |text: &str| parameter(text).unwrap().join("|");
        assert_eq!(values("a = [1, 0.50, 'x', true, [0.1, 0.2, 0.3]]"), "1|0.50|x|true|0.1 0.2 0.3");
        assert_eq!(values("a = { from = 0, to = 0.3, step = 0.1 }"), "0|0.1|0.2|0.3");
        assert_eq!(values("a = { from = 3, to = 1, step = -1 }"), "3|2|1");
        assert_eq!(values("a = { from = -1, to = 1, count = 5 }"), "-1|-0.5|0|0.5|1");
        assert_eq!(values("a = { from = 0, to = 1, step = 0.4 }"), "0|0.4|0.8");
        assert_eq!(values("a = { from = 1e-9, to = 3e-9, count = 3 }"), "0.000000001|0.000000002|0.000000003");
    }

    #[test]
    fn rows_are_read_with_quotes_and_without_blanks() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "power, view\n0.5 ,\"eye=1,2,3\"\n 2,\n").unwrap();
        let said = Said { key: String::new(), text: String::new(), place: String::new() };
        let found = read_rows(&said, file.path()).unwrap();
        assert_eq!(
            (found.names, found.rows),
            (vec!["power".into(), "view".into()], vec![vec!["0.5".into(), "eye=1,2,3".into()], vec!["2".into(), String::new()]])
        );
    }

    #[test]
    fn what_is_no_range_is_told_with_line_and_key() {
        for (text, words) in [
            ("\na = 1", "jobs.toml:2: a: it must be a list"),
            ("a = []", "jobs.toml:1: a: it has no value"),
            ("a = { from = 1 }", "a range has 'from' and 'to'"),
            ("a = { from = 1, to = 2 }", "either 'step' or 'count'"),
            ("a = { from = 1, to = 2, step = 1, count = 2 }", "either 'step' or 'count'"),
            ("a = { from = 1, to = 2, step = 0 }", "does not lead"),
            ("a = { from = 1, to = 2, step = -1 }", "does not lead"),
            ("a = { from = 1, to = 2, count = 1 }", "at least 2"),
            ("a = { from = 0, to = 1, step = 1e-9 }", "more than 1000000"),
            ("a = { from = 0, to = 'b', step = 1 }", "jobs.toml:1: a.to: 'b' is no number"),
            ("a = { from = 0, too = 1 }", "jobs.toml:1: a.too: there is no such key"),
            ("a = 1979-05-27", "jobs.toml:1: a: it must be a list"),
            ("a = [0x10]", "a decimal number"),
            ("a = [", "jobs.toml:1: "),
        ] {
            let message = parameter(text).unwrap_err();
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
