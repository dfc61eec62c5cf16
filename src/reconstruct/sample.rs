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
        || (Scratch::default(), Vec::new(), Vec::new(), Vec::new()),
        |(scratch, indices, places, values), (radiosity, points)| {
            if observer.cancelled() {
                return;
            }
            // The points that lie on a surface.
            indices.clear();
            places.clear();
            for (index, point) in points.iter().enumerate() {
                let position = DVec3::from(point.position);
                if let Some(surface) = reconstruction.hierarchy.surface_at(position, DVec3::from(point.normal), tolerance) {
                    indices.push(index);
                    places.push((position, surface));
                }
            }

            // Their values, all together.
            values.clear();
            values.resize(channels * places.len(), 0.0);
            reconstruction.radiosities_at(places.iter().copied(), reconstruction.effort, scratch, values);
            for (&index, value) in indices.iter().zip(values.chunks(channels)) {
                let radiosity = &mut radiosity[index * channels..][..channels];
                radiosity.iter_mut().zip(value).for_each(|(radiosity, value)| *radiosity = *value as f32);
            }

            let done = done.fetch_add(points.len(), Ordering::Relaxed) + points.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    let missed = radiosity.chunks(channels).filter(|value| value[0].is_nan()).count();
    (!observer.cancelled()).then_some(Values { channels, radiosity, missed })
}
