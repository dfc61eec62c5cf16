//! Writes the scenes of this repository: `cargo run --example generate_scenes [folder]`, by default into `scenes/`.
//!
//! `cargo run --example generate_scenes KIND COUNT SEED FILE.obj` writes one scene of any size instead: a `hall` of so many polygons, at least 400, or
//! vegetation, `tree`, `hedge` or `garden` of so many leaves, `maize` of so many plants.
#![allow(clippy::print_stdout, reason = "a program that tells what it wrote")]

mod chang_shih;
mod cornell;
mod foliage;
mod furnace;
mod furniture;
mod hall;
mod interior;
mod lischinski;
mod model;
mod paper_rooms;
mod pyramid;
mod room;
mod scenes;
mod two_rooms;
mod vegetation;

use std::io::{Error, ErrorKind};
use std::path::Path;

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [kind, count, seed, file] = &arguments[..] {
        return write_one(kind, count, seed, Path::new(file));
    }
    let folder = arguments.first().cloned().unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/scenes").to_owned());
    for (name, content) in scenes::all() {
        let path = Path::new(&folder).join(name);
        std::fs::write(&path, content)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Writes a scene of a kind, of so many of what the kind is counted in.
fn write_one(kind: &str, count: &str, seed: &str, file: &Path) -> std::io::Result<()> {
    const LEAST_POLYGONS: usize = 400;
    let wrong = |what: &str| Error::new(ErrorKind::InvalidInput, what.to_owned());
    let count: usize = count.parse().map_err(|_| wrong("COUNT must be a whole number"))?;
    let seed = seed.parse().map_err(|_| wrong("SEED must be a whole number below 2^32"))?;
    let model = match kind {
        "hall" if count >= LEAST_POLYGONS => hall::hall(count, seed),
        "hall" => return Err(wrong("a hall has at least 400 polygons")),
        _ if count == 0 => return Err(wrong("COUNT must be at least 1")),
        _ => vegetation::of_kind(kind, count, seed).ok_or_else(|| wrong("KIND must be hall, tree, hedge, maize or garden"))?,
    };
    let name = file.file_stem().and_then(|name| name.to_str()).ok_or_else(|| wrong("FILE.obj must have a name"))?;
    let (obj, mtl) = model.write(name);
    std::fs::write(file, obj)?;
    std::fs::write(file.with_extension("mtl"), mtl)?;
    println!("{}", file.display());
    Ok(())
}
