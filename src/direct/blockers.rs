//! All polygons of a scene as blockers.
//!
//! The rules are those of rays (`visibility`): what lies in the plane of either end hides nothing, and neither does a polygon whose plane
//! the point touches. A polygon that is not quite flat blocks as its outline, and touches what is no farther from its mean plane than its
//! own corners; rays see it as a fan of triangles. The form factor differs by no more than that distance over the one to the point.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use crate::geometry::Aabb;
use crate::scene::Scene;
use crate::visibility::{BoxTree, HalfSpace, contact_tolerance};

/// A convex polygon that occludes from both sides.
pub(super) struct Blocker {
    first_vertex: u32,
    vertex_count: u32,
    /// The number of its plane.
    pub plane: u32,
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
    pub fn size_from(&self, point: DVec3) -> f64 {
        let distance_sq = (self.centroid - point).length_squared() + self.area;
        self.height(point).abs() * self.area / (distance_sq * distance_sq.sqrt())
    }
}

/// Bytes of a box as given, and of two nodes of the tree with what it is built from.
const BOXES: usize = 32 + 2 * 64 + 4;

/// The blockers of a scene.
pub(crate) struct Blockers {
    vertices: Vec<DVec3>,
    blockers: Vec<Blocker>,
    tree: BoxTree,
    /// [`OccluderMesh::contact_tolerance`](crate::visibility::OccluderMesh::contact_tolerance).
    pub(crate) contact: f64,
}

impl Blockers {
    /// Bytes that a surface of four corners takes, with its boxes in the tree and while that is built.
    pub const BYTES_OF_SURFACE: usize = size_of::<Blocker>() + 4 * size_of::<DVec3>() + BOXES;

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
        Self { tree, vertices, blockers, contact: contact_tolerance(&scene.bounds()) }
    }

    pub(super) fn get(&self, number: u32) -> &Blocker {
        &self.blockers[number as usize]
    }

    pub(super) fn vertices(&self, blocker: &Blocker) -> &[DVec3] {
        &self.vertices[blocker.first_vertex as usize..][..blocker.vertex_count as usize]
    }

    /// How far from a blocker's plane a point touches it.
    pub(super) fn touch(&self, blocker: &Blocker) -> f64 {
        self.contact + blocker.off_plane
    }

    /// Calls `visit` with each blocker whose box may touch `bounds` and lies wholly outside none of the half-spaces, until it says that this is
    /// enough.
    pub(super) fn until_enough_between(&self, bounds: &Aabb, within: &[HalfSpace], mut visit: impl FnMut(u32, &Blocker) -> bool) {
        self.tree.until_enough_between(bounds, within, |number| visit(number, &self.blockers[number as usize]));
    }
}

/// The blockers of a scene, found when they are first asked for, and shared by all clones.
#[derive(Clone, Default)]
pub(crate) struct SharedBlockers(Arc<OnceLock<Blockers>>);

impl SharedBlockers {
    /// The blockers of the scene, which is the same for all clones.
    pub fn of(&self, scene: &Scene) -> &Blockers {
        self.0.get_or_init(|| Blockers::of(scene))
    }
}
