//! Transmittance maps beside rays: error against time and memory, over the links of solves in vegetation, and over pairs that look through it.
//!
//! `cargo bench --bench foliage` prints tables as Markdown, in some minutes; `-- tree_20000` prints those of one scene, `-- pairs` tells how true maps
//! are of 10,000 pairs, `--plots docs` draws error against time and memory into docs/. In each scene the links are those of a
//! solve, by the coarse tolerance of [`LINK_TOLERANCE`]; [`links::MOST_LINKS`] of them are looked at, as far as they are partly blocked.
//! What is judged is a link's transmittance, against thousands of rays. All on one thread, CPU seconds.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]
#![allow(dead_code, reason = "a part of the generator is used")]

#[path = "../../tests/support/clouds.rs"]
mod clouds;
#[path = "../support/cpu.rs"]
mod cpu;
mod figures;
#[path = "../../examples/generate_scenes/foliage.rs"]
mod foliage;
#[path = "../../examples/generate_scenes/furniture.rs"]
mod furniture;
mod links;
mod measure;
#[path = "../../examples/generate_scenes/model.rs"]
mod model;
mod pairs;
#[path = "../support/plot.rs"]
mod plot;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod tables;
#[path = "../../tests/support/triangles.rs"]
mod triangles;
#[path = "../../examples/generate_scenes/vegetation.rs"]
mod vegetation;

use std::path::PathBuf;

use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, Solver, Strategy};
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};

use links::Crossing;
use measure::Ladder;
use tables::Table;

/// Scenes by kind and how many leaves, of maize plants.
const SCENES: [(&str, usize); 5] = [("tree", 20_000), ("tree", 200_000), ("hedge", 20_000), ("maize", 50), ("garden", 60_000)];

/// Of the oracle: some ten thousand links.
const LINK_TOLERANCE: f64 = 0.5;

/// The solve makes no more.
const MOST_LINKS_MADE: u64 = 400_000;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut wanted, mut plots) = (None, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--plots" => plots = arguments.next().map(PathBuf::from),
            _ => wanted = Some(argument),
        }
    }
    if wanted.as_deref() == Some("pairs") {
        return pairs::print(&scene("tree", 20_000));
    }
    for (kind, count) in SCENES {
        let name = format!("{kind}_{count}");
        if wanted.as_ref().is_none_or(|wanted| *wanted == name) {
            let tables = print(&name, scene(kind, count));
            if let Some(folder) = &plots {
                figures::draw(&name, &tables, folder).expect("the folder can be written");
            }
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

fn print(name: &str, scene: Scene) -> [Table; 2] {
    let tiled = links::tiled(&scene);
    let hierarchy = Hierarchy::new(&tiled);
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&tiled)).expect("a backend");
    let pairs: Vec<_> =
        links::of_lawn_and_sky(&tiled).into_iter().map(|pair| pair.map(|surface| hierarchy.node_of(surface))).collect();
    let of_tiles = compare(&format!("{name}: tiles of lawn and sky"), &tiled, &hierarchy, &pairs, visibility.as_ref());

    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).expect("a backend");
    let mut options = SolveOptions { strategy: Strategy::Hanrahan91, solver: Solver::Links, error: 0.9, ..SolveOptions::default() };
    options.links.tolerance = Some(LINK_TOLERANCE);
    options.links.leaf_rays = Some(0);
    options.max_links = Some(MOST_LINKS_MADE);
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    let (lit, _) = pipeline::solve(scene, &options, &run, &Silent).expect("a solution");
    let solution = lit.solution();
    let links = links::of_solution(solution);
    let of_links =
        compare(&format!("{name}: links of a solve"), solution.scene(), solution.hierarchy(), &links, visibility.as_ref());
    [of_tiles, of_links]
}

fn compare(what: &str, scene: &Scene, hierarchy: &Hierarchy, pairs: &[[NodeId; 2]], visibility: &dyn Visibility) -> Table {
    let crossings = Crossing::of(scene, hierarchy, pairs, visibility);
    println!("\n### {what}, {} pairs, {} partly blocked ones looked at\n", pairs.len(), crossings.len());
    let mut found = Table { title: what.to_owned(), ..Table::default() };
    if !crossings.is_empty() {
        found.fill(&Ladder { scene, hierarchy, visibility, crossings: &crossings });
    }
    found
}
