//! Pictures that tell numbers: false colours, and lines.

use std::fs;

use super::Place;

#[test]
fn false_colours_and_lines_are_asked_for_in_full() {
    let place = Place::new();
    for (arguments, words) in [
        ("solve room.obj --image a.png --scale 5..1", &["scale is '5..1'", "as in 0..500"][..]),
        ("solve room.obj --image a.png --scale 0-500", &["scale is '0-500'"]),
        ("solve room.obj --image a.exr --scale 0..1", &["--scale is for .png"]),
        ("solve room.obj --image a.png --scale 0..1 --exposure 1", &["--scale", "--exposure"]),
        ("solve room.obj --image a.png --scale 0..1 --size 80x60", &["legend", "176x120"]),
        ("solve room.obj --image a.png --quantity illuminance", &["false colours", "--scale 0..500"]),
        ("solve room.obj --scale 0..1", &["need --image"]),
        ("solve room.obj --image a.png --show dots", &["show is 'dots'", "mesh or curves"]),
        ("solve room.obj --image a.exr --show curves", &["--show is for .png"]),
        ("solve room.obj --image a.png --show mesh --from gather", &["--show mesh needs --lit-mesh"]),
        ("render room.solution -o a.png --error 0", &["error is 0"]),
        ("render room.solution -o a.png --error 0.1 --from gather", &["--error asks for a mesh", "leave --from"]),
    ] {
        place.run(arguments).failed(2, words);
    }
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}

#[test]
fn pictures_tell_numbers_in_false_colours_and_show_lines() {
    let place = Place::new();
    let ran = place.run(
        "solve room.obj --error 0.2 -o s.solution --mesh m.ply --image i.png --image i.exr --quantity illuminance --scale 0..500 --show mesh \
         --size 180x120",
    );
    assert!(ran.succeeded().stderr.contains("i.png (illuminance from 0 to 500 lx)"), "{}", ran.stderr);
    let text = |name: &str| String::from_utf8_lossy(&fs::read(place.path(name)).unwrap()).into_owned();
    assert!(text("i.exr").contains("quantity: illuminance\nunit: lx\n") && text("i.png").contains("0..500 lx"));
    place.run("render s.solution -o c.png --show curves --size 60x40").succeeded();
    place.run("render s.solution -o h.exr --quantity irradiance --size 60x40").succeeded();
    assert!(text("h.exr").contains("quantity: irradiance\nunit: W/m^2\n"));
    place.run("render s.solution -o n.png --show mesh --size 60x40").succeeded();
    place.run("solve room.obj --error 0.5 -o without.solution").succeeded();
    place.run("render without.solution -o v.png --show mesh --size 60x40").succeeded();
    place
        .run("render without.solution -o none.png --show mesh --from gather --size 60x40")
        .failed(2, &["--show mesh", "no lit mesh"]);
}

/// A picture of a solution without a mesh makes one, and tells what is claimed of that; a small one, or one that is to be gathered, has standard errors alone.
#[test]
fn a_picture_tells_what_is_claimed_of_it() {
    let place = Place::new();
    let ran = place.run("solve room.obj --error 0.1 -o s.solution --image a.png --image a.exr --size 96x72 --threads 1");
    assert!(ran.succeeded().stderr.contains("over the pixels"), "{}", ran.stderr);
    let bytes = |name: &str| fs::read(place.path(name)).unwrap();
    let text = |name: &str| String::from_utf8_lossy(&bytes(name)).into_owned();
    let claim = "off the values at points, in the local norm over the pixels";
    assert!(text("a.png").contains(claim) && text("a.exr").contains(claim) && text("a.exr").contains("se.R\0"));

    // Stored, the same again; another error is another picture.
    place.run("render s.solution -o b.png -o b.exr --size 96x72 --threads 2").succeeded();
    assert!(bytes("a.png") == bytes("b.png") && bytes("a.exr") == bytes("b.exr"));
    place.run("render s.solution -o c.exr --size 96x72 --error 0.02").succeeded();
    assert!(bytes("c.exr") != bytes("a.exr"));

    for (flags, name) in [("--size 60x40", "small.exr"), ("--size 96x72 --from gather", "gathered.exr")] {
        place.run(&format!("render s.solution -o {name} {flags}")).succeeded();
        assert!(text(name).contains("se.R\0") && !text(name).contains(claim), "{name}");
    }
}

/// A mesh of the view ends with the time and with the memory, and where there is none, values are gathered; the picture is written, and says what it is.
#[test]
fn limits_hold_for_pictures_and_the_picture_says_so() {
    let place = Place::new();
    for (limit, word) in [
        ("--time 0", "time is '0'"),
        ("--memory 0", "memory is '0'"),
        ("--time 1e300", "time is 1e300"),
        ("--time soon", "time is 'soon'"),
    ] {
        place.run(&format!("render room.solution -o a.png {limit}")).failed(2, &[word]);
    }
    place.run("solve room.obj --error 0.1 -o s.solution").succeeded();
    let text = |name: &str| String::from_utf8_lossy(&fs::read(place.path(name)).unwrap()).into_owned();

    // More than can be had in this time.
    let asked = "--error 0.0005 --size 400x300";
    let ran = place.run(&format!("render s.solution -o t.exr {asked} --time 2"));
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(ran.stderr.contains("the time was over"), "{}", ran.stderr);
    let claim = "off the values at points, in the local norm over the pixels";
    assert!(text("t.exr").contains(claim) || text("t.exr").contains("% of the pixels were gathered"), "{}", ran.stderr);

    // No time at all: few pixels are gathered, and standard errors of the others are not known.
    let ran = place.run("render s.solution -o none.exr --size 400x300 --time 0.000001");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(text("none.exr").contains("% of the pixels were gathered; others show one beside them"));
    let ran = place.run("solve room.obj --error 0.001 --time 0.05 --image solved.png --size 400x300");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(text("solved.png").contains("the time was over") || text("solved.png").contains(claim), "{}", ran.stderr);

    // No room: the pixels are those that are gathered without limits. If an error was asked for, that is not reached.
    place.run("render s.solution -o gathered.exr --from gather --size 96x72").succeeded();
    let ran = place.run("render s.solution -o m.exr --size 96x72 --memory 0.001");
    assert!(ran.succeeded().stderr.contains("not enough room for a mesh of the view"), "{}", ran.stderr);
    assert!(fs::read(place.path("m.exr")).unwrap() == fs::read(place.path("gathered.exr")).unwrap());
    let ran = place.run("render s.solution -o e.exr --error 0.05 --size 96x72 --memory 0.001");
    assert_eq!(ran.code, 5, "{}", ran.stderr);
    assert!(place.path("e.exr").exists());

    // Where limits do not act, they change nothing.
    place.run("render s.solution -o free.exr --size 96x72").succeeded();
    place.run("render s.solution -o limited.exr --size 96x72 --time 1000 --memory 2").succeeded();
    assert!(fs::read(place.path("free.exr")).unwrap() == fs::read(place.path("limited.exr")).unwrap());
}

#[test]
fn a_camera_that_turns_out_impossible_in_the_scene_is_a_usage_error() {
    let place = Place::new();
    let camera = ["render", "room.solution", "-o", "a.png", "--camera", "eye=1,1,1 target=1,2,1 up=0,1,0"];
    place.run_with(&camera, "").failed(2, &["up is zero or parallel"]);
    assert!(place.new_files().is_empty());
}
