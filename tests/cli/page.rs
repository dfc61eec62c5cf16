//! Pages with measuring planes, and plots of a run.

use std::fs;

use serde_json::Value;

use super::Place;

/// The facts of a page.
fn facts(page: &str) -> Value {
    let start = page.find("id=\"facts-data\">").unwrap() + 16;
    serde_json::from_str(&page[start..start + page[start..].find("</script>").unwrap()]).unwrap()
}

#[test]
fn pages_show_the_planes_that_are_asked_for_and_measure_no_others() {
    let place = Place::new();
    let arguments = ["report", "room.solution", "-o", "two.html", "--plane", "height=1 spacing=0.5", "--plane", "height=0.5"];
    place.run_with(&arguments, "").succeeded();
    let told = facts(&place.read("two.html"));
    assert_eq!(
        (&told["planes"][0]["name"], &told["planes"][0]["counts"]),
        (&"height=1 spacing=0.5".into(), &[4, 4].to_vec().into())
    );
    assert_eq!(told["planes"].as_array().unwrap().len(), 2);
    assert!(told["planes"][1]["summary"]["minimum"].as_f64().unwrap() > 0.0);
    place.run("report room.solution -o none.html").succeeded();
    assert_eq!(facts(&place.read("none.html"))["planes"], Value::Array(Vec::new()));

    // A solve that is asked for nothing else leaves its page with the plane.
    place.run("solve room.obj --error 0.3 --plane height=1").succeeded();
    let told = facts(&place.read("out/room.html"));
    assert_eq!((told["planes"].as_array().unwrap().len(), &told["report"]["warned_faces"]), (1, &Value::Array(Vec::new())));
}

#[test]
fn planes_that_cannot_be_are_refused_before_the_work() {
    let place = Place::new();
    place.run("report room.solution -o a.html --plane height").failed(2, &["has no '='"]);
    place.run("report room.solution -o a.html --plane width=1").failed(2, &["is no key of a plane"]);
    place.run("solve room.obj -o b.solution --plane height=1").failed(2, &["--plane", "--html FILE.html"]);
    place.run("solve room.obj --html a.html --plane height=nan").failed(2, &["needs a number of metres"]);
    fs::write(place.path("flat.obj"), "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 1 2 3 4\n").unwrap();
    let ran = place.run_with(&["solve", "flat.obj", "--html", "a.html", "--plane", "height=1 up=z"], "");
    ran.failed(2, &["span no area"]);
    assert_eq!(place.new_files(), ["flat.obj"]);
}

#[test]
fn plots_are_pictures_of_the_run() {
    let place = Place::new();
    place.run("solve room.obj --error 0.3 --lit-mesh --plots a/plots --report r.json").succeeded();
    let report: Value = serde_json::from_str(&place.read("r.json")).unwrap();
    let history = report["history"].as_array().unwrap();
    assert_eq!((history[0]["rays_per_point"].is_u64(), &history.last().unwrap()["of"]), (true, &"lit_mesh".into()));
    assert!(!place.path("out").exists());
    for name in ["error.png", "time.png", "light.png"] {
        let file = fs::File::open(place.path("a/plots").join(name)).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let dark = bytes.chunks(3).filter(|pixel| pixel.iter().all(|&value| value < 70)).count();
        assert!((info.width, info.color_type) == (960, png::ColorType::Rgb) && dark > 1000, "{name}: {dark} dark pixels");
    }

    // A file is in the way of the folder, or the same file twice.
    fs::write(place.path("taken"), "").unwrap();
    place.run("solve room.obj --plots taken").failed(2, &["cannot make the folder taken"]);
    place.run("solve room.obj --plots a --image a/error.png").failed(2, &["two outputs cannot both be"]);
}

/// Whoever interrupts a solve gets the page, and does not wait for planes and curves.
#[cfg(unix)]
#[test]
fn an_interrupted_solve_leaves_its_page_without_extras() {
    let place = Place::new();
    let (code, said) = place.run_until_signal("solve room.obj --error 0.000001 --html a.html --plane height=1 --curves", "INT");
    assert_eq!((code, place.new_files()), (Some(130), vec!["a.html".to_owned()]), "{said}");
    assert!(said.contains("measuring planes and curves are left out"), "{said}");
    let facts = facts(&place.read("a.html"));
    assert_eq!(facts["planes"], Value::Array(Vec::new()));
    assert!(facts["curves"].as_array().unwrap().iter().all(|degree| degree[0] == 0), "{facts}");
}
