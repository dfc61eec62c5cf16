//! Scenes made by hand, for the tests that look at files and the command line.
#![allow(dead_code, reason = "each test file uses a part of it")]

use patchlight::geometry::Polygon;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{RunOptions, SolveOptions};

/// A closed room of 2 x 2 x 2 m, seen from inside, y up, with a lamp under the ceiling. Colours differ by channel.
pub fn small_room(channels: usize) -> Scene {
    let material = |name: &str, rho: f64, exitance: f64| Material {
        name: name.to_owned(),
        reflectance: (0..channels).map(|k| rho / (1.0 + k as f64)).collect(),
        exitance: (0..channels).map(|k| exitance * (1.0 + k as f64)).collect(),
    };
    let quads: [([[f64; 3]; 4], u32); 7] = [
        ([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, 0.0]], 0),
        ([[0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 2.0], [0.0, 2.0, 2.0]], 0),
        ([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]], 0),
        ([[0.0, 0.0, 2.0], [0.0, 2.0, 2.0], [2.0, 2.0, 2.0], [2.0, 0.0, 2.0]], 0),
        ([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, 2.0], [0.0, 0.0, 2.0]], 0),
        ([[2.0, 0.0, 0.0], [2.0, 0.0, 2.0], [2.0, 2.0, 2.0], [2.0, 2.0, 0.0]], 0),
        ([[0.7, 1.99, 0.7], [1.3, 1.99, 0.7], [1.3, 1.99, 1.3], [0.7, 1.99, 1.3]], 1),
    ];
    // The floor faces up, which is counter-clockwise seen from above; so do the other sides, inwards.
    let faces =
        quads.iter().zip(0..).map(|((corners, material), face)| (Polygon::new(corners).unwrap(), *material, face)).collect();
    Scene::new(channels, vec![material("wall", 0.6, 0.0), material("lamp", 0.1, 10.0)], faces, Sides::Front).unwrap()
}

/// The small room, solved.
pub fn solved(channels: usize) -> Evaluator {
    let options = SolveOptions { error: 0.1, ..SolveOptions::default() };
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    pipeline::solve(small_room(channels), &options, &run, &Silent).unwrap().0
}
