//! What generators give.

use patchlight::scene::Scene;
use patchlight::visibility::Backend;

use super::super::path_tracer::Portal;
use super::super::rooms::Room;

/// What a generator gives.
pub struct Made {
    pub scene: Scene,
    /// Where paths of the reference are aimed at.
    pub portals: Vec<Portal>,
    /// Who answers rays of the reference.
    pub backend: Backend,
}

impl Made {
    pub fn of(room: Room) -> Self {
        Self { scene: room.scene(), portals: Vec::new(), backend: Backend::Auto }
    }

    /// The same with portals.
    pub fn through(self, portals: &[Portal]) -> Self {
        Self { portals: portals.to_vec(), ..self }
    }
}
