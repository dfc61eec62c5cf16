//! What does direct light cost, exactly and by rays, and how far off are rays? Prints a table.
//!
//! `cargo bench --bench direct`: points uniform by area on the scenes of the repository, on one thread. Rays are held against the exact values,
//! and these against many rays.
#![allow(clippy::print_stdout, reason = "a bench tells what it measured")]

#[path = "support/cpu.rs"]
mod cpu;
#[path = "support/points.rs"]
mod points;
#[path = "../tests/support/triangles.rs"]
mod triangles;

use std::path::Path;

use cpu::cpu_seconds;
use patchlight::direct::{DirectEffort, DirectIrradiance, Method, direct_irradiance};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};
use points::{LeftOut, spread};

const POINTS: usize = 2000;

/// So many points are checked by so many rays.
const MANY: u32 = 1 << 14;
const CHECKED: usize = 200;

struct Measured {
    found: DirectIrradiance,
    micros: f64,
}

fn measure(scene: &Scene, visibility: &dyn Visibility, points: &[(SurfaceId, [f64; 3])], effort: DirectEffort) -> Measured {
    let build = {
        let start = cpu_seconds();
        direct_irradiance(scene, visibility, &[], effort, 1);
        cpu_seconds() - start
    };
    let start = cpu_seconds();
    let found = direct_irradiance(scene, visibility, points, effort, 1);
    Measured { found, micros: 1e6 * (cpu_seconds() - start - build) / points.len() as f64 }
}

/// Root mean square difference over that of the values.
fn difference(found: &[f64], exact: &[f64]) -> f64 {
    let sum = |of: &dyn Fn(f64, f64) -> f64| found.iter().zip(exact).map(|(a, b)| of(*a, *b)).sum::<f64>();
    (sum(&|a, b| (a - b).powi(2)) / sum(&|_, b| b * b)).sqrt()
}

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<_> = ["cornell", "room", "full_office", "living_room", "dining_room", "hevea", "two_rooms"]
        .map(|name| root.join(format!("scenes/{name}.obj")))
        .into();
    files.extend(["cornell", "office"].map(|name| root.join(format!("../shared/peers/scenes/{name}.obj"))));
    println!("| scene | surfaces, emitters | way | us a point | error | claimed | rays a point |");
    println!("|---|---|---|---|---|---|---|");
    for file in files.iter().filter(|file| file.exists()) {
        let scene = read_scene(file, &ImportOptions::default()).expect("a scene").scene;
        let visibility = build(Backend::Auto, &OccluderMesh::of_scene(&scene)).expect("a backend");
        let points: Vec<(SurfaceId, [f64; 3])> = spread(&scene, |_| true, LeftOut::AllBacks, POINTS, 1)
            .into_iter()
            .map(|(surface, point)| (surface, point.position))
            .collect();
        let emitters = (0..scene.surfaces().len()).filter(|&id| scene.material_of(SurfaceId(id as u32)).emits()).count();
        let name = format!("{} | {}, {emitters}", file.file_stem().unwrap_or_default().to_string_lossy(), scene.surfaces().len());
        let effort = |rays, method| DirectEffort { rays, method };

        let exact = measure(&scene, &*visibility, &points, effort(1, Method::Exact));
        let many = measure(&scene, &*visibility, &points[..CHECKED], effort(MANY, Method::Rays));
        let channels = scene.channels();
        let off = difference(&many.found.irradiance, &exact.found.irradiance[..CHECKED * channels]);
        let claimed = |found: &DirectIrradiance| {
            (found.variance.iter().sum::<f64>() / found.irradiance.iter().map(|h| h * h).sum::<f64>()).sqrt()
        };
        assert!(off <= 2.0 * claimed(&many.found) + 1e-12, "{name}: exact values and rays are {off:e} apart");
        println!("| {name} | exact | {:.2} | {off:.1e} | {:.1e} | |", exact.micros, claimed(&many.found));
        for rays in [16, 64, 256, 1024] {
            for (way, method) in [("rays", Method::Rays), ("cheaper", Method::Cheaper)] {
                let Measured { found, micros } = measure(&scene, &*visibility, &points, effort(rays, method));
                let error = difference(&found.irradiance, &exact.found.irradiance);
                println!(
                    "| {name} | {way} {rays} | {micros:.2} | {error:.1e} | {:.1e} | {:.1} |",
                    claimed(&found),
                    found.rays as f64 / POINTS as f64
                );
            }
        }
    }
}
