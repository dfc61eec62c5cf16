//! The first rays of paths.

use std::f64::consts::PI;

use glam::DVec3;

use super::course::Course;
use super::ends::{Arrival, Continuation, ValueEnd};
use super::grids::NO_CELL;
use super::place::{Directions, Place, Receives, cosine_rays};
use super::trace::{LightPaths, PathScratch};
use crate::direct::Receiver;
use crate::geometry::{sampling, streams};
use crate::scene::SurfaceId;
use crate::visibility::{Hit, Ray};

impl LightPaths<'_> {
    /// Casts the first rays of all paths.
    pub(super) fn leave(&self, places: &[impl Receives], directions: &[Directions], course: &Course, scratch: &mut PathScratch) {
        let (count, beyond) = (course.count, course.bounces > 0 || course.past_values);
        let past_unresolved = course.past_unresolved || self.grids.past_unresolved();
        self.draw_first_rays(places, directions, course, scratch);
        let PathScratch { ends, rays, heads, continuation_of, into_sky, value_ends, .. } = scratch;
        heads.clear();
        continuation_of.clear();
        value_ends.clear();
        self.rays.first_hits(rays, &mut scratch.hits);

        // Paths end where they arrive, or go on from there.
        for (path, (ray, hit)) in rays.iter().zip(&scratch.hits).enumerate() {
            let (arrival, weight) = self.arrival(&places[path / count as usize], ray, *hit, [beyond, past_unresolved]);
            ends.first_weight[path] *= weight;
            match arrival {
                Arrival::Nothing => {}
                Arrival::Sky(direction) => {
                    into_sky.push((ends.continued.len(), direction));
                    ends.trail.iter_mut().for_each(|trail| trail.goes_on(path / count as usize, 1.0));
                    ends.continued.push(Continuation { path, cell: NO_CELL, value_end: None, is_of_sky: true });
                }
                Arrival::Cell(cell, point, surface) => {
                    let from = &places[path / count as usize];
                    (ends.cell[path], ends.point[path], ends.surface[path]) = (cell, point, surface.0);
                    ends.form_factor[path] = hit.map_or(0.0, |hit| self.form_factor(&from.receiver(self.scene), ray, hit));
                }
                Arrival::Onward(point, surface, small) => {
                    let (place, ray) = (path / count as usize, path % count as usize);
                    ends.trail.iter_mut().for_each(|trail| trail.goes_on(place, weight));
                    ends.surface[path] = surface.0;
                    let seed = sampling::hash(places[place].receiver(self.scene).seed, streams::PATHS_ONWARD + ray as u64);
                    heads.push(Place { point, surface, seed });
                    continuation_of.push(ends.continued.len());
                    if let Some(cell) = small.filter(|_| course.past_values) {
                        value_ends.push(ValueEnd { continuation: ends.continued.len(), cell, surface, bounces: 0 });
                    }
                    ends.continued.push(Continuation { path, cell: NO_CELL, value_end: None, is_of_sky: false });
                }
            }
        }
    }

    /// Draws these rays, and fills in their weights.
    fn draw_first_rays(&self, places: &[impl Receives], directions: &[Directions], course: &Course, scratch: &mut PathScratch) {
        let PathScratch { ends, order, rays, direct, .. } = scratch;
        let count = course.count as usize;
        ends.clear(places.len() * count);
        rays.clear();

        // Neighbouring directions one after the other: rays cost less then.
        if order.len() != count {
            *order = sampling::neighbours_in_order(course.count);
        }
        if course.sees_exactly() {
            direct.guide(&self.direct_light(), places, course.vertex_rays);
        }
        for (number, (place, &Directions { seed, first })) in places.iter().zip(directions).enumerate() {
            let receiver = Receiver { seed, ..place.receiver(self.scene) };
            let indices = order.iter().map(|ray| first + ray);
            if !course.sees_exactly() {
                rays.extend(cosine_rays(&receiver, indices));
                continue;
            }
            let guide = direct.guides.of(number);
            for (index, weight) in indices.zip(&mut ends.first_weight[number * count..]) {
                let (ray, of_ray) = guide.ray(&receiver, index);
                rays.push(ray);
                *weight = of_ray;
            }
        }
    }

    /// The form factor of the cell where a ray from a place arrives, about: by the kernel there.
    fn form_factor(&self, from: &Receiver, ray: &Ray, hit: Hit) -> f64 {
        let surface = SurfaceId(hit.surface);
        let direction = DVec3::from(ray.direction);
        let normal = self.scene.surface(surface).polygon.facet().normal;
        let cosines = from.normal.dot(direction).abs() * normal.dot(direction).abs();
        let grid = self.grids.at(surface, from.point + hit.distance * direction);
        let area = grid.map_or(0.0, |grid| grid.size().powi(2));
        (cosines * area / (PI * hit.distance.powi(2))).min(1.0)
    }
}
