//! The scenes that are measured, each with where its reference comes from.
#![allow(clippy::print_stderr, reason = "a benchmark tells how far it is")]

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use patchlight::scene::SurfacePoint;

use super::peers::Peers;
use super::points::read_values;
use super::problem::{Problem, spread_over};
use super::run;
use super::triangles::Random;
use super::two_squares::TwoSquares;

/// Points of scenes that have none of their own.
const POINTS: usize = 2000;

/// All scenes that are there, or those with one of the `wanted` words in their names.
pub fn all(root: &Path, folder: &Path, wanted: &[String], peers: Option<&Peers>) -> Vec<Problem> {
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str()));
    let mut problems = vec![two_squares(folder)];
    let shared = root.join("../shared/peers");
    problems.extend(["cornell", "office"].into_iter().filter_map(|name| of_peers(&shared, name)));
    problems.retain(|problem| is_wanted(&problem.name));
    let own_scene = |name: &str| (name.replace('_', " "), root.join(format!("scenes/{name}.obj")));
    let by_others = |name: &str| (format!("{name} (by others)"), root.join(format!("../shared/scenes/{name}/scene.obj")));
    let scenes = ["full_office", "room", "dining_room", "hevea", "two_rooms"].map(own_scene).into_iter();
    for (name, scene) in scenes.chain(["corridor", "oa_czest1dm"].map(by_others)) {
        if is_wanted(&name) && scene.is_file() {
            eprintln!("{name}: looking for its reference");
            problems.push(with_reference(name, scene, folder, peers));
        }
    }
    problems
}

/// Two facing squares with a blocker between them: exact.
fn two_squares(folder: &Path) -> Problem {
    let scene = folder.join("two_squares.obj");
    let text = "mtllib two_squares.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv .25 .25 .5\nv .75 .25 .5\n\
                v .75 .75 .5\nv .25 .75 .5\nusemtl lower\nf 1 2 3 4\nusemtl upper\nf 5 8 7 6\nusemtl black\nf 9 10 11 12\nf 12 11 10 9\n";
    std::fs::write(&scene, text).expect("a scene is written");
    let radiance = 1.0 / PI;
    let materials = format!(
        "newmtl lower\nKd .5 .5 .5\nKe {radiance} {radiance} {radiance}\nnewmtl upper\nKd .7 .7 .7\nnewmtl black\nKd 0 0 0\n"
    );
    std::fs::write(folder.join("two_squares.mtl"), materials).expect("materials are written");

    let exact = TwoSquares::new(true);
    let mut random = Random(3);
    let (mut points, mut reference, mut exitance) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..POINTS {
        let (square, [x, y]) = (k % 2, [random.unit(), random.unit()]);
        points.push(SurfacePoint { position: [x, y, square as f64], normal: [0.0, 0.0, 1.0 - 2.0 * square as f64] });
        reference.push([exact.at(square, [x, y]); 3]);
        exitance.push([1.0 - square as f64; 3]);
    }
    let (name, reference_is) = ("two squares".to_owned(), "exact".to_owned());
    Problem { name, scene, points, reference, exitance, noise: 0.0, reference_is, bakes: false, both_solvers: true }
}

/// A scene that peers were measured on, if it is there.
fn of_peers(folder: &Path, name: &str) -> Option<Problem> {
    let numbers = |file: PathBuf| -> Option<Vec<Vec<f64>>> {
        let text = std::fs::read_to_string(file).ok()?;
        Some(text.lines().filter_map(|line| line.split([' ', ',']).map(|number| number.parse().ok()).collect()).collect())
    };
    let points = numbers(folder.join(format!("scenes/{name}.pts")))?;
    let rows = numbers(folder.join(format!("refs/{name}_ref.csv")))?;
    let sum_sq =
        |columns: std::ops::Range<usize>| -> f64 { rows.iter().flat_map(|row| &row[columns.clone()]).map(|x| x * x).sum() };
    Some(Problem {
        name: format!("{name} of the peers"),
        scene: folder.join(format!("scenes/{name}.obj")),
        points: points
            .iter()
            .map(|row| SurfacePoint { position: [row[0], row[1], row[2]], normal: [row[3], row[4], row[5]] })
            .collect(),
        reference: rows.iter().map(|row| [row[0], row[1], row[2]]).collect(),
        exitance: vec![[0.0; 3]; rows.len()],
        noise: (sum_sq(3..6) / sum_sq(0..3)).sqrt(),
        reference_is: "path tracing, converged".to_owned(),
        bakes: name == "office",
        both_solvers: true,
    })
}

/// A scene with a reference by a path tracer where one is installed.
fn with_reference(name: String, scene: PathBuf, folder: &Path, peers: Option<&Peers>) -> Problem {
    let points = spread_over(&scene, POINTS, 5);
    let exitance = vec![[0.0; 3]; points.len()];
    let (reference, reference_is) = (Vec::new(), String::new());
    let both_solvers = name == "full office";
    let mut problem = Problem { name, scene, points, reference, exitance, noise: 0.0, reference_is, bakes: false, both_solvers };
    (problem.reference, problem.noise, problem.reference_is) = match peers {
        Some(peers) => peers.reference(&problem, folder),
        None => own_reference(&problem, folder),
    };
    problem
}

/// Light paths of our own, four times as accurate as anything that is scored, with another seed.
fn own_reference(problem: &Problem, folder: &Path) -> (Vec<[f64; 3]>, f64, String) {
    let (values, report) = (folder.join("reference.csv"), folder.join("reference.json"));
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.arg("solve").arg(&problem.scene).args(["--error", "0.0025", "--seed", "977", "--set", "solver=cells", "--time", "60"]);
    command.arg("--points").arg(problem.points_file(folder)).arg("--values").arg(&values).arg("--report").arg(&report);
    run::timed_well(&mut command);
    let text = std::fs::read_to_string(report).expect("the program wrote a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("a report is JSON");
    let claimed = report["error"]["estimate"].as_f64().expect("a claim");
    let reference_is = format!("light paths of our own, claimed {:.2}%", 100.0 * claimed);
    (read_values(&values), claimed, reference_is)
}
