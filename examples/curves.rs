//! The discontinuities of scenes: a row of counts for each, and pictures of surfaces.
//!
//! `cargo run --release --example curves -- SCENE...` prints time and counts, after table 4.4 of Lischinski's thesis.
//! `--picture SURFACE` before a scene writes `curves.svg`, that surface with its curves; `--picture floor` takes the floor, or the
//! piece of it that has most.
//! `--contacts` looks for D0 alone.
//! `--tolerance X` leaves out what changes irradiance by no more than this part of the largest exitance.
#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::time::Instant;

use patchlight::discontinuities::{Discontinuities, of_contacts, of_emitters, svg};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (mut picture, mut tolerance, mut contacts) = (None, 0.0, false);
    println!("scene  surfaces  s  sources' edges  edges  wedges  hidden  D0  D1  D2  most  worst case  left out  weak  unfollowed");
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--picture" => picture = arguments.next(),
            "--contacts" => contacts = true,
            "--tolerance" => tolerance = arguments.next().ok_or("--tolerance needs a number")?.parse()?,
            file => {
                let scene = read_scene(file.as_ref(), &ImportOptions::default())?.scene;
                let start = Instant::now();
                let found = if contacts { of_contacts(&scene) } else { of_emitters(&scene, tolerance) };
                print_row(file, &scene, &found, start.elapsed().as_secs_f64());
                if let Some(name) = picture.take() {
                    let surface = if name == "floor" { floor(&scene, &found) } else { SurfaceId(name.parse()?) };
                    std::fs::write("curves.svg", svg(&scene, &found, surface))?;
                }
            }
        }
    }
    Ok(())
}

fn print_row(file: &str, scene: &Scene, found: &Discontinuities, seconds: f64) {
    let c = found.counters();
    println!(
        "{file}  {}  {seconds:.3}  {}  {}  {}  {}  {}  {}  {}  {}  {}  {}  {}  {}",
        scene.surfaces().len(),
        c.source_edges,
        c.edges,
        c.wedges,
        c.hidden_wedges,
        c.d0,
        c.d1,
        c.d2,
        c.most_per_surface,
        c.worst_case_per_surface(),
        c.left_out,
        c.weak_edges,
        c.unfollowed_edges
    );
}

/// The surface with most segments among the lowest of those that look up; y is up.
fn floor(scene: &Scene, found: &Discontinuities) -> SurfaceId {
    let ids = || (0..scene.surfaces().len() as u32).map(SurfaceId);
    let polygon = |id: SurfaceId| &scene.surface(id).polygon;
    let candidates: Vec<SurfaceId> = ids().filter(|&id| polygon(id).normal()[1] > 0.99).collect();
    let lowest = candidates.iter().map(|&id| polygon(id).centroid()[1]).fold(f64::INFINITY, f64::min);
    let room = 1e-3 * scene.bounds().diagonal();
    let on_floor = candidates.into_iter().filter(|&id| polygon(id).centroid()[1] < lowest + room);
    on_floor.max_by_key(|&id| found.of(id).len()).unwrap_or(SurfaceId(0))
}
