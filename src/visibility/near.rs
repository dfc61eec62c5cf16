//! Which surfaces come near a place, or reach between some planes.

use glam::DVec3;

use super::box_tree::{BoxTree, HalfSpace};
use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

/// The boxes of surfaces.
pub(crate) struct SurfaceBoxes {
    tree: BoxTree,
    /// The surfaces that have a box, in their order; empty where all have one.
    surfaces: Vec<SurfaceId>,
}

impl SurfaceBoxes {
    /// Bytes that a surface takes: its number, its box as given, and two nodes of the tree with what it is built from.
    pub const BYTES_OF_SURFACE: usize = 4 + 32 + 2 * 64 + 4;

    /// Of all surfaces.
    pub fn of(scene: &Scene) -> Self {
        let tree = BoxTree::of(scene.surfaces().iter().map(|surface| surface.polygon.bounds()));
        Self { tree, surfaces: Vec::new() }
    }

    /// Of the sheets of a scene: of one with two sides the first surface alone.
    pub fn of_sheets(scene: &Scene) -> Self {
        let is_first = |id: &SurfaceId| scene.surface(*id).twin().is_none_or(|twin| *id < twin);
        let surfaces: Vec<SurfaceId> = (0..scene.surfaces().len() as u32).map(SurfaceId).filter(is_first).collect();
        if surfaces.len() == scene.surfaces().len() {
            return Self::of(scene);
        }
        Self { tree: BoxTree::of(surfaces.iter().map(|&id| scene.surface(id).polygon.bounds())), surfaces }
    }

    /// Calls `visit` for each surface whose box may touch `bounds`, in no order that means anything, but always the same.
    pub fn for_each_near(&self, bounds: &Aabb, mut visit: impl FnMut(SurfaceId)) {
        self.tree.for_each_near(bounds, |number| visit(self.surface(number)));
    }

    /// Calls `visit` for each surface of which `may_meet` says so of its box and of all boxes around it, each given by its centre and half its
    /// extent, until it says that this is enough. In no order that means anything, but always the same.
    pub fn until_enough_where(&self, may_meet: impl Fn(DVec3, DVec3) -> bool, mut visit: impl FnMut(SurfaceId) -> bool) {
        self.tree.until_enough_where(may_meet, |number| visit(self.surface(number)));
    }

    /// Calls `visit` for each surface whose box may touch `bounds` and lies wholly outside none of the half-spaces, until it says that this is
    /// enough; in an order as above.
    pub fn until_enough_between(&self, bounds: &Aabb, within: &[HalfSpace], mut visit: impl FnMut(SurfaceId) -> bool) {
        self.tree.until_enough_between(bounds, within, |number| visit(self.surface(number)));
    }

    /// The surface of a box.
    fn surface(&self, number: u32) -> SurfaceId {
        self.surfaces.get(number as usize).copied().unwrap_or(SurfaceId(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    /// Unit squares at so many heights.
    fn squares(sides: Sides) -> Scene {
        let square = |z: f64| Polygon::new(&[[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        Scene::new(1, vec![material], (0..5).map(|k| (square(f64::from(k)), 0, k as u32)).collect(), sides).unwrap()
    }

    #[test]
    fn each_sheet_has_one_box_whichever_sides_it_has() {
        let everywhere = Aabb::around([DVec3::splat(-1.0), DVec3::splat(9.0)]);
        let above = HalfSpace::at(DVec3::new(0.0, 0.0, 1.5), DVec3::Z);
        for (sides, first) in [(Sides::Front, [0, 1, 2, 3, 4]), (Sides::Both, [0, 2, 4, 6, 8])] {
            let boxes = SurfaceBoxes::of_sheets(&squares(sides));
            let (mut near, mut between) = (Vec::new(), Vec::new());
            boxes.for_each_near(&everywhere, |surface| near.push(surface.0));
            boxes.until_enough_between(&everywhere, &[above], |surface| {
                between.push(surface.0);
                false
            });
            near.sort_unstable();
            between.sort_unstable();
            assert_eq!((&near[..], &between[..]), (&first[..], &first[2..]));
        }
    }
}
