//! Objects and groups of an OBJ file: `o name` and `g name ...` hold for the faces behind them, until the next.

use std::collections::HashMap;

use crate::scene::FaceNames;

/// The names of one kind, as they are read.
#[derive(Default)]
pub(super) struct NamesReader {
    names: FaceNames,
    by_name: HashMap<String, u32>,
    current: Option<u32>,
}

impl NamesReader {
    /// The faces that follow have this name; without one, none.
    pub fn start(&mut self, name: &str) {
        let name = name.split_whitespace().collect::<Vec<&str>>().join(" ");
        self.current = (!name.is_empty()).then(|| match self.by_name.get(&name) {
            Some(&number) => number,
            None => {
                let number = self.names.add(name.clone());
                self.by_name.insert(name, number);
                number
            }
        });
    }

    /// A face follows.
    pub fn face(&mut self) {
        self.names.push(self.current);
    }

    /// All that were read.
    pub fn finish(self) -> FaceNames {
        self.names.trimmed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_hold_until_the_next_and_come_again() {
        let mut reader = NamesReader::default();
        reader.face();
        for (name, faces) in [("table  top", 2), ("", 1), ("chair", 1), ("table top", 1)] {
            reader.start(name);
            (0..faces).for_each(|_| reader.face());
        }
        let names = reader.finish();
        assert_eq!(names.names(), ["table top", "chair"]);
        let of: Vec<Option<usize>> = (0..8).map(|face| names.of(face)).collect();
        assert_eq!(of, [None, Some(0), Some(0), None, Some(1), Some(0), None, None]);
        assert!(names.is_valid());
        let mut nameless = NamesReader::default();
        nameless.face();
        assert_eq!(nameless.finish(), FaceNames::default());
    }
}
