//! What the commands beside `solve` write: `sample`, `render`, `export` and `info`.

use std::fs;
use std::process::{Command, Stdio};

use super::Place;

#[test]
fn sample_writes_values_beside_the_points() {
    let place = Place::new();
    let ran = place.run("sample room.solution P.csv");
    ran.succeeded();
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert_eq!((lines.len(), lines[0]), (3, "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,face"));
    assert!(lines[1].starts_with("1,0,1,0,1,0,") && lines[2].starts_with("0,1,0.5,1,0,0,"), "{lines:?}");

    place.run("sample room.solution P.csv -o V.csv --progress none").succeeded();
    assert_eq!(place.read("V.csv"), ran.stdout);
    let piped = place.run_with(&["sample", "room.solution", "-"], &place.read("P.csv"));
    assert_eq!(piped.succeeded().stdout, ran.stdout);
    let none = place.run_with(&["sample", "room.solution", "-"], "x,y,z,nx,ny,nz\n");
    assert_eq!(none.succeeded().stdout, "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,face\n");
}

#[test]
fn render_and_export_write_what_the_extension_says() {
    let place = Place::new();
    for (arguments, name, magic) in [
        ("render room.solution --size 32x24 -o a.png", "a.png", &b"\x89PNG"[..]),
        ("render room.solution --size 32x24 -o a.EXR", "a.EXR", &[0x76, 0x2f, 0x31, 0x01]),
        ("render room.solution --size 32x24 -o a.hdr", "a.hdr", b"#?RADIANCE\nSOFTWARE=patchlight "),
        ("export room.solution -o a.ply", "a.ply", b"ply\nformat binary_little_endian"),
        ("export room.solution -o a.glb", "a.glb", b"glTF\x02\0\0\0"),
        ("export room.solution -o a.vtp", "a.vtp", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\""),
    ] {
        let ran = place.run(arguments);
        assert!(ran.succeeded().stdout.is_empty());
        assert!(fs::read(place.path(name)).unwrap().starts_with(magic), "{name}");
    }
    place.run("solve room.obj --texture blur").failed(2, &["--texture", "face, reject"]);
    let camera =
        ["render", "room.solution", "-o", "b.png", "--size", "8x6", "--camera", "eye=1,1,1.9 target=1,1,0", "--exposure", "-2"];
    let ran = place.run_with(&camera, "");
    assert!(ran.succeeded().stderr.contains("eye=1,1,1.9 target=1,1,0") && ran.stderr.contains("EV -2.00"), "{}", ran.stderr);
}

#[test]
fn progress_none_says_nothing_and_json_says_json() {
    let place = Place::new();
    assert_eq!(place.run("render room.solution --size 8x6 -o a.png --progress none").succeeded().stderr, "");
    let ran = place.run("render room.solution --size 8x6 -o a.png --progress json");
    assert!(!ran.succeeded().stderr.is_empty());
    for line in ran.stderr.lines() {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(value["event"].is_string(), "{line}");
    }
}

#[test]
fn info_of_a_solution_goes_to_stdout() {
    let place = Place::new();
    let ran = place.run("info room.solution");
    ran.succeeded();
    for word in ["room.solution: solution", "surfaces", "emitters     1 surfaces", "\"error\":0.1"] {
        assert!(ran.stdout.contains(word), "'{word}' is not in: {}", ran.stdout);
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let place = Place::new();
    let rows: String = (0..50_000).map(|k| format!("{},0,1,0,1,0\n", f64::from(k) * 4e-5)).collect();
    fs::write(place.path("many.csv"), format!("x,y,z,nx,ny,nz\n{rows}")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_patchlight"))
        .args(["sample", "room.solution", "many.csv"])
        .current_dir(place.0.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn info_tells_what_is_in_a_scene() {
    let place = Place::new();
    let ran = place.run("info room.obj");
    ran.succeeded();
    assert!(ran.stdout.contains("room.obj: scene") && ran.stdout.contains("surfaces     7"), "{}", ran.stdout);
    assert!(!ran.stdout.contains("suspicious"), "{}", ran.stdout);
}

#[test]
fn info_draws_what_it_finds() {
    let place = Place::new();
    let (room, bad) = (place.read("room.obj"), place.path("bad.obj"));
    fs::write(&bad, format!("{room}f 9 10 11 12\n")).unwrap();
    let ran = place.run("info bad.obj --image bad.png --size 60x40");
    let stdout = ran.succeeded().stdout.clone();
    assert!(
        stdout.contains("picture      bad.png, from eye=") && stdout.contains("  dropped, repeats another: 1 face\n"),
        "{stdout}"
    );
    let reader = png::Decoder::new(std::io::Cursor::new(fs::read(place.path("bad.png")).unwrap())).read_info().unwrap();
    assert!(reader.info().height == 40 && reader.info().width > 60);
    let ran = place.run("info room.obj --image room.png --size 60x40");
    assert!(ran.succeeded().stdout.contains("  nothing is found wrong\n"), "{}", ran.stdout);
    for (arguments, words) in [
        ("info room.obj --image a.exr", &["--image draws a PNG", "a.png"][..]),
        ("info room.obj --size 60x40", &["--camera and --size need --image"]),
        ("info room.obj --image a.png --size 0x40", &["the size 0x40"]),
        ("info room.obj --image none/a.png", &["none"]),
        ("info room.solution --image a.png", &["--image is for scenes", "patchlight render"]),
        ("info room.png --image room.png", &["room.png is read by this command"]),
    ] {
        place.run(arguments).failed(2, words);
    }
}
