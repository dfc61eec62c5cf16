//! Values at the points that a user asks for.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::budget::RayBudget;
use super::error_bars::ErrorBars;
use super::gather::{Gather, Gathered, Over, Scratch};
use super::irradiance_cache::{CacheBuilder, Fitted, IrradianceCache};
use crate::paths::Place;
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Scene, SurfaceId, SurfacePoint};

/// Radiosities at points.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// Channels per value.
    pub channels: usize,
    /// `channels` radiosities per point in W/m^2, point after point; NaN at points that lie on no surface.
    pub radiosity: Vec<f32>,
    /// The standard error of each, in W/m^2: noise, and what is known of bias. NaN where it is not known, as in solutions whose error was
    /// not estimated.
    pub standard_error: Vec<f32>,
    /// The number of the face in the input, from 0, that each point lies on; `None` for a point that lies on no surface.
    pub faces: Vec<Option<u32>>,
    /// How many points lie on no surface.
    pub missed: usize,
    /// The error over these points; `None` where standard errors are not known, or no light is reflected there.
    pub error: Option<ValuesError>,
}

/// An estimate of the error of values over the points that were asked for, by their standard errors: root mean squares, every point
/// counting alike, channels pooled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ValuesError {
    /// Relative to the root mean square of the reflected light.
    pub energy: f64,
    /// Over the lit points, relative to the reflected light at each, or to its median where it is darker.
    pub local: f64,
}

impl Values {
    /// Of radiosities with their standard errors, by point and channel, on these surfaces; `None` for a point that lies on none.
    pub(crate) fn of_numbers(scene: &Scene, surfaces: impl Iterator<Item = Option<SurfaceId>>, numbers: Vec<[f32; 2]>) -> Self {
        let (channels, mut faces, mut squares) = (scene.channels(), Vec::new(), Vec::new());
        for (surface, numbers) in surfaces.zip(numbers.chunks(channels)) {
            faces.push(surface.map(|surface| scene.surface(surface).face));
            let Some(surface) = surface else { continue };
            let of_channels = numbers.iter().zip(&scene.material_of(surface).exitance).map(|(numbers, e)| {
                let [radiosity, error] = numbers.map(f64::from);
                [(radiosity - e).powi(2), error.powi(2)]
            });
            squares.push(of_channels.fold([0.0; 2], |sum, squares| [sum[0] + squares[0], sum[1] + squares[1]]));
        }
        let error = ValuesError::of(&squares);
        let (radiosity, standard_error) = numbers.into_iter().map(|[radiosity, error]| (radiosity, error)).unzip();
        let missed = faces.iter().filter(|face| face.is_none()).count();
        Self { channels, radiosity, standard_error, faces, missed, error }
    }

    /// Bytes that so many take, with all that is needed to take them: places, cached irradiance, radiosities and squares of errors.
    pub fn bytes_of(points: usize, channels: usize) -> u64 {
        let of_channel = size_of::<[f32; 2]>() + 2 * size_of::<f32>() + size_of::<Fitted>();
        (points * (size_of::<Option<Place>>() + size_of::<Option<u32>>() + CROWDED + size_of::<[f64; 4]>() + channels * of_channel))
            as u64
    }
}

/// Bytes that it takes to find out where points crowd: their cells and numbers, sorted.
const CROWDED: usize = 96;

impl ValuesError {
    /// Of values with these squares of the reflected light and of the standard errors, point by point, channels added.
    fn of(squares: &[[f64; 2]]) -> Option<Self> {
        let mut lit: Vec<[f64; 2]> = squares.iter().copied().filter(|[light_sq, _]| *light_sq > 0.0).collect();
        lit.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [typical_sq, _] = *lit.get(lit.len().checked_sub(1)? / 2)?;
        let sum = |of: &dyn Fn(&[f64; 2]) -> f64| lit.iter().map(of).sum::<f64>();
        let all: f64 = squares.iter().map(|[_, error_sq]| error_sq).sum();
        let energy = (all / sum(&|[light_sq, _]| *light_sq)).sqrt();
        let local = (sum(&|[light_sq, error_sq]| error_sq / light_sq.max(typical_sq)) / lit.len() as f64).sqrt();
        (energy.is_finite() && local.is_finite()).then_some(Self { energy, local })
    }
}

/// A point lies on a surface if it is within this part of the scene's diagonal: files round to six or seven digits.
const TOLERANCE: f64 = 1e-5;

/// A point lies on a surface of a scene within so many metres.
pub(crate) fn tolerance(scene: &Scene) -> f64 {
    TOLERANCE * scene.bounds().diagonal()
}

/// Progress is reported, and cancelling asked for, once in so many points.
const BATCH: usize = 256;

/// Takes values at places.
struct Sampler<'a> {
    gather: &'a Gather<'a>,
    error_bars: Option<ErrorBars>,
    cache: Option<IrradianceCache>,
    budget: RayBudget,
}

/// Radiosities at `points`, in their order; `None` if the observer cancels.
///
/// Over cells, points that lie close take indirect light from an irradiance cache where it is smooth, see [`CacheBuilder`].
pub(crate) fn values_at(
    gather: &Gather<'_>,
    error_bars: Option<ErrorBars>,
    points: &[SurfacePoint],
    observer: &dyn Observer,
) -> Option<Values> {
    let channels = gather.scene.channels();

    // The surfaces that the points lie on.
    let tolerance = tolerance(gather.scene);
    let place = |point: &SurfacePoint| {
        let (position, normal) = (DVec3::from(point.position), DVec3::from(point.normal));
        Some(gather.place_at(position, gather.hierarchy.surface_at(position, normal, tolerance)?))
    };
    let places: Vec<Option<Place>> = points.par_iter().map(place).collect();

    // The irradiance cache. It may leave fewer rays to points.
    let cache = build_cache(gather, &places, tolerance, observer);
    let budget = RayBudget { rays: cache.as_ref().map_or(gather.budget.rays, |cache| cache.rays), ..gather.budget };
    let sampler = Sampler { gather, error_bars, cache, budget };

    // Their values, batch by batch.
    let mut numbers = vec![[f32::NAN; 2]; channels * points.len()];
    let (done, total, share) = (AtomicUsize::new(0), points.len(), gather.share());
    numbers.par_chunks_mut(channels * BATCH).zip(places.par_chunks(BATCH)).enumerate().for_each_init(
        Scratch::default,
        |scratch, (batch, (numbers, places))| {
            if observer.cancelled() || !share.has(batch) {
                return;
            }
            sampler.take(batch * BATCH, places, scratch, numbers);

            let done = done.fetch_add(places.len(), Ordering::Relaxed) + places.len();
            let fraction = Some(done as f64 / total as f64);
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction, links: 0, elements: 0, error: None });
        },
    );
    share.exchange_chunks(&mut numbers, channels * BATCH);
    if observer.cancelled() {
        return None;
    }

    Some(Values::of_numbers(gather.scene, places.iter().map(|place| place.as_ref().map(|place| place.surface)), numbers))
}

/// The irradiance cache of some places, over cells.
fn build_cache(gather: &Gather<'_>, places: &[Option<Place>], tolerance: f64, observer: &dyn Observer) -> Option<IrradianceCache> {
    let Over::Cells(final_gather) = &gather.over else { return None };
    let RayBudget { rays, seed, .. } = gather.budget;
    let cancelled = || observer.cancelled();
    let builder = CacheBuilder { gather: final_gather, hierarchy: gather.hierarchy, rays, seed, tolerance, cancelled: &cancelled };
    Some(builder.build(places))
}

impl Sampler<'_> {
    /// Fills in the values of some places and their standard errors, by place and channel; `first` is the number of the first place.
    /// Those with cached indirect irradiance gather direct light alone.
    fn take(&self, first: usize, places: &[Option<Place>], scratch: &mut Scratch, numbers: &mut [[f32; 2]]) {
        let Self { gather, budget, .. } = *self;
        let channels = gather.scene.channels();
        let cached = |index: usize| self.cache.as_ref().and_then(|cache| cache.of(first + index));
        let on_surfaces = places.iter().enumerate().filter_map(|(index, place)| Some((index, (*place)?)));
        let (in_cache, own): (Vec<_>, Vec<_>) = on_surfaces.partition(|(index, _)| cached(*index).is_some());

        // Places that gather everything.
        let places: Vec<Place> = own.iter().map(|(_, place)| *place).collect();
        let mut gathered = Gathered::default();
        gather.values_at(&places, budget, scratch, &mut gathered);
        for (number, &(index, _)) in own.iter().enumerate() {
            for channel in 0..channels {
                let value = number * channels + channel;
                numbers[index * channels + channel] =
                    [gathered.radiosity[value] as f32, self.standard_error(&gathered, value) as f32];
            }
        }

        // Places that take indirect light from the cache.
        let Over::Cells(final_gather) = &gather.over else { return };
        let places: Vec<Place> = in_cache.iter().map(|(_, place)| *place).collect();
        let fitted = || in_cache.iter().filter_map(|(index, _)| cached(*index)).flatten();
        let known = fitted().map(|of| [of.irradiance, of.by_cells_sq].map(f64::from));
        let gathered = gather.values_with_indirect(final_gather, &places, budget, known, scratch);
        for (value, fitted) in fitted().enumerate() {
            let (number, channel) = (value / channels, value % channels);
            let rho = gather.scene.material_of(places[number].surface).reflectance[channel];
            let error = self.standard_error(&gathered, value).hypot(rho * f64::from(fitted.variance).sqrt());
            numbers[in_cache[number].0 * channels + channel] = [gathered.radiosity[value] as f32, error as f32];
        }
    }

    fn standard_error(&self, gathered: &Gathered, value: usize) -> f64 {
        self.error_bars.map_or(f64::NAN, |error_bars| error_bars.standard_error(gathered, value))
    }
}
