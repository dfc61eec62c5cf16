//! A picture of the solution: first hits from the backend, and the gather at each of them.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::{CameraRays, Effort, Image, Reconstruction, Scratch};
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfaceId;
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// Rays through each pixel.
const SUBSAMPLES: u32 = 4;

/// Visibility rays to a pixel: more than a picture of 8 bits shows would be in vain.
const RAYS_PER_PIXEL: u32 = 64;

/// A source that carries little gets a ray with this probability at least.
const LEAST_CHANCE: f64 = 0.125;

/// Radiance `L = B / pi` through the pixels of a camera, black where a back or nothing is met; `None` if the observer cancels.
pub(crate) fn render(
    reconstruction: &Reconstruction<'_>,
    visibility: &Rays<'_>,
    rays: &CameraRays,
    width: u32,
    height: u32,
    observer: &dyn Observer,
) -> Option<Image> {
    let channels = reconstruction.scene.channels();
    let mut image = Image::black(width, height, channels);
    let done = AtomicUsize::new(0);

    image.radiance.par_chunks_mut(channels * width as usize).enumerate().for_each_init(
        || (Scratch::default(), Vec::new(), Vec::new()),
        |(scratch, radiosity, hits), (row, radiance)| {
            if observer.cancelled() {
                return;
            }
            let subsamples = |column| (0..SUBSAMPLES).map(move |sample| rays.through_pixel(column, row as u32, sample, SUBSAMPLES));
            let looks: Vec<_> = (0..width).flat_map(subsamples).collect();
            visibility.first_hits(&looks, hits);
            let place = |(look, hit): (&Ray, &Option<Hit>)| {
                let (direction, hit) = (DVec3::from(look.direction), hit.as_ref()?);
                let surface = reconstruction.scene.side_towards(SurfaceId(hit.surface), -direction)?;
                Some((surface, DVec3::from(look.origin) + hit.distance * direction))
            };
            let places: Vec<Option<(SurfaceId, DVec3)>> = looks.iter().zip(hits.iter()).map(place).collect();

            // Where all rays of a pixel meet one surface, one of the points is worth as much as all with a share of the rays each.
            let is_one = |places: &[Option<(SurfaceId, DVec3)>]| {
                places[0].is_some_and(|(first, _)| places.iter().all(|place| place.is_some_and(|(other, _)| other == first)))
            };
            for shaded in [1, SUBSAMPLES] {
                // The points that get the same rays, all together.
                let pixels = places.chunks(SUBSAMPLES as usize).enumerate().filter(|(_, places)| is_one(places) == (shaded == 1));
                let points = pixels.flat_map(|(column, places)| {
                    places[..shaded as usize].iter().flatten().map(move |&(surface, point)| (column, point, surface))
                });
                let points: Vec<(usize, DVec3, SurfaceId)> = points.collect();
                let budget = reconstruction.effort.rays.min(RAYS_PER_PIXEL).div_ceil(shaded);
                let effort = Effort { rays: budget, least_chance: LEAST_CHANCE, ..reconstruction.effort };
                radiosity.clear();
                radiosity.resize(channels * points.len(), 0.0);
                let asked = points.iter().map(|&(_, point, surface)| (point, surface));
                reconstruction.radiosities_at(asked, effort, scratch, radiosity);

                for (&(column, ..), radiosity) in points.iter().zip(radiosity.chunks(channels)) {
                    let pixel = &mut radiance[column * channels..][..channels];
                    let share = 1.0 / (PI * f64::from(shaded));
                    pixel.iter_mut().zip(radiosity).for_each(|(pixel, radiosity)| *pixel += (radiosity * share) as f32);
                }
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(height));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    (!observer.cancelled()).then_some(image)
}
