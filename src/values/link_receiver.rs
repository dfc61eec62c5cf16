//! Where light is gathered over links.

use glam::DVec3;

use crate::hierarchy::NodeId;

/// Which light of lights a gather adds, beside that of surfaces.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum WhichLights {
    All,
    Skies,
    None,
}

/// Where light is gathered, with what the gather reads often.
pub(super) struct Receiver<'a> {
    pub point: DVec3,
    pub normal: DVec3,
    pub plane: u32,
    /// What counts of the light, by channel: the part that is reflected on a surface, in space all of it.
    pub reflectance: &'a [f64],
    /// The leaf that it lies on; `None` in space.
    pub leaf: Option<NodeId>,
    pub seed: u64,
    /// Which light of lights is added.
    pub lights: WhichLights,
}
