//! A picture of how far apart the bounds of the radiosity are at every place that a camera sees.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::{Camera, CameraError};
use super::image::Image;
use crate::bounds::RadiosityBounds;
use crate::hierarchy::Hierarchy;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Ray;

/// Rays through each pixel.
const SUBSAMPLES: u32 = 4;

/// `(upper - lower) / pi` through the pixels of a camera, black where a back or nothing is met; `None` if the observer cancels.
///
/// # Errors
/// See [`Camera::validate`].
pub(crate) fn render_width(
    bounds: &RadiosityBounds,
    scene: &Scene,
    hierarchy: &Hierarchy,
    visibility: &Rays<'_>,
    camera: &Camera,
    observer: &dyn Observer,
) -> Result<Option<Image>, CameraError> {
    let through = camera.rays()?;
    let (channels, width, height) = (scene.channels(), camera.width, camera.height);
    let mut image = Image::black(width, height, channels);
    let done = AtomicUsize::new(0);
    image.radiance.par_chunks_mut(channels * width as usize).enumerate().for_each_init(Vec::new, |hits, (row, pixels)| {
        if observer.cancelled() {
            return;
        }
        let subsamples = |column| (0..SUBSAMPLES).map(move |sample| through.through_pixel(column, row as u32, sample, SUBSAMPLES));
        let rays: Vec<Ray> = (0..width).flat_map(subsamples).collect();
        visibility.first_hits(&rays, hits);
        for (index, (ray, hit)) in rays.iter().zip(hits.iter()).enumerate() {
            let direction = DVec3::from(ray.direction);
            let Some(hit) = hit else { continue };
            let Some(surface) = scene.side_towards(SurfaceId(hit.surface), -direction) else { continue };
            let leaf = hierarchy.leaf_at(surface, DVec3::from(ray.origin) + hit.distance * direction);
            let pixel = &mut pixels[index / SUBSAMPLES as usize * channels..][..channels];
            for ((pixel, lower), upper) in pixel.iter_mut().zip(bounds.lower(leaf)).zip(bounds.upper(leaf)) {
                *pixel += ((upper - lower) / (PI * f64::from(SUBSAMPLES))) as f32;
            }
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        let fraction = Some(done as f64 / f64::from(height));
        observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
    });
    Ok((!observer.cancelled()).then_some(image))
}
