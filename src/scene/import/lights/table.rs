//! Tables of a TOML file: values by their keys, and whatever is wrong told with file and line.

use std::cell::RefCell;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::super::ImportError;

/// A file that is read.
pub(super) struct Text<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl Text<'_> {
    /// The line of a byte, from 1.
    fn line(&self, at: usize) -> u32 {
        let before = self.text.as_bytes()[..at.min(self.text.len())].iter().filter(|&&byte| byte == b'\n').count();
        u32::try_from(1 + before).unwrap_or(u32::MAX)
    }

    /// What is wrong at a byte.
    pub fn wrong(&self, at: usize, reason: impl std::fmt::Display) -> ImportError {
        ImportError::Syntax { file: self.path.to_owned(), line: self.line(at), face: None, reason: reason.to_string() }
    }
}

/// A table. Keys are known once they are asked for.
pub(super) struct Table<'a> {
    text: &'a Text<'a>,
    table: &'a DeTable<'a>,
    at: usize,
    asked: RefCell<Vec<&'static str>>,
}

/// What stands behind a key.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    text: &'a Text<'a>,
    /// Its key.
    pub key: &'static str,
    at: usize,
    value: &'a DeValue<'a>,
}

impl<'a> Table<'a> {
    /// A table that begins at a byte.
    pub fn new(text: &'a Text<'a>, table: &'a DeTable<'a>, at: usize) -> Self {
        Self { text, table, at, asked: RefCell::default() }
    }

    /// What stands behind a key.
    pub fn get(&self, key: &'static str) -> Option<Value<'a>> {
        self.asked.borrow_mut().push(key);
        let (found, value) = self.table.get_key_value(key)?;
        Some(Value { text: self.text, key, at: found.span().start, value: value.get_ref() })
    }

    /// What stands behind the one of these keys that is there.
    pub fn one_of(&self, keys: &[&'static str]) -> Result<Option<Value<'a>>, ImportError> {
        let found: Vec<Value<'a>> = keys.iter().filter_map(|&key| self.get(key)).collect();
        match found[..] {
            [first, second, ..] => {
                Err(second.wrong(format_args!("'{}' and '{}' say the same thing: leave one of them out", first.key, second.key)))
            }
            _ => Ok(found.first().copied()),
        }
    }

    /// What stands behind a key that must be there.
    pub fn needed(&self, key: &'static str, example: &str) -> Result<Value<'a>, ImportError> {
        self.get(key).ok_or_else(|| self.wrong(format_args!("'{key}' is missing: write it, as in {key} = {example}")))
    }

    /// The line that it begins on.
    pub fn line(&self) -> u32 {
        self.text.line(self.at)
    }

    /// It is wrong.
    pub fn wrong(&self, reason: impl std::fmt::Display) -> ImportError {
        self.text.wrong(self.at, reason)
    }

    /// An error if it has keys that nobody asked for.
    pub fn check_keys(&self) -> Result<(), ImportError> {
        let asked = self.asked.borrow();
        let unknown = self.table.keys().filter(|key| !asked.contains(&key.get_ref().as_ref())).min_by_key(|key| key.span().start);
        unknown.map_or(Ok(()), |key| {
            let known = asked.join(", ");
            Err(self
                .text
                .wrong(key.span().start, format_args!("there is no key '{}' here, it must be one of {known}", key.get_ref())))
        })
    }
}

impl<'a> Value<'a> {
    /// It is wrong.
    pub fn wrong(self, reason: impl std::fmt::Display) -> ImportError {
        self.text.wrong(self.at, reason)
    }

    /// A text.
    pub fn text(self) -> Result<&'a str, ImportError> {
        match self.value {
            DeValue::String(text) => Ok(text),
            _ => Err(self.wrong(format_args!("'{}' must be a text in quotes", self.key))),
        }
    }

    /// A number from `low` to `high`.
    pub fn number(self, low: f64, high: f64) -> Result<f64, ImportError> {
        let number = self.number_of(self.value)?;
        if !(low..=high).contains(&number) {
            return Err(self.wrong(format_args!("'{}' is {number}, it must be from {low} to {high}", self.key)));
        }
        Ok(number)
    }

    /// One number of 0 or more for all of so many channels, or one for each.
    pub fn channels(self, channels: usize) -> Result<Vec<f64>, ImportError> {
        let numbers = match self.value {
            DeValue::Array(_) => self.numbers()?,
            one => vec![self.number_of(one)?; channels],
        };
        if numbers.len() != channels {
            let (key, count) = (self.key, numbers.len());
            return Err(self.wrong(format_args!("'{key}' has {count} numbers, the scene {channels} channels: give one for each")));
        }
        match numbers.iter().find(|number| **number < 0.0) {
            Some(number) => Err(self.wrong(format_args!("'{}' is {number}, it must be 0 or more", self.key))),
            None => Ok(numbers),
        }
    }

    /// Three coordinates.
    pub fn vector(self) -> Result<[f64; 3], ImportError> {
        let numbers = if self.value.is_array() { self.numbers()? } else { Vec::new() };
        numbers.try_into().map_err(|_| self.wrong(format_args!("'{}' must be three numbers, as in [0, 2.5, 1]", self.key)))
    }

    /// Whether it is a text.
    pub fn is_text(self) -> bool {
        self.value.is_str()
    }

    fn numbers(self) -> Result<Vec<f64>, ImportError> {
        let DeValue::Array(items) = self.value else { return Err(self.no_number()) };
        items.iter().map(|item| self.number_of(item.get_ref())).collect()
    }

    fn number_of(self, value: &DeValue<'_>) -> Result<f64, ImportError> {
        let text = match value {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => return Err(self.no_number()),
        };
        match text.parse::<f64>() {
            Ok(number) if number.abs() <= LARGEST => Ok(number),
            _ => Err(self.wrong(format_args!("'{}' is {text}, not a number below {LARGEST:e}", self.key))),
        }
    }

    fn no_number(self) -> ImportError {
        self.wrong(format_args!("'{}' must be a decimal number, or a list of them where there are several", self.key))
    }
}

/// Numbers may not be larger than this, as in all files.
const LARGEST: f64 = 1e30;
