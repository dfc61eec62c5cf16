//! Values at the points that a user asks for.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::budget::RayBudget;
use super::gather::{Gather, Over, Scratch};
use super::irradiance_cache::{CacheBuilder, IrradianceCache};
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfacePoint;

/// Radiosities at points.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// Channels per value.
    pub channels: usize,
    /// `channels` radiosities per point in W/m^2, point after point; NaN at points that lie on no surface.
    pub radiosity: Vec<f32>,
    /// How many points lie on no surface.
    pub missed: usize,
}

/// A point lies on a surface if it is within this part of the scene's diagonal: files round to six or seven digits.
const TOLERANCE: f64 = 1e-5;

/// Progress is reported, and cancelling asked for, once in so many points.
const BATCH: usize = 256;

/// Radiosities at `points`, in their order; `None` if the observer cancels.
///
/// Over cells, points that lie close take indirect light from an irradiance cache where it is smooth, see [`CacheBuilder`].
pub(crate) fn values_at(gather: &Gather<'_>, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Values> {
    let channels = gather.scene.channels();

    // The surfaces that the points lie on.
    let tolerance = TOLERANCE * gather.scene.bounds().diagonal();
    let place = |point: &SurfacePoint| {
        let (position, normal) = (DVec3::from(point.position), DVec3::from(point.normal));
        Some(gather.place_at(position, gather.hierarchy.surface_at(position, normal, tolerance)?))
    };
    let places: Vec<Option<Place>> = points.par_iter().map(place).collect();
    let missed = places.iter().filter(|place| place.is_none()).count();

    // The irradiance cache. It may leave fewer rays to points.
    let cache = build_cache(gather, &places, tolerance, observer);
    let budget = RayBudget { rays: cache.as_ref().map_or(gather.budget.rays, |cache| cache.rays), ..gather.budget };

    // Their values, batch by batch.
    let mut radiosity = vec![f32::NAN; channels * points.len()];
    let (done, total) = (AtomicUsize::new(0), points.len());
    radiosity.par_chunks_mut(channels * BATCH).zip(places.par_chunks(BATCH)).enumerate().for_each_init(
        Scratch::default,
        |scratch, (batch, (radiosity, places))| {
            if observer.cancelled() {
                return;
            }
            let cached = |index: usize| cache.as_ref().and_then(|cache| cache.of(batch * BATCH + index));
            take_batch(gather, places, cached, budget, scratch, radiosity);

            let done = done.fetch_add(places.len(), Ordering::Relaxed) + places.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    (!observer.cancelled()).then_some(Values { channels, radiosity, missed })
}

/// The irradiance cache of some places, over cells.
fn build_cache(gather: &Gather<'_>, places: &[Option<Place>], tolerance: f64, observer: &dyn Observer) -> Option<IrradianceCache> {
    let Over::Cells(final_gather) = &gather.over else { return None };
    let RayBudget { rays, seed, .. } = gather.budget;
    let cancelled = || observer.cancelled();
    let builder = CacheBuilder { gather: final_gather, hierarchy: gather.hierarchy, rays, seed, tolerance, cancelled: &cancelled };
    Some(builder.build(places))
}

/// The values of a batch of places. Those with `cached` indirect irradiance gather direct light alone.
fn take_batch<'c>(
    gather: &Gather<'_>,
    places: &[Option<Place>],
    cached: impl Fn(usize) -> Option<&'c [f32]>,
    budget: RayBudget,
    scratch: &mut Scratch,
    radiosity: &mut [f32],
) {
    let channels = gather.scene.channels();
    let on_surfaces = places.iter().enumerate().filter_map(|(index, place)| Some((index, (*place)?)));
    let (in_cache, own): (Vec<_>, Vec<_>) = on_surfaces.partition(|(index, _)| cached(*index).is_some());
    let mut write = |of: &[(usize, Place)], values: &[f64]| {
        for ((index, _), value) in of.iter().zip(values.chunks(channels)) {
            let radiosity = &mut radiosity[index * channels..][..channels];
            radiosity.iter_mut().zip(value).for_each(|(radiosity, value)| *radiosity = *value as f32);
        }
    };

    // Places that gather everything.
    let own_places: Vec<Place> = own.iter().map(|(_, place)| *place).collect();
    let mut values = vec![0.0; channels * own.len()];
    gather.radiosities_at(&own_places, budget, scratch, &mut values);
    write(&own, &values);

    // Places that take indirect light from the cache.
    if let Over::Cells(final_gather) = &gather.over {
        let places: Vec<Place> = in_cache.iter().map(|(_, place)| *place).collect();
        values.clear();
        values.extend(in_cache.iter().filter_map(|(index, _)| cached(*index)).flatten().map(|&h| f64::from(h)));
        final_gather.add_sampled_direct(&places, budget.rays, &mut scratch.paths, &mut values);
        gather.reflect(&places, &mut values);
        write(&in_cache, &values);
    }
}
