//! PLY and STL: the same two triangles and a square however they are written, and what is said of bad files.

use patchlight::scene::import::{DiagnosticKind, ImportError, ImportOptions, Imported, read_scene};

use super::{Folder, areas, kinds};

fn read(name: &str, bytes: &[u8]) -> Result<Imported, ImportError> {
    let folder = Folder::with(&[(name, bytes)]);
    read_scene(&folder.path(name), &ImportOptions::default())
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// A triangle that stands on the square's first edge.
const UP: [f32; 3] = [1.0, 0.0, 1.0];

fn header(format: &str, faces: usize) -> Vec<u8> {
    format!(
        "ply\nformat {format} 1.0\ncomment by hand\nelement vertex 5\nproperty uchar red\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nproperty short flags\nelement edge 1\n\
         property int a\nend_header\n"
    )
    .into_bytes()
}

fn binary_ply(big_endian: bool, faces: &[&[i32]]) -> Vec<u8> {
    let mut file = header(if big_endian { "binary_big_endian" } else { "binary_little_endian" }, faces.len());
    let mut put = |bytes: &[u8]| if big_endian { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
    for vertex in CORNERS.iter().chain([&UP]) {
        put(&[7]);
        vertex.iter().for_each(|x| put(&x.to_le_bytes()));
    }
    for face in faces {
        put(&[face.len() as u8]);
        face.iter().for_each(|corner| put(&corner.to_le_bytes()));
        put(&[1, 0]);
    }
    put(&[0; 4]);
    file
}

const TRIANGLES: [&[i32]; 3] = [&[0, 1, 2], &[0, 2, 3], &[1, 0, 4]];

#[test]
fn each_way_to_write_them_gives_the_same_faces() {
    let text = |faces: &[&[i32]]| {
        let mut text = String::from_utf8(header("ascii", faces.len())).unwrap();
        CORNERS.iter().chain([&UP]).for_each(|[x, y, z]| text += &format!("255 {x} {y} {z}\n"));
        for face in faces {
            let corners: Vec<String> = face.iter().map(ToString::to_string).collect();
            text += &format!("{} {} 0\n", face.len(), corners.join(" "));
        }
        (text + "0\n").into_bytes()
    };
    let corner = |corner: i32| if corner == 4 { UP } else { CORNERS[corner as usize] };
    let mut stl = [&[b' '; 80][..], &3_u32.to_le_bytes()].concat();
    let mut solid = String::from("solid a\n");
    for face in TRIANGLES {
        stl.extend([0; 12]);
        face.iter().flat_map(|&k| corner(k)).for_each(|x| stl.extend(x.to_le_bytes()));
        stl.extend([0; 2]);
        solid += "facet normal 0 0 0\n outer loop\n";
        face.iter().map(|&k| corner(k)).for_each(|[x, y, z]| solid += &format!("  vertex {x} {y:e} {z}\n"));
        solid += " endloop\nendfacet\n";
    }
    solid += "endsolid a\n";

    let square_and_triangle: [&[i32]; 2] = [&[0, 1, 2, 3], &[1, 0, 4]];
    for (name, file, last) in [
        ("a.ply", text(&TRIANGLES), 2),
        ("a.ply", binary_ply(false, &TRIANGLES), 2),
        ("a.ply", binary_ply(true, &TRIANGLES), 2),
        ("a.ply", text(&square_and_triangle), 1),
        ("a.ply", binary_ply(true, &square_and_triangle), 1),
        ("a.stl", stl, 2),
        ("a.stl", solid.into_bytes(), 2),
    ] {
        let imported = read(name, &file).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(areas(&imported), [2.0, 1.0], "{name}");
        assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::NoMaterial], "{name}");
        assert_eq!(imported.scene.surfaces()[1].face, last, "{name}");
        assert_eq!(imported.scene.surfaces()[0].polygon.normal(), [0.0, 0.0, 1.0], "{name}");
        assert_eq!(imported.scene.materials()[0].reflectance, [0.5; 3]);
    }
}

#[test]
fn bad_files_are_told() {
    let bad_index: [&[i32]; 1] = [&[0, 1, 5]];
    let huge = b"ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let empty = b"ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nelement face 0\nproperty list uchar int vertex_index\nend_header\n";
    let whole = binary_ply(false, &TRIANGLES);
    let nan = whole.iter().copied().take(whole.len()).collect::<Vec<u8>>();
    let at = header("binary_little_endian", 3).len() + 1;
    let nan = [&nan[..at], &f32::NAN.to_le_bytes(), &nan[at + 4..]].concat();
    for (name, file, expected) in [
        ("a.ply", &b"plx"[..], "no PLY file"),
        ("a.ply", b"ply\nformat ascii 1.0\n", "does not end in 'end_header'"),
        ("a.ply", b"ply\nend_header\n", "names no format"),
        ("a.ply", huge, "cut off"),
        ("a.ply", empty, "has no face"),
        ("a.ply", &binary_ply(false, &bad_index), "face 1: vertex 5 does not exist: there are 5"),
        ("a.ply", &binary_ply(false, &[&[0, 1, -1]]), "face 1: vertex 4294967295 does not exist"),
        ("a.ply", &whole[..whole.len() - 1], "cut off"),
        ("a.ply", &nan, "a coordinate of vertex 0"),
        ("a.stl", b"", "no STL file"),
        ("a.stl", b"solid\nvertex 1 2 3\n", "cut off"),
        ("a.stl", b"solid\nvertex 1 2\nendsolid\n", "a.stl:2: a vertex should have three numbers"),
        ("a.stl", b"solid\nvertex 1 2 1e40\nvertex 1 2 3\nvertex 1 0 3\nendsolid\n", "a.stl:2: a coordinate of face 1"),
    ] {
        let error = read(name, file).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}
