//! The lit mesh on the command line: asked for, written, stored, and read again.

use std::fs;

use super::Place;

impl Place {
    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    fn report(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }
}

#[test]
fn what_contradicts_itself_or_is_not_there_is_a_usage_error() {
    let place = Place::new();
    for (arguments, words) in [
        ("solve room.obj --set lit_mesh=perhaps", &["lit_mesh is perhaps", "true or false"][..]),
        ("solve room.obj --mesh m.ply --set lit_mesh=false", &["--set lit_mesh=false and --mesh contradict each other"]),
        ("solve room.obj --mesh m.obj", &["m.obj: unknown extension", ".ply or .glb or .vtp"]),
        ("solve room.obj --image a.png --from mesh", &["--from mesh needs --lit-mesh"]),
        ("solve room.obj --lit-mesh --from mesh", &["need --image"]),
        ("solve room.obj --lit-mesh --bounds guaranteed --image w.exr --quantity width --from mesh", &["leave --from out"]),
        ("render room.solution -o a.png --from mesh", &["no lit mesh", "--lit-mesh"]),
        ("sample room.solution P.csv -o V.csv --from mesh", &["no lit mesh", "--lit-mesh"]),
        ("export room.solution -o a.ply --quadratic", &["no lit mesh", "--lit-mesh"]),
        ("export room.solution -o a.ply --quadratic --elements", &["cannot be used with"]),
        ("solve room.obj -o a.ply --mesh a.ply", &["two outputs cannot both be a.ply"]),
    ] {
        place.run(arguments).failed(2, words);
    }
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}

#[test]
fn a_stored_mesh_gives_the_same_bytes_as_at_once() {
    let place = Place::new();
    let solve = "solve room.obj --error 0.1 --image a.png --image a.exr --size 16x12 --report r.json";
    let ran = place.run(&format!("{solve} --mesh m.ply -o s.solution --threads 1"));
    ran.succeeded();
    for word in ["mesh ", "off the values", "claimed of both together; 10.00% asked for: reached"] {
        assert!(ran.stderr.contains(word), "'{word}' is not in: {}", ran.stderr);
    }

    // The picture shows it, and so does one of the stored solution; unless values are to be gathered.
    place.run("render s.solution -o b.png -o b.exr --size 16x12").succeeded();
    assert!(place.bytes("a.png") == place.bytes("b.png") && place.bytes("a.exr") == place.bytes("b.exr"));
    place.run("render s.solution -o c.exr --size 16x12 --from mesh").succeeded();
    assert!(place.bytes("c.exr") == place.bytes("a.exr"));
    place.run("render s.solution -o g.exr --size 16x12 --from gather").succeeded();
    let has_layer = |name: &str| place.bytes(name).windows(5).any(|text| text == b"se.R\0");
    assert!(has_layer("g.exr") && has_layer("a.exr") && place.bytes("g.exr") != place.bytes("a.exr"));

    // Exported is the mesh, as it was written, or by faces of six vertices; or the elements of the solver.
    place.run("export s.solution -o n.ply").succeeded();
    assert!(place.bytes("n.ply") == place.bytes("m.ply"));
    place.run("export s.solution -o q.ply --quadratic").succeeded();
    place.run("export s.solution -o e.ply --elements").succeeded();
    let header = |name: &str| String::from_utf8_lossy(&place.bytes(name)[..1500]).into_owned();
    let count = |name: &str, what: &str| -> u64 {
        header(name).lines().find_map(|line| line.strip_prefix(&format!("element {what} "))).unwrap().parse().unwrap()
    };
    assert_eq!((4 * count("q.ply", "face"), count("q.ply", "vertex")), (count("n.ply", "face"), count("n.ply", "vertex")));
    let told = &place.report("r.json")["lit_mesh"];
    assert_eq!((told["elements"].as_u64(), told["nodes"].as_u64()), (Some(count("q.ply", "face")), Some(count("q.ply", "vertex"))));
    let face = header("e.ply").split_once("element face").unwrap().1.to_owned();
    assert!(face.contains("property float B_r"), "elements of the solver have one radiosity each: {face}");

    // Threads change nothing.
    place.run(&format!("{solve} --lit-mesh -o t.solution --threads 3")).succeeded();
    assert!(place.bytes("t.solution") == place.bytes("s.solution"));
}

#[test]
fn values_are_gathered_unless_they_are_to_be_of_the_mesh() {
    let place = Place::new();
    place.run("solve room.obj --error 0.1 --lit-mesh -o s.solution --points P.csv --values V.csv").succeeded();
    assert_eq!(place.run("sample s.solution P.csv").succeeded().stdout, place.read("V.csv"));
    assert_eq!(place.run("sample s.solution P.csv --from gather").succeeded().stdout, place.read("V.csv"));
    let of_mesh = place.run("sample s.solution P.csv --from mesh").succeeded().stdout.clone();
    let rows = |text: &str| -> Vec<Vec<f64>> {
        text.lines().skip(1).map(|line| line.split(',').filter_map(|field| field.parse().ok()).collect()).collect()
    };
    for (gathered, of_mesh) in rows(&place.read("V.csv")).iter().zip(&rows(&of_mesh)) {
        // A point, three channels, their standard errors, and the face.
        assert_eq!((gathered.len(), of_mesh.len()), (13, 13), "{of_mesh:?}");
        for channel in 6..9 {
            let spread = of_mesh[channel + 3].hypot(gathered[channel + 3]);
            assert!(
                of_mesh[channel + 3] > 0.0 && (gathered[channel] - of_mesh[channel]).abs() < 5.0 * spread,
                "{gathered:?} {of_mesh:?}"
            );
        }
    }
    assert!(place.run("info s.solution").succeeded().stdout.contains("lit mesh     "));
}

#[test]
fn the_report_tells_of_the_whole() {
    let place = Place::new();
    for norm in ["local", "energy"] {
        place.run(&format!("solve room.obj --error 0.1 --norm {norm} --set lit_mesh=true --report r.json")).succeeded();
        let report = place.report("r.json");
        let number =
            |path: &str| report.pointer(path).and_then(serde_json::Value::as_f64).unwrap_or_else(|| panic!("{path}: {report}"));
        let whole = number("/lit_mesh/whole/estimate");
        assert!((whole - number("/error/estimate").hypot(number("/lit_mesh/off_values/estimate"))).abs() < 1e-12);
        assert!(whole <= 0.1 && number("/time_s/mesh") > 0.0 && number("/error/requested") == 0.1);
        assert_eq!((&report["converged"], &report["stopped_by"]), (&true.into(), &"error".into()));
        assert_eq!(report["options"]["lit_mesh"], true);
    }
    place.run("solve room.obj --error 0.1 --report r.json").succeeded();
    assert!(place.report("r.json")["lit_mesh"].is_null());
}

/// In a tenth of a second nothing of this is found; the seconds of reading may be all that there are.
#[test]
fn a_mesh_that_there_is_no_time_for_ends_with_4_and_all_else_is_written() {
    let place = Place::new();
    let ran =
        place.run("solve room.obj --error 0.0001 --time 0.1 --mesh m.ply -o s.solution --report r.json --image a.png --size 8x6");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    let report = place.report("r.json");
    assert_eq!((&report["converged"], &report["stopped_by"]), (&false.into(), &"time".into()));
    let has_mesh = !report["lit_mesh"].is_null();
    assert_eq!(place.path("m.ply").exists(), has_mesh);
    assert!(has_mesh || ran.stderr.contains("m.ply is not written: there is no mesh"), "{}", ran.stderr);
    let others: Vec<String> = place.new_files().into_iter().filter(|name| name != "m.ply").collect();
    assert_eq!(others, ["a.png", "r.json", "s.solution"]);
    assert_eq!(place.run("info s.solution").code, 0);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_mesh_with_130_and_the_values_are_written() {
    let place = Place::new();
    let solve = "solve room.obj --error 0.01 --lit-mesh -o s.solution --report r.json";
    let (code, said) = place.run_until_signal_at(solve, "\"stage\":\"mesh\"", "INT");
    assert_eq!(code, Some(130), "{said}");
    assert_eq!(place.new_files(), ["r.json", "s.solution"]);
    let report = place.report("r.json");
    assert!(report["lit_mesh"].is_null() && report["error"]["estimate"].as_f64().unwrap() < 0.01, "{report}");
    assert_eq!(place.run("info s.solution").code, 0);
}
