//! Objects: which faces belong together, and what they are called.

use serde::{Deserialize, Serialize};

/// An object of the input: it has the faces from its first to that of the next object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Object {
    /// What it is called, as in `table/top`; empty for faces without a name.
    pub name: String,
    /// The 0-based number of its first face.
    pub first_face: u32,
}

/// The name of the object that a face belongs to.
pub(super) fn name_in(objects: &[Object], face: u32) -> Option<&str> {
    let after = objects.partition_point(|object| object.first_face <= face);
    let name = after.checked_sub(1).map(|index| objects[index].name.as_str());
    name.filter(|name| !name.is_empty())
}
