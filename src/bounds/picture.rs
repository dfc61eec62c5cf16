//! A picture of how much is left open: what lies between the bounds at every place that a camera sees.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::RadiosityBounds;
use crate::hierarchy::Hierarchy;
use crate::progress::{Observer, Progress, Stage};
use crate::reconstruct::{CameraRays, Image};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Ray;

/// Rays through each pixel.
const SUBSAMPLES: u32 = 4;

impl RadiosityBounds {
    /// `(upper - lower) / pi` through the pixels of an `image` that is still black, as for radiances; `None` if the observer
    /// cancels.
    pub(crate) fn render_width(
        &self,
        scene: &Scene,
        hierarchy: &Hierarchy,
        visibility: &Rays<'_>,
        camera: &CameraRays,
        mut image: Image,
        observer: &dyn Observer,
    ) -> Option<Image> {
        let (channels, width, height) = (image.channels, image.width, image.height);
        let done = AtomicUsize::new(0);
        image.radiance.par_chunks_mut(channels * width as usize).enumerate().for_each_init(Vec::new, |hits, (row, pixels)| {
            if observer.cancelled() {
                return;
            }
            let subsamples =
                |column| (0..SUBSAMPLES).map(move |sample| camera.through_pixel(column, row as u32, sample, SUBSAMPLES));
            let looks: Vec<Ray> = (0..width).flat_map(subsamples).collect();
            visibility.first_hits(&looks, hits);
            for (index, (look, hit)) in looks.iter().zip(hits.iter()).enumerate() {
                let direction = DVec3::from(look.direction);
                let Some(hit) = hit else { continue };
                let Some(surface) = scene.side_towards(SurfaceId(hit.surface), -direction) else { continue };
                let leaf = hierarchy.leaf_at(surface, DVec3::from(look.origin) + hit.distance * direction);
                let pixel = &mut pixels[index / SUBSAMPLES as usize * channels..][..channels];
                for ((pixel, lower), upper) in pixel.iter_mut().zip(self.lower(leaf)).zip(self.upper(leaf)) {
                    *pixel += ((upper - lower) / (PI * f64::from(SUBSAMPLES))) as f32;
                }
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(height));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        });
        (!observer.cancelled()).then_some(image)
    }
}
