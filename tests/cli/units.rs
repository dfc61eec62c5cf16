//! `--unit` and `--up`: files of other lengths, and with another axis up.

use std::fs;

use super::Place;

const LIGHTS: &str = "[[sun]]\nazimuth = 90\nelevation = 30\nirradiance = 8\n[[point]]\nposition = POSITION\nintensity = 3\n";

/// A floor of 2 m with a lamp 2 m above it and a sun, in a unit of so many metres, with y or z up.
fn place(metres: f64, is_z_up: bool) -> Place {
    let place = Place::new();
    let across = 2.0 / metres;
    // The same floor in both, by a right-handed change of axes: (x, y, z) with y up is (x, -z, y) with z up.
    let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, across], [across, 0.0, across], [across, 0.0, 0.0]];
    let turned = |[x, y, z]: [f64; 3]| if is_z_up { [x, -z, y] } else { [x, y, z] };
    let vertex = |corner: &[f64; 3]| turned(*corner).map(|x| x.to_string()).join(" ");
    let vertices: String = corners.iter().map(|corner| format!("v {}\n", vertex(corner))).collect();
    fs::write(place.path("floor.obj"), format!("mtllib floor.mtl\n{vertices}usemtl floor\nf 1 2 3 4\n")).unwrap();
    fs::write(place.path("floor.mtl"), "newmtl floor\nKd 0.5 0.5 0.5\n").unwrap();
    let position = format!("{:?}", turned([1.0, 2.0, 1.0]));
    fs::write(place.path("lights.toml"), LIGHTS.replace("POSITION", &position)).unwrap();
    let list = |numbers: [f64; 3]| turned(numbers).map(|x| x.to_string()).join(",");
    let point = format!("x,y,z,nx,ny,nz\n{},{}\n", list([1.0, 0.0, 1.0]), list([0.0, 1.0, 0.0]));
    fs::write(place.path("P.csv"), point).unwrap();
    place
}

/// The number in a column of the only row of a CSV file.
fn number(place: &Place, file: &str, column: &str) -> f64 {
    let text = place.read(file);
    let (names, row) = (text.lines().next().unwrap(), text.lines().nth(1).unwrap());
    let at = names.split(',').position(|name| name == column).unwrap();
    row.split(',').nth(at).unwrap().parse().unwrap()
}

#[test]
fn a_scene_in_other_units_is_lit_as_it_is_in_metres() {
    // 3 W/sr from 2 m above, and 8 W/m^2 at 30 degrees over the horizon; half of that is reflected.
    let expected = 0.5 * (3.0 / 4.0 + 8.0 * 0.5);
    for (metres, unit) in [(1.0, "m"), (0.01, "cm"), (0.001, "mm"), (0.0254, "inch"), (0.3048, "ft"), (12.5, "12.5")] {
        for is_z_up in [false, true] {
            let place = place(metres, is_z_up);
            let up = if is_z_up { "z" } else { "y" };
            let line = "solve floor.obj --lights lights.toml --points P.csv --values V.csv -o f.solution";
            place.run(&format!("{line} --unit {unit} --up {up}")).succeeded();
            let found = number(&place, "V.csv", "B_r");
            assert!((found / expected - 1.0).abs() < 1e-3, "{unit}, {up} up: {found} for {expected}");
            // A solution is in metres, and knows where up is: of a floor that stands on edge there is no horizontal plane.
            place.run("sample f.solution --plane height=0.5 -o S.csv").succeeded();
            assert_eq!(number(&place, "S.csv", if is_z_up { "z" } else { "y" }), 0.5);
        }
    }
}

#[test]
fn units_are_for_files_that_have_none() {
    let place = place(1.0, false);
    place.run("solve floor.obj --unit league -o f.solution").failed(2, &["it must be m, cm, mm, inch, ft, or a number of metres"]);
    place.run("solve floor.obj --unit 1e10 -o f.solution").failed(2, &["from 1e-9 to 1e9"]);
    place.run("solve floor.obj --up w -o f.solution").failed(2, &["must be x, y or z"]);
    fs::write(place.path("room.glb"), "glTF").unwrap();
    place.run("solve room.glb --unit cm -o f.solution").failed(3, &["glTF is in metres, and y is up"]);
    place.run("info room.solution --up z").failed(2, &["--up is for scenes; room.solution is solved already"]);
    place.run("bake room.solution --unit cm -o l.exr").failed(2, &["--unit is for scenes; room.solution is solved already"]);
}
