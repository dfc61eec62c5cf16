//! The list of the scenes.

use super::{cornell, furnace, room};

/// Name and content of every file.
pub fn all() -> Vec<(String, String)> {
    [("cornell", cornell::cornell()), ("furnace", furnace::furnace()), ("room", room::room())]
        .into_iter()
        .flat_map(|(name, model)| {
            let (obj, mtl) = model.write(name);
            [(format!("{name}.obj"), obj), (format!("{name}.mtl"), mtl)]
        })
        .collect()
}
