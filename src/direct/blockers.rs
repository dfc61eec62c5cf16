//! All polygons of a scene as blockers.
//!
//! The rules are those of rays (`visibility`): what lies in the plane of either end hides nothing, and neither does a polygon whose plane
//! the point touches. A polygon that is not quite flat blocks as its outline, and touches what is no farther from its mean plane than its
//! own corners; rays see it as a fan of triangles. The form factor differs by no more than that distance over the one to the point.

use glam::DVec3;

use super::view::View;
use crate::geometry::{Aabb, Facet};
use crate::scene::{Scene, Surface, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{HalfSpace, Ray, SurfaceBoxes, contact_tolerance};

/// A convex polygon that occludes from both sides.
#[derive(Clone, Copy)]
pub(super) struct Blocker<'a>(&'a Surface);

impl<'a> Blocker<'a> {
    fn facet(&self) -> Facet<'a> {
        self.0.polygon.facet()
    }

    pub fn vertices(&self) -> &'a [DVec3] {
        self.facet().vertices
    }

    /// The number of its plane.
    pub fn plane(&self) -> u32 {
        self.0.plane()
    }

    /// The distance of a point from the mean plane, positive in front.
    #[inline]
    pub fn height(&self, point: DVec3) -> f64 {
        self.facet().height(point)
    }

    /// About the solid angle that it takes, seen from a point.
    pub fn size_from(&self, point: DVec3) -> f64 {
        let Facet { area, centroid, .. } = self.facet();
        let distance_sq = (centroid - point).length_squared() + area;
        self.height(point).abs() * area / (distance_sq * distance_sq.sqrt())
    }

    /// Whether a point so high over the mean plane touches it: by `contact` or less from as far as corners lie off it.
    pub fn is_touched(&self, height: f64, contact: f64) -> bool {
        let facet = self.facet();
        let beyond = height.abs() - contact;
        // No corner is farther from the plane than from the centroid.
        beyond <= facet.radius && facet.vertices.iter().any(|&corner| facet.height(corner).abs() >= beyond)
    }
}

/// The blockers of a scene.
#[derive(Clone, Copy)]
pub(crate) struct Blockers<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    sheets: &'a SurfaceBoxes,
    /// [`OccluderMesh::contact_tolerance`](crate::visibility::OccluderMesh::contact_tolerance).
    pub(crate) contact: f64,
}

impl<'a> Blockers<'a> {
    /// All surfaces of a scene; of a sheet with two sides only the first.
    pub fn of(scene: &'a Scene, rays: &'a Rays<'a>) -> Self {
        Self { scene, rays, sheets: rays.sheets(scene), contact: contact_tolerance(&scene.bounds()) }
    }

    pub(super) fn get(&self, surface: SurfaceId) -> Blocker<'a> {
        Blocker(self.scene.surface(surface))
    }

    /// The first blocker that a ray from the point meets in front of the source.
    pub(super) fn first_met(&self, view: &View<'_>, direction: DVec3) -> Option<Blocker<'a>> {
        let ray = Ray { origin: view.point.to_array(), direction: direction.to_array(), origin_plane: view.plane };
        let hit = self.rays.first_hit(ray)?;
        let blocker = self.get(SurfaceId(hit.surface));
        let to_source = view.source.height(view.point) / -view.source.normal.dot(direction);
        (hit.distance < to_source && blocker.plane() != view.source_plane).then_some(blocker)
    }

    /// Calls `visit` with each blocker whose box may touch `bounds` and lies wholly outside none of the half-spaces, until it says that this is
    /// enough.
    pub(super) fn until_enough_between(
        &self,
        bounds: &Aabb,
        within: &[HalfSpace],
        mut visit: impl FnMut(SurfaceId, Blocker<'a>) -> bool,
    ) {
        self.sheets.until_enough_between(bounds, within, |surface| visit(surface, self.get(surface)));
    }
}
