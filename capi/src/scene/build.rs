//! From what was added to a scene that can be solved.

use patchlight::scene::Scene;
use patchlight::scene::import::Draft;

use super::note::Note;
use crate::status::{Ending, Outcome, PATCHLIGHT_INVALID_SCENE};

/// A scene that can be solved.
pub struct Committed {
    pub scene: Scene,
    /// The files that it was read from, if any.
    pub files: String,
    /// What was repaired or is suspicious.
    pub warnings: Vec<String>,
}

/// The scene, and what was noted.
pub fn build(draft: &Draft) -> (Outcome<Committed>, Vec<Note>) {
    match draft.build() {
        Ok((scene, diagnostics)) => {
            let files: Vec<String> = draft.files.iter().map(|file| file.file.display().to_string()).collect();
            let notes = diagnostics.items.iter().map(Note::of).collect();
            (Ok(Committed { scene, files: files.join(", "), warnings: diagnostics.warnings() }), notes)
        }
        Err(error) => {
            let notes = error.diagnostics.items.iter().map(Note::of).chain(error.mistakes.iter().map(Note::of_mistake)).collect();
            (Err(Ending::new(PATCHLIGHT_INVALID_SCENE, error)), notes)
        }
    }
}
