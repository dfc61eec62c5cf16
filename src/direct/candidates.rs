//! Which blockers may stand between a point and a source.

use glam::DVec3;

use super::blockers::Blockers;
use super::outline::Outline;
use super::view::View;
use crate::geometry::Aabb;
use crate::scene::SurfaceId;
use crate::visibility::HalfSpace;

/// A blocker that may stand between.
#[derive(Clone, Copy)]
struct Candidate {
    /// About the solid angle that it takes.
    size: f64,
    surface: SurfaceId,
}

/// Blockers that may stand between; memory that is reused.
#[derive(Default)]
pub(super) struct Candidates {
    found: Vec<Candidate>,
    /// Corners that were held against planes.
    pub steps: u64,
}

/// Planes that the tree is searched with: that of the source, and one for each of so many edges.
const MOST_PLANES: usize = 9;

impl Candidates {
    /// Finds the blockers that hide something of the cone `corners` of a source, as far as planes through the edges of either tell. Beyond
    /// `most` steps it ends, and not all are found.
    pub fn find(&mut self, view: &View<'_>, corners: &[DVec3], blockers: &Blockers<'_>, outline: &mut Outline, most: u64) {
        // The region: around point and source, in front of the source, and inside of the planes through the cone's edges.
        let bounds = Aabb::around(view.source.vertices.iter().copied().chain([view.point]));
        let mut within = [HalfSpace::at(view.source.vertices[0], view.source.normal); MOST_PLANES];
        let mut planes = 1;
        for k in 0..corners.len().min(MOST_PLANES - 1) {
            let inward = corners[if k + 1 == corners.len() { 0 } else { k + 1 }].cross(corners[k]);
            within[planes] = HalfSpace::at(view.point, inward);
            planes += 1;
        }
        let within = &within[..planes];

        // What is there and not in the plane of either end.
        self.found.clear();
        self.steps = 0;
        blockers.until_enough_between(&bounds, within, |surface, blocker| {
            if blocker.plane() == view.plane || blocker.plane() == view.source_plane {
                return false;
            }
            let vertices = blocker.vertices();
            self.steps += (vertices.len() * planes) as u64;
            let is_behind = |half: &HalfSpace| vertices.iter().all(|v| half.normal.dot(*v) <= half.offset);
            let mut may_hide = || outline.trace(view, blocker, blockers.contact) && !outline.is_apart_from(corners);
            if !within.iter().any(is_behind) && may_hide() {
                self.steps += 2 * (vertices.len() * corners.len()) as u64;
                self.found.push(Candidate { size: blocker.size_from(view.point), surface });
            }
            self.steps > most
        });
    }

    /// How many were found.
    pub fn len(&self) -> usize {
        self.found.len()
    }

    /// The blockers that were found, the largest first.
    pub fn by_size(&mut self) -> impl Iterator<Item = SurfaceId> {
        self.found.sort_unstable_by(|a, b| b.size.total_cmp(&a.size).then(a.surface.cmp(&b.surface)));
        self.found.iter().map(|candidate| candidate.surface)
    }
}
