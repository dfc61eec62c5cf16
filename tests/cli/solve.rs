//! What `patchlight solve` writes, and how it ends.

use std::fs;

use super::Place;

#[test]
fn solve_without_outputs_prints_the_key_figures_and_leaves_a_page() {
    let place = Place::new();
    let ran = place.run("solve room.obj --error 0.1");
    ran.succeeded();
    assert!(ran.stdout.is_empty());
    for word in ["backend", "claimed", "links", "CPU-s"] {
        assert!(ran.stderr.contains(word), "'{word}' is not in: {}", ran.stderr);
    }
    assert_eq!(place.run("solve room.obj --error 0.1 --progress none").succeeded().stderr, "");
    assert_eq!(place.new_files(), ["out"]);
    assert!(place.read("out/room.html").starts_with("<!DOCTYPE html>"));
}

#[test]
fn solve_writes_all_that_is_asked_for() {
    let place = Place::new();
    let ran = place.run(
        "solve room.obj --error 0.1 --threads 1 -o s.solution --image a.png --size 16x12 --points P.csv --values V.csv --report r.json",
    );
    ran.succeeded();
    assert!(ran.stdout.is_empty());
    assert_eq!(place.new_files(), ["V.csv", "a.png", "r.json", "s.solution"]);
    assert_eq!(place.read("V.csv").lines().count(), 3);

    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    let keys = [
        "schema",
        "software",
        "scene",
        "options",
        "threads",
        "backend",
        "time_s",
        "cpu_s",
        "counts",
        "memory",
        "error",
        "energy",
        "skipped",
        "converged",
        "stopped_by",
        "warnings",
    ];
    keys.iter().for_each(|key| assert!(!report[key].is_null(), "{key} is not in {report}"));
    for stage in
        ["load", "build", "refine", "visibility", "form_factor", "gather", "push_pull", "error", "sample", "output", "total"]
    {
        assert!(report["time_s"][stage].is_f64(), "{stage}: {report}");
    }
    assert_eq!((&report["schema"], &report["options"]["error"]), (&2.into(), &0.1.into()));
    assert_eq!(report["options"]["expected_values"], 2, "the points are counted");
    assert_eq!((&report["scene"]["surfaces"], &report["scene"]["channels"]), (&7.into(), &3.into()));
    assert_eq!(report["threads"], 1);

    // What was stored gives the same values and the same picture.
    place.run("sample s.solution P.csv -o V2.csv").succeeded();
    assert_eq!(place.read("V2.csv"), place.read("V.csv"));
    place.run("render s.solution -o b.png --size 16x12").succeeded();
    assert!(fs::read(place.path("a.png")).unwrap() == fs::read(place.path("b.png")).unwrap());
}

#[test]
fn guaranteed_bounds_stand_beside_the_values_in_the_report_and_in_a_picture() {
    let place = Place::new();
    let ran = place.run(
        "solve room.obj --error 0.1 --bounds guaranteed -o s.solution --points P.csv --values V.csv --report r.json \
         --image w.exr --quantity width --size 16x12",
    );
    ran.succeeded();
    let text = place.read("V.csv");
    let mut lines = text.lines();
    let header = "x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,lower_r,lower_g,lower_b,upper_r,upper_g,upper_b,face";
    assert_eq!(lines.next(), Some(header));
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        for channel in 6..9 {
            assert!(0.0 < row[channel + 6] && row[channel + 6] <= row[channel] && row[channel] <= row[channel + 9], "{line}");
        }
    }
    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    assert_eq!(report["bounds"]["certainty"], "guaranteed");
    assert_eq!(report["error"]["bound"], report["bounds"]["relative_error"]);
    assert_eq!(report["bounds"]["channels"].as_array().unwrap().len(), 3);

    // A stored solution has the same bounds; one that was solved without has none to show.
    place.run("sample s.solution P.csv -o V2.csv").succeeded();
    assert_eq!(place.read("V2.csv"), text);
    place.run("render s.solution -o w2.exr --quantity width --size 16x12").succeeded();
    assert!(fs::read(place.path("w.exr")).unwrap() == fs::read(place.path("w2.exr")).unwrap());
    place.run("render room.solution -o w3.exr --quantity width").failed(2, &["no bounds", "--bounds guaranteed"]);
}

#[test]
fn values_and_reports_may_go_to_stdout() {
    let place = Place::new();
    let values = place.run("solve room.obj --error 0.1 --points P.csv --values -");
    assert!(values.succeeded().stdout.starts_with("x,y,z,nx,ny,nz,B_r,B_g,B_b,se_r,se_g,se_b,face\n"));
    let faces: Vec<&str> = values.stdout.lines().skip(1).filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(faces, ["1", "5"]);
    let report = place.run("solve room.obj --error 0.1 --report -");
    assert!(serde_json::from_str::<serde_json::Value>(&report.succeeded().stdout).is_ok());
}

/// With one link allowed no such error is reached over links.
#[test]
fn a_limit_ends_with_4_and_results_are_written() {
    let place = Place::new();
    let ran = place.run("solve room.obj --error 0.001 --max-links 1 --set solver=links -o s.solution --report r.json");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert_eq!(place.new_files(), ["r.json", "s.solution"]);
    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    assert_eq!((&report["converged"], &report["stopped_by"]), (&false.into(), &"max_links".into()));
}

#[test]
fn the_memory_budget_ends_with_5_and_results_are_written() {
    let place = Place::new();
    let ran = place.run("solve room.obj --error 0.001 --memory 0.03 -o s.solution --image s.png --size 16x12 --report r.json");
    assert_eq!(ran.code, 5, "{}", ran.stderr);
    assert_eq!(place.new_files(), ["r.json", "s.png", "s.solution"]);
    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    assert_eq!((&report["converged"], &report["stopped_by"]), (&false.into(), &"memory".into()));
    assert_eq!(place.run("info s.solution").code, 0);
}

#[test]
fn a_memory_budget_that_is_too_small_to_begin_is_told_before() {
    let place = Place::new();
    let ran = place.run("solve room.obj --memory 0.001 -o s.solution");
    assert_eq!(ran.code, 5, "{}", ran.stderr);
    assert!(ran.stderr.contains("--memory") && ran.stderr.contains("0.001 GB"), "{}", ran.stderr);
    assert!(place.new_files().is_empty());
}

/// The address space is what a test can limit.
#[cfg(target_os = "linux")]
#[test]
fn a_run_that_takes_too_much_ends_with_5_and_writes_nothing() {
    let place = Place::new();
    let solve = "solve room.obj --threads 1 --set solver=links --error 0.0005 -o s.solution";
    let limited = format!("ulimit -v 600000; exec {} {solve}", env!("CARGO_BIN_EXE_patchlight"));
    let ran = place.run_in_shell(&limited);
    assert_eq!(ran.code, 5, "{}", ran.stderr);
    assert!(ran.stderr.contains("out of memory: the program takes") && ran.stderr.contains("--memory"), "{}", ran.stderr);
    assert!(place.new_files().is_empty());
}

/// Embree has no room for its device.
#[cfg(target_os = "linux")]
#[test]
fn a_backend_without_memory_is_told_as_such() {
    if !patchlight::visibility::Backend::Embree.is_built() {
        return;
    }
    let place = Place::new();
    let solve = "solve room.obj --threads 1 --error 0.5 -o s.solution";
    let ran = place.run_in_shell(&format!("ulimit -v 300000; exec {} {solve}", env!("CARGO_BIN_EXE_patchlight")));
    assert_eq!(ran.code, 5, "{}", ran.stderr);
    assert!(ran.stderr.contains("out of memory"), "{}", ran.stderr);
    assert!(place.new_files().is_empty());
}

/// For so small an error the solver takes long.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_what_there_is_is_written() {
    let place = Place::new();
    let (code, said) = place.run_until_signal("solve room.obj --error 0.000001 -o s.solution --report r.json", "INT");
    assert_eq!(code, Some(130), "{said}");
    assert_eq!(place.new_files(), ["r.json", "s.solution"]);
    assert_eq!(place.run("info s.solution").code, 0);
}
