//! Pixels as a path tracer finds them: twice each, independently, so that the squared error of a picture is known without bias.

use patchlight::picture::{Camera, CameraRays, Image};
use patchlight::scene::Scene;
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};
use rayon::prelude::*;

use super::path_tracer::PathTracer;
use super::triangles::{Random, add, times};

/// Rays through a pixel in each half of its reference, and the paths from where each of them arrives.
const POSITIONS: u32 = 256;
const PATHS: u32 = 16;

/// A pixel: its number, and the radiosity that is reflected through it, in two halves.
struct Pixel {
    number: usize,
    reflected: [[f64; 3]; 2],
    /// What surfaces emit through it, which is known.
    emitted: [[f64; 3]; 2],
}

/// Pixels drawn at random from a picture of the default view.
pub struct Reference(Vec<Pixel>);

impl Reference {
    /// Traces `count` pixels.
    pub fn trace(scene: &Scene, [width, height]: [u32; 2], count: usize) -> Self {
        let visibility = build(Backend::Auto, &OccluderMesh::of_scene(scene)).expect("a backend of this build");
        let rays = Camera::default_view(scene, &*visibility, width, height).rays().expect("a camera");
        let tracer = PathTracer::new(scene, None, Backend::Auto);
        let of_pixel = |index: usize| {
            // One in each of as many strata of all pixels.
            let pixels = width as usize * height as usize;
            let drawn = (index as f64 + Random(index as u64).unit()) / count as f64;
            let number = ((drawn * pixels as f64) as usize).min(pixels - 1);
            let at = [(number % width as usize) as f64, (number / width as usize) as f64];
            let halves = [1, 2].map(|half| trace_half(scene, &*visibility, (&rays, &tracer), at, (number as u64) << 2 | half));
            Pixel { number, reflected: halves.map(|half| half[0]), emitted: halves.map(|half| half[1]) }
        };
        Self((0..count).into_par_iter().map(of_pixel).collect())
    }

    /// One pixel a line: its number, and twelve radiosities.
    pub fn written(&self) -> String {
        let line = |pixel: &Pixel| {
            let numbers: Vec<f64> = [pixel.reflected, pixel.emitted].as_flattened().as_flattened().to_vec();
            format!("{} {}\n", pixel.number, numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" "))
        };
        self.0.iter().map(line).collect()
    }

    /// The same, read again.
    pub fn read(text: &str) -> Self {
        let pixel = |line: &str| {
            let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().expect("a number")).collect();
            let of = |half: usize| std::array::from_fn(|k| numbers[1 + 3 * half + k]);
            Pixel { number: numbers[0] as usize, reflected: [of(0), of(1)], emitted: [of(2), of(3)] }
        };
        Self(text.lines().map(pixel).collect())
    }

    pub fn pixels(&self) -> usize {
        self.0.len()
    }

    /// How far a picture is off, locally and by energy, over the pixels that show anything that reflects, each with its standard error; and the same
    /// without the pixels through which anything emits, at whose edges a picture is off by how finely it is sampled there.
    pub fn errors_of(&self, image: &Image) -> [[f64; 2]; 4] {
        let emits = |pixel: &Pixel| pixel.emitted.as_flattened().iter().any(|&emitted| emitted > 0.0);
        let [local, energy] = self.errors_over(image, |_| true);
        let [local_dark, energy_dark] = self.errors_over(image, |pixel| !emits(pixel));
        [local_dark, energy_dark, local, energy]
    }

    fn errors_over(&self, image: &Image, counts: impl Fn(&Pixel) -> bool) -> [[f64; 2]; 2] {
        let squares = |pixel: &Pixel| {
            let shown = &image.radiance[3 * pixel.number..][..3];
            let off = |half: usize, k: usize| {
                std::f64::consts::PI * f64::from(shown[k]) - pixel.reflected[half][k] - pixel.emitted[half][k]
            };
            let error: f64 = (0..3).map(|k| off(0, k) * off(1, k)).sum();
            let light: f64 = (0..3).map(|k| pixel.reflected[0][k] * pixel.reflected[1][k]).sum();
            [error, light]
        };
        let all: Vec<[f64; 2]> =
            self.0.iter().filter(|pixel| counts(pixel)).map(squares).filter(|[_, light]| *light > 0.0).collect();
        let mut light: Vec<f64> = all.iter().map(|of| of[1]).collect();
        light.sort_by(f64::total_cmp);
        let (typical, mean) = (light[light.len() / 2], light.iter().sum::<f64>() / light.len() as f64);
        let root = |weight: &dyn Fn(f64) -> f64| {
            let parts: Vec<f64> = all.iter().map(|&[error, light]| error / weight(light)).collect();
            let count = parts.len() as f64;
            let square = parts.iter().sum::<f64>() / count;
            let scatter = parts.iter().map(|part| (part - square).powi(2)).sum::<f64>() / count;
            let error = square.max(0.0).sqrt();
            [error, 0.5 * (scatter / count).sqrt() / error.max(f64::MIN_POSITIVE)]
        };
        [root(&|light| light.max(typical)), root(&|_| mean)]
    }
}

/// What is reflected and what is emitted through a pixel, in the mean over random positions in it.
fn trace_half(
    scene: &Scene,
    visibility: &dyn Visibility,
    (rays, tracer): (&CameraRays, &PathTracer<'_>),
    [column, row]: [f64; 2],
    seed: u64,
) -> [[f64; 3]; 2] {
    let mut random = Random(seed);
    let through: Vec<_> = (0..POSITIONS).map(|_| rays.through(column + random.unit(), row + random.unit())).collect();
    let mut hits = vec![None; through.len()];
    visibility.first_hits(&through, &mut hits);
    let mut sums = [[0.0; 3]; 2];
    for (ray, hit) in through.iter().zip(hits) {
        let seed = random.bits();
        let Some(hit) = hit else { continue };
        let Some(front) = tracer.front(hit.surface, ray.direction) else { continue };
        let at = add(ray.origin, times(ray.direction, hit.distance));
        let found = tracer.batch(front, at, PATHS, seed).radiosity;
        let exitance = &scene.material_of(front).exitance;
        let [reflected, emitted] = &mut sums;
        *reflected = [0, 1, 2].map(|k| reflected[k] + (found[k] - exitance[k]) / f64::from(POSITIONS));
        *emitted = [0, 1, 2].map(|k| emitted[k] + exitance[k] / f64::from(POSITIONS));
    }
    sums
}
