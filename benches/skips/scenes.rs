//! Scenes in which there is something to leave out.

use std::path::Path;

use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Material, Scene};
use patchlight::solve::{SolveOptions, Solver};

use super::rooms::{Room, crowded, cube, straight};

/// Name, scene, and what is asked of it: values over links, because cells need hardly any.
pub fn all() -> Vec<(&'static str, Scene, SolveOptions)> {
    let links = |error| SolveOptions { error, solver: Solver::Links, ..SolveOptions::default() };
    vec![
        ("empty_room", empty_room(), links(0.02)),
        ("cornell", read("cornell"), links(0.05)),
        ("bands", bands(&read("cornell")), links(0.05)),
        ("black_and_sealed", black_and_sealed(), links(0.05)),
        ("full_office", read("full_office"), links(0.1)),
        ("furnace", cube(&[0.5], &[1.0]), links(0.02)),
        ("crowded", crowded(40, 1), SolveOptions { error: 0.05, ..SolveOptions::default() }),
    ]
}

fn read(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.obj"));
    read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene
}

/// The scene in nine bands: each of its channels twice, and three in which no light is on.
fn bands(scene: &Scene) -> Scene {
    let bands = |values: &[f64], dark: f64| (0..9).map(|band| values.get(band / 2).copied().unwrap_or(dark)).collect();
    let materials = scene.materials().iter().map(|material| Material {
        name: material.name.clone(),
        reflectance: bands(&material.reflectance, 0.5),
        exitance: bands(&material.exitance, 0.0),
    });
    let faces = scene.surfaces().iter().map(|surface| (surface.polygon.clone(), surface.material, surface.face));
    Scene::new(9, materials.collect(), faces.collect(), scene.sides()).expect("as good as the scene it is made of")
}

/// A closed room in which nothing can occlude anything, lit by one of its walls.
fn empty_room() -> Scene {
    let mut room = Room::default();
    let wall = room.material(&[0.5, 0.6, 0.7], &[0.0; 3]);
    let lamp = room.material(&[0.2; 3], &[5.0; 3]);
    room.cuboid([0.0; 3], straight(4.0, 3.0, 2.5), true, |_, face| if face == 0 { lamp } else { wall });
    room.scene()
}

/// Two rooms beside each other without a door, of which one has a lamp; half of the boxes in them are black.
fn black_and_sealed() -> Scene {
    let mut room = Room::default();
    let wall = room.material(&[0.5, 0.6, 0.7], &[0.0; 3]);
    let black = room.material(&[0.0; 3], &[0.0; 3]);
    let lamp = room.material(&[0.0; 3], &[20.0; 3]);
    for (k, x) in [0.0, 4.2].into_iter().enumerate() {
        room.cuboid([x, 0.0, 0.0], straight(4.0, 3.0, 2.5), true, |_, _| wall);
        for place in 0..4 {
            let corner = [x + 0.5 + 1.6 * f64::from(place % 2), 0.5 + 1.3 * f64::from(place / 2), 0.1];
            let material = if place % 2 == 0 { black } else { wall };
            room.cuboid(corner, straight(0.6, 0.5, 0.8), false, |_, _| material);
        }
        if k == 0 {
            room.quad([x + 1.5, 1.0, 2.45], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        }
    }
    room.scene()
}
