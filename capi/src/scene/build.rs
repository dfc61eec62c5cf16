//! From what was added to a scene that can be solved.

use patchlight::scene::import::Draft;
use patchlight::scene::{LightGrouping, Scene};

use super::note::Note;
use crate::status::{Ending, Outcome, PATCHLIGHT_INVALID_SCENE};

/// A scene that can be solved.
pub struct Committed {
    pub scene: Scene,
    /// The files that it was read from, if any.
    pub files: String,
    /// What was repaired or is suspicious.
    pub warnings: Vec<String>,
    /// The faces that these are about, from 1.
    pub warned_faces: Vec<Option<u32>>,
}

/// The scene, with its lights grouped if they are, and what was noted.
pub fn build(draft: &Draft, grouping: Option<&LightGrouping>) -> (Outcome<Committed>, Vec<Note>) {
    match draft.build() {
        Ok((scene, diagnostics)) => {
            let grouped = match grouping {
                None => Ok(scene),
                Some(grouping) => scene.with_light_groups(grouping).map_err(|error| Ending::new(PATCHLIGHT_INVALID_SCENE, error)),
            };
            let files: Vec<String> = draft.files.iter().map(|file| file.file.display().to_string()).collect();
            let notes = diagnostics.items.iter().map(Note::of).collect();
            let (files, warnings, warned_faces) = (files.join(", "), diagnostics.warnings(), diagnostics.warned_faces());
            (grouped.map(|scene| Committed { scene, files, warnings, warned_faces }), notes)
        }
        Err(error) => {
            let notes = error.diagnostics.items.iter().map(Note::of).chain(error.mistakes.iter().map(Note::of_mistake)).collect();
            (Err(Ending::new(PATCHLIGHT_INVALID_SCENE, error)), notes)
        }
    }
}
