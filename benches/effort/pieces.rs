//! Does it matter how finely a scene is cut, and what is around it that light never meets?

use patchlight::geometry::Polygon;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{RunOptions, SolveOptions, Solver};

use super::cpu::cpu_seconds;
use super::measure::Points;
use super::rooms;
use super::scenes::cornell;

/// Runs of which the medians count, each with a seed of its own.
const SEEDS: u64 = 9;

const ERROR: f64 = 0.02;

/// What stands around, all black.
#[derive(Clone, Copy)]
enum Around {
    Nothing,
    /// A box, a tenth of a metre outside.
    Box,
    /// A square of 20 km, a metre below.
    Ground,
}

/// Prints CPU seconds and errors, on one thread.
pub fn print() {
    let whole = cut(1, Around::Nothing);
    let points = Points::of(&whole);
    let fine = SolveOptions { error: 0.003, seed: 977, solver: Solver::Cells, ..SolveOptions::default() };
    let reference = rooms::values(&rooms::solve(whole.clone(), &fine).0, &points.places);

    println!(
        "\n| pieces | around | surfaces | CPU-s | least, most | times whole | measured | claimed | claims hold |\n|{}",
        "---|".repeat(9)
    );
    let mut of_whole = None;
    for around in [Around::Nothing, Around::Box, Around::Ground] {
        for side in [1, 2, 4, 8] {
            let scene = cut(side, around);
            let mut runs: Vec<[f64; 3]> = (0..SEEDS)
                .map(|seed| {
                    let (run, options) = (
                        RunOptions { threads: 1, ..RunOptions::default() },
                        SolveOptions { error: ERROR, seed, ..SolveOptions::default() },
                    );
                    let start = cpu_seconds();
                    let (solved, report) = pipeline::solve(scene.clone(), &options, &run, &Silent).expect("options that are legal");
                    let cpu = cpu_seconds() - start;
                    let values = rooms::values(&solved, &points.places);
                    let error = points.product(&values, &values, [&reference, &reference]).sqrt();
                    [cpu, error, report.error.estimate]
                })
                .collect();
            let held = runs.iter().filter(|[_, error, claimed]| error <= claimed).count();
            let medians = [0, 1, 2].map(|of| {
                runs.sort_by(|a, b| a[of].total_cmp(&b[of]));
                runs[runs.len() / 2][of]
            });
            runs.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let times = medians[0] / *of_whole.get_or_insert(medians[0]);
            let name = match around {
                Around::Nothing => "nothing",
                Around::Box => "black box",
                Around::Ground => "black ground, 20 km",
            };
            println!(
                "| {} | {name} | {} | {:.3} | {:.2}, {:.2} | {times:.2} | {:.2}% | {:.2}% | {held}/{} |",
                side * side,
                scene.surfaces().len(),
                medians[0],
                runs[0][0],
                runs[runs.len() - 1][0],
                100.0 * medians[1],
                100.0 * medians[2],
                runs.len()
            );
        }
    }
}

/// The Cornell box with each polygon cut into `side` by `side` pieces.
fn cut(side: usize, around: Around) -> Scene {
    let scene = cornell();
    let mut materials = scene.materials().to_vec();
    let channels = scene.channels();
    materials.push(Material { name: "black".to_owned(), reflectance: vec![0.0; channels], exitance: vec![0.0; channels] });
    let black = materials.len() as u32 - 1;
    let mut faces: Vec<(Vec<[f64; 3]>, u32)> = Vec::new();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        faces.extend(pieces_of(&corners, side).into_iter().map(|piece| (piece, surface.material)));
    }
    faces.extend(things(&scene, around).into_iter().map(|corners| (corners, black)));
    let faces = faces.into_iter().zip(0..).map(|((corners, material), face)| (polygon(&corners), material, face));
    Scene::new(channels, materials, faces.collect(), Sides::Front).expect("as good as the scene it is made of")
}

fn polygon(corners: &[[f64; 3]]) -> Polygon {
    Polygon::new(corners).expect("a piece of a polygon")
}

/// Quads by lines between opposite edges; of a triangle one edge is halved first.
fn pieces_of(corners: &[[f64; 3]], side: usize) -> Vec<Vec<[f64; 3]>> {
    let between = |a: [f64; 3], b: [f64; 3], t: f64| -> [f64; 3] { std::array::from_fn(|k| a[k] + t * (b[k] - a[k])) };
    let quad = match *corners {
        [a, b, c] => [a, between(a, b, 0.5), b, c],
        [a, b, c, d] => [a, b, c, d],
        _ => unreachable!("the Cornell box has triangles and quads"),
    };
    if side == 1 {
        return vec![corners.to_vec()];
    }
    let at = |i: usize, j: usize| {
        let (u, v) = (i as f64 / side as f64, j as f64 / side as f64);
        between(between(quad[0], quad[1], u), between(quad[3], quad[2], u), v)
    };
    let piece = |k: usize| {
        let (i, j) = (k / side, k % side);
        vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    (0..side * side).map(piece).collect()
}

/// The black polygons around.
fn things(scene: &Scene, around: Around) -> Vec<Vec<[f64; 3]>> {
    let bounds = scene.bounds();
    let (low, high): ([f64; 3], [f64; 3]) = (bounds.min().map(|x| x - 0.1), bounds.max().map(|x| x + 0.1));
    match around {
        Around::Nothing => Vec::new(),
        Around::Box => {
            let corner =
                |k: usize| -> [f64; 3] { std::array::from_fn(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] }) };
            let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
            sides.map(|side| side.map(corner).to_vec()).to_vec()
        }
        Around::Ground => {
            let (far, y) = (1e4, low[1] - 0.9);
            vec![vec![[-far, y, -far], [-far, y, far], [far, y, far], [far, y, -far]]]
        }
    }
}
