//! A scene with points and a reference: what runs are scored against.

use std::path::{Path, PathBuf};

use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfacePoint};

use super::points::{LeftOut, spread, write_points};

/// Points of a whole bake: an office of 344 m^2 in texels of 5 cm.
pub const BAKE_POINTS: usize = 138_000;

/// A scene, points, and what is right there.
pub struct Problem {
    pub name: String,
    pub scene: PathBuf,
    pub points: Vec<SurfacePoint>,
    pub reference: Vec<[f64; 3]>,
    /// E at the points.
    pub exitance: Vec<[f64; 3]>,
    /// One standard deviation of the reference, relative in the norm of errors.
    pub noise: f64,
    /// Where the reference comes from.
    pub reference_is: String,
    /// Whether a bake of the whole scene is timed too.
    pub bakes: bool,
    /// Whether both solvers are timed, not just the one that the program chooses.
    pub both_solvers: bool,
}

impl Problem {
    pub fn file_name(&self) -> String {
        self.name.replace(' ', "_").replace(['(', ')'], "")
    }

    /// The points as the program reads them.
    pub fn points_file(&self, folder: &Path) -> PathBuf {
        let file = folder.join(format!("{}_points.csv", self.file_name()));
        write_points(&file, self.points.iter());
        file
    }

    /// The scored points and so many in all, as texels of a bake.
    pub fn bake_points(&self, folder: &Path, count: usize) -> PathBuf {
        let file = folder.join(format!("{}_bake.csv", self.file_name()));
        let more = spread_over(&self.scene, count - self.points.len(), 77);
        write_points(&file, self.points.iter().chain(&more));
        file
    }

    /// `||B - R|| / ||R - E||`, and what the noise of the reference adds to it.
    pub fn error_of(&self, found: &[[f64; 3]]) -> (f64, f64) {
        let (mut error_sq, mut norm_sq) = (0.0, 0.0);
        for ((found, expected), exitance) in found.iter().zip(&self.reference).zip(&self.exitance) {
            for channel in 0..3 {
                error_sq += (found[channel] - expected[channel]).powi(2);
                norm_sq += (expected[channel] - exitance[channel]).powi(2);
            }
        }
        ((error_sq / norm_sq).sqrt(), self.noise)
    }
}

fn read(scene: &Path) -> Scene {
    read_scene(scene, &ImportOptions::default()).expect("a scene of the repository").scene
}

/// Points of what does not emit, from which no ray meets a back: others are covered, and nobody sees them.
pub fn spread_over(scene: &Path, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let places = spread(&read(scene), |material| !material.emits(), LeftOut::AnyBack, count, seed);
    places.into_iter().map(|(_, point)| point).collect()
}
