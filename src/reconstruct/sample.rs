//! Values at many points.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::light_paths::Place;
use super::reconstruction::{Way, place_at};
use super::shared_irradiance::{SharedIrradiance, Sharing};
use super::{Effort, Reconstruction, Scratch, SurfacePoint, Values};
use crate::progress::{Observer, Progress, Stage};

/// A point belongs to a surface within this part of the scene's diagonal: files round to six or seven digits.
const TOLERANCE: f64 = 1e-5;

/// Progress is told, and cancelling asked, once in so many points.
const BATCH: usize = 256;

/// Radiosities at `points`, in their order; `None` if the observer cancels.
///
/// Over the hemisphere, points that lie close share their indirect light where it is smooth, see [`Sharing`].
pub(crate) fn values_at(reconstruction: &Reconstruction<'_>, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Values> {
    let Reconstruction { scene, hierarchy, way, effort } = reconstruction;
    let channels = scene.channels();

    // Where the points are.
    let tolerance = TOLERANCE * scene.bounds().diagonal();
    let place = |point: &SurfacePoint| {
        let (position, normal) = (DVec3::from(point.position), DVec3::from(point.normal));
        Some(place_at(position, hierarchy.surface_at(position, normal, tolerance)?, effort.seed))
    };
    let places: Vec<Option<Place>> = points.par_iter().map(place).collect();
    let missed = places.iter().filter(|place| place.is_none()).count();

    // What they share.
    let cancelled = || observer.cancelled();
    let shared = match way {
        Way::Hemisphere(gather) => Some(
            Sharing { gather, hierarchy, rays: effort.rays, seed: effort.seed, tolerance, cancelled: &cancelled }.share(&places),
        ),
        Way::Links(_) => None,
    };

    // Their values, batch by batch.
    let mut radiosity = vec![f32::NAN; channels * points.len()];
    let (done, total) = (AtomicUsize::new(0), points.len());
    radiosity.par_chunks_mut(channels * BATCH).zip(places.par_chunks(BATCH)).enumerate().for_each_init(
        || (Scratch::default(), Vec::new()),
        |(scratch, values), (batch, (radiosity, places))| {
            if observer.cancelled() {
                return;
            }
            let on_surfaces = places.iter().enumerate().filter_map(|(index, place)| Some((index, (*place)?)));
            let shares = |index: usize| shared.as_ref().and_then(|shared| shared.of(batch * BATCH + index));
            let (sharing, own): (Vec<_>, Vec<_>) = on_surfaces.partition(|(index, _)| shares(*index).is_some());
            let mut write = |of: &[(usize, Place)], values: &[f64]| {
                for ((index, _), value) in of.iter().zip(values.chunks(channels)) {
                    let radiosity = &mut radiosity[index * channels..][..channels];
                    radiosity.iter_mut().zip(value).for_each(|(radiosity, value)| *radiosity = *value as f32);
                }
            };

            let effort = Effort { rays: shared.as_ref().map_or(effort.rays, |shared: &SharedIrradiance| shared.rays), ..*effort };
            values.clear();
            values.resize(channels * own.len(), 0.0);
            reconstruction.radiosities_at(own.iter().map(|(_, place)| (place.point, place.surface)), effort, scratch, values);
            write(&own, values);
            if let Way::Hemisphere(gather) = way {
                let places: Vec<Place> = sharing.iter().map(|(_, place)| *place).collect();
                values.clear();
                values.extend(sharing.iter().filter_map(|(index, _)| shares(*index)).flatten().map(|&h| f64::from(h)));
                gather.add_sampled_direct(&places, effort.rays, &mut scratch.paths, values);
                reconstruction.reflect(&places, values);
                write(&sharing, values);
            }

            let done = done.fetch_add(places.len(), Ordering::Relaxed) + places.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    (!observer.cancelled()).then_some(Values { channels, radiosity, missed })
}
