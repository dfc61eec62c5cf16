//! Textures of material libraries: each face has the mean over it.

use patchlight::scene::import::{DiagnosticKind, ImportError, ImportOptions, Imported, Textures, read_scene};

use super::{Folder, kinds};

/// An image of two columns, black on the left and `right` on the right, both of sRGB codes.
fn png(right: [u8; 3]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 2, 1);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = [[0; 3], right].concat();
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    file
}

/// A square whose texture coordinates are its own, as one face, or as its right half and a triangle in its left half.
const SQUARE: &str = "mtllib bad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 0 0\nv .5 1 0\n\
                      vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .5 0\nvt .5 1\nusemtl a\n";

fn read(faces: &str, mtl: &str, right: [u8; 3]) -> Result<Imported, ImportError> {
    let obj = format!("{SQUARE}{faces}");
    Folder::with(&[("bad.obj", obj.as_bytes()), ("bad.mtl", mtl.as_bytes()), ("a b.png", &png(right))]).read()
}

/// The reflectance of each surface.
fn reflectances(imported: &Imported) -> Vec<Vec<f64>> {
    let scene = &imported.scene;
    scene.surfaces().iter().map(|surface| scene.materials()[surface.material as usize].reflectance.clone()).collect()
}

/// The linear value of sRGB code 188, by IEC 61966-2-1.
fn of_188() -> f64 {
    ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4)
}

#[test]
fn each_face_has_the_mean_of_its_texture_times_kd() {
    let whole = "f 1/1 2/2 3/3 4/4\n";
    let halves = "f 5/5 2/2 3/3 6/6\nf 1/1 5/5 4/4\n";
    let mtl = "newmtl a\nKd 0.5 1 1\nmap_Kd a b.png\n";
    let imported = read(whole, mtl, [188; 3]).unwrap();
    let mean = 0.5 * of_188();
    assert!(reflectances(&imported)[0].iter().zip([0.5, 1.0, 1.0]).all(|(rho, kd)| (rho - kd * mean).abs() < 1e-6), "{imported:?}");
    assert_eq!(kinds(&imported.diagnostics), []);
    assert_eq!(imported.libraries.len(), 2, "the library and the image: {:?}", imported.libraries);

    // Coordinates from the end, and a concave face: the lower right half of the square without the triangle up to (0.75, 0.25).
    let [right, left] = <[_; 2]>::try_from(reflectances(&read(halves, mtl, [188; 3]).unwrap())).unwrap();
    assert!((right[1] - of_188()).abs() < 1e-6 && left[1].abs() < 1e-6, "{right:?} {left:?}");
    assert_eq!(reflectances(&read("f 5/-2 2/-5 3/-4 6/-1\n", mtl, [188; 3]).unwrap())[0], right);
    let concave = "v .75 .25 0\nvt .75 .25\nf 1/1 2/2 3/3 7/7\n";
    let found = reflectances(&read(concave, mtl, [188; 3]).unwrap())[0][1];
    // 5/24 of its area of 1/4 lie on the right.
    assert!((found - 5.0 / 6.0 * of_188()).abs() < 0.01 * of_188(), "{found}");
}

#[test]
fn textures_emit_are_moved_and_clamped() {
    let whole = "f 1/1 2/2 3/3 4/4\n";
    let imported = read(whole, "newmtl a\nKd 0 0 0\nKe 2 4 6\nmap_Ke a b.png\n", [255; 3]).unwrap();
    let exitance = &imported.scene.materials()[imported.scene.surfaces()[0].material as usize].exitance;
    let pi = std::f64::consts::PI;
    assert!(exitance.iter().zip([1.0, 2.0, 3.0]).all(|(e, l)| (e - pi * l).abs() < 1e-6), "{exitance:?}");

    // Half as fast and moved by a half: the right half alone.
    let moved = read(whole, "newmtl a\nKd 1 1 1\nmap_Kd -s .5 1 1 -o .5 0 0 a b.png\n", [188; 3]).unwrap();
    assert!((reflectances(&moved)[0][0] - of_188()).abs() < 1e-6);
    // A white texture reflects 0.99, and that is told once.
    let white = read("f 5/5 2/2 3/3\nf 5/5 3/3 6/6\n", "newmtl a\nKd 1 1 1\nmap_Kd a b.png\n", [255; 3]).unwrap();
    assert_eq!(reflectances(&white), [[0.99; 3], [0.99; 3]]);
    assert_eq!(kinds(&white.diagnostics), [DiagnosticKind::ReflectanceClamped]);
    // A black Kd, or none, would hide the texture.
    for kd in ["Kd 0 0 0\n", ""] {
        let found = read("f 5/5 2/2 3/3 6/6\n", &format!("newmtl a\n{kd}map_Kd a b.png\n"), [188; 3]).unwrap();
        assert!((reflectances(&found)[0][0] - of_188()).abs() < 1e-6 && kinds(&found.diagnostics).is_empty(), "{found:?}");
    }
}

#[test]
fn faces_without_coordinates_have_the_mean_of_the_image() {
    let mtl = "newmtl a\nKd 1 1 1\nmap_Kd a b.png\n";
    for face in ["f 5 2 3 6\n", "f 5/99 2/2 3/3 6/6\n", "vt x y\nf 5/7 2/2 3/3 6/6\n"] {
        let found = reflectances(&read(face, mtl, [188; 3]).unwrap())[0][0];
        assert!((found - 0.5 * of_188()).abs() < 0.01, "{face}: {found}");
    }
}

#[test]
fn what_cannot_be_read_is_told_and_kd_counts() {
    let face = "f 1/1 2/2 3/3 4/4\n";
    for (map, why) in [
        ("gone.png", "gone.png is left out: No such file"),
        ("bad.mtl", "neither PNG nor JPEG"),
        ("../../../../../../../etc/hostname", "outside of the folder"),
    ] {
        let imported = read(face, &format!("newmtl a\nKd .2 .3 .4\nmap_Kd {map}\n"), [188; 3]).unwrap();
        assert_eq!(reflectances(&imported), [[0.2, 0.3, 0.4]]);
        assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::MissingTexture]);
        let text = imported.diagnostics.warnings().join("\n");
        assert!(text.contains("bad.mtl:3") && text.contains(why), "{text}");
    }
    let error = read(face, "newmtl a\nmap_Kd -s 1 1\n", [188; 3]).unwrap_err();
    assert!(matches!(error, ImportError::Syntax { line: 2, .. }), "{error:?}");

    // Textures may be refused; those of materials that no face has are none.
    let folder = Folder::with(&[
        ("bad.obj", format!("{SQUARE}{face}").as_bytes()),
        ("bad.mtl", b"newmtl a\nKd .2 .2 .2\nnewmtl b\nmap_Kd x.png\n"),
    ]);
    let options = ImportOptions { textures: Textures::Reject, ..ImportOptions::default() };
    assert!(read_scene(&folder.path("bad.obj"), &options).is_ok());
    std::fs::write(folder.path("bad.mtl"), "newmtl a\nmap_Kd x.png\n").unwrap();
    let error = read_scene(&folder.path("bad.obj"), &options).unwrap_err();
    assert!(error.to_string().contains("bad.mtl:2") && error.to_string().contains("--texture"), "{error}");
}
