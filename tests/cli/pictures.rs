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
        ("solve room.obj --image a.png --show mesh", &["--show mesh needs --lit-mesh"]),
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
    place.run("render without.solution -o none.png --show mesh --size 60x40").failed(2, &["--show mesh", "no lit mesh"]);
}

#[test]
fn a_camera_that_turns_out_impossible_in_the_scene_is_a_usage_error() {
    let place = Place::new();
    let camera = ["render", "room.solution", "-o", "a.png", "--camera", "eye=1,1,1 target=1,2,1 up=0,1,0"];
    place.run_with(&camera, "").failed(2, &["up is zero or parallel"]);
    assert!(place.new_files().is_empty());
}
