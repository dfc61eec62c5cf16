//! What is around a place, by rays from there.

use glam::DVec3;

use super::place::{Place, Receives, cosine_rays};
use super::trace::LightPaths;
use crate::scene::SurfaceId;
use crate::visibility::{Hit, NO_PLANE, Ray, Segment};

impl LightPaths<'_> {
    /// The surfaces whose fronts `count` cosine-distributed rays from a place meet first.
    pub fn sampled_seen(&self, place: &Place, count: u32) -> Vec<SurfaceId> {
        let (rays, mut hits): (Vec<Ray>, _) = (cosine_rays(&place.receiver(self.scene), 0..count).collect(), Vec::new());
        self.rays.first_hits(&rays, &mut hits);
        let side = |(ray, hit): (&Ray, &Option<Hit>)| {
            self.scene.side_towards(SurfaceId(hit.as_ref()?.surface), -DVec3::from(ray.direction))
        };
        let mut seen: Vec<SurfaceId> = rays.iter().zip(&hits).filter_map(side).collect();
        seen.sort_unstable();
        seen.dedup();
        seen
    }

    /// The part of `count` cosine-distributed rays from a place that meet something within so many metres.
    pub fn sampled_near(&self, place: &Place, count: u32, within: f64) -> f64 {
        let to_end = |ray: Ray| {
            let to = DVec3::from(ray.origin) + within * DVec3::from(ray.direction);
            Segment { from: ray.origin, to: to.to_array(), from_plane: ray.origin_plane, to_plane: NO_PLANE }
        };
        let segments: Vec<Segment> = cosine_rays(&place.receiver(self.scene), 0..count).map(to_end).collect();
        let mut occluded = Vec::new();
        self.rays.occluded(&segments, &mut occluded);
        occluded.iter().filter(|&&occluded| occluded).count() as f64 / f64::from(count)
    }
}
