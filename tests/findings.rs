//! What is found wrong with a scene is told by face, and drawn where it is.

use std::fs;
use std::path::PathBuf;

use patchlight::inspect::{DEFAULT_POINTS, FindingClass, Findings, inspect};
use patchlight::output::KeyLine;
use patchlight::picture::{BACK_COLOUR, Camera, PlainPicture};
use patchlight::pipeline::picture_of_findings;
use patchlight::scene::import::{DiagnosticKind, ImportOptions, Imported, read_scene};
use patchlight::visibility::{Backend, OccluderMesh, build};

/// The floor of a room, seen from above, and faces on and over it: squares of one metre, by their corner.
fn square([x, y, z]: [f64; 3], up: bool) -> String {
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let vertices: String = corners.iter().map(|[dx, dz]| format!("v {} {y} {}\n", x + dx, z + dz)).collect();
    format!("{vertices}f {}\n", if up { "-4 -3 -2 -1" } else { "-1 -2 -3 -4" })
}

fn read(text: &str) -> Imported {
    let folder = tempfile::tempdir().unwrap();
    let file: PathBuf = folder.path().join("a.obj");
    fs::write(&file, text).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl bright\nKd 1.5 0.5 0.5\n").unwrap();
    read_scene(&file, &ImportOptions::default()).unwrap()
}

/// What is found, and a picture from straight above: 10 pixels to a metre, the origin in the middle of 200.
fn drawn(imported: &Imported) -> (Findings, PlainPicture, Vec<KeyLine>) {
    let visibility = build(Backend::Obvhs, &OccluderMesh::of_scene(&imported.scene)).unwrap();
    let findings = Findings::new(imported, &inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS));
    let half = (10.0_f64 / 1000.0).atan().to_degrees();
    let (eye, up) = ([0.0, 1000.0, 0.0], [0.0, 0.0, -1.0]);
    let camera = Camera { eye, target: [0.0; 3], up, field_of_view_degrees: 2.0 * half, width: 200, height: 200 };
    let (picture, key) = picture_of_findings(&imported.scene, &findings, visibility.as_ref(), &camera).unwrap();
    (findings, picture, key)
}

fn pixel(picture: &PlainPicture, [x, z]: [f64; 2]) -> [u8; 3] {
    picture.pixels[(100.0 + 10.0 * z) as usize * 200 + (100.0 + 10.0 * x) as usize]
}

fn class(kind: DiagnosticKind) -> usize {
    FindingClass::ALL.iter().position(|class| class.kinds == [kind] || class.kinds.contains(&kind)).unwrap()
}

fn is_grey([r, g, b]: [u8; 3]) -> bool {
    r.abs_diff(g) < 4 && g.abs_diff(b) < 4 && r > 150
}

#[test]
fn each_face_has_the_colour_of_what_is_found_about_it() {
    let scene = [
        "mtllib a.mtl\nusemtl grey\n".to_owned(),
        square([0.0, 0.0, 0.0], true),
        // A sheet, a repeated face, one in the front of another, a bent one, one of a material that was repaired, one that looks down.
        square([2.0, 0.0, 0.0], true) + "f -1 -2 -3 -4\n",
        square([4.0, 0.0, 0.0], true) + "f -3 -2 -1 -4\n",
        square([6.0, 0.0, 0.0], true) + &square([6.5, 0.0, 0.0], true),
        "v 0 0 4\nv 0 0.3 5\nv 1 0 5\nv 1 0 4\nf -4 -3 -2 -1\n".to_owned(),
        format!("usemtl bright\n{}usemtl grey\n", square([2.0, 0.0, 4.0], true)),
        square([4.0, 0.0, 4.0], false),
        "v 6 0 4.5\nv 6.5 0 4.5\nv 7 0 4.5\nf -3 -2 -1\n".to_owned(),
    ];
    let imported = read(&scene.concat());
    let (findings, picture, key) = drawn(&imported);
    let colour = |kind| FindingClass::ALL[class(kind)].colour;
    let is_shade = |seen: [u8; 3], whole: [u8; 3]| (0..3).all(|k| seen[k].abs_diff(whole[k]) < 12);
    assert!(is_grey(pixel(&picture, [0.5, 0.5])));
    for (place, kind) in [
        ([2.5, 0.5], DiagnosticKind::Sheet),
        ([4.5, 0.5], DiagnosticKind::DuplicateFace),
        ([6.2, 0.5], DiagnosticKind::Overlap),
        ([7.2, 0.5], DiagnosticKind::Overlap),
        ([0.9, 4.5], DiagnosticKind::NonPlanarFace),
        ([2.5, 4.5], DiagnosticKind::ReflectanceClamped),
        ([6.5, 4.5], DiagnosticKind::DegenerateFace),
    ] {
        assert!(is_shade(pixel(&picture, place), colour(kind)), "{kind:?}: {:?} {:?}", pixel(&picture, place), colour(kind));
    }
    assert!(is_shade(pixel(&picture, [4.5, 4.5]), BACK_COLOUR) && picture.shows_backs);

    // The key counts faces: of a sheet both.
    let counted = |kind| findings.faces[class(kind)];
    assert_eq!(
        (counted(DiagnosticKind::Sheet), counted(DiagnosticKind::DuplicateFace), counted(DiagnosticKind::Overlap)),
        (2, 1, 2)
    );
    assert_eq!((counted(DiagnosticKind::DegenerateFace), counted(DiagnosticKind::ReflectanceClamped)), (1, 1));
    let line = key.iter().find(|line| line.colour == Some(colour(DiagnosticKind::Overlap))).unwrap();
    assert_eq!(line.text, "in the front of another: 2 faces");
    assert_eq!(findings.elsewhere, 1, "that nothing emits is about no face");
}

#[test]
fn what_is_wrong_shows_as_stripes_through_what_hides_it() {
    let hidden = square([0.0, 0.0, 0.0], true) + "f -3 -2 -1 -4\n";
    let imported = read(&("mtllib a.mtl\nusemtl grey\n".to_owned() + &hidden + &square([0.0, 30.0, 0.0], true)));
    // So high above that its back does not count.
    let (_, picture, key) = drawn(&imported);
    let seen: Vec<[u8; 3]> = (0..9).map(|k| pixel(&picture, [0.05 + 0.1 * f64::from(k), 0.5])).collect();
    let violet = |[r, g, b]: [u8; 3]| b > g.saturating_add(60) && r > g;
    assert!(seen.iter().any(|&pixel| violet(pixel)) && seen.iter().any(|&pixel| is_grey(pixel)), "{seen:?}");
    assert!(picture.shows_stripes && key.iter().any(|line| line.text.contains("stripes")));
}

#[test]
fn of_a_closed_room_nothing_is_found_wrong() {
    let scene = concat!(
        "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n",
        "usemtl grey\nf 1 5 6 2\nf 4 3 7 8\nf 1 2 3 4\nf 5 8 7 6\nf 1 4 8 5\nf 2 6 7 3\n"
    );
    let imported = read(scene);
    let (findings, picture, key) = drawn(&imported);
    // Only that nothing emits.
    assert_eq!((findings.elsewhere, findings.faces.iter().sum::<usize>(), findings.inside), (1, 0, None));
    assert!(findings.of_surfaces.iter().all(Option::is_none) && findings.places.is_empty());
    assert!(picture.shows_backs && !picture.shows_stripes);
    assert_eq!(key[0].text, "about no face: 1");
    let findings = Findings { elsewhere: 0, ..findings };
    assert!(findings.are_notes());
}
