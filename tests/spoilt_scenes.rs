//! Scenes that are spoilt at random, solved by the program as a user would: it ends in time, says so, and writes what can be read.
//!
//! `PATCHLIGHT_SPOILT_SCENE=162` takes that scene alone and leaves it in the system's folder for temporary files.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/spoilt.rs"]
mod spoilt;
#[path = "support/triangles.rs"]
mod triangles;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use patchlight::output::read_solution;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use spoilt::{faces_of, mtl, obj, spoilt, spoilt_materials};
use triangles::Random;

/// What runs longer than this hangs.
const LONGEST: Duration = Duration::from_secs(120);

/// Whoever takes longer than allowed does so this often: others may be at work on the machine.
const TRIES: u32 = 3;

/// All scenes of the repository.
fn scenes() -> Vec<(String, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    let name = |file: &Path| file.file_stem().unwrap().to_string_lossy().into_owned();
    files.iter().map(|file| (name(file), read_scene(file, &ImportOptions::default()).unwrap().scene)).collect()
}

/// Solves scene `number` of a folder within so many seconds, with other options for each; its exit code, and how long it took.
fn solve(folder: &Path, number: usize, time_s: f64) -> (i32, Duration, String) {
    let start = Instant::now();
    let seconds = time_s.to_string();
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.current_dir(folder).args(["solve", "scene.obj", "--time", &seconds, "-o", "s.solution", "--progress", "none"]);
    command.args(["--sides", ["front", "both"][number % 2], "--set", ["solver=auto", "solver=links", "solver=cells"][number % 3]]);
    if number.is_multiple_of(5) {
        command.args(["--bounds", "guaranteed"]);
    }
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > LONGEST {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let took = start.elapsed();
    let output = child.wait_with_output().unwrap();
    (output.status.code().unwrap_or(-1), took, String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Spoils so many scenes and solves each within so many seconds. Gives how long the slowest took.
fn solve_spoilt(count: usize, time_s: f64, allowed: Duration) -> Duration {
    let scenes = scenes();
    let folder = tempfile::tempdir().unwrap();
    let only: Option<usize> = std::env::var("PATCHLIGHT_SPOILT_SCENE").ok().map(|number| number.parse().expect("a number"));
    let (mut random, mut slowest, mut refused) = (Random(5), Duration::ZERO, 0);
    for number in 0..count {
        let (name, scene) = &scenes[random.below(scenes.len())];
        let materials = spoilt_materials(scene.materials(), &mut random);
        std::fs::write(folder.path().join("scene.mtl"), mtl(&materials)).unwrap();
        std::fs::write(folder.path().join("scene.obj"), obj(&spoilt(&faces_of(scene), &mut random), &materials)).unwrap();
        if only.is_some_and(|only| only != number) {
            continue;
        }
        if only.is_some() {
            let kept = std::env::temp_dir().join(format!("spoilt-{number}"));
            std::fs::create_dir_all(&kept).unwrap();
            for file in ["scene.obj", "scene.mtl"] {
                std::fs::copy(folder.path().join(file), kept.join(file)).unwrap();
            }
        }
        let what = format!("scene {number}, from {name}");
        let mut took = Duration::MAX;
        for _ in 0..TRIES {
            let (code, this, said) = solve(folder.path(), number, time_s);
            assert!([0, 3, 4].contains(&code) && !said.contains("panicked"), "{what}: exit {code} after {this:?}: {said}");
            took = took.min(this);
            if code == 3 {
                refused += 1;
            } else {
                let solution = read_solution(&folder.path().join("s.solution")).unwrap_or_else(|error| panic!("{what}: {error}"));
                assert_eq!(solution.validate(), Ok(()), "{what}");
            }
            if took < allowed {
                break;
            }
        }
        if took > slowest {
            println!("{what}: {took:.2?}");
            slowest = took;
        }
    }
    println!("{count} scenes, {refused} of them refused; the slowest took {slowest:.2?}");
    assert!(refused * 20 <= count, "most are still scenes");
    slowest
}

#[test]
fn a_few_spoilt_scenes_are_solved() {
    solve_spoilt(22, 0.1, LONGEST);
}

#[test]
#[ignore = "takes up to an hour"]
fn spoilt_scenes_end_in_time() {
    let allowed = Duration::from_secs(6);
    assert!(solve_spoilt(500, 5.0, allowed) < allowed);
}
