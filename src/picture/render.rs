//! A picture of the solution: first hits from the backend, and the gather at each of them.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use super::image::Image;
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfaceId;
use crate::transmittance::Rays;
use crate::values::{Gather, RayBudget, Scratch};
use crate::visibility::{Hit, Ray};

/// Rays through each pixel.
const SUBSAMPLES: u32 = 4;

/// Visibility rays to a pixel at most: with more, a picture of 8 bits shows no difference.
const RAYS_PER_PIXEL: u32 = 64;

/// [`RayBudget::least_chance`] of pictures.
const LEAST_CHANCE: f64 = 0.125;

/// Adds the radiance `L = B / pi` through the pixels of a camera to an `image` that is still black; it stays black where a back or
/// nothing is met. `None` if the observer cancels.
pub(crate) fn render(
    gather: &Gather<'_>,
    visibility: &Rays<'_>,
    camera: &CameraRays,
    mut image: Image,
    observer: &dyn Observer,
) -> Option<Image> {
    let (channels, width, height) = (image.channels, image.width, image.height);
    let done = AtomicUsize::new(0);
    image.radiance.par_chunks_mut(channels * width as usize).enumerate().for_each_init(
        || (Scratch::default(), Vec::new()),
        |(scratch, hits), (row, radiance)| {
            if observer.cancelled() {
                return;
            }
            // Where the rays through the pixels of a row arrive.
            let subsamples =
                |column| (0..SUBSAMPLES).map(move |sample| camera.through_pixel(column, row as u32, sample, SUBSAMPLES));
            let rays: Vec<Ray> = (0..width).flat_map(subsamples).collect();
            visibility.first_hits(&rays, hits);
            let place = |(ray, hit): (&Ray, &Option<Hit>)| {
                let (direction, hit) = (DVec3::from(ray.direction), hit.as_ref()?);
                let surface = gather.scene.side_towards(SurfaceId(hit.surface), -direction)?;
                Some(gather.place_at(DVec3::from(ray.origin) + hit.distance * direction, surface))
            };
            let places: Vec<Option<Place>> = rays.iter().zip(hits.iter()).map(place).collect();

            // What is seen there.
            shade_row(gather, &places, scratch, radiance);

            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(height));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    (!observer.cancelled()).then_some(image)
}

/// Adds the radiances of a row of pixels, each seen at [`SUBSAMPLES`] places.
fn shade_row(gather: &Gather<'_>, places: &[Option<Place>], scratch: &mut Scratch, radiance: &mut [f32]) {
    // If all rays of a pixel meet one surface, one of the points with all visibility rays is as good as all points with a share
    // each.
    let channels = gather.scene.channels();
    let is_one = |places: &[Option<Place>]| {
        let is_first = |other: Option<Place>| other.map(|place| place.surface) == places[0].map(|place| place.surface);
        places[0].is_some() && places.iter().all(|place| is_first(*place))
    };
    for shaded in [1, SUBSAMPLES] {
        // All points with the same number of rays together.
        let pixels = places.chunks(SUBSAMPLES as usize).enumerate().filter(|(_, places)| is_one(places) == (shaded == 1));
        let points =
            pixels.flat_map(|(column, places)| places[..shaded as usize].iter().flatten().map(move |place| (column, *place)));
        let (columns, points): (Vec<usize>, Vec<Place>) = points.unzip();
        let rays_each = gather.budget.rays.min(RAYS_PER_PIXEL).div_ceil(shaded);
        let budget = RayBudget { rays: rays_each, least_chance: LEAST_CHANCE, ..gather.budget };
        let mut radiosity = vec![0.0; channels * points.len()];
        gather.radiosities_at(&points, budget, scratch, &mut radiosity);

        for (column, radiosity) in columns.into_iter().zip(radiosity.chunks(channels)) {
            let pixel = &mut radiance[column * channels..][..channels];
            let share = 1.0 / (PI * f64::from(shaded));
            pixel.iter_mut().zip(radiosity).for_each(|(pixel, radiosity)| *pixel += (radiosity * share) as f32);
        }
    }
}
