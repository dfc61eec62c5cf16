//! All polygons of a scene as blockers, and which of them may stand between a point and a source.
//!
//! The rules are those of rays (`visibility`): what lies in the plane of either end hides nothing, and neither does a polygon whose plane
//! the point touches. A polygon that is not quite flat blocks as its outline, and touches what is no farther from its mean plane than its
//! own corners; rays see it as a fan of triangles. The form factor differs by no more than that distance over the one to the point.

use glam::DVec3;

use super::outline::Outline;
use super::view::View;
use crate::geometry::Aabb;
use crate::scene::Scene;
use crate::visibility::{BoxTree, HalfSpace, OccluderMesh};

/// A convex polygon that occludes from both sides.
pub(super) struct Blocker {
    first_vertex: u32,
    vertex_count: u32,
    plane: u32,
    normal: DVec3,
    centroid: DVec3,
    area: f64,
    /// The distance of the farthest vertex from the mean plane.
    off_plane: f64,
}

impl Blocker {
    /// The distance of a point from the mean plane, positive in front.
    #[inline]
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.centroid)
    }

    /// About the solid angle that it takes, seen from a point.
    fn size_from(&self, point: DVec3) -> f64 {
        let distance_sq = (self.centroid - point).length_squared() + self.area;
        self.height(point).abs() * self.area / (distance_sq * distance_sq.sqrt())
    }
}

/// The blockers of a scene.
pub(super) struct Blockers {
    vertices: Vec<DVec3>,
    blockers: Vec<Blocker>,
    tree: BoxTree,
    /// [`OccluderMesh::contact_tolerance`].
    pub contact: f64,
}

/// A blocker that may stand between.
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    /// About the solid angle that it takes.
    size: f64,
    number: u32,
}

impl Blockers {
    /// All surfaces of a scene; of a sheet with two sides only the first.
    pub fn of(scene: &Scene) -> Self {
        let (mut vertices, mut blockers) = (Vec::new(), Vec::new());
        for (index, surface) in scene.surfaces().iter().enumerate() {
            if surface.twin().is_some_and(|twin| twin.index() < index) {
                continue;
            }
            let facet = surface.polygon.facet();
            let off_plane = facet.vertices.iter().map(|&v| facet.normal.dot(v - facet.centroid).abs()).fold(0.0, f64::max);
            blockers.push(Blocker {
                first_vertex: vertices.len() as u32,
                vertex_count: facet.vertices.len() as u32,
                plane: surface.plane(),
                normal: facet.normal,
                centroid: facet.centroid,
                area: facet.area,
                off_plane,
            });
            vertices.extend_from_slice(facet.vertices);
        }
        let of = |blocker: &Blocker| &vertices[blocker.first_vertex as usize..][..blocker.vertex_count as usize];
        let tree = BoxTree::of(blockers.iter().map(|blocker| Aabb::around(of(blocker).iter().copied())));
        Self { tree, vertices, blockers, contact: OccluderMesh::of_scene(scene).contact_tolerance() }
    }

    pub fn get(&self, candidate: Candidate) -> &Blocker {
        &self.blockers[candidate.number as usize]
    }

    pub fn vertices(&self, blocker: &Blocker) -> &[DVec3] {
        &self.vertices[blocker.first_vertex as usize..][..blocker.vertex_count as usize]
    }

    /// How far from a blocker's plane a point touches it.
    pub fn touch(&self, blocker: &Blocker) -> f64 {
        self.contact + blocker.off_plane
    }

    /// Finds what may stand between a point and the cone `corners` of its source, the largest first. Only what hides something of the cone is
    /// found, as far as planes through the edges of either tell. Gives the work that it took, in corners held against planes; beyond `most` of
    /// that it ends, and not all is found.
    pub fn find_between(
        &self,
        view: &View<'_>,
        corners: &[DVec3],
        outline: &mut Outline,
        found: &mut Vec<Candidate>,
        most: u64,
    ) -> u64 {
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
        found.clear();
        let mut steps = 0;
        self.tree.until_enough_between(&bounds, within, |number| {
            let blocker = &self.blockers[number as usize];
            if blocker.plane == view.plane || blocker.plane == view.source_plane {
                return false;
            }
            let vertices = self.vertices(blocker);
            steps += (vertices.len() * planes) as u64;
            let is_behind = |half: &HalfSpace| vertices.iter().all(|v| half.normal.dot(*v) <= half.offset);
            let mut may_hide = || outline.trace(view, self, blocker) && !outline.is_apart_from(corners);
            if !within.iter().any(is_behind) && may_hide() {
                steps += 2 * (vertices.len() * corners.len()) as u64;
                found.push(Candidate { size: blocker.size_from(view.point), number });
            }
            steps > most
        });
        found.sort_unstable_by(|a, b| b.size.total_cmp(&a.size).then(a.number.cmp(&b.number)));
        steps
    }
}

/// Planes that the tree is searched with: that of the source, and one for each of so many edges.
const MOST_PLANES: usize = 9;
