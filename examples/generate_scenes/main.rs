//! Writes the scenes of this repository: `cargo run --example generate_scenes [folder]`, by default into `scenes/`.
//!
//! `cargo run --example generate_scenes hall POLYGONS SEED FILE.obj` writes a hall of so many polygons, at least 400, instead.
#![allow(clippy::print_stdout, reason = "a program that tells what it wrote")]

mod chang_shih;
mod cornell;
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

use std::io::{Error, ErrorKind};
use std::path::Path;

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [name, polygons, seed, file] = &arguments[..]
        && name == "hall"
    {
        return write_hall(polygons, seed, Path::new(file));
    }
    let folder = arguments.first().cloned().unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/scenes").to_owned());
    for (name, content) in scenes::all() {
        let path = Path::new(&folder).join(name);
        std::fs::write(&path, content)?;
        println!("{}", path.display());
    }
    Ok(())
}

fn write_hall(polygons: &str, seed: &str, file: &Path) -> std::io::Result<()> {
    const LEAST: usize = 400;
    let wrong = |what: &str| Error::new(ErrorKind::InvalidInput, what.to_owned());
    let polygons = polygons.parse().ok().filter(|&polygons| polygons >= LEAST);
    let polygons = polygons.ok_or_else(|| wrong("POLYGONS must be a whole number, at least 400"))?;
    let seed = seed.parse().map_err(|_| wrong("SEED must be a whole number below 2^32"))?;
    let name = file.file_stem().and_then(|name| name.to_str()).ok_or_else(|| wrong("FILE.obj must have a name"))?;
    let (obj, mtl) = hall::hall(polygons, seed).write(name);
    std::fs::write(file, obj)?;
    std::fs::write(file.with_extension("mtl"), mtl)?;
    println!("{}", file.display());
    Ok(())
}
