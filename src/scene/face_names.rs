//! What the faces of a file belong to, by its own names: objects, groups.

use serde::{Deserialize, Serialize};

/// No name.
const NONE: u32 = u32::MAX;

/// A name for each face of the input, or none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaceNames {
    /// Names in the order of their first use.
    names: Vec<String>,
    /// By face, the number of its name; faces beyond the end have none.
    of_face: Vec<u32>,
}

impl FaceNames {
    /// The names, in the order of their first use.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The number of a face's name, faces counting from 0.
    pub fn of(&self, face: u32) -> Option<usize> {
        self.of_face.get(face as usize).filter(|&&name| name != NONE).map(|&name| name as usize)
    }

    /// Gives the next face the name of this number.
    pub(super) fn push(&mut self, name: Option<u32>) {
        self.of_face.push(name.unwrap_or(NONE));
    }

    /// Adds a name.
    pub(super) fn add(&mut self, name: String) -> u32 {
        self.names.push(name);
        self.names.len() as u32 - 1
    }

    /// The same, of which nothing is kept if no face has a name.
    pub(super) fn trimmed(self) -> Self {
        if self.of_face.iter().all(|&name| name == NONE) { Self::default() } else { self }
    }

    /// Whether every number is that of a name.
    pub(super) fn is_valid(&self) -> bool {
        self.of_face.iter().all(|&name| name == NONE || (name as usize) < self.names.len())
    }
}
