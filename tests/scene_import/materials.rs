//! Material libraries: what is found, missing, out of range or ignored.

use patchlight::scene::import::{DiagnosticKind, ImportError};

use super::{Folder, GREY, GREY_MTL, SQUARE, after_square, kinds, read, read_with, reflectance};

#[test]
fn libraries_and_names_are_found() {
    let obj = format!(
        "mtllib one.mtl two three.mtl\nmtllib  with space.mtl\nmtllib one.mtl\n{SQUARE}usemtl red paint # the wall\nf 1 2 3 4\n\
         usemtl\tblue\nf 1 2 3\nusemtl W\u{e4}nde#3\nf 2 3 4\nusemtl red paint\nf 3 4 1\n"
    );
    let folder = Folder::with(&[
        ("bad.obj", obj.as_bytes()),
        ("one.mtl", b"newmtl red paint\r\n\tKd\t0.6 0.1 0.1 # red\r\n"),
        ("three.mtl", b"newmtl blue\nKd .1\nKe 1 2 3\n"),
        ("with space.mtl", "newmtl W\u{e4}nde#3\nKd 0.3 0.3 0.3".as_bytes()),
    ]);
    let imported = folder.read().unwrap();
    let of = |k: usize| &imported.scene.materials()[imported.scene.surfaces()[k].material as usize];
    assert_eq!((&*of(0).name, &of(0).reflectance), ("red paint", &vec![0.6, 0.1, 0.1]));
    assert_eq!((&*of(1).name, &of(1).reflectance), ("blue", &vec![0.1, 0.1, 0.1]));
    let pi = std::f64::consts::PI;
    assert_eq!(of(1).exitance, [pi, 2.0 * pi, 3.0 * pi]);
    assert_eq!((&*of(2).name, &of(2).reflectance), ("W\u{e4}nde#3", &vec![0.3, 0.3, 0.3]));
    assert_eq!(of(3).name, "red paint");
    // The library 'two' is missing, and only that.
    assert_eq!(imported.diagnostics.items.len(), 1, "{:?}", imported.diagnostics);
    let text = imported.diagnostics.items[0].to_string();
    assert!(text.contains("bad.obj:1: material library") && text.contains("two cannot be read"), "{text}");
}

#[test]
fn what_is_missing_is_grey() {
    let imported = after_square("usemtl lost\nf 1 2 3\nusemtl also lost\nf 2 3 4\nusemtl lost\nf 3 4 1\n");
    assert_eq!(reflectance(&imported), [0.5; 3]);
    use DiagnosticKind::{MissingLibrary, MissingMaterial, NoMaterial, NoReflectance};
    assert_eq!(kinds(&imported.diagnostics), [MissingMaterial, MissingMaterial]);
    let text = imported.diagnostics.warnings().join("\n");
    assert!(text.contains("bad.obj:5: material 'lost'"), "{text}");

    // A material that a missing library may define is an error.
    let error = read_with(&format!("{SQUARE}mtllib gone.mtl\nusemtl lost\nf 1 2 3\n"), "").unwrap_err();
    assert!(matches!(error, ImportError::MissingLibrary { line: 5, .. }), "{error:?}");
    assert!(error.to_string().contains("gone.mtl") && error.to_string().contains("'lost'"), "{error}");

    // One library of two is missing; a material is defined in a library that is named after its use.
    let folder = Folder::with(&[
        ("bad.obj", format!("mtllib gone.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\nmtllib a.mtl\n").as_bytes()),
        ("a.mtl", b"newmtl a\nKd 0.2 0.3 0.4\n"),
    ]);
    let imported = folder.read().unwrap();
    assert_eq!((reflectance(&imported), kinds(&imported.diagnostics)), (vec![0.2, 0.3, 0.4], vec![MissingLibrary]));

    // Faces before the first usemtl, and behind one without a name.
    let imported =
        read_with(&format!("{SQUARE}f 1 2 3\n{GREY}f 1 2 3 4\nusemtl\nf 2 3 4\n"), "newmtl grey\nKd .1 .1 .1\n").unwrap();
    assert_eq!(imported.scene.surfaces().iter().map(|s| s.material).collect::<Vec<_>>(), [1, 0, 1]);
    assert_eq!(kinds(&imported.diagnostics), [NoMaterial]);
    let text = imported.diagnostics.items[0].to_string();
    assert!(text.contains("bad.obj:5: face 1: 2 faces"), "{text}");

    // A material without Kd.
    let imported = read_with(&format!("{GREY}{SQUARE}f 1 2 3 4\n"), "# c\nnewmtl grey\nKe 1 1 1\n").unwrap();
    assert_eq!((reflectance(&imported), kinds(&imported.diagnostics)), (vec![0.5; 3], vec![NoReflectance]));
    assert!(imported.diagnostics.items[0].to_string().contains("bad.mtl:2"), "{:?}", imported.diagnostics);
}

#[test]
fn values_out_of_range_are_brought_into_it_and_told() {
    let import = |mtl: &str| read_with(&format!("{GREY}{SQUARE}f 1 2 3 4\n"), mtl).unwrap_or_else(|error| panic!("{mtl}: {error}"));
    let imported = import("newmtl grey\nKd 1 0.999 7\n");
    assert_eq!(reflectance(&imported), [0.99, 0.999, 0.99]);
    assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::ReflectanceClamped]);
    let text = imported.diagnostics.items[0].to_string();
    assert!(text.contains("bad.mtl:2") && text.contains("'grey'") && text.contains("0.99"), "{text}");

    let imported = import("newmtl grey\nKd -0.1 -0 0.4\nKe -1 2 0\n");
    assert_eq!(reflectance(&imported), [0.0, 0.0, 0.4]);
    assert_eq!(imported.scene.materials()[0].exitance, [0.0, 2.0 * std::f64::consts::PI, 0.0]);
    assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::NegativeValue, DiagnosticKind::NegativeValue]);
    assert!(imported.diagnostics.items[1].to_string().contains("bad.mtl:3"), "{:?}", imported.diagnostics);

    // What no face uses is nobody's trouble.
    let imported = import(&format!("{GREY_MTL}newmtl unused\nKd 2 2 2\n"));
    assert_eq!(kinds(&imported.diagnostics), []);

    // The first of two definitions counts.
    let imported = import(&format!("{GREY_MTL}newmtl grey\nKd 0.1 0.1 0.1\n"));
    assert_eq!((reflectance(&imported), kinds(&imported.diagnostics)), (vec![0.5; 3], vec![DiagnosticKind::MaterialDefinedTwice]));
}

#[test]
fn materials_that_are_no_numbers_are_fatal() {
    let import = |mtl: &str| read_with(&format!("{GREY}{SQUARE}f 1 2 3 4\n"), mtl).expect_err(mtl);
    for line in ["Kd nan 0 0", "Ke 0 inf 0", "Kd 1e999 0 0", "Ke 1e30 0 0", "Kd -nan", "Kd 1.#QNAN 0 0"] {
        let error = import(&format!("newmtl grey\n\n{line}\n"));
        assert!(matches!(error, ImportError::NotFinite { line: 3, .. }), "{line}: {error:?}");
        assert!(error.to_string().contains("bad.mtl:3"), "{error}");
    }
    for line in ["Kd", "Kd 0.5 0.5", "Kd red", "Kd 1 2 3 4", "Ke 1,5 0 0", "newmtl", "Kd 0..5 0 0"] {
        let error = import(&format!("newmtl grey\n# c\n{line}\n"));
        assert!(matches!(error, ImportError::Syntax { line: 3, .. }), "{line}: {error:?}");
        assert!(error.to_string().contains("bad.mtl:3"), "{error}");
    }
    assert!(import("Kd 1 1 1\n").to_string().contains("bad.mtl:1"));
}

#[test]
fn what_a_diffuse_material_does_not_have_is_mentioned_once() {
    let mtl = "newmtl grey\nKd .5 .5 .5\nKa 1 1 1\nKs 0 0 0\nNs 10\nNi 1.5\nillum 2.5\nd 1\nTr 0\nTf 1 1 1\nmap_Ks a b.png\nmap_Ks -s 1 1 1 c.png\n\
               bump\nPr 0.5\nPr 0.6\nd 0.5\n";
    let imported = read_with(&format!("{GREY}{SQUARE}f 1 2 3 4\n"), mtl).unwrap();
    let lines = imported.diagnostics.warnings();
    for expected in [
        "bad.mtl:11: 'map_Ks' (2 times)",
        "bad.mtl:13: 'bump'",
        "bad.mtl:16: 'd'",
        "bad.mtl:14: 2 statements from here on are unknown",
    ] {
        assert_eq!(lines.iter().filter(|line| line.contains(expected)).count(), 1, "{expected}: {lines:?}");
    }
    assert_eq!(kinds(&imported.diagnostics).len(), 4, "{lines:?}");
}

#[test]
fn latin1_names_are_read() {
    let folder = Folder::with(&[
        ("bad.obj", &[SQUARE.as_bytes(), b"mtllib bad.mtl\nusemtl W\xe4nde\nf 1 2 3 4\nusemtl W\xfcnde\nf 4 3 2 1\n"].concat()),
        ("bad.mtl", b"newmtl W\xe4nde\nKd .1 .1 .1\nnewmtl W\xfcnde\nKd .2 .2 .2\n"),
    ]);
    let imported = folder.read().unwrap();
    assert_eq!(reflectance(&imported), [0.1; 3]);
    assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::NotUtf8, DiagnosticKind::NotUtf8, DiagnosticKind::Sheet]);
    // Bytes like that inside of a number are an error as any other.
    let error = read(b"v 1 2 \xff\nf 1 1 1\n").unwrap_err();
    assert!(matches!(error, ImportError::Syntax { line: 1, .. }), "{error:?}");
}
