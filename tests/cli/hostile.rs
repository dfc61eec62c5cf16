//! Scenes, points and outputs that would do harm: what is refused, before the work, and how.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::Command;

use super::{MATERIALS, Place, ROOM};

#[test]
fn a_scene_reads_no_library_elsewhere_unless_that_is_allowed() {
    let place = Place::new();
    fs::create_dir(place.path("below")).unwrap();
    fs::rename(place.path("room.mtl"), place.path("below/room.mtl")).unwrap();
    fs::write(place.path("room.obj"), ROOM.replace("room.mtl", "below/room.mtl")).unwrap();
    place.run("solve room.obj --error 0.5").succeeded();

    fs::write(place.path("below/a.obj"), ROOM.replace("room.mtl", "../secret.mtl")).unwrap();
    fs::write(place.path("secret.mtl"), format!("{MATERIALS}password hunter2\npassword hunter3\n")).unwrap();
    for command in ["solve below/a.obj", "info below/a.obj"] {
        let words = ["below/a.obj:1: material library", "secret.mtl", "outside of the folder", "--allow-any-path"];
        place.run(command).failed(3, &words);
    }
    // A link leads elsewhere as well.
    symlink("../secret.mtl", place.path("below/link.mtl")).unwrap();
    fs::write(place.path("below/b.obj"), ROOM.replace("room.mtl", "link.mtl")).unwrap();
    place.run("solve below/b.obj").failed(3, &["outside of the folder"]);

    // What is no statement of a library is not repeated.
    let ran = place.run("info below/a.obj --allow-any-path");
    assert!(ran.succeeded().stdout.contains("2 statements from here on are unknown"), "{}", ran.stdout);
    assert!(!ran.stdout.contains("hunter") && !ran.stdout.contains("password"), "{}", ran.stdout);
}

#[test]
fn a_missing_library_is_an_error_where_its_materials_are_used() {
    let place = Place::new();
    fs::write(place.path("room.obj"), ROOM.replace("room.mtl", "gone.mtl")).unwrap();
    place
        .run("solve room.obj -o s.solution")
        .failed(3, &["room.obj:1: material library gone.mtl cannot be read", "material 'wall'"]);
    // Another library has them all.
    fs::write(place.path("room.obj"), ROOM.replace("room.mtl", "gone.mtl room.mtl")).unwrap();
    let ran = place.run("solve room.obj --error 0.5");
    assert!(ran.succeeded().stderr.contains("warning: room.obj:1: material library gone.mtl cannot be read"), "{}", ran.stderr);
}

#[test]
fn the_library_of_a_scene_is_not_written() {
    let place = Place::new();
    for arguments in ["-o room.mtl", "--report room.mtl", "--points P.csv --values room.mtl"] {
        place.run(&format!("solve room.obj {arguments}")).failed(2, &["room.mtl is read by this command"]);
    }
    assert_eq!(place.read("room.mtl"), MATERIALS);
}

#[test]
fn inputs_that_never_end_are_given_up() {
    let place = Place::new();
    assert!(Command::new("mkfifo").arg(place.path("pipe.obj")).status().unwrap().success());
    place.run("sample room.solution /dev/zero").failed(3, &["/dev/zero:1: the line is longer"]);
    place.run("solve room.obj --points /dev/zero --values -").failed(3, &["/dev/zero:1: the line is longer"]);
    for (arguments, words) in [
        ("info pipe.obj", "it is not a regular file"),
        ("solve pipe.obj", "it is not a regular file"),
        ("sample pipe.obj P.csv", "it is not a regular file"),
        ("render /dev/zero -o a.png", "it is not a regular file"),
    ] {
        place.run(arguments).failed(3, &[words]);
    }
}

#[test]
fn outputs_that_cannot_be_replaced_are_found_before_the_work() {
    let place = Place::new();
    let name = "x".repeat(300);
    place.run(&format!("solve missing.obj -o {name}")).failed(2, &["cannot write x", "File name too long"]);
    symlink("nowhere", place.path("link")).unwrap();
    place.run("solve missing.obj -o link").failed(2, &["link to something that does not exist"]);
    fs::write(place.path("kept"), "precious").unwrap();
    let mut permissions = fs::metadata(place.path("kept")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(place.path("kept"), permissions).unwrap();
    place.run("solve missing.obj --report kept").failed(2, &["cannot write kept", "permission denied"]);
    assert!(Command::new("mkfifo").arg(place.path("pipe")).status().unwrap().success());
    place.run("solve missing.obj --report pipe").failed(2, &["nobody reads this pipe"]);
    assert_eq!(
        (place.read("kept"), place.new_files()),
        ("precious".to_owned(), vec!["kept".to_owned(), "link".into(), "pipe".into()])
    );
}

#[test]
fn names_that_are_not_utf8_are_names() {
    let place = Place::new();
    let name = OsStr::from_bytes(b"r\xffm.obj");
    fs::rename(place.path("room.obj"), place.0.path().join(name)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_patchlight"))
        .arg("solve")
        .arg(name)
        .args(["--error", "0.5", "--report", "-"])
        .current_dir(place.0.path())
        .output()
        .unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), report["scene"]["file"].as_str()), (Some(0), Some("r\u{fffd}m.obj")));
}

/// A limit on the size of files stands for a full disk. Its signal is ignored, so that writing fails.
#[test]
fn a_disk_that_is_full_is_called_so() {
    let place = Place::new();
    let script =
        format!("trap '' XFSZ; ulimit -f 1; exec {} solve room.obj --error 0.1 -o s.solution", env!("CARGO_BIN_EXE_patchlight"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(place.0.path()).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("cannot write s.solution") && stderr.contains("File too large"), "{stderr}");
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}

/// A pipe that nobody writes to is not waited for.
#[test]
fn a_pipe_is_no_scene_and_no_solution() {
    let place = Place::new();
    let ran = place.run_in_shell(&format!(
        "mkfifo a.obj b; timeout 20 {0} info a.obj; echo $?; timeout 20 {0} info b; echo $?",
        env!("CARGO_BIN_EXE_patchlight")
    ));
    assert_eq!(ran.stdout, "3\n3\n", "{}", ran.stderr);
}

#[test]
fn one_sigterm_ends_it_and_the_solution_is_written() {
    let place = Place::new();
    let (code, said) =
        place.run_until_signal("solve room.obj --error 0.000001 -o s.solution --image a.png --size 4000x4000", "TERM");
    assert_eq!(code, Some(130), "{said}");
    assert_eq!(place.new_files(), ["s.solution"]);
    assert!(!said.contains("inf%"), "{said}");
}

#[test]
fn a_picture_from_outside_of_a_closed_room_is_warned_of() {
    let place = Place::new();
    let outside = ["render", "room.solution", "-o", "a.png", "--size", "8x6", "--camera", "eye=9,1,1 target=1,1,1"];
    let ran = place.run_with(&outside, "");
    assert!(ran.succeeded().stderr.contains("warning: the picture is black"), "{}", ran.stderr);
    assert!(!place.run("render room.solution -o a.png --size 8x6").succeeded().stderr.contains("warning"));
}

#[test]
fn an_existing_output_survives_a_failed_run() {
    let place = Place::new();
    for name in ["V.csv", "a.png", "a.exr", "a.ply", "m.ply", "out.solution", "r.json"] {
        fs::write(place.path(name), "precious").unwrap();
    }
    let mut bytes = fs::read(place.path("room.solution")).unwrap();
    bytes.truncate(1000);
    fs::write(place.path("bad.solution"), bytes).unwrap();
    fs::write(place.path("bad.csv"), "x,y,z,nx,ny,nz\nbad\n").unwrap();
    for arguments in [
        "sample bad.solution P.csv -o V.csv",
        "sample room.solution bad.csv -o V.csv",
        "render bad.solution -o a.png",
        "render bad.solution -o a.exr",
        "export bad.solution -o a.ply",
        "solve missing.obj -o out.solution --report r.json --image a.png --points P.csv --values V.csv --mesh m.ply",
    ] {
        assert_eq!(place.run(arguments).code, 3, "{arguments}");
    }
    for name in ["V.csv", "a.png", "a.exr", "a.ply", "m.ply", "out.solution", "r.json"] {
        assert_eq!(place.read(name), "precious", "{name}");
    }
    let expected = ["V.csv", "a.exr", "a.ply", "a.png", "bad.csv", "bad.solution", "m.ply", "out.solution", "r.json"];
    assert_eq!(place.new_files(), expected);
}
