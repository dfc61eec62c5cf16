//! A picture of the solution: first hits from the backend, and the gather at each of them.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use super::coarse_to_fine::CoarseToFine;
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
/// where nothing is, but for the sky; and the part of the pixels that were taken, which is 1 but where the time ended before: others show one beside them,
/// and their errors are not known. `None` if the observer cancels.
pub(crate) fn render(
    (gather, error_bars): (&Gather<'_>, Option<ErrorBars>),
    visibility: &Rays<'_>,
    (camera, size): (&CameraRays, [u32; 2]),
    shown: Shown,
    deadline: Option<Instant>,
    observer: &dyn Observer,
) -> Option<(Image, f64)> {
    let ([width, height], channels) = (size, gather.scene.channels());
    let (shader, share, count) = (Shader { gather, error_bars, shown }, gather.share(), width as usize * height as usize);
    // Rows that other processes take count as done.
    let mut is_done: Vec<bool> = (0..count).map(|pixel| !share.has(pixel / width as usize)).collect();
    let own = is_done.iter().filter(|&&is_done| !is_done).count();
    let (mut pixels, done) = (vec![[0.0; 2]; channels * count], AtomicUsize::new(0));
    let grids = deadline.map_or(CoarseToFine::at_once(size), |_| CoarseToFine::from_few(size));
    for (number, step) in grids.steps().enumerate() {
        // The first grid is taken to its end: else there is nothing to show.
        let is_late = || number > 0 && deadline.is_some_and(|deadline| Instant::now() >= deadline);
        let rows = pixels.par_chunks_mut(channels * width as usize).zip(is_done.par_chunks_mut(width as usize)).enumerate();
        let of_grid = rows.filter(|(row, _)| row % step as usize == 0);
        of_grid.for_each_init(<(Scratch, Vec<Option<Hit>>)>::default, |(scratch, hits), (row, (pixels, is_done))| {
            if observer.cancelled() || is_late() {
                return;
            }
            // Where the rays through the pixels of a row arrive.
            let columns: Vec<u32> = (0..width).step_by(step as usize).filter(|&column| !is_done[column as usize]).collect();
            let subsamples =
                |&column: &u32| (0..SUBSAMPLES).map(move |sample| camera.through_pixel(column, row as u32, sample, SUBSAMPLES));
            let rays: Vec<Ray> = columns.iter().flat_map(subsamples).collect();
            visibility.first_hits(&rays, hits);
            let place = |(ray, hit): (&Ray, &Option<Hit>)| {
                let (direction, hit) = (DVec3::from(ray.direction), hit.as_ref()?);
                let surface = gather.scene.side_towards(SurfaceId(hit.surface), -direction)?;
                Some(gather.place_at(DVec3::from(ray.origin) + hit.distance * direction, surface))
            };
            let places: Vec<Option<Place>> = rays.iter().zip(hits.iter()).map(place).collect();

            // What is seen there.
            shader.shade_row((&columns, &places), scratch, pixels);
            shader.add_sky((&columns, &rays), hits, pixels);
            columns.iter().for_each(|&column| is_done[column as usize] = true);

            let done = done.fetch_add(columns.len(), Ordering::Relaxed) + columns.len();
            let fraction = Some(done as f64 / own as f64);
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        });
        if observer.cancelled() {
            return None;
        }
    }
    share.exchange_chunks(&mut pixels, channels * width as usize);
    grids.for_each_missing(&is_done, |missing, instead| {
        for channel in 0..channels {
            pixels[missing * channels + channel] = [pixels[instead * channels + channel][0], f32::NAN];
        }
    });
    let (radiance, standard_error) = pixels.into_iter().map(|[radiance, error]| (radiance, error)).unzip();
    let image = Image { width, height, channels, radiance, standard_error: error_bars.map(|_| standard_error) };
    Some((image, done.into_inner() as f64 / own.max(1) as f64))
}

impl Shader<'_> {
    /// Adds what the pixels of a row in some columns show of the sky, by the [`SUBSAMPLES`] rays through each.
    fn add_sky(&self, (columns, rays): (&[u32], &[Ray]), hits: &[Option<Hit>], pixels: &mut [[f32; 2]]) {
        let (scene, share) = (self.gather.scene, 1.0 / f64::from(SUBSAMPLES));
        let mut radiance = vec![0.0; scene.channels()];
        for (index, ray) in rays.iter().enumerate().filter(|(index, _)| hits[*index].is_none()) {
            radiance.fill(0.0);
            self.shown.add_sky(scene, DVec3::from(ray.direction), share, &mut radiance);
            let pixel = &mut pixels[columns[index / SUBSAMPLES as usize] as usize * radiance.len()..];
            pixel.iter_mut().zip(&radiance).for_each(|([number, _], radiance)| *number += radiance);
        }
    }

    /// Adds the radiances of the pixels of a row in some columns, each seen at [`SUBSAMPLES`] places, and their standard errors.
    fn shade_row(&self, (columns, places): (&[u32], &[Option<Place>]), scratch: &mut Scratch, pixels: &mut [[f32; 2]]) {
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
            let of_pixel = columns.iter().zip(places.chunks(SUBSAMPLES as usize));
            let of_pixel = of_pixel.filter(|(_, places)| is_one(places) == (shaded == 1));
            let points = of_pixel.flat_map(|(column, places)| {
                places[..shaded as usize].iter().flatten().map(move |place| (*column as usize, *place))
            });
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
