//! What the rays through pixels meet, more of them where a pixel shows more than one surface.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use crate::mesh::{SeenPoint, SeenSurfaces};
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// Rays through a pixel, and through one that shows more than one surface: powers of 2.
const SUBSAMPLES: u32 = 4;
const SUBSAMPLES_AT_EDGES: u32 = 16;

/// The pixels of a camera.
#[derive(Clone, Copy)]
pub(super) struct Antialiased<'a> {
    pub scene: &'a Scene,
    pub visibility: &'a Rays<'a>,
    pub camera: &'a CameraRays,
    /// In pixels.
    pub size: [u32; 2],
}

/// What a ray through a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub column: u32,
    /// The part of the pixel.
    pub share: f64,
    pub met: Met,
}

/// What it meets.
#[derive(Clone, Copy, Debug)]
pub(super) enum Met {
    Surface(SurfaceId, DVec3),
    /// The sky, in a direction.
    Sky(DVec3),
}

impl Antialiased<'_> {
    /// Visits what the rays through the pixels of a row show; nothing where they meet a back.
    pub fn for_each_in_row(&self, row: u32, hits: &mut Vec<Option<Hit>>, mut visit: impl FnMut(Sight)) {
        // All pixels, then those again that have edges.
        let columns: Vec<u32> = (0..self.size[0]).collect();
        let at_edges = self.visit_columns((row, &columns, SUBSAMPLES), hits, &mut visit);
        self.visit_columns((row, &at_edges, SUBSAMPLES_AT_EDGES), hits, &mut visit);
    }

    /// Visits what is shown by so many rays through each pixel of some columns, but for those that show more than one surface, if more rays through
    /// these would tell more: their columns are returned.
    fn visit_columns(
        &self,
        (row, columns, count): (u32, &[u32], u32),
        hits: &mut Vec<Option<Hit>>,
        visit: &mut impl FnMut(Sight),
    ) -> Vec<u32> {
        let through = |&column: &u32| (0..count).map(move |sample| self.camera.through_pixel(column, row, sample, count));
        let rays: Vec<Ray> = columns.iter().flat_map(through).collect();
        self.visibility.first_hits(&rays, hits);
        let mut at_edges = Vec::new();
        for ((&column, rays), hits) in columns.iter().zip(rays.chunks(count as usize)).zip(hits.chunks(count as usize)) {
            let surface = |hit: &Option<Hit>| hit.as_ref().map(|hit| hit.surface);
            if count < SUBSAMPLES_AT_EDGES && hits.iter().any(|hit| surface(hit) != surface(&hits[0])) {
                at_edges.push(column);
                continue;
            }
            for (ray, hit) in rays.iter().zip(hits) {
                let direction = DVec3::from(ray.direction);
                let met = match hit {
                    None => Met::Sky(direction),
                    Some(hit) => {
                        let Some(surface) = self.scene.side_towards(SurfaceId(hit.surface), -direction) else { continue };
                        Met::Surface(surface, DVec3::from(ray.origin) + hit.distance * direction)
                    }
                };
                visit(Sight { column, share: 1.0 / f64::from(count), met });
            }
        }
        at_edges
    }

    /// All that is shown; `None` if the observer cancels.
    pub fn seen(&self, observer: &dyn Observer) -> Option<SeenSurfaces> {
        let seen = SeenSurfaces::new(self.scene);
        let of_row = |hits: &mut Vec<Option<Hit>>, row: u32| {
            let mut points: Vec<SeenPoint> = Vec::new();
            if !observer.cancelled() {
                self.for_each_in_row(row, hits, |Sight { share, met, .. }| {
                    if let Met::Surface(surface, point) = met {
                        points.push(seen.point(surface, point, share));
                    }
                });
            }
            points
        };
        let rows: Vec<Vec<SeenPoint>> = (0..self.size[1]).into_par_iter().map_init(Vec::new, of_row).collect();
        let mut seen = seen;
        rows.into_iter().for_each(|points| seen.extend(points));
        (!observer.cancelled()).then_some(seen)
    }

    /// Shades all pixels, by channel: `shade` adds what a ray shows to the pixel, with what `begin` makes for a row, along which neighbours follow each
    /// other. `None` if the observer cancels.
    pub fn shaded<Row>(
        &self,
        channels: usize,
        observer: &dyn Observer,
        begin: impl Fn() -> Row + Sync,
        shade: impl Fn(Sight, &mut Row, &mut [f32]) + Sync,
    ) -> Option<Vec<f32>> {
        let [width, height] = self.size.map(|side| side as usize);
        let (mut pixels, done) = (vec![0.0; channels * width * height], AtomicUsize::new(0));
        pixels.par_chunks_mut(channels * width).enumerate().for_each_init(Vec::new, |hits, (row, pixels)| {
            if observer.cancelled() {
                return;
            }
            let mut of_row = begin();
            self.for_each_in_row(row as u32, hits, |sight| {
                shade(sight, &mut of_row, &mut pixels[sight.column as usize * channels..][..channels]);
            });
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / height as f64);
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        });
        (!observer.cancelled()).then_some(pixels)
    }
}
