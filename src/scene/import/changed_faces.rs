//! Faces of which the scene holds something else than the input says.

use glam::DVec3;

/// Faces that were dropped or flattened, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChangedFaces {
    /// Those that are not in the scene.
    pub dropped: Vec<DroppedFace>,
    /// The 0-based numbers of those whose corners were moved onto a plane, by less than the digits of the file are worth.
    pub flattened: Vec<u32>,
}

/// A face that is not in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DroppedFace {
    /// Its 0-based number in the input.
    pub face: u32,
    /// The 0-based number of the earlier face that it repeats; `None` of a face without area.
    pub repeats: Option<u32>,
    /// The mean of its corners, in metres.
    pub place: [f64; 3],
}

impl ChangedFaces {
    /// Notes a face that is dropped.
    pub(super) fn drop(&mut self, face: u32, corners: &[DVec3], repeats: Option<u32>) {
        let origin = corners.first().copied().unwrap_or_default();
        let offset: DVec3 = corners.iter().map(|&corner| (corner - origin) / corners.len() as f64).sum();
        self.dropped.push(DroppedFace { face, repeats, place: (origin + offset).to_array() });
    }
}
