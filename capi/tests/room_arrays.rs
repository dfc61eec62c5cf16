//! The arrays of examples/c/room.h are the furnished room.

use std::fmt::Write as _;
use std::path::Path;

use patchlight::scene::import::{ImportOptions, read_scene};

/// Writes the header anew instead of looking at it.
const WRITE: &str = "PATCHLIGHT_WRITE_ROOM";

/// Numbers in rows of so many, as an array of C.
fn array(name: &str, kind: &str, numbers: &[String], row: usize) -> String {
    let rows: Vec<String> = numbers.chunks(row).map(|row| format!("    {},\n", row.join(", "))).collect();
    format!("\nstatic const {kind} {name}[] = {{\n{}}};\n", rows.concat())
}

#[test]
fn the_arrays_are_the_room() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let path = top.join("scenes/room.obj");
    let imported = read_scene(&path, &ImportOptions::default()).unwrap();
    let scene = &imported.scene;

    // Vertices and corners as the file has them; materials as the reader understands them.
    let text = std::fs::read_to_string(&path).unwrap();
    let words = |key: &str| {
        let lines = text.lines().filter_map(move |line| line.strip_prefix(key)?.strip_prefix(' '));
        lines.map(|line| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (vertices, faces) = (words("v"), words("f"));
    let mut material_of_face = vec![u32::MAX; faces.len()];
    scene.surfaces().iter().for_each(|surface| material_of_face[surface.face as usize] = surface.material);
    assert!(!material_of_face.contains(&u32::MAX), "a face is dropped");

    let corners: Vec<String> =
        faces.iter().flatten().map(|corner| (corner.split('/').next().unwrap().parse::<u32>().unwrap() - 1).to_string()).collect();
    let counts: Vec<String> = faces.iter().map(|face| face.len().to_string()).collect();
    let materials: Vec<String> = material_of_face.iter().map(u32::to_string).collect();
    let numbers = |of: fn(&patchlight::scene::Material) -> &Vec<f64>| {
        scene.materials().iter().flat_map(of).map(|number| format!("{number:?}")).collect::<Vec<_>>()
    };
    let mut header =
        "// The furnished room of scenes/room.obj. Made by capi/tests/room_arrays.rs: change that, not this file.\n".to_owned();
    let sizes =
        [("VERTICES", vertices.len()), ("FACES", faces.len()), ("CORNERS", corners.len()), ("MATERIALS", scene.materials().len())];
    header.push('\n');
    sizes.iter().for_each(|(name, size)| writeln!(header, "#define ROOM_{name} {size}").unwrap());
    header += &array("room_vertices", "double", &vertices.concat(), 9);
    header += &array("room_corners", "uint32_t", &corners, 20);
    header += &array("room_counts", "uint32_t", &counts, 40);
    header += &array("room_materials", "uint32_t", &materials, 40);
    header += &array("room_reflectance", "double", &numbers(|material| &material.reflectance), 3);
    header += &array("room_exitance", "double", &numbers(|material| &material.exitance), 3);

    let path = top.join("examples/c/room.h");
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(&path, &header).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap_or_default() == header,
        "{WRITE}=1 cargo test -p patchlight-capi --test room_arrays"
    );
}
