//! TOML with the lines that its texts stand on. Whatever is wrong is told with file, line and key.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::exit::Failure;

/// A text of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// The last part of its key.
    pub key: String,
    /// What it says; numbers as they are written.
    pub text: String,
    /// File, line and full key.
    pub place: String,
}

impl Said {
    /// It is wrong.
    pub fn wrong(&self, why: impl std::fmt::Display) -> Failure {
        Failure::bad_input(format_args!("{}: {why}", self.place))
    }
}

/// A table of the file.
#[derive(Clone, Copy)]
pub struct Table<'a> {
    file: &'a File<'a>,
    /// Its full key with a dot behind it, or nothing at the top.
    prefix: &'a str,
    table: &'a DeTable<'a>,
}

/// A key of a table, with what stands behind it.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    file: &'a File<'a>,
    /// The last part of its key.
    pub key: &'a str,
    prefix: &'a str,
    at: usize,
    value: &'a DeValue<'a>,
}

/// A file that is read.
struct File<'a> {
    path: &'a Path,
    text: &'a str,
}

impl File<'_> {
    fn line(&self, at: usize) -> usize {
        1 + self.text.as_bytes()[..at.min(self.text.len())].iter().filter(|&&byte| byte == b'\n').count()
    }

    fn wrong(&self, at: usize, why: impl std::fmt::Display) -> Failure {
        Failure::bad_input(format_args!("{}:{}: {why}", self.path.display(), self.line(at)))
    }
}

/// Parses `text`, the text of the file at `path`, and gives its table at the top to `read`.
pub fn read<R>(path: &Path, text: &str, read: impl FnOnce(Table<'_>) -> Result<R, Failure>) -> Result<R, Failure> {
    let file = File { path, text };
    let parsed = DeTable::parse(text).map_err(|error| file.wrong(error.span().map_or(0, |span| span.start), error.message()))?;
    read(Table { file: &file, prefix: "", table: parsed.get_ref() })
}

impl<'a> Table<'a> {
    /// What stands in it, in the order of the file.
    pub fn entries(self) -> Vec<Entry<'a>> {
        let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let name: &'a std::borrow::Cow<'a, str> = key.get_ref();
            Entry { file: self.file, key: name, prefix: self.prefix, at: key.span().start, value: value.get_ref() }
        };
        let mut entries: Vec<Entry<'a>> = self.table.iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.at);
        entries
    }
}

impl<'a> Entry<'a> {
    /// File, line and full key.
    pub fn place(self) -> String {
        format!("{}:{}: {}{}", self.file.path.display(), self.file.line(self.at), self.prefix, self.key)
    }

    /// It is wrong.
    pub fn wrong(self, why: impl std::fmt::Display) -> Failure {
        Failure::bad_input(format_args!("{}: {why}", self.place()))
    }

    /// There is no such key.
    pub fn unknown(self, known: &[&str]) -> Failure {
        self.wrong(format_args!("there is no such key, it must be one of {}", known.join(", ")))
    }

    /// The table that it is.
    pub fn table<R>(self, read: impl FnOnce(Table<'_>) -> Result<R, Failure>) -> Result<R, Failure> {
        let DeValue::Table(table) = self.value else { return Err(self.wrong("it must be a table")) };
        read(Table { file: self.file, prefix: &format!("{}{}.", self.prefix, self.key), table })
    }

    /// Whether it is a table.
    pub fn is_table(self) -> bool {
        self.value.is_table()
    }

    /// A text, a number, `true` or `false`.
    pub fn said(self) -> Result<Said, Failure> {
        self.said_by(self.value)
    }

    /// One text or number, or one of several numbers: these are kept with blanks between.
    pub fn said_or_numbers(self) -> Result<Said, Failure> {
        self.numbers_by(self.value)
    }

    /// One or several of [`Entry::said`].
    pub fn several(self) -> Result<Vec<Said>, Failure> {
        match self.value {
            DeValue::Array(items) => items.iter().map(|item| self.said_by(item.get_ref())).collect(),
            one => Ok(vec![self.said_by(one)?]),
        }
    }

    /// The items of a list, each of [`Entry::said_or_numbers`].
    pub fn list(self) -> Result<Vec<Said>, Failure> {
        let DeValue::Array(items) = self.value else { return Err(self.wrong("it must be a list, as in [1, 2, 3]")) };
        items.iter().map(|item| self.numbers_by(item.get_ref())).collect()
    }

    fn numbers_by(self, value: &DeValue<'_>) -> Result<Said, Failure> {
        let DeValue::Array(numbers) = value else { return self.said_by(value) };
        let texts: Vec<String> =
            numbers.iter().map(|number| Ok(self.said_by(number.get_ref())?.text)).collect::<Result<_, Failure>>()?;
        Ok(self.with(texts.join(" ")))
    }

    fn said_by(self, value: &DeValue<'_>) -> Result<Said, Failure> {
        let text = match value {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().to_owned(),
            DeValue::Float(number) => number.as_str().to_owned(),
            DeValue::Boolean(yes) => yes.to_string(),
            _ => return Err(self.wrong("it must be a text, a decimal number, true or false")),
        };
        Ok(self.with(text))
    }

    fn with(self, text: String) -> Said {
        Said { key: self.key.to_owned(), text, place: self.place() }
    }
}
