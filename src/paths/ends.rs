//! Where paths end, and the light that they collected before.

use glam::DVec3;

use super::grid::NO_CELL;

/// A place lies inside a solid if more than this part of the rays from there meets backs first.
pub(crate) const INSIDE: f32 = 0.5;

/// Where paths end, path after path. A path that ends where its first ray arrives brings the radiosity of the cell there.
#[derive(Default)]
pub(crate) struct Ends {
    /// By path, the cell where its first ray arrives; [`NO_CELL`] if there is none, or if the path went on.
    pub cell: Vec<u32>,
    /// By path, the point in that cell.
    pub point: Vec<DVec3>,
    /// By path, whether its first ray met a back.
    pub back: Vec<bool>,
    /// The paths that went on, in their order.
    pub continued: Vec<Continuation>,
    /// By continuation and channel: it brings `constant + weight * B`, B being the radiosity of the cell where it ends.
    pub constant: Vec<f64>,
    pub weight: Vec<f64>,
    /// Cells of reflectors that next-event rays of continuations see: the number of the continuation, and the cell.
    pub seen: Vec<(usize, u32)>,
    /// By entry of `seen` and channel: it brings `weight * B`, B being the radiosity of the cell.
    pub seen_weight: Vec<f64>,
}

/// A path that went on from where its first ray arrived.
pub(crate) struct Continuation {
    pub path: usize,
    /// The cell where it ends.
    pub cell: u32,
    /// The cell where the first ray arrived, if only the least number of bounces kept the path from ending there; else [`NO_CELL`].
    pub shortcut: u32,
}

impl Ends {
    /// By place, each with `count` paths: whether it lies inside a solid.
    pub fn inside(&self, count: u32) -> Vec<bool> {
        let is_inside = |backs: &[bool]| backs.iter().filter(|&&back| back).count() as f32 > INSIDE * count as f32;
        self.back.chunks(count as usize).map(is_inside).collect()
    }

    /// Forgets everything, and makes room for so many paths.
    pub(super) fn clear(&mut self, paths: usize) {
        self.cell.clear();
        self.cell.resize(paths, NO_CELL);
        self.point.resize(paths, DVec3::ZERO);
        self.back.clear();
        self.back.resize(paths, false);
        self.continued.clear();
        self.seen.clear();
        self.seen_weight.clear();
    }
}
