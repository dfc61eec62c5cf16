//! Writes the scenes of this repository: `cargo run --example generate_scenes [folder]`, by default into `scenes/`.
#![allow(clippy::print_stdout, reason = "a program that tells what it wrote")]

mod cornell;
mod furnace;
mod furniture;
mod interior;
mod model;
mod paper_rooms;
mod room;
mod scenes;

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/scenes").to_owned());
    for (name, content) in scenes::all() {
        let path = std::path::Path::new(&folder).join(name);
        std::fs::write(&path, content)?;
        println!("{}", path.display());
    }
    Ok(())
}
