//! A picture of the solution: first hits from the backend, and the gather at each of them.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use super::image::Image;
use super::shown::Shown;
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfaceId;
use crate::transmittance::Rays;
use crate::values::{ErrorBars, Gather, Gathered, RayBudget, Scratch};
use crate::visibility::{Hit, Ray};

/// Rays through each pixel.
const SUBSAMPLES: u32 = 4;

/// Visibility rays to a pixel at most: with more, a picture of 8 bits shows no difference.
const RAYS_PER_PIXEL: u32 = 64;

/// [`RayBudget::least_chance`] of pictures.
const LEAST_CHANCE: f64 = 0.125;

/// What pixels are shaded by.
struct Shader<'a> {
    gather: &'a Gather<'a>,
    error_bars: Option<ErrorBars>,
    shown: Shown,
}

/// What is shown through the pixels of a camera, with standard errors where `error_bars` are known; black where a back is met, and
/// where nothing is, but for the sky. `None` if the observer cancels.
pub(crate) fn render(
    (gather, error_bars): (&Gather<'_>, Option<ErrorBars>),
    visibility: &Rays<'_>,
    (camera, size): (&CameraRays, [u32; 2]),
    shown: Shown,
    observer: &dyn Observer,
) -> Option<Image> {
    let ([width, height], channels) = (size, gather.scene.channels());
    let shader = Shader { gather, error_bars, shown };
    let mut pixels = vec![[0.0; 2]; channels * width as usize * height as usize];
    let done = AtomicUsize::new(0);
    pixels.par_chunks_mut(channels * width as usize).enumerate().for_each_init(
        || (Scratch::default(), Vec::new()),
        |(scratch, hits), (row, pixels)| {
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
            shader.shade_row(&places, scratch, pixels);
            shader.add_sky(&rays, hits, pixels);

            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(height));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    if observer.cancelled() {
        return None;
    }
    let (radiance, standard_error) = pixels.into_iter().map(|[radiance, error]| (radiance, error)).unzip();
    Some(Image { width, height, channels, radiance, standard_error: error_bars.map(|_| standard_error) })
}

impl Shader<'_> {
    /// Adds what a row of pixels shows of the sky, by the [`SUBSAMPLES`] rays through each.
    fn add_sky(&self, rays: &[Ray], hits: &[Option<Hit>], pixels: &mut [[f32; 2]]) {
        let (scene, share) = (self.gather.scene, 1.0 / f64::from(SUBSAMPLES));
        let mut radiance = vec![0.0; scene.channels()];
        for (index, ray) in rays.iter().enumerate().filter(|(index, _)| hits[*index].is_none()) {
            radiance.fill(0.0);
            self.shown.add_sky(scene, DVec3::from(ray.direction), share, &mut radiance);
            let pixel = &mut pixels[index / SUBSAMPLES as usize * radiance.len()..];
            pixel.iter_mut().zip(&radiance).for_each(|([number, _], radiance)| *number += radiance);
        }
    }

    /// Adds the radiances of a row of pixels, each seen at [`SUBSAMPLES`] places, and their standard errors.
    fn shade_row(&self, places: &[Option<Place>], scratch: &mut Scratch, pixels: &mut [[f32; 2]]) {
        // If all rays of a pixel meet one surface, one of the points with all visibility rays is as good as all points with a share
        // each.
        let Self { gather, error_bars, shown } = *self;
        let channels = gather.scene.channels();
        let is_one = |places: &[Option<Place>]| {
            let is_first = |other: Option<Place>| other.map(|place| place.surface) == places[0].map(|place| place.surface);
            places[0].is_some() && places.iter().all(|place| is_first(*place))
        };
        let mut gathered = Gathered::default();
        for shaded in [1, SUBSAMPLES] {
            // All points with the same number of rays together.
            let of_pixel = places.chunks(SUBSAMPLES as usize).enumerate().filter(|(_, places)| is_one(places) == (shaded == 1));
            let points =
                of_pixel.flat_map(|(column, places)| places[..shaded as usize].iter().flatten().map(move |place| (column, *place)));
            let (columns, points): (Vec<usize>, Vec<Place>) = points.unzip();
            let rays_each = gather.budget.rays.min(RAYS_PER_PIXEL).div_ceil(shaded);
            let budget = RayBudget { rays: rays_each, least_chance: LEAST_CHANCE, ..gather.budget };
            gather.values_at(&points, budget, scratch, &mut gathered);

            // Of a pixel that several points make up, their errors are taken to be as large as if they were alike.
            let share = 1.0 / f64::from(shaded);
            for (value, &radiosity) in gathered.radiosity.iter().enumerate() {
                let (point, channel) = (value / channels, value % channels);
                let material = gather.scene.material_of(points[point].surface);
                let [number, error] = &mut pixels[columns[point] * channels + channel];
                let of_value = error_bars.map_or(0.0, |error_bars| error_bars.standard_error(&gathered, value));
                *number += (share * shown.of(material, channel, radiosity)) as f32;
                *error += (share * shown.of_difference(material, channel, of_value)) as f32;
            }
        }
    }
}
