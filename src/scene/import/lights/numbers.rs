//! The numbers of a photometric file, one after the other, and what is wrong with them by their lines.

use std::path::Path;

use super::super::ImportError;

/// The numbers of a file, one after the other.
pub(super) struct Numbers<'a> {
    path: &'a Path,
    /// With their lines, from 1.
    words: Box<dyn Iterator<Item = (u32, &'a str)> + 'a>,
    /// The line of the last one.
    line: u32,
    /// Whether tilts come first.
    pub has_tilt: bool,
    pub is_of_2019: bool,
}

impl<'a> Numbers<'a> {
    /// Those behind the line that tells of the tilt.
    pub fn after_tilt(path: &'a Path, text: &'a str) -> Result<Self, ImportError> {
        let mut lines = (1..).zip(text.lines());
        let is_of_2019 = text.lines().next().is_some_and(|line| line.trim().eq_ignore_ascii_case("IES:LM-63-2019"));
        let tilt = lines.find_map(|(line, text)| {
            let (key, value) = text.split_once('=')?;
            key.trim().eq_ignore_ascii_case("TILT").then(|| (line, value.trim().to_ascii_uppercase()))
        });
        let wrong = |line, reason: &str| ImportError::Syntax { file: path.to_owned(), line, face: None, reason: reason.to_owned() };
        let has_tilt = match tilt {
            Some((_, value)) if value == "NONE" => false,
            Some((_, value)) if value == "INCLUDE" => true,
            Some((line, _)) => {
                return Err(wrong(line, "the tilt is in another file: write TILT=INCLUDE and put it here, or TILT=NONE"));
            }
            None => return Err(wrong(0, "it has no line TILT=...: it is no photometric file (IESNA LM-63)")),
        };
        // A file may end with the end-of-file character of DOS.
        let separates = |c: char| c.is_whitespace() || c == ',' || c == '\u{1a}';
        let words =
            lines.flat_map(move |(line, text)| text.split(separates).filter(|word| !word.is_empty()).map(move |word| (line, word)));
        Ok(Self { path, words: Box::new(words), line: 0, has_tilt, is_of_2019 })
    }

    /// What is wrong with the last one.
    pub fn wrong(&self, reason: impl std::fmt::Display) -> ImportError {
        ImportError::Syntax { file: self.path.to_owned(), line: self.line, face: None, reason: reason.to_string() }
    }

    /// The next one.
    pub fn next(&mut self, what: &str) -> Result<f64, ImportError> {
        let Some((line, word)) = self.words.next() else {
            return Err(self.wrong(format_args!("the file ends where {what} should be: it is not whole")));
        };
        self.line = line;
        let number = word.parse().ok().filter(|number: &f64| number.abs() <= 1e30);
        number.ok_or_else(|| self.wrong(format_args!("'{word}' stands where {what} should be, a number")))
    }

    /// The next one, which lies between these.
    pub fn between(&mut self, what: &str, low: f64, high: f64) -> Result<f64, ImportError> {
        let number = self.next(what)?;
        let fits = (low..=high).contains(&number);
        if fits { Ok(number) } else { Err(self.wrong(format_args!("{what} is {number}, it must be from {low} to {high}"))) }
    }

    /// The next one, which is whole and at least so much.
    pub fn count(&mut self, what: &str, least: usize) -> Result<usize, ImportError> {
        let number = self.between(what, least as f64, 1e9)?;
        if number.fract() == 0.0 {
            Ok(number as usize)
        } else {
            Err(self.wrong(format_args!("{what} is {number}, no whole number")))
        }
    }

    /// Rising angles in degrees.
    pub fn angles(&mut self, what: &str, count: usize) -> Result<Vec<f64>, ImportError> {
        let mut angles: Vec<f64> = Vec::new();
        for _ in 0..count {
            let angle = self.between(what, 0.0, 360.0)?;
            if let Some(last) = angles.last().filter(|last| **last >= angle) {
                return Err(self.wrong(format_args!("{what} is {angle} behind {last}: they must rise")));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    /// Nothing may follow.
    pub fn end(&mut self) -> Result<(), ImportError> {
        match self.words.next() {
            None => Ok(()),
            Some((line, word)) => {
                self.line = line;
                Err(self.wrong(format_args!("'{word}' follows the last intensity: there are more than the numbers of angles say")))
            }
        }
    }
}
