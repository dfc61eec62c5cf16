//! Lights that are no surfaces: `--lights`, and `lights` in a file of jobs.

use std::fs;

use super::Place;

/// A floor alone, black but for a half.
const FLOOR: &str = "mtllib floor.mtl\nv 0 0 0\nv 0 0 2\nv 2 0 2\nv 2 0 0\nusemtl floor\nf 1 2 3 4\n";

const LIGHTS: &str =
    "[[ies]]\nname = 'lamp'\nfile = 'a.ies'\nposition = [1, 2, 1]\n\n[[sun]]\nazimuth = 90\nelevation = 30\nirradiance = 8\n";

/// 358 cd straight down and anywhere else below.
const IES: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 30\n0 90\n0\n358 358\n";

fn place() -> Place {
    let place = Place::new();
    fs::write(place.path("floor.obj"), FLOOR).unwrap();
    fs::write(place.path("floor.mtl"), "newmtl floor\nKd 0.5 0.5 0.5\n").unwrap();
    fs::write(place.path("lights.toml"), LIGHTS).unwrap();
    fs::write(place.path("a.ies"), IES).unwrap();
    fs::write(place.path("P.csv"), "x,y,z,nx,ny,nz\n1,0,1,0,1,0\n").unwrap();
    place
}

/// The radiosity in the file of values.
fn value(place: &Place, file: &str) -> f64 {
    let text = place.read(file);
    let (names, row) = (text.lines().next().unwrap(), text.lines().nth(1).unwrap());
    let column = names.split(',').position(|name| name == "B_r").unwrap();
    row.split(',').nth(column).unwrap().parse().unwrap()
}

#[test]
fn a_scene_is_lit_by_them() {
    let place = place();
    place.run("solve floor.obj --lights lights.toml --points P.csv --values V.csv -o f.solution").succeeded();
    // 2 W/sr from 2 m above, and 8 W/m^2 at 30 degrees over the horizon; half of that is reflected.
    let expected = 0.5 * (2.0 / 4.0 + 8.0 * 0.5);
    assert!((value(&place, "V.csv") / expected - 1.0).abs() < 1e-3, "{}", value(&place, "V.csv"));

    for line in ["info floor.obj --lights lights.toml", "info f.solution"] {
        let ran = place.run(line);
        let told = &ran.succeeded().stdout;
        assert!(told.contains("light        'lamp', ies: 12.5664 12.5664 12.5664 W, 2249.4 lm"), "{told}");
        assert!(told.contains("light        'sun 2', sun: 8.0000 8.0000 8.0000 W/m^2, 1432.0 lx"), "{told}");
    }
    let ran = place.run("bake floor.obj --lights lights.toml --texel 0.5 -o l.exr");
    ran.succeeded();
    for line in ["info f.solution --lights lights.toml", "bake f.solution --lights lights.toml -o l.exr"] {
        place.run(line).failed(2, &["--lights is for scenes; f.solution is solved already"]);
    }
}

#[test]
fn what_is_wrong_with_them_is_told() {
    let place = place();
    fs::write(place.path("bad.toml"), LIGHTS.replace("elevation", "height")).unwrap();
    place.run("solve floor.obj --lights bad.toml -o f.solution").failed(3, &["bad.toml:6: say where the sun stands"]);
    place.run("info floor.obj --lights none.toml").failed(3, &["none.toml: cannot be read"]);
    // What is read is not written.
    place.run("solve floor.obj --lights lights.toml --report lights.toml").failed(2, &["lights.toml"]);
    place.run("solve floor.obj --lights lights.toml --report a.ies").failed(2, &["a.ies"]);
    assert_eq!((place.read("lights.toml"), place.read("a.ies")), (LIGHTS.to_owned(), IES.to_owned()));
}

#[test]
fn a_batch_knows_what_is_done_by_them_too() {
    let place = place();
    fs::write(place.path("other.toml"), LIGHTS.replace("irradiance = 8", "irradiance = 4")).unwrap();
    let jobs = "scenes = 'floor.obj'\nname = '{which}'\nlights = '{which}.toml'\npoints = 'P.csv'\n\
                [parameters]\nwhich = ['lights', 'other']\n[outputs]\nvalues = '{name}.csv'\n";
    fs::write(place.path("jobs.toml"), jobs).unwrap();
    place.run("batch jobs.toml -o out").succeeded();
    let noted = || place.read("out/jobs.0-of-1.journal").lines().count();
    let (values, first) = ([value(&place, "out/lights.csv"), value(&place, "out/other.csv")], noted());
    assert!((values[0] - values[1] - 0.5 * 4.0 * 0.5).abs() < 1e-3, "{values:?}");
    place.run("batch jobs.toml -o out --resume").succeeded();
    assert_eq!(noted(), first);
    // The photometric file is read by both jobs, the other file of lights by one.
    for (file, from, to, again) in [("a.ies", "358 358", "358 179", 2), ("other.toml", "= 4", "= 5", 1)] {
        fs::write(place.path(file), place.read(file).replace(from, to)).unwrap();
        let before = noted();
        place.run("batch jobs.toml -o out --resume").succeeded();
        assert_eq!(noted(), before + again, "{file}");
    }
}
