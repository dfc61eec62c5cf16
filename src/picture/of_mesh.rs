//! A picture of a lit mesh: first hits from the backend, and the function at each of them.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use super::image::Image;
use super::shown::Shown;
use crate::mesh::MeshReader;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// Rays through a pixel, and through one that shows more than one surface: powers of 2.
const SUBSAMPLES: u32 = 4;
const SUBSAMPLES_AT_EDGES: u32 = 16;

/// What is shown through the pixels of a camera, black where a back or nothing is met. `None` if the observer cancels.
pub(crate) fn render_mesh(
    scene: &Scene,
    mesh: &MeshReader<'_>,
    visibility: &Rays<'_>,
    (camera, [width, height]): (&CameraRays, [u32; 2]),
    shown: Shown,
    observer: &dyn Observer,
) -> Option<Image> {
    let channels = scene.channels();
    let mut radiance = vec![0.0; channels * width as usize * height as usize];
    let done = AtomicUsize::new(0);
    radiance.par_chunks_mut(channels * width as usize).enumerate().for_each_init(
        || Row { scene, mesh, visibility, shown, hits: Vec::new(), radiosity: vec![0.0; channels] },
        |row, (number, pixels)| {
            if observer.cancelled() {
                return;
            }
            // All pixels, then those again that have edges.
            let through =
                |column: u32, count: u32| (0..count).map(move |sample| camera.through_pixel(column, number as u32, sample, count));
            let columns: Vec<u32> = (0..width).collect();
            let at_edges = row.shade(&columns, SUBSAMPLES, through, pixels);
            row.shade(&at_edges, SUBSAMPLES_AT_EDGES, through, pixels);

            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(height));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    (!observer.cancelled()).then_some(Image { width, height, channels, radiance, standard_error: None })
}

/// What a row of pixels is shaded by.
struct Row<'a> {
    scene: &'a Scene,
    mesh: &'a MeshReader<'a>,
    visibility: &'a Rays<'a>,
    shown: Shown,
    hits: Vec<Option<Hit>>,
    radiosity: Vec<f64>,
}

impl Row<'_> {
    /// Shades the pixels of some columns by so many rays each, and returns the columns that show more than one surface.
    fn shade<I: Iterator<Item = Ray>>(
        &mut self,
        columns: &[u32],
        count: u32,
        through: impl Fn(u32, u32) -> I,
        pixels: &mut [f32],
    ) -> Vec<u32> {
        let rays: Vec<Ray> = columns.iter().flat_map(|&column| through(column, count)).collect();
        self.visibility.first_hits(&rays, &mut self.hits);
        let channels = self.radiosity.len();
        let mut at_edges = Vec::new();
        for ((&column, rays), hits) in columns.iter().zip(rays.chunks(count as usize)).zip(self.hits.chunks(count as usize)) {
            let pixel = &mut pixels[column as usize * channels..][..channels];
            pixel.fill(0.0);
            for (ray, hit) in rays.iter().zip(hits) {
                let Some(hit) = hit else { continue };
                let direction = DVec3::from(ray.direction);
                let Some(surface) = self.scene.side_towards(SurfaceId(hit.surface), -direction) else { continue };
                self.mesh.radiosity_at(DVec3::from(ray.origin) + hit.distance * direction, surface, &mut self.radiosity);
                let material = self.scene.material_of(surface);
                for (channel, (sum, &radiosity)) in pixel.iter_mut().zip(&self.radiosity).enumerate() {
                    *sum += (self.shown.of(material, channel, radiosity) / f64::from(count)) as f32;
                }
            }
            let surface = |hit: &Option<Hit>| hit.as_ref().map(|hit| hit.surface);
            if hits.iter().any(|hit| surface(hit) != surface(&hits[0])) {
                at_edges.push(column);
            }
        }
        at_edges
    }
}
