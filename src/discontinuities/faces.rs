//! The faces of a scene as what curves are cut by: which of them a plane cuts, and where.

use glam::DVec3;

use super::fan::{Cut, Fan, Windows, take_out};
use crate::geometry::{Aabb, Facet};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::SurfaceBoxes;

/// A plane through a point with a unit normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub origin: DVec3,
    pub normal: DVec3,
}

impl Plane {
    /// The plane through `origin` along two directions; `None` where these are parallel.
    pub fn along(origin: DVec3, u: DVec3, v: DVec3) -> Option<Self> {
        Some(Self { origin, normal: u.cross(v).try_normalize()? })
    }

    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.origin)
    }

    /// The same plane seen from its other side.
    pub fn reversed(self) -> Self {
        Self { origin: self.origin, normal: -self.normal }
    }
}

/// All faces: of a sheet with two sides only the first.
pub(super) struct Faces<'a> {
    pub scene: &'a Scene,
    pub boxes: SurfaceBoxes,
    /// What is nearer to each other counts as touching, in metres.
    pub tolerance: f64,
}

impl<'a> Faces<'a> {
    pub fn of(scene: &'a Scene) -> Self {
        Self { scene, boxes: SurfaceBoxes::of(scene), tolerance: scene.contact_tolerance() }
    }

    /// A height above a plane up to which a corner counts as lying in it: the plane and the corner are each off by the tolerance.
    pub fn on_plane(&self) -> f64 {
        2.0 * self.tolerance
    }

    pub fn facet(&self, id: SurfaceId) -> Facet<'a> {
        self.scene.surface(id).polygon.facet()
    }

    /// Whether a surface is the second side of a sheet.
    pub fn is_second_side(&self, id: SurfaceId) -> bool {
        self.scene.surface(id).twin().is_some_and(|twin| twin < id)
    }

    pub fn ids(&self) -> impl Iterator<Item = SurfaceId> + '_ {
        (0..self.scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| !self.is_second_side(id))
    }

    /// The faces whose boxes come within the tolerance of `bounds`, in the order of their numbers.
    pub fn near(&self, bounds: &Aabb) -> Vec<SurfaceId> {
        let room = DVec3::splat(self.on_plane());
        let wide = Aabb { min: bounds.min - room, max: bounds.max + room };
        let mut near = Vec::new();
        self.boxes.for_each_near(&wide, |id| {
            if !self.is_second_side(id) {
                near.push(id);
            }
        });
        near.sort_unstable();
        near
    }

    /// The faces whose boxes come within the tolerance of `bounds` and of a plane, in the order of their numbers.
    pub fn along(&self, plane: &Plane, bounds: &Aabb) -> Vec<SurfaceId> {
        let (middle, reach) = (bounds.centre(), 0.5 * bounds.extent() + self.on_plane());
        let mut along = Vec::new();
        let may_meet =
            |centre: DVec3, half: DVec3| (centre - middle).abs().cmple(half + reach).all() && self.may_cut(plane, centre, half);
        self.boxes.until_enough_where(may_meet, |id| {
            if !self.is_second_side(id) {
                along.push(id);
            }
            false
        });
        along.sort_unstable();
        along
    }

    /// Whether a box, by its centre and half its extent, comes within the tolerance of a plane.
    fn may_cut(&self, plane: &Plane, centre: DVec3, half: DVec3) -> bool {
        plane.height(centre).abs() <= plane.normal.abs().dot(half) + self.on_plane()
    }

    /// Where the faces cut the plane of a fan, as seen from its apex: those farther than `range[0]` times the fan's segment, and no farther than
    /// `range[1]` times. Answers whether anything touches the plane there. Faces of `but` do not count.
    ///
    /// The plane is thought of as moved a little along its normal, so that what only touches it from behind does not cut it, and what touches it
    /// from the front does: where surfaces meet in the plane, no ray slips through between them.
    pub fn cut(&self, plane: &Plane, (fan, range): (&Fan, [f64; 2]), but: &[SurfaceId], cuts: &mut Vec<Cut>) -> bool {
        cuts.clear();
        self.until_enough_cut(plane, (fan, range), but, |cut| {
            cuts.push(cut);
            false
        })
    }

    /// Takes the rays out of `windows` on which a face is nearer than `w`, until none is left. Answers whether anything touches the plane, of what was
    /// looked at.
    pub fn hide(&self, plane: &Plane, (fan, w): (&Fan, f64), but: &[SurfaceId], windows: &mut Windows) -> bool {
        self.until_enough_cut(plane, (fan, [0.0, 1.0]), but, |cut| {
            if let Some(hidden) = cut.nearer_than(w) {
                take_out(windows, hidden);
            }
            windows.is_empty()
        })
    }

    fn until_enough_cut(
        &self,
        plane: &Plane,
        (fan, range): (&Fan, [f64; 2]),
        but: &[SurfaceId],
        mut visit: impl FnMut(Cut) -> bool,
    ) -> bool {
        let mut is_touched = false;
        let may_meet = |centre: DVec3, half: DVec3| self.may_cut(plane, centre, half) && fan.may_reach(centre, half, range);
        self.boxes.until_enough_where(may_meet, |id| {
            if self.is_second_side(id) || but.contains(&id) {
                return false;
            }
            let vertices = self.facet(id).vertices;
            is_touched |= vertices.iter().any(|&vertex| plane.height(vertex).abs() <= self.on_plane());
            let section = section(vertices, plane, self.on_plane());
            let cut = section.and_then(|[from, to]| fan.project(from, to, id, self.scene.surface(id).plane()));
            cut.is_some_and(&mut visit)
        });
        is_touched
    }
}

/// Where a convex polygon crosses a plane that is moved a little along its normal: corners within `tolerance` of the plane count as behind.
fn section(vertices: &[DVec3], plane: &Plane, tolerance: f64) -> Option<[DVec3; 2]> {
    let mut found = [DVec3::ZERO; 2];
    let mut count = 0;
    let mut a = vertices[vertices.len() - 1];
    let mut height_a = plane.height(a);
    for &b in vertices {
        let height_b = plane.height(b);
        if (height_a > tolerance) != (height_b > tolerance) {
            // A corner that lies in the plane is the crossing itself.
            let (above, below) = (height_a.max(height_b), height_a.min(height_b).min(0.0));
            let (from, to) = if height_a > tolerance { (a, b) } else { (b, a) };
            if count < 2 {
                found[count] = from + (to - from) * (above / (above - below));
            }
            count += 1;
        }
        (a, height_a) = (b, height_b);
    }
    (count == 2).then_some(found)
}
