//! What the page of a run tells beside the light: how the error fell, where the faces are that warnings are about, and measuring planes; under real clicks
//! in Chromium, skipped aloud where there is none.
#![allow(clippy::print_stdout, reason = "a test tells what it skips")]

#[path = "support/browser.rs"]
#[allow(dead_code, reason = "other tests drag and press keys")]
mod browser;
#[path = "support/page_text.rs"]
mod page_text;

use std::fs;
use std::path::Path;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use browser::Browser;
use page_text::{array_of, text_of};
use patchlight::geometry::Polygon;
use patchlight::inspect::DEFAULT_POINTS;
use patchlight::output::{MeasuredPlane, Page, Provenance, RunReport, SceneReport, write_page};
use patchlight::picture::PlaneRequest;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Light, LightShape, Material, Scene, Sides, Sky, SkyLight};
use patchlight::solve::{JudgedPart, RunOptions, SolveOptions, SolveReport};
use serde_json::Value;

/// A closed room of 2 m with a lamp; its face number 8 is a quadrilateral that lies in no plane, and number 9 none at all.
const ROOM: &str = "\
mtllib room.mtl
v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2
v 0.7 1.99 0.7\nv 1.3 1.99 0.7\nv 1.3 1.99 1.3\nv 0.7 1.99 1.3
v 0.4 0.4 0.4\nv 0.4 0.4 0.9\nv 0.9 0.6 0.9\nv 0.9 0.4 0.4
usemtl wall
o shell
g walls
f 1 5 6 2\nf 4 3 7 8\nf 1 2 3 4\nf 5 8 7 6\nf 1 4 8 5\nf 2 6 7 3
usemtl lamp
f 9 10 11 12
usemtl wall
f 13 14 15 16
f 1 2 1
";

const MATERIALS: &str = "newmtl wall\nKd 0.6 0.5 0.4\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n";

/// A page of a run in a folder, with what the solve told and a measuring plane.
fn write_to(folder: &Path) -> (String, SolveReport, MeasuredPlane) {
    fs::write(folder.join("room.obj"), ROOM).unwrap();
    fs::write(folder.join("room.mtl"), MATERIALS).unwrap();
    let imported = read_scene(&folder.join("room.obj"), &ImportOptions::default()).unwrap();
    let of_scene = SceneReport::of(&imported.scene, "room.obj".into());
    let options = SolveOptions { error: 0.1, lit_mesh: true, ..SolveOptions::default() };
    let (evaluator, solved) = pipeline::solve(imported.scene, &options, &RunOptions::default(), &Silent).unwrap();
    let mut report = RunReport::of_solve("test", of_scene, &options, &solved);
    (report.warnings, report.warned_faces) = (imported.diagnostics.warnings(), imported.diagnostics.warned_faces());
    // What is held back, is told where it is known.
    report.energy.held_back = 0.25;
    assert_eq!(report.warned_faces, [None, Some(8)], "{:?}", report.warnings);

    let name = "height=0.75 spacing=0.25".to_owned();
    let (plane, is_inside) = evaluator.measuring_plane(&name.parse::<PlaneRequest>().unwrap()).unwrap();
    assert!(is_inside.iter().all(|is_inside| *is_inside));
    let irradiances = evaluator.irradiances_at(&plane.sensors(), &Silent);
    let planes = [MeasuredPlane { name, plane, irradiances }];

    let (camera, mut written) = (evaluator.default_camera(960, 720), Vec::new());
    let (solution, report) = (evaluator.solution(), Some(&report));
    let curves = evaluator.curves(1e-3, &Silent).unwrap();
    let met = evaluator.surface_rays(DEFAULT_POINTS);
    let page = Page { title: "room", solution, camera: &camera, report, planes: &planes, curves: &curves, met: &met };
    write_page(&mut written, &page, &Provenance::new(&options)).unwrap();
    fs::write(folder.join("page.html"), &written).unwrap();
    let [plane] = planes;
    (String::from_utf8(written).unwrap(), solved, plane)
}

#[test]
fn a_page_holds_what_the_run_told() {
    let folder = tempfile::tempdir().unwrap();
    let (page, solved, plane) = write_to(folder.path());
    let facts: Value = serde_json::from_str(text_of(&page, "facts-data")).unwrap();

    // The error as it fell: in the order of time, the last one being that of the lit mesh, which is claimed.
    let history = &solved.history;
    assert!(history.len() >= 2 && history.windows(2).all(|pair| pair[0].time_s <= pair[1].time_s && pair[0].rays <= pair[1].rays));
    let (mesh, values) = history.split_last().unwrap();
    assert_eq!((mesh.of, mesh.claimed, mesh.rays_per_point), (JudgedPart::LitMesh, solved.claimed(), None));
    assert_eq!((values.last().unwrap().claimed, values.last().unwrap().measured), (solved.error.estimate, solved.error.measured));
    assert!(values.iter().all(|at| at.of != JudgedPart::LitMesh && at.rays_per_point.is_some_and(|rays| rays > 0)));
    assert_eq!(facts["report"]["history"].as_array().unwrap().len(), history.len());

    // Lines where light is not smooth: six coordinates each, and how many of each degree.
    let numbers = array_of(&page, "curve-ends").len() as u64;
    let counts: Vec<u64> = facts["curves"].as_array().unwrap().iter().map(|degree| degree[0].as_u64().unwrap()).collect();
    assert!(counts.len() == 3 && counts[1] > 0 && numbers == 6 * counts.iter().sum::<u64>(), "{counts:?}");

    // Rays that meet backs: of the slanted face, which hangs free, or of the lamp, 1 cm under the ceiling. Nothing is open.
    let ends: Vec<f32> = array_of(&page, "lost-ray-ends").into_iter().map(f32::from_le_bytes).collect();
    assert_eq!((&facts["lost"]["leave"], &facts["lost"]["kinds"][0][0]), (&0.0.into(), &0.into()));
    assert!(facts["lost"]["meet_backs"].as_f64().unwrap() > 0.005 && ends.len() > 6 * 50);
    let is_back = |end: &[f32]| end.iter().all(|x| (0.4 - 1e-5..0.9 + 1e-5).contains(x)) || (end[1] - 1.99).abs() < 1e-5;
    let wrong: Vec<&[f32]> = ends.chunks(6).filter(|ray| is_back(&ray[..3]) || !is_back(&ray[3..])).collect();
    assert!(wrong.is_empty(), "{wrong:?}");

    // The face, cut into two triangles, has an outline of its four edges.
    let places = facts["places"].as_object().unwrap();
    assert_eq!((places.len(), places["8"]["outline"].as_array().unwrap().len()), (1, 4 * 6));

    // The plane, to the bit, and its summary.
    let shown: Vec<f32> = array_of(&page, "plane-values").into_iter().map(f32::from_le_bytes).collect();
    let lux = |h: &[f32]| 179.0 * (0.2126 * h[0] + 0.7152 * h[1] + 0.0722 * h[2]);
    let expected: Vec<f32> = plane.irradiances.irradiance.chunks(3).map(lux).collect();
    assert_eq!((shown.len(), facts["planes"][0]["counts"].to_string()), (64, "[8,8]".to_owned()));
    assert!(shown.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-5 * b), "{shown:?} {expected:?}");
    let summary = &facts["planes"][0]["summary"];
    let mean = expected.iter().sum::<f32>() / 64.0;
    assert!((summary["mean"].as_f64().unwrap() - f64::from(mean)).abs() < 1e-4 * f64::from(mean));
    let command = facts["command"].as_str().unwrap();
    assert!(command.ends_with("--html page.html --plane 'height=0.75 spacing=0.25' --curves"), "{command}");
    assert!(summary["daylight_factor"].is_null() && facts["planes"][0]["outdoors"].is_null(), "there is no sky");
}

/// Over open ground arrives what the sky sends, and a wall hides half of it from a sensor at its foot: factors of 1 and a half.
#[test]
fn open_ground_has_a_daylight_factor_of_one() {
    let square = |corners: &[[f64; 3]]| (Polygon::new(corners).unwrap(), 0, 0);
    let ground = square(&[[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]]);
    let wall = square(&[[-500.0, 0.0, -0.01], [500.0, 0.0, -0.01], [500.0, 900.0, -0.01], [-500.0, 900.0, -0.01]]);
    let black = Material { name: "black".into(), reflectance: vec![0.0; 3], exitance: vec![0.0; 3] };
    let sky = Sky::new([0.0, 1.0, 0.0], SkyLight::Overcast, 0.2).unwrap();
    let light = Light { name: "sky".into(), strength: vec![10.0; 3], shape: LightShape::Sky(sky) };
    for (faces, expected) in [(vec![ground.clone()], 1.0), (vec![ground, wall], 0.5)] {
        let scene = Scene::new(3, vec![black.clone()], faces, Sides::Front).unwrap().with_lights(vec![light.clone()]).unwrap();
        let options = SolveOptions { error: 0.2, ..SolveOptions::default() };
        let (evaluator, _) = pipeline::solve(scene, &options, &RunOptions::default(), &Silent).unwrap();
        let name = "origin=-0.005,0.1,0.005 u=0.01,0,0 v=0,0,-0.01 counts=1x1".to_owned();
        let (plane, _) = evaluator.measuring_plane(&name.parse::<PlaneRequest>().unwrap()).unwrap();
        let irradiances = evaluator.irradiances_at(&plane.sensors(), &Silent);
        let (scene, measured) = (evaluator.solution().scene(), MeasuredPlane { name, plane, irradiances });
        let shown = measured.shown(scene);
        let factor = shown.daylight_factor(shown.summary.unwrap().mean, scene).unwrap();
        assert!((factor - expected).abs() < 0.05, "{factor} for {expected}");
    }
}

/// How many pixels of the picture of a scene have the colour of what a warning is about, and how far their middle is from that of the picture, by its sides.
fn marked(browser: &mut Browser) -> (usize, [f64; 2]) {
    let picture = browser.picture();
    let bytes = STANDARD.decode(picture.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let is_marked = |pixel: &[u8]| pixel[0] > 230 && pixel[1] < 90 && pixel[2] > 180;
    let found = pixels.chunks(info.color_type.samples()).enumerate().filter(|(_, pixel)| is_marked(pixel));
    let places: Vec<[f64; 2]> = found.map(|(at, _)| [at as u32 % info.width, at as u32 / info.width].map(f64::from)).collect();
    let middle = [0, 1].map(|axis| {
        let side = f64::from([info.width, info.height][axis]);
        places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64 / side - 0.5
    });
    (places.len(), middle)
}

#[test]
fn a_page_shows_what_the_run_told() {
    let folder = tempfile::tempdir().unwrap();
    let (_, solved, _) = write_to(folder.path());
    let Some(mut browser) = Browser::open(folder.path(), "page.html") else {
        println!("SKIPPED: there is no Chromium to click in (apt-get install chromium)");
        return;
    };
    let first = browser.picture();
    let facts = browser.value("document.getElementById('facts').textContent").as_str().unwrap().to_owned();
    for words in [
        "Error against time",
        "Measuring plane height=0.75",
        "uniformity, minimum / mean",
        "sensors measured64 of 8 x 8",
        "held back at most0.25 W",
    ] {
        assert!(facts.contains(words), "'{words}' is not in: {facts}");
    }
    assert!(!facts.contains("daylight factor") && !facts.contains("held back unseen"), "{facts}");

    // A point for each time that the error was judged; time goes to the right.
    let places: Vec<f64> = serde_json::from_value(
        browser.value("[...document.querySelectorAll('svg.plot circle.claimed')].map((p) => Number(p.getAttribute('cx')))"),
    )
    .unwrap();
    assert_eq!(places.len(), solved.history.iter().filter(|at| at.claimed.is_finite()).count());
    assert!(places.windows(2).all(|pair| pair[0] <= pair[1]), "{places:?}");

    // Planes and curves are layers that can be taken away.
    for id in ["curves", "planes"] {
        browser.click_on(id);
        assert!(
            browser.picture() != first && browser.value("location.hash.slice(1)").as_str().unwrap().contains(&format!("{id}=0"))
        );
        browser.click_on(id);
        assert!(browser.picture() == first, "{id} are another layer the second time");
    }
    browser.click_on("planes");
    let without = browser.picture();
    browser.click_on("lost");
    assert!(browser.picture() != without && browser.value("location.hash.slice(1)").as_str().unwrap().contains("lost=1"));
    browser.click_on("lost");
    assert!(browser.picture() == without, "lost rays leave something");

    // A warning brings its face before the eye, outlined.
    assert_eq!(marked(&mut browser).0, 0);
    browser.value("document.querySelector('.show-face').click()");
    std::thread::sleep(Duration::from_millis(1500));
    assert!(browser.value("location.hash.slice(1)").as_str().unwrap().contains("face=8"));
    let (count, middle) = marked(&mut browser);
    assert!(count > 200 && middle.iter().all(|off| off.abs() < 0.1), "{count} pixels, {middle:?} off the middle");
    browser.click_on("reset");
    assert!(browser.picture() == without, "something of the face is left");

    // A click tells whose light it is, by the names of the input.
    browser.click([400.0, 400.0]);
    let note = browser.value("document.getElementById('note').textContent").as_str().unwrap().to_owned();
    assert!(note.starts_with("wall, face ") && note.contains(", object shell, group walls, at "), "{note}");
}
