//! What the OBJ reader makes of good, odd and bad files: fatal errors with file, line and face; repairs that are told; no panic.

mod any_bytes;
mod lights;
mod materials;
mod meshes;
mod textures;

use std::path::PathBuf;

use patchlight::scene::import::{DiagnosticKind, Diagnostics, ImportError, ImportOptions, Imported, read_scene};
use patchlight::scene::{SceneSummary, Sides};

/// A folder with files in it that goes away with the value.
struct Folder(tempfile::TempDir);

impl Folder {
    fn with(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self) -> Result<Imported, ImportError> {
        read_scene(&self.path("bad.obj"), &ImportOptions::default())
    }
}

fn read(obj: impl AsRef<[u8]>) -> Result<Imported, ImportError> {
    Folder::with(&[("bad.obj", obj.as_ref())]).read()
}

fn read_with(obj: &str, mtl: &str) -> Result<Imported, ImportError> {
    Folder::with(&[("bad.obj", obj.as_bytes()), ("bad.mtl", mtl.as_bytes())]).read()
}

/// Four corners of a unit square, vertices 1 to 4 in lines 1 to 4.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// The error of a file whose text starts with [`SQUARE`].
fn error_after_square(rest: &str) -> ImportError {
    read(format!("{SQUARE}{rest}")).expect_err(rest)
}

/// The import of a file whose text starts with [`SQUARE`].
fn after_square(rest: &str) -> Imported {
    read(format!("{SQUARE}{rest}")).unwrap_or_else(|error| panic!("{rest:?}: {error}"))
}

fn kinds(diagnostics: &Diagnostics) -> Vec<DiagnosticKind> {
    diagnostics.items.iter().map(|item| item.kind).filter(|kind| *kind != DiagnosticKind::NoLight).collect()
}

fn areas(imported: &Imported) -> Vec<f64> {
    imported.scene.surfaces().iter().map(|surface| surface.polygon.area()).collect()
}

/// Reflectance of the material of the first surface.
fn reflectance(imported: &Imported) -> Vec<f64> {
    imported.scene.materials()[imported.scene.surfaces()[0].material as usize].reflectance.clone()
}

/// Without this, faces that name no material would add a warning to every case.
const GREY: &str = "mtllib bad.mtl\nusemtl grey\n";
const GREY_MTL: &str = "newmtl grey\nKd 0.5 0.5 0.5\n";

// ------------------------------------------------------------------------------------------------------------- files

#[test]
fn files_that_cannot_be_read() {
    let folder = Folder::with(&[("scene.fbx", b""), ("noextension", b"")]);
    let import = |name: &str| read_scene(&folder.path(name), &ImportOptions::default()).unwrap_err();
    for name in ["scene.fbx", "noextension", "missing.max"] {
        let error = import(name);
        assert!(matches!(error, ImportError::UnknownExtension { .. }), "{error:?}");
        assert!(error.to_string().contains(name) && error.to_string().contains(".obj"), "{error}");
    }
    let error = import("missing.obj");
    assert!(matches!(error, ImportError::Unreadable { .. }) && error.to_string().contains("missing.obj"), "{error}");

    std::fs::create_dir(folder.path("folder.obj")).unwrap();
    let error = import("folder.obj");
    assert!(matches!(error, ImportError::Unreadable { .. }) && error.to_string().contains("directory"), "{error}");
}

#[test]
fn extensions_are_read_in_any_case() {
    let folder = Folder::with(&[("SCENE.OBJ", format!("{SQUARE}f 1 2 3 4").as_bytes())]);
    assert_eq!(read_scene(&folder.path("SCENE.OBJ"), &ImportOptions::default()).unwrap().lines, [5]);
}

#[test]
fn files_without_a_face() {
    for text in ["", "# nothing\n", "v 1 2 3\n", "\n\n\r\n", "g empty", "\0\0\u{1}binary"] {
        let error = read(text).unwrap_err();
        assert!(matches!(error, ImportError::NoFaces { read: 0, .. }), "{text:?}: {error:?}");
        assert!(error.to_string().contains("bad.obj"), "{error}");
    }
    let error = error_after_square("f 1 2\nf 1 1 1\nf 1 2 1\n");
    assert!(matches!(error, ImportError::NoFaces { read: 3, dropped: 3, .. }), "{error:?}");
}

#[test]
fn utf16_is_named() {
    let error = read(b"\xff\xfev\0 \0").unwrap_err();
    assert!(error.to_string().contains("UTF-16"), "{error}");
}

// ----------------------------------------------------------------------------------------------------------- vertices

#[test]
fn vertices_that_are_not_finite_are_fatal() {
    for value in ["nan", "NaN", "-nan", "inf", "-INF", "infinity", "1e999", "-1e31", "1.#QNAN", "-1.#IND", "nan(ind)"] {
        // Used by a face or not.
        for rest in ["f 1 2 3 5\n", "f 1 2 3 4\n"] {
            let error = error_after_square(&format!("v 0 {value} 0\n{rest}"));
            assert!(matches!(error, ImportError::NotFinite { line: 5, .. }), "{value}: {error:?}");
            let message = error.to_string();
            assert!(message.contains("bad.obj:5") && message.contains("vertex 5") && message.contains(value), "{message}");
        }
    }
}

#[test]
fn vertices_that_are_no_numbers_are_fatal() {
    for bad in ["v 1 2", "v", "v 1 2 x", "v 1,5 2 3", "v 1.2.3 0 0", "v 1 2 3 red", "v 1e 0 0", "v - 0 0"] {
        let error = error_after_square(&format!("f 1 2 3 4\n\n{bad}\n"));
        assert!(matches!(error, ImportError::Syntax { line: 7, .. }), "{bad}: {error:?}");
        assert!(error.to_string().contains("bad.obj:7") && error.to_string().contains("vertex 5"), "{error}");
    }
}

#[test]
fn weights_and_colours_do_not_move_vertices() {
    let imported = read("v 0 0 0 2\nv 1 0 0 .1 .2 .3\nv 1 1 0 1\nv 0 1 0 0.5\nf 1 2 3 4\n").unwrap();
    assert_eq!(areas(&imported), [1.0]);
    assert_eq!(imported.diagnostics.count(DiagnosticKind::IgnoredProperty), 1, "{:?}", imported.diagnostics);
}

// -------------------------------------------------------------------------------------------------------------- faces

#[test]
fn indices_out_of_range_are_fatal() {
    let huge = "99999999999999999999999999";
    for index in ["0", "5", "-5", "4294967297", "9223372036854775807", "-9223372036854775808", huge, "-0", "00"] {
        let error = error_after_square(&format!("f 1 2 3\nf 1 2 {index}\n"));
        assert!(matches!(error, ImportError::IndexOutOfRange { line: 6, face: 2, vertices: 4, .. }), "{index}: {error:?}");
        let message = error.to_string();
        assert!(message.contains("bad.obj:6: face 2") && message.contains("4 vertices"), "{message}");
    }
    assert!(read("f 1 2 3").unwrap_err().to_string().contains("no vertex"));
    // Negative indices count back from the face, not from the end.
    let error = read("v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n").unwrap_err();
    assert!(matches!(error, ImportError::IndexOutOfRange { line: 3, face: 1, vertices: 2, .. }), "{error:?}");
}

#[test]
fn broken_faces_are_fatal() {
    for corner in ["x", "1.5", "1/2/3/4", "1/a", "/1", "1//x", "--1", "1-2", "", "nan"] {
        let error = error_after_square(&format!("f 1 2 3 {corner}/\n"));
        assert!(matches!(error, ImportError::Syntax { line: 5, face: Some(1), .. }), "{corner:?}: {error:?}");
        assert!(error.to_string().contains("bad.obj:5: face 1"), "{error}");
    }
}

#[test]
fn every_way_to_write_a_face_is_the_same_face() {
    for face in [
        "f 1 2 3 4",
        "f -4 -3 -2 -1",
        "f\t1\t2\t3\t4\t",
        "  f 1 2 3 4 # a comment",
        "f 1/1 2/2 3/3 4/4",
        "f 1//9 2//-9 3//0 4//1",
        "f 1/7/8 2/7/8 3/7/8 4/7/8",
        "vt 0 0\nvn 0 0 1\nf 1/-1/-1 2/1/1 3 4//1",
        "f 1 2 \\\n3 \\ # more\n4",
        "fo 1 2 3 4",
        "f 1 1 2 2 3 4 4 1",
        "g a b\no c\ns off\nf 1 2 3 4\ng\n",
    ] {
        let imported = after_square(face);
        let square: Vec<[f64; 3]> = imported.scene.surfaces()[0].polygon.vertices().collect();
        assert_eq!(square, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], "{face:?}");
        assert_eq!(imported.scene.surfaces().len(), 1);
        assert_eq!(kinds(&imported.diagnostics), [DiagnosticKind::NoMaterial], "{face:?}");
    }
    // Line ends of other systems, a byte order mark, and a vertex that is defined below its face and in another group.
    let unix = format!("{SQUARE}f 1 2 3 4\n");
    let late = "v 0 0 0\ng a\nf 1 2 3 4\ng b\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 4 3 2 1\n".to_owned();
    for text in [unix.replace('\n', "\r\n"), unix.replace('\n', "\r"), format!("\u{feff}{unix}"), late] {
        assert_eq!(areas(&read(&text).unwrap())[0], 1.0, "{text:?}");
    }
}

#[test]
fn lines_and_points_are_no_faces() {
    // tobj takes a polyline of three points for a triangle.
    let imported = after_square("l 1 2 3\nl 1 2\np 1 2 3\ncurv 0 1 1 2\nf 1 2 3 4\nnonsense 1\nnonsense 2\n");
    assert_eq!((areas(&imported), &imported.lines), (vec![1.0], &vec![9]));
    let text = imported.diagnostics.warnings().join("\n");
    assert!(text.contains("bad.obj:5: 'l' (2 times)") && text.contains("'nonsense' (2 times) is unknown"), "{text}");
    assert_eq!(imported.diagnostics.count(DiagnosticKind::IgnoredElement), 3);
    assert_eq!(imported.diagnostics.count(DiagnosticKind::UnknownKeyword), 1);
}

#[test]
fn degenerate_faces_are_dropped_and_counted() {
    let imported = after_square("v 2 0 0\nf 1 2\nf 1\nf\nf 1 1 2\nf 1 2 5\nf 1 2 4 3\nf 1 2 3 4\n");
    assert_eq!((imported.lines.len(), areas(&imported)), (7, vec![1.0]));
    assert_eq!(imported.scene.surfaces()[0].face, 6);
    let lines: Vec<_> = imported.diagnostics.items.iter().filter(|d| d.kind == DiagnosticKind::DegenerateFace).collect();
    // The bow tie of line 11 has areas that cancel.
    assert_eq!(
        lines.iter().map(|d| (d.line, d.face)).collect::<Vec<_>>(),
        (6..12).map(|l| (Some(l), Some(l - 5))).collect::<Vec<_>>()
    );
    assert!(lines[0].to_string().contains("bad.obj:6: face 1: dropped"), "{}", lines[0]);
}

#[test]
fn duplicates_are_dropped_and_sheets_are_kept() {
    // The same square again, from another corner, on vertices of its own; then from behind, twice.
    let imported =
        after_square(&format!("f 1 2 3 4\nf 3 4 1 2\n{}f -4 -3 -2 -1\nf 4 3 2 1\nf 2 1 4 3\n", SQUARE.replace('0', "-0")));
    assert_eq!(areas(&imported), [1.0, 1.0]);
    assert_eq!(
        imported.scene.surfaces().iter().map(|s| (s.face, s.twin().map(|t| t.0))).collect::<Vec<_>>(),
        [(0, Some(1)), (3, Some(0))]
    );
    let dropped: Vec<String> =
        imported.diagnostics.items.iter().filter(|d| d.kind == DiagnosticKind::DuplicateFace).map(ToString::to_string).collect();
    assert_eq!(dropped.len(), 3);
    assert!(dropped[0].ends_with("bad.obj:6: face 2: dropped: it repeats face 1 of line 5"), "{}", dropped[0]);
    assert!(dropped[2].ends_with("bad.obj:13: face 5: dropped: it repeats face 4 of line 12"), "{}", dropped[2]);
    assert_eq!(imported.diagnostics.count(DiagnosticKind::Sheet), 1);

    // Both sides of both: nothing to add.
    let folder = Folder::with(&[("a.obj", format!("{SQUARE}f 1 2 3 4\nf 4 3 2 1\nf 1 2 3\n").as_bytes())]);
    let both = read_scene(&folder.path("a.obj"), &ImportOptions { sides: Sides::Both, ..ImportOptions::default() }).unwrap();
    assert_eq!(both.scene.surfaces().iter().map(|s| s.twin().unwrap().0).collect::<Vec<_>>(), [1, 0, 3, 2]);
}

#[test]
fn polygons_become_convex_and_planar() {
    // An L, concave.
    let l = read("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n").unwrap();
    assert_eq!(l.scene.surfaces().len(), 2);
    assert!((areas(&l).iter().sum::<f64>() - 3.0).abs() < 1e-14);
    assert!(l.scene.surfaces().iter().all(|s| s.face == 0 && s.plane() == 0));
    assert_eq!(l.diagnostics.count(DiagnosticKind::ConcaveFace), 1);

    // A bent quad and a bent pentagon, each also from behind: their pieces are twins of each other.
    let bent = read("v 0 0 0\nv 1 0 0\nv 1 1 .1\nv 0 1 0\nv -1 .5 0\nf 1 2 3 4\nf 3 2 1 4\nf 5 1 2 3 4\nf 1 5 4 3 2\n").unwrap();
    assert_eq!(bent.scene.surfaces().len(), 2 + 2 + 3 + 3);
    assert!(bent.scene.surfaces().iter().all(|s| s.twin().is_some()));
    assert_eq!(bent.diagnostics.count(DiagnosticKind::NonPlanarFace), 4);
    let first = bent.diagnostics.first(DiagnosticKind::NonPlanarFace).unwrap();
    assert!(first.to_string().contains("bad.obj:6: face 1: is not planar"), "{first}");

    // Bent by the rounding of its digits only.
    let rounded =
        read("v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 5 5 1\nv 5.1 5 1\nv 5.1 5.1 1.000001\nv 5 5.1 1\nf 1 2 3 4\nf 5 6 7 8\n");
    let rounded = rounded.unwrap();
    assert_eq!((rounded.scene.surfaces().len(), rounded.diagnostics.count(DiagnosticKind::Flattened)), (2, 1));

    // A pentagram turns left at every corner and yet is no polygon.
    let star = read("v 1 0 0\nv -.809 .588 0\nv .309 -.951 0\nv .309 .951 0\nv -.809 -.588 0\nf 1 2 3 4 5\n").unwrap();
    assert_eq!(star.diagnostics.count(DiagnosticKind::CrossingFace), 1);
}

#[test]
fn a_polygon_of_ten_thousand_corners_is_cut() {
    // A comb: every other corner points inwards.
    let teeth = 5_000;
    let mut text = format!("v 0 -1 0\nv {} -1 0\n", 2 * teeth);
    let mut face = "f 1 2".to_owned();
    for tooth in (0..teeth).rev() {
        text += &format!("v {} 0 0\nv {} 1 0\n", 2 * tooth + 2, 2 * tooth + 1);
        face += &format!(" {} {}", 2 * (teeth - tooth) + 1, 2 * (teeth - tooth) + 2);
    }
    text += &format!("v 0 0 0\n{face} {}\n", 2 * teeth + 3);
    let imported = read(text).unwrap();
    let total: f64 = areas(&imported).iter().sum();
    assert!((total / f64::from(3 * teeth) - 1.0).abs() < 1e-12, "{total}");
    assert_eq!(imported.diagnostics.count(DiagnosticKind::CrossingFace), 0);
}

// ------------------------------------------------------------------------------------------------------------ summary

#[test]
fn the_summary_tells_what_is_there_and_keeps_it_short() {
    let mut obj = format!("{GREY}{SQUARE}f 1 2 3 4\nf 4 3 2 1\n");
    for _ in 0..50 {
        obj += "f 1 2\n";
    }
    let imported = read_with(&obj, "newmtl grey\nKd 0.25 0.5 0.75\nKe 1 0 2\n").unwrap();
    let summary = SceneSummary::new(&imported.scene, &imported.diagnostics);
    assert_eq!((summary.vertices, summary.faces, summary.surfaces, summary.triangles), (4, 2, 2, 4));
    assert_eq!((summary.sheets, summary.planes, summary.materials, summary.emitters), (1, 1, 1, 2));
    assert_eq!((summary.area, summary.reflectance, summary.mean_reflectance), (2.0, [0.25, 0.75], 0.5));
    let pi = std::f64::consts::PI;
    assert_eq!(summary.emitted_power, [2.0 * pi, 0.0, 4.0 * pi]);
    assert_eq!(summary.repairs.len(), Diagnostics::LISTED_PER_KIND + 1);
    assert_eq!(summary.repairs.last().unwrap(), "... and 46 more like this");
    let text = summary.to_string();
    assert!(text.contains("2 (4 triangles, 1 two-sided sheets)") && text.contains("repaired:"), "{text}");

    let dark = after_square("f 1 2 3 4\n");
    let text = SceneSummary::new(&dark.scene, &dark.diagnostics).to_string();
    assert!(text.contains("no light"), "{text}");
}
