//! Values for whoever does not wait for good ones.

use std::time::Instant;

use super::Evaluator;
use crate::bounds::PointBounds;
use crate::progress::{Observer, Silent};
use crate::scene::SurfacePoint;
use crate::values::{self, Gather, Values};

/// How many points are tried to see how long values take: enough for all threads, and for points that differ.
const TRIED: usize = 64;

/// The fewest rays that a value takes: light that arrives from a quarter of what is seen is not missed.
const LEAST_RAYS: u32 = 4;

impl Evaluator {
    /// [`Evaluator::bounded_values_at`] in about so many seconds if it can be done: with fewer rays to a point than the solve planned, as a trial at a
    /// few of the points tells. Standard errors are those of the rays that were taken.
    pub fn hurried_values_at(
        &self,
        points: &[SurfacePoint],
        seconds: f64,
        observer: &dyn Observer,
    ) -> Option<(Values, Option<PointBounds>)> {
        self.gathered_values_at(points, observer, |gather| gather.budget.rays = rays_within(gather, points, seconds))
    }
}

/// How many rays a value at each of these points may take.
fn rays_within(gather: &mut Gather<'_>, points: &[SurfacePoint], seconds: f64) -> u32 {
    let planned = gather.budget.rays;
    let tried: Vec<SurfacePoint> = points.iter().step_by(points.len().div_ceil(TRIED).max(1)).copied().collect();
    gather.budget.rays = planned.min(LEAST_RAYS);
    let start = Instant::now();
    values::values_at(gather, None, &tried, &Silent);
    let of_all = start.elapsed().as_secs_f64() * points.len() as f64 / tried.len().max(1) as f64;
    let rays = f64::from(LEAST_RAYS) * seconds / of_all.max(f64::MIN_POSITIVE);
    (rays.max(f64::from(LEAST_RAYS)) as u32).min(planned)
}
