//! `sample --sensors` and `--plane`, `export --flux`, and pages.

use std::fs;

use super::Place;

/// One in the middle of the room that looks up, one that looks at a wall, one outside of it.
const SENSORS: &str = "name,x,y,z,nx,ny,nz\nup,1,1,1,0,1,0\naside,1,1,1,1,0,0\noutside,1,5,1,0,-1,0\n";

/// The fields of a table of numbers, by row; empty ones are not numbers.
fn numbers(text: &str, columns: std::ops::Range<usize>) -> Vec<Vec<f64>> {
    let number = |field: &str| field.parse().unwrap_or(f64::NAN);
    let row = |line: &str| line.split(',').take(columns.end).skip(columns.start).map(number).collect();
    text.lines().skip(1).map(row).collect()
}

#[test]
fn sensors_have_irradiance_and_illuminance_with_error_bars() {
    let place = Place::new();
    fs::write(place.path("S.csv"), SENSORS).unwrap();
    let ran = place.run("sample room.solution --sensors S.csv");
    let text = &ran.succeeded().stdout;
    assert!(text.starts_with("x,y,z,nx,ny,nz,H_r,H_g,H_b,se_r,se_g,se_b,lux,se_lux,name\n1,1,1,0,1,0,"), "{text}");
    let rows = numbers(text, 6..14);
    assert!(rows[0][..3].iter().all(|&h| h > 1.0) && rows[0][0] != rows[0][1] && rows[0][6] > rows[1][6], "{rows:?}");
    assert!(rows[..2].iter().all(|row| row[3..6].iter().all(|&se| se > 0.0 && se < row[0]) && row[7] > 0.0), "{rows:?}");
    assert_eq!(rows[2], [0.0; 8]);
    let lux = 179.0 * (0.2126 * rows[0][0] + 0.7152 * rows[0][1] + 0.0722 * rows[0][2]);
    assert!((rows[0][6] / lux - 1.0).abs() < 1e-6);

    // From stdin, into a file, by another number of threads: the same bytes. What was measured goes in again.
    let piped = place.run_with(&["sample", "room.solution", "--sensors", "-", "--threads", "2", "-o", "H.csv"], SENSORS);
    assert!(piped.succeeded().stderr.contains("H.csv (3 sensors)"));
    assert_eq!(&place.read("H.csv"), text);
    assert_eq!(&place.run("sample room.solution --sensors H.csv").succeeded().stdout, text);
}

#[test]
fn a_plane_is_a_grid_with_a_summary_and_a_picture() {
    let place = Place::new();
    // Over the floor of the room, all sensors are in it.
    let line = ["sample", "room.solution", "--plane", "height=0.75 spacing=0.25", "-o", "H.csv", "--image", "H.png"];
    let ran = place.run_with(&line, "");
    let table = place.read("H.csv");
    let rows = numbers(&table, 0..13);
    assert_eq!((ran.succeeded().stdout.as_str(), rows.len()), ("", 64));
    assert_eq!(rows[0][..6], [0.125, 0.75, 1.875, 0.0, 1.0, 0.0]);
    let lux: Vec<f64> = rows.iter().map(|row| row[12]).collect();
    let (mean, least) = (lux.iter().sum::<f64>() / 64.0, lux.iter().copied().fold(f64::INFINITY, f64::min));
    let largest = lux.iter().copied().fold(0.0, f64::max);
    for word in [
        "8x8 sensors, 64 of them measured: illuminance in lx".to_owned(),
        format!("mean      {mean:.3} (standard error "),
        format!("minimum   {least:.3}\n"),
        format!("maximum   {largest:.3}\n"),
        format!("uniform   {:.3} (minimum over mean)", least / mean),
        "H.png (illuminance from 0 to ".to_owned(),
    ] {
        assert!(ran.stderr.contains(&word), "'{word}' is not in: {}", ran.stderr);
    }
    let picture = png::Decoder::new(std::io::Cursor::new(fs::read(place.path("H.png")).unwrap())).read_info().unwrap();
    assert_eq!((picture.info().width, picture.info().height), (720 + 2 * 118, 720));

    // A plane that is given in full, through the wall: the half outside is measured as well, and dark.
    let line = ["sample", "room.solution", "--plane", "origin=1,0.5,0.5 u=0,0,1 v=2,0,0 counts=2x4"];
    let rows = numbers(&place.run_with(&line, "").succeeded().stdout, 0..13);
    assert!(rows.len() == 8 && rows.iter().all(|row| (row[12] > 0.0) == (row[0] < 2.0)), "{rows:?}");
    // Above the room a horizontal one has no sensor.
    let ran = place.run_with(&["sample", "room.solution", "--plane", "height=3"], "");
    assert!(
        ran.succeeded().stderr.contains("warning: none of the") && ran.stdout.lines().skip(1).all(|row| row.ends_with(",,,,,,,,"))
    );
}

#[test]
fn what_sensors_cannot_do_is_told() {
    let place = Place::new();
    fs::write(place.path("S.csv"), SENSORS).unwrap();
    for (arguments, words) in [
        (&["room.solution"][..], "--sensors"),
        (&["room.solution", "P.csv", "--sensors", "S.csv"], "cannot be used with"),
        (&["room.solution", "--sensors", "S.csv", "--plane", "height=1"], "cannot be used with"),
        (&["room.solution", "--sensors", "S.csv", "--from", "mesh"], "cannot be used with"),
        (&["room.solution", "--sensors", "S.csv", "--image", "a.png"], "--plane"),
        (&["room.solution", "P.csv", "--time", "5"], "cannot be used with"),
        (&["room.solution", "--sensors", "S.csv", "--time", "0"], "above 0"),
        (&["room.solution", "--sensors", "S.csv", "--time", "1e300"], "below 3.2e13"),
        (&["room.solution", "--sensors", "S.csv", "-o", "S.csv"], "S.csv is read by this command"),
        (&["room.solution", "--plane", "height"], "'height' has no '='"),
        (&["room.solution", "--plane", "height=1", "--image", "a.exr"], "name the file a.png"),
        (&["room.solution", "--plane", "height=1", "--image", "a.png", "--scale", "5"], "scale is '5'"),
        (&["room.solution", "--plane", "height=1", "-o", "a.png", "--image", "a.png"], "two outputs"),
    ] {
        place.run_with(&[&["sample"], arguments].concat(), "").failed(2, &[words]);
    }
    fs::write(place.path("bad.csv"), "x,y,z,nx,ny,nz\n1,1,1,0,2,0\n").unwrap();
    place.run("sample room.solution --sensors bad.csv").failed(3, &["bad.csv:2: the normal"]);
    assert_eq!(place.new_files(), ["S.csv", "bad.csv"]);
}

#[test]
fn what_there_is_no_time_for_is_empty() {
    let place = Place::new();
    let line = ["sample", "room.solution", "--plane", "height=1 spacing=0.01", "--time", "0.000001", "-o", "H.csv"];
    let ran = place.run_with(&line, "");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(ran.stderr.contains("40000 sensors were not measured") && ran.stderr.contains("time"), "{}", ran.stderr);
    assert_eq!(place.read("H.csv").lines().count(), 40_001);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_sensors_with_130_and_what_was_measured_is_written() {
    let place = Place::new();
    let rows: String = (0..200_000).map(|k| format!("1,{},1,0,1,0\n", 0.1 + 1e-6 * f64::from(k))).collect();
    fs::write(place.path("S.csv"), format!("x,y,z,nx,ny,nz\n{rows}")).unwrap();
    let (code, said) = place.run_until_signal("sample room.solution --sensors S.csv -o H.csv", "INT");
    assert!(code == Some(130) && said.contains("were not measured"), "{said}");
    let table = place.read("H.csv");
    let measured = table.lines().skip(1).filter(|row| !row.ends_with(",,")).count();
    assert!(table.lines().count() == 200_001 && measured > 0 && measured < 200_000, "{measured}");
}

#[test]
fn export_writes_power_by_face() {
    let place = Place::new();
    let ran = place.run("export room.solution --flux -");
    let text = &ran.succeeded().stdout;
    assert!(text.starts_with("of,face,material,object,group,area_m2,emitted_r,") && text.contains("\nface,7,lamp,,,"), "{text}");
    place.run("export room.solution --flux F.csv -o a.ply").succeeded();
    assert_eq!(&place.read("F.csv"), text);
    assert_eq!(place.new_files(), ["F.csv", "a.ply"]);
    place.run("export room.solution").failed(2, &["--output"]);
    place.run("export room.solution --flux F.csv --quadratic").failed(2, &["--output"]);
    place.run("export room.solution --flux room.solution").failed(2, &["room.solution is read by this command"]);
}

#[test]
fn a_page_is_written_from_a_solution_and_by_a_solve() {
    let place = Place::new();
    place.run("report room.solution -o page.html").succeeded();
    assert!(place.read("page.html").starts_with("<!DOCTYPE html>"));
    let ran = place.run("solve room.obj --error 0.3 --html solved.HTML");
    assert!(ran.code == 0 && ran.stderr.contains("solved.HTML"), "{}", ran.stderr);
    let page = place.read("solved.HTML");
    for words in ["\"title\":\"room.obj\"", "patchlight solve room.obj --set error=0.3", "\"time_s\":{", "\"converged\":true"] {
        assert!(page.contains(words), "'{words}' is not in the page");
    }
    place.run("report room.solution -o page.png").failed(2, &["name the file page.html"]);
    place.run("solve room.obj --html page").failed(2, &["name the file page.html"]);
    place.run("report room.solution -o room.solution").failed(2, &["name the file room.html"]);
}
