//! What a point sees of a surface and its elements, with all that is in the way: the range of a form factor, which is as wide as rounding
//! where the shadows of everything in the way are known.

use glam::DVec3;

use super::blockers::{Blockers, Lit, Shadows};
use crate::form_factor::bound_at_point;
use crate::geometry::{ClippedFacet, Facet, plane_noise};
use crate::scene::SurfaceId;

/// Nearer to a polygon than this part of its radius a point touches it: there a form factor has no value, but a limit.
const TOUCHING: f64 = 1e-9;

/// What a point sees of a surface.
pub(in crate::bounds) enum PointSight {
    /// Nothing.
    Nothing,
    /// It lies on the surface, or on its edge.
    Touching,
    /// Some of it, or all.
    Some(Sighted),
}

/// A point with a normal, and the shadows that it sees on a surface.
pub(in crate::bounds) struct Sighted {
    x: DVec3,
    normal: DVec3,
    /// `None` if nothing is in the way.
    shadows: Option<Shadows>,
}

impl Blockers<'_> {
    /// What the point x of a surface sees of another.
    pub fn sight_at(&self, x: DVec3, on: SurfaceId, source: SurfaceId) -> PointSight {
        let facet = self.facet(source);
        let height = facet.height(x);
        if self.share_a_plane(on, source) {
            return PointSight::Nothing;
        }
        if height.abs() <= TOUCHING * facet.radius && facet.distance_to(x) <= TOUCHING * facet.radius {
            return PointSight::Touching;
        }
        if height <= plane_noise(x, facet.vertices[0]) {
            return PointSight::Nothing;
        }
        PointSight::Some(Sighted { x, normal: self.facet(on).normal, shadows: self.shadows_at(x, on, source) })
    }
}

impl Sighted {
    /// Whether all of a part of the surface is visible, but for what is below the horizon.
    pub fn is_clear(&self, part: &Facet<'_>) -> bool {
        self.shadows.as_ref().is_none_or(|shadows| shadows.miss(part))
    }

    /// The least and the largest form factor to a part of the surface that is known to be clear, or not known to be.
    pub fn form_factor(&self, part: &Facet<'_>, is_clear: bool) -> [f64; 2] {
        let of = |part: &Facet<'_>| bound_at_point(self.x, self.normal, part);
        let unoccluded = of(part);
        let Some(shadows) = self.shadows.as_ref().filter(|_| unoccluded[1] > 0.0 && !is_clear) else {
            return unoccluded;
        };
        if shadows.hide(part) {
            return [0.0, 0.0];
        }
        let Lit { certain, possible, .. } = shadows.lit(part);
        let sum = |parts: &[ClippedFacet], end: usize| parts.iter().map(|part| of(&part.facet())[end]).sum::<f64>() + 0.0;
        let lower = sum(&certain, 0).min(unoccluded[1]);
        [lower, sum(&possible, 1).min(unoccluded[1]).max(lower)]
    }
}
