//! Transmittance maps beside rays: error against time and memory, over the links of solves in vegetation, and over pairs that look through it.
//!
//! `cargo bench --bench foliage` prints tables as Markdown, in some minutes; `-- tree_20000` prints those of one scene. In each scene the links are those of a
//! solve, by the coarse tolerance of [`LINK_TOLERANCE`]; [`links::MOST_LINKS`] of them are looked at, as far as they are partly blocked.
//! What is judged is a link's transmittance, against thousands of rays. All on one thread, CPU seconds.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]
#![allow(dead_code, reason = "a part of the generator is used")]

#[path = "../support/cpu.rs"]
mod cpu;
#[path = "../../examples/generate_scenes/foliage.rs"]
mod foliage;
#[path = "../../examples/generate_scenes/furniture.rs"]
mod furniture;
mod links;
mod measure;
#[path = "../../examples/generate_scenes/model.rs"]
mod model;
#[path = "../../tests/support/triangles.rs"]
mod triangles;
#[path = "../../examples/generate_scenes/vegetation.rs"]
mod vegetation;

use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, Solver, Strategy};
use patchlight::transmittance::maps::MapResolution;
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};

use links::Crossing;
use measure::{Ladder, Measured};

/// Scenes by kind and how many leaves, of maize plants.
const SCENES: [(&str, usize); 5] = [("tree", 20_000), ("tree", 200_000), ("hedge", 20_000), ("maize", 50), ("garden", 60_000)];

/// Of the oracle: some ten thousand links.
const LINK_TOLERANCE: f64 = 0.5;

/// The solve makes no more.
const MOST_LINKS_MADE: u64 = 400_000;

/// How finely maps know lines: direction cells along a side of a face, offset cells along a side.
const RESOLUTIONS: [MapResolution; 2] = [MapResolution { directions: 4, offsets: 8 }, MapResolution { directions: 8, offsets: 16 }];

fn main() {
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    for (kind, count) in SCENES {
        let name = format!("{kind}_{count}");
        if wanted.as_ref().is_none_or(|wanted| *wanted == name) {
            print(&name, scene(kind, count));
        }
    }
}

/// A scene of the generator, with seed 1.
fn scene(kind: &str, count: usize) -> Scene {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let file = folder.path().join("scene.obj");
    let (obj, mtl) = vegetation::of_kind(kind, count, 1).expect("a kind").write("scene");
    std::fs::write(&file, obj).and_then(|()| std::fs::write(file.with_extension("mtl"), mtl)).expect("files can be written");
    read_scene(&file, &ImportOptions::default()).expect("a scene").scene
}

fn print(name: &str, scene: Scene) {
    let tiled = links::tiled(&scene);
    let hierarchy = Hierarchy::new(&tiled);
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&tiled)).expect("a backend");
    let pairs = links::of_lawn_and_sky(&tiled, &hierarchy);
    compare(&format!("{name}: tiles of lawn and sky"), &tiled, &hierarchy, &pairs, visibility.as_ref());

    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).expect("a backend");
    let mut options = SolveOptions { strategy: Strategy::Hanrahan91, solver: Solver::Links, error: 0.9, ..SolveOptions::default() };
    options.links.tolerance = Some(LINK_TOLERANCE);
    options.links.leaf_rays = Some(0);
    options.max_links = Some(MOST_LINKS_MADE);
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    let (lit, _) = pipeline::solve(scene, &options, &run, &Silent).expect("a solution");
    let solution = lit.solution();
    let links = links::of_solution(solution);
    compare(&format!("{name}: links of a solve"), solution.scene(), solution.hierarchy(), &links, visibility.as_ref());
}

fn compare(what: &str, scene: &Scene, hierarchy: &Hierarchy, pairs: &[[NodeId; 2]], visibility: &dyn Visibility) {
    let crossings = Crossing::of(scene, hierarchy, pairs, visibility);
    println!("\n### {what}, {} pairs, {} partly blocked ones looked at\n", pairs.len(), crossings.len());
    if !crossings.is_empty() {
        table(&Ladder { scene, hierarchy, visibility, crossings: &crossings });
    }
}

fn table(ladder: &Ladder<'_>) {
    println!(
        "| method | error | of answered | claimed | answered | CPU-ms | rays' CPU-ms for that error | CPU-ms of making maps | MB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut by_rays = Vec::new();
    for rays in [1, 4, 16, 64, 256] {
        let measured = ladder.rays(rays);
        println!("| rays, {rays} a link | {:.3} | | | | {:.1} | | | |", measured.error, 1e3 * measured.seconds);
        by_rays.push((measured.error, measured.seconds));
    }
    for resolution in RESOLUTIONS {
        for (tolerance, lines) in [(0.2, 4), (0.2, 16), (0.1, 16), (0.1, 64)] {
            row(resolution, tolerance, lines, &ladder.maps(resolution, tolerance, lines), &by_rays);
        }
    }
}

fn row(resolution: MapResolution, tolerance: f64, lines: usize, measured: &Measured, by_rays: &[(f64, f64)]) {
    let MapResolution { directions, offsets } = resolution;
    let Measured { error, error_of_answered, seconds, making, answered, claimed, bytes } = measured;
    println!(
        "| maps {directions}/{offsets}, tolerance {tolerance}, {lines} lines | {error:.3} | {error_of_answered:.3} | {claimed:.3} | {:.0}% | {:.1} | {:.1} \
         | {:.0} | {:.1} |",
        100.0 * answered,
        1e3 * (seconds - making),
        1e3 * seconds_of_rays(*error, by_rays),
        1e3 * making,
        *bytes as f64 * 1e-6
    );
}

/// What rays alone take for an error, between two that were measured; beyond, the square of the error falls as work grows.
fn seconds_of_rays(error: f64, by_rays: &[(f64, f64)]) -> f64 {
    let between = by_rays.windows(2).find(|pair| (pair[1].0..=pair[0].0).contains(&error));
    match between {
        Some(&[(more, less_work), (less, more_work)]) => {
            let part = (more / error).ln() / (more / less).ln();
            less_work * (more_work / less_work).powf(part)
        }
        _ => {
            let (nearest, seconds) = if error > by_rays[0].0 { by_rays[0] } else { by_rays[by_rays.len() - 1] };
            seconds * (nearest / error).powi(2)
        }
    }
}
