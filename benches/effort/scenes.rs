//! The scenes over which the law is fitted.

use std::path::Path;

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};

/// Scenes of the repository, and those beside it.
const OWN: [&str; 9] =
    ["cornell", "dining_room", "four_polygons", "full_office", "hevea", "living_room", "room", "two_rooms", "west_room"];
const BY_OTHERS: [&str; 5] = ["cornell_mcguire", "corridor", "oa_czest1dm", "office2", "sh3d_room"];

/// All that are there, by name.
pub fn all() -> impl Iterator<Item = (String, Scene)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = OWN.map(|name| (name, root.join(format!("scenes/{name}.obj"))));
    let by_others = BY_OTHERS.map(|name| (name, root.join(format!("../shared/scenes/{name}/scene.obj"))));
    own.into_iter().chain(by_others).filter_map(|(name, file)| Some((name.replace('_', " "), read(&file)?)))
}

/// The Cornell box.
pub fn cornell() -> Scene {
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj")).expect("a scene of the repository")
}

fn read(file: &Path) -> Option<Scene> {
    file.is_file().then(|| read_scene(file, &ImportOptions::default()).expect("a scene that can be read").scene)
}
