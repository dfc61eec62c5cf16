//! How references are made: a pilot tells how noisy points are, then each gets as many paths as the two norms need.

use patchlight::scene::{Material, Scene, SurfaceId, SurfacePoint};
use patchlight::visibility::Backend;
use rayon::prelude::*;

use super::norms::{Norm, square};
use super::path_tracer::{MOST_OF_A_BATCH, PathTracer, Portal};
use super::points::{LeftOut, spread};
use super::reference::Reference;
use super::triangles::{Random, sub};

const POINTS: usize = 600;
const SEED: u64 = 2;

/// Noise that is aimed at, in either norm.
const NOISE: f64 = 0.002;

/// Batches of the pilot, and their paths.
const PILOT: (u64, u32) = (8, 128);
/// Batches of a point; more where a batch would be too long.
const BATCHES: u32 = 16;
/// No point gets fewer than this part of the mean number of paths, since the pilot may have missed what is rare.
const LEAST: f64 = 0.25;
/// Paths of the shortest batch.
const SHORTEST: u32 = 64;

/// What batches of paths say of a point.
struct Found {
    radiosity: [f64; 3],
    /// The squares of standard errors.
    variance: [f64; 3],
    rays: u64,
}

/// The reference of a scene, for about so many rays at most.
pub fn make(scene: &Scene, portal: Option<Portal>, backend: Backend, most_rays: f64) -> Reference {
    let tracer = PathTracer::new(scene, portal, backend);
    let reflects = |material: &Material| material.reflectance.iter().any(|&rho| rho > 0.0);
    let places: Vec<(SurfaceId, SurfacePoint)> = (spread(scene, reflects, LeftOut::AllBacks, POINTS, SEED).into_iter())
        .map(|(surface, point)| (surface, SurfacePoint { position: point.position.map(nanometres), ..point }))
        .collect();
    let pilot = traced(&tracer, &places, &vec![PILOT; POINTS], 1);
    let exitance: Vec<[f64; 3]> =
        places.iter().map(|(surface, _)| std::array::from_fn(|k| scene.material_of(*surface).exitance[k])).collect();
    let found = traced(&tracer, &places, &batches(&pilot, &exitance, most_rays), 2);
    Reference {
        surfaces: places.iter().map(|(surface, _)| *surface).collect(),
        points: places.iter().map(|(_, point)| *point).collect(),
        radiosity: found.iter().map(|found| found.radiosity).collect(),
        noise: found.iter().map(|found| found.variance.map(f64::sqrt)).collect(),
        exitance,
    }
}

fn nanometres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e9
}

/// Batches and their paths for each point, by what the pilot found.
///
/// With n paths a point of variance v adds w v / n to the square of the noise: the fewest paths for a noise are in proportion to sqrt(w v).
fn batches(pilot: &[Found], exitance: &[[f64; 3]], most_rays: f64) -> Vec<(u64, u32)> {
    let light: Vec<f64> =
        pilot.iter().zip(exitance).map(|(found, exitance)| square(sub(found.radiosity, *exitance)).sqrt()).collect();
    let of_pilot = PILOT.0 as f64 * f64::from(PILOT.1);
    let mut paths = vec![0.0_f64; pilot.len()];
    for norm in Norm::ALL {
        let weights = norm.weights(&light);
        let roots =
            weights.iter().zip(pilot).map(|(weight, found)| (weight * of_pilot * found.variance.iter().sum::<f64>()).sqrt());
        let roots: Vec<f64> = roots.collect();
        let all: f64 = roots.iter().sum();
        paths.iter_mut().zip(&roots).for_each(|(paths, root)| *paths = paths.max(root * all / (NOISE * NOISE)));
    }
    let least = LEAST * paths.iter().sum::<f64>() / paths.len() as f64;
    paths.iter_mut().for_each(|paths| *paths = paths.max(least));

    let rays: f64 = paths.iter().zip(pilot).map(|(paths, found)| paths * found.rays as f64 / of_pilot).sum();
    let part = (most_rays / rays).min(1.0);
    eprintln!("  {rays:.1e} rays would do, {:.0}% of them are taken", 100.0 * part);
    let of_point = |paths: f64| {
        let longest = (part * paths / f64::from(BATCHES)).clamp(f64::from(SHORTEST), f64::from(MOST_OF_A_BATCH));
        let of_batch = 1 << longest.log2().floor() as u32;
        ((part * paths / f64::from(of_batch)).ceil().max(f64::from(BATCHES)) as u64, of_batch)
    };
    paths.into_iter().map(of_point).collect()
}

/// Means and standard errors over batches, point by point.
fn traced(tracer: &PathTracer, places: &[(SurfaceId, SurfacePoint)], batches: &[(u64, u32)], seed: u64) -> Vec<Found> {
    let of_point = |point: usize| {
        let ((surface, at), (count, paths)) = (places[point], batches[point]);
        let batch = |number: u64| {
            let mut seeds = Random(seed << 60 | (point as u64) << 32 | number);
            tracer.batch(surface, at.position, paths, seeds.bits())
        };
        let all: Vec<_> = (0..count).into_par_iter().map(batch).collect();
        let radiosity = [0, 1, 2].map(|k| all.iter().map(|batch| batch.radiosity[k]).sum::<f64>() / count as f64);
        let squares = |k: usize| all.iter().map(|batch| (batch.radiosity[k] - radiosity[k]).powi(2)).sum::<f64>();
        let variance = [0, 1, 2].map(|k| squares(k) / (count * (count - 1)) as f64);
        Found { radiosity, variance, rays: all.iter().map(|batch| batch.rays).sum() }
    };
    (0..places.len()).into_par_iter().map(of_point).collect()
}
