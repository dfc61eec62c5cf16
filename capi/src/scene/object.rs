//! A scene behind its handle: what was added, then what can be solved.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use patchlight::scene::import::Draft;
use patchlight::scene::{LightGrouping, Sides};

use super::build::{Committed, build};
use super::note::Note;
use crate::context::Context;
use crate::handles::Handle;
use crate::status::{Ending, Outcome, PATCHLIGHT_WRONG_STATE};

/// What is lit. Put together, then committed, and unchangeable from there on.
pub struct patchlight_scene {
    _private: [u8; 0],
}

impl Handle for patchlight_scene {
    type Target = SceneObject;
    const NAME: &'static str = "scene";
}

/// Behind a handle.
pub struct SceneObject {
    pub context: Arc<Context>,
    state: Mutex<State>,
}

/// What there is of a scene.
pub struct State {
    pub draft: Draft,
    /// How its lights are grouped, if they are.
    grouping: Option<LightGrouping>,
    /// Once it is committed.
    scene: Option<Arc<Committed>>,
    /// What the last commit noted.
    pub notes: Vec<Note>,
}

impl SceneObject {
    pub fn new(context: Arc<Context>, channels: usize, sides: Sides) -> Self {
        let state = State { draft: Draft::new(channels, sides), grouping: None, scene: None, notes: Vec::new() };
        Self { context, state: Mutex::new(state) }
    }

    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The scene, if it is committed.
    pub fn committed(&self) -> Outcome<Arc<Committed>> {
        let message = "the scene is not committed: call patchlight_scene_commit first";
        self.state().scene.clone().ok_or_else(|| Ending::new(PATCHLIGHT_WRONG_STATE, message))
    }

    /// What is not committed yet.
    fn open(&self) -> Outcome<MutexGuard<'_, State>> {
        let state = self.state();
        if state.scene.is_some() {
            return Err(Ending::new(PATCHLIGHT_WRONG_STATE, "the scene is committed and cannot be changed: make a new one"));
        }
        Ok(state)
    }

    /// Changes what is not committed yet.
    pub fn change(&self, change: impl FnOnce(&mut Draft) -> Outcome) -> Outcome {
        change(&mut self.open()?.draft)
    }

    /// Changes how lights are grouped, of what is not committed yet.
    pub fn group_lights(&self, change: impl FnOnce(&mut Option<LightGrouping>)) -> Outcome {
        change(&mut self.open()?.grouping);
        Ok(())
    }

    /// Makes a scene of what was added, and returns what was repaired or is suspicious.
    pub fn commit(&self) -> Outcome<Vec<String>> {
        let mut state = self.state();
        if state.scene.is_some() {
            return Err(Ending::new(PATCHLIGHT_WRONG_STATE, "the scene is committed already"));
        }
        // The lock is held by this thread: a worker that waits for others may take up work that asks for the same lock.
        let State { draft, grouping, .. } = &*state;
        let (built, notes) = self.context.workers.install(|| build(draft, grouping.as_ref()));
        state.notes = notes;
        let committed = Arc::new(built?);
        let warnings = committed.warnings.clone();
        state.scene = Some(committed);
        state.draft.clear();
        Ok(warnings)
    }
}
