//! What generators give.

use patchlight::scene::Scene;
use patchlight::visibility::Backend;

use super::super::path_tracer::Portal;
use super::super::rooms::Room;

/// What a generator gives.
pub struct Made {
    pub scene: Scene,
    /// Where paths of the reference are aimed at.
    pub portal: Option<Portal>,
    /// Who answers rays of the reference.
    pub backend: Backend,
}

impl Made {
    pub fn of(room: Room) -> Self {
        Self { scene: room.scene(), portal: None, backend: Backend::Auto }
    }

    /// The same with a portal.
    pub fn through(self, portal: Portal) -> Self {
        Self { portal: Some(portal), ..self }
    }
}
