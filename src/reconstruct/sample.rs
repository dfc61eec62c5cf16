//! Values at many points.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::{Reconstruction, Scratch, SurfacePoint, Values};
use crate::progress::{Observer, Progress, Stage};

/// A point belongs to a surface within this part of the scene's diagonal: files round to six or seven digits.
const TOLERANCE: f64 = 1e-5;

/// Progress is told, and cancelling asked, once in so many points.
const BATCH: usize = 256;

/// Radiosities at `points`, in their order; `None` if the observer cancels.
pub(crate) fn values_at(reconstruction: &Reconstruction<'_>, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Values> {
    let channels = reconstruction.scene.channels();
    let tolerance = TOLERANCE * reconstruction.scene.bounds().diagonal();
    let mut radiosity = vec![f32::NAN; channels * points.len()];
    let (done, total) = (AtomicUsize::new(0), points.len());

    radiosity.par_chunks_mut(channels * BATCH).zip(points.par_chunks(BATCH)).for_each_init(
        || (Scratch::default(), vec![0.0; channels]),
        |(scratch, value), (radiosity, points)| {
            if observer.cancelled() {
                return;
            }
            for (radiosity, point) in radiosity.chunks_mut(channels).zip(points) {
                let position = DVec3::from(point.position);
                if let Some(surface) = reconstruction.hierarchy.surface_at(position, DVec3::from(point.normal), tolerance) {
                    reconstruction.radiosities_at([(position, surface)].into_iter(), reconstruction.effort, scratch, value);
                    radiosity.iter_mut().zip(value.iter()).for_each(|(radiosity, value)| *radiosity = *value as f32);
                }
            }
            let done = done.fetch_add(points.len(), Ordering::Relaxed) + points.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    let missed = radiosity.chunks(channels).filter(|value| value[0].is_nan()).count();
    (!observer.cancelled()).then_some(Values { channels, radiosity, missed })
}
