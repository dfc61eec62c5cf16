//! A scene that runs are made on, in a file, and where its reference lies.

use std::path::{Path, PathBuf};

use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, Sides};
use patchlight::visibility::Backend;

use super::options::Options;
use super::path_tracer::Portal;
use super::reference::Reference;
use super::scenes::HardScene;
use super::{making, obj, scenes};

pub struct Subject {
    pub name: String,
    pub file: PathBuf,
    /// With which it is read.
    pub sides: Sides,
    scene: Scene,
    portal: Option<Portal>,
    backend: Backend,
    reference: PathBuf,
    /// Whether the reference is made wherever there is none: those of the repository's scenes belong to it.
    is_own: bool,
}

impl Subject {
    /// A scene of the suite; its file goes to the folder, its reference lies in the repository.
    pub fn of_suite(hard: &HardScene, root: &Path, folder: &Path) -> Self {
        let made = hard.make();
        let (file, scene) = obj::through_obj(&made.scene, folder, hard.name);
        let reference = root.join(format!("benches/hard_scenes/references/{}.csv", hard.name));
        let (name, sides, is_own) = (hard.name.to_owned(), Sides::Front, false);
        Self { name, file, sides, scene, portal: made.portal, backend: made.backend, reference, is_own }
    }

    /// A scene of the user's; its reference lies in the folder.
    pub fn of_file(file: &Path, sides: Sides, folder: &Path) -> Self {
        let name = file.file_stem().map_or_else(|| "scene".to_owned(), |name| name.to_string_lossy().into_owned());
        let read = read_scene(file, &ImportOptions { sides, ..ImportOptions::default() })
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let reference = folder.join(format!("{name}_reference.csv"));
        let (scene, portal, backend) = (read.scene, None, Backend::Auto);
        Self { name, file: file.to_owned(), sides, scene, portal, backend, reference, is_own: true }
    }

    /// A random room; its file and its reference go to the folder.
    pub fn of_random(number: u64, folder: &Path) -> Self {
        let (made, name) = (scenes::random_room(number), format!("random_{number}"));
        let (file, scene) = obj::through_obj(&made.scene, folder, &name);
        let reference = folder.join(format!("{name}_reference.csv"));
        let (sides, portal, backend) = (Sides::Front, made.portal, made.backend);
        Self { name, file, sides, scene, portal, backend, reference, is_own: true }
    }

    /// What is right in the scene, made if that is asked for.
    pub fn reference(&self, options: &Options) -> Reference {
        if options.references || (self.is_own && !self.reference.exists()) {
            eprintln!("{}: {} surfaces", self.name, self.scene.surfaces().len());
            let made = making::make(&self.scene, self.portal, self.backend, options.most_rays);
            made.write(&self.reference).expect("a reference is written");
        }
        let read = Reference::read(&self.reference, &self.scene);
        read.unwrap_or_else(|error| panic!("{}: {error}; --references makes it", self.reference.display()))
    }
}
