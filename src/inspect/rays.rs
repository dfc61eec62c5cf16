//! Rays from the surfaces of a scene, and which of them bring no light back.

use glam::DVec3;

use crate::geometry::{Aabb, Frame};
use crate::scene::Scene;
use crate::visibility::{Hit, Ray, Visibility};

/// Rays from each point.
const RAYS_PER_POINT: u32 = 16;

/// A point lies inside of something if so many of its rays, or more, meet backs.
const RAYS_OF_INSIDE: usize = 15;

/// A ray that leaves the scene is followed beyond its bounds by this part of their diagonal: then it shows where the scene ends, too.
const BEYOND: f64 = 0.05;

/// A ray that light would be lost on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostRay {
    /// The point that it leaves, in metres, and that where it meets a back, or beyond the bounds of the scene.
    pub ends: [[f64; 3]; 2],
    /// The 0-based number of the one-sided face whose back it meets; `None` if it leaves the scene.
    pub back_of: Option<u32>,
}

/// What rays from the surfaces of a scene meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceRays {
    /// How many points rays were cast from.
    pub points: u32,
    /// Those that lie inside of closed objects, in metres.
    pub inside_at: Vec<[f64; 3]>,
    /// How many rays left the other points.
    pub rays: u32,
    /// Those of them that leave the scene or meet backs.
    pub lost: Vec<LostRay>,
}

impl SurfaceRays {
    /// Casts rays from `points` points (at least one) on the surfaces of `scene`; `visibility` must be of that scene.
    pub fn cast(scene: &Scene, visibility: &dyn Visibility, points: u32) -> Self {
        let points = points.clamp(1, u32::MAX / RAYS_PER_POINT);
        let rays = rays_from(scene, points);
        let mut hits = vec![None; rays.len()];
        visibility.first_hits(&rays, &mut hits);

        // What those of a point are lost on: that of most of them are backs tells that it lies inside of something.
        let bounds = scene.bounds();
        let beyond = DVec3::splat(BEYOND * bounds.diagonal());
        let bounds = Aabb { min: bounds.min - beyond, max: bounds.max + beyond };
        let mut met = Self { points, ..Self::default() };
        let per_point = RAYS_PER_POINT as usize;
        for (rays, hits) in rays.chunks(per_point).zip(hits.chunks(per_point)) {
            let lost: Vec<LostRay> =
                rays.iter().zip(hits).filter_map(|(ray, hit)| lost(scene, &bounds, ray, hit.as_ref())).collect();
            if lost.iter().filter(|ray| ray.back_of.is_some()).count() >= RAYS_OF_INSIDE {
                met.inside_at.push(rays[0].origin);
            } else {
                met.rays += RAYS_PER_POINT;
                met.lost.extend(lost);
            }
        }
        met
    }

    /// How many rays left the scene.
    pub fn escaped(&self) -> u32 {
        self.rays_with(|ray| ray.back_of.is_none())
    }

    /// How many rays met the back of a one-sided surface first.
    pub fn met_back(&self) -> u32 {
        self.rays_with(|ray| ray.back_of.is_some())
    }

    fn rays_with(&self, of: impl Fn(&LostRay) -> bool) -> u32 {
        self.lost.iter().filter(|ray| of(ray)).count() as u32
    }

    /// A number of rays as a part of all.
    pub fn share(&self, rays: u32) -> f64 {
        f64::from(rays) / f64::from(self.rays.max(1))
    }
}

/// Rays in cosine-distributed directions from points at even steps through the areas of the surfaces.
fn rays_from(scene: &Scene, points: u32) -> Vec<Ray> {
    // Areas up to and with each surface, to pick surfaces by area.
    let mut total = 0.0;
    let areas: Vec<f64> = (scene.surfaces().iter())
        .map(|surface| {
            total += surface.polygon.area();
            total
        })
        .collect();

    let sample = |index, dimension, seed| f64::from(sobol_burley::sample(index, dimension, seed));
    let mut rays = Vec::with_capacity((points * RAYS_PER_POINT) as usize);
    for point in 0..points {
        let picked = (f64::from(point) + 0.5) / f64::from(points) * total;
        let surface = &scene.surfaces()[areas.partition_point(|&area| area < picked).min(areas.len() - 1)];
        let facet = surface.polygon.facet();
        let origin = facet.point_at(sample(point, 0, 0), sample(point, 1, 0));
        let frame = Frame::around(facet.normal);

        // Points of the unit disk, lifted to the hemisphere, are cosine-distributed directions (Malley's method).
        rays.extend((0..RAYS_PER_POINT).map(|ray| {
            let (radius, angle) = (sample(ray, 0, point + 1).sqrt(), std::f64::consts::TAU * sample(ray, 1, point + 1));
            let height = (1.0 - radius * radius).max(0.0).sqrt();
            let direction = frame.to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), height));
            Ray { origin: origin.to_array(), direction: direction.to_array(), origin_plane: surface.plane }
        }));
    }
    rays
}

/// The ray, if it meets nothing, or a back; `bounds` hold the scene.
fn lost(scene: &Scene, bounds: &Aabb, ray: &Ray, hit: Option<&Hit>) -> Option<LostRay> {
    let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
    let to = |distance: f64| [ray.origin, (origin + distance * direction).to_array()];
    let Some(hit) = hit else {
        // Where it leaves the bounds: through the nearest of the planes that it goes towards.
        let towards = DVec3::select(direction.cmpgt(DVec3::ZERO), bounds.max, bounds.min);
        let distances = ((towards - origin) / direction).to_array().into_iter().filter(|distance| distance.is_finite());
        return Some(LostRay { ends: to(distances.fold(f64::INFINITY, f64::min)), back_of: None });
    };
    let surface = &scene.surfaces()[hit.surface as usize];
    let is_behind = surface.polygon.facet().normal.dot(direction) > 0.0;
    (surface.twin.is_none() && is_behind).then(|| LostRay { ends: to(hit.distance), back_of: Some(surface.face) })
}
