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

    /// The name of a face, faces counting from 0.
    pub fn name_of(&self, face: u32) -> Option<&str> {
        self.of(face).map(|name| self.names[name].as_str())
    }

    /// Gives so many faces that follow a name of their own, or none if it is empty.
    pub fn push_run(&mut self, name: &str, faces: usize) {
        let name = if name.is_empty() { NONE } else { self.add(name.to_owned()) };
        self.of_face.extend(std::iter::repeat_n(name, faces));
    }

    /// Adds the names of other faces, which follow after the first `before`.
    pub(super) fn append(&mut self, before: u32, others: &Self) {
        let known = self.names.len() as u32;
        self.of_face.resize(before as usize, NONE);
        self.of_face.extend(others.of_face.iter().map(|&name| if name == NONE { NONE } else { known + name }));
        self.names.extend_from_slice(&others.names);
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
