//! The command line: exit codes, messages, and what a failed run leaves behind.

mod bake;
mod batch;
mod commands;
mod hostile;
mod lights;
mod lit_mesh;
#[cfg(feature = "mpi")]
mod mpi;
mod page;
mod pictures;
mod relight;
mod sensors;
mod solve;
#[path = "../support/mod.rs"]
mod support;
mod units;

use std::fs;
use std::io::Write;
#[cfg(unix)]
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use patchlight::output::{Destination, Provenance, write_solution};
use patchlight::solve::SolveOptions;
use tempfile::TempDir;

/// A closed room of 2 m with a lamp, faces inwards.
const ROOM: &str = "\
mtllib room.mtl
v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2
v 0.7 1.99 0.7\nv 1.3 1.99 0.7\nv 1.3 1.99 1.3\nv 0.7 1.99 1.3
usemtl wall
f 1 5 6 2\nf 4 3 7 8\nf 1 2 3 4\nf 5 8 7 6\nf 1 4 8 5\nf 2 6 7 3
usemtl lamp
f 9 10 11 12
";

const MATERIALS: &str = "newmtl wall\nKd 0.6 0.5 0.4\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n";

/// A directory with a scene, a solution and points in it.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        fs::write(place.path("room.obj"), ROOM).unwrap();
        fs::write(place.path("room.mtl"), MATERIALS).unwrap();
        fs::write(place.path("P.csv"), "x,y,z,nx,ny,nz\n1,0,1,0,1,0\n0,1,0.5,1,0,0\n").unwrap();
        let evaluator = support::solved(3);
        let provenance = Provenance::new(evaluator.solution().options());
        let destination = Destination::new(&place.path("room.solution")).unwrap();
        destination.write(|file| write_solution(file, evaluator.solution(), &provenance)).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Runs a line in a shell.
    #[cfg(unix)]
    fn run_in_shell(&self, line: &str) -> Ran {
        Ran::new(Command::new("sh").args(["-c", line]).current_dir(self.0.path()).output().unwrap())
    }

    /// Runs `patchlight` in this directory, with arguments separated by blanks.
    fn run(&self, arguments: &str) -> Ran {
        self.run_with(&arguments.split_whitespace().collect::<Vec<_>>(), "")
    }

    fn run_with(&self, arguments: &[&str], stdin: &str) -> Ran {
        let mut child = Command::new(env!("CARGO_BIN_EXE_patchlight"))
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A program that rejects its arguments does not read.
        let _ = child.stdin.take().unwrap().write_all(stdin.as_bytes());
        Ran::new(child.wait_with_output().unwrap())
    }

    /// Runs `patchlight`, sends it a signal (a name that `kill` knows) once it has reported progress, and gives its exit code and what it
    /// says after that.
    #[cfg(unix)]
    fn run_until_signal(&self, arguments: &str, signal: &str) -> (Option<i32>, String) {
        self.run_until_signal_at(arguments, "\"progress\"", signal)
    }

    /// The same once it has reported something.
    #[cfg(unix)]
    fn run_until_signal_at(&self, arguments: &str, reported: &str, signal: &str) -> (Option<i32>, String) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_patchlight"))
            .args(arguments.split_whitespace())
            .args(["--progress", "json"])
            .current_dir(self.0.path())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains(reported) {
            line.clear();
            assert!(stderr.read_line(&mut line).unwrap() > 0, "the program ended before it reported {reported}");
        }
        // Every shell has a kill of its own; the program of this name may not be installed.
        let kill = format!("kill -{signal} {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
        let mut rest = String::new();
        stderr.read_to_string(&mut rest).unwrap();
        (child.wait().unwrap().code(), rest)
    }

    /// Names of the files, without those that were there from the start.
    fn new_files(&self) -> Vec<String> {
        let known = ["room.obj", "room.mtl", "room.solution", "P.csv"];
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| !known.contains(&name.as_str())).collect();
        names.sort();
        names
    }
}

struct Ran {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Ran {
    fn new(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let ran = Self { code: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) };
        assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
        ran
    }

    /// The run failed with `code`, said all of `words`, and nothing on stdout.
    fn failed(&self, code: i32, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (code, ""), "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "'{word}' is not in: {}", self.stderr);
        }
    }

    /// The run did what was asked for, up to the limits of a solve.
    fn succeeded(&self) -> &Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }
}

#[test]
fn help_goes_to_stdout_and_lists_the_exit_codes() {
    let place = Place::new();
    for arguments in ["--help", "solve --help", "sample --help", "render --help", "export --help", "report --help", "info --help"] {
        let ran = place.run(arguments);
        assert!(ran.succeeded().stdout.contains("130  interrupted") && ran.stderr.is_empty(), "{arguments}: {}", ran.stdout);
    }
    assert_eq!(place.run("--version").succeeded().stdout, format!("patchlight {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn help_lists_all_options_with_range_and_default() {
    let help = Place::new().run("solve --help").succeeded().stdout.clone();
    let (flags, keys) = help.split_once("Options of --set").unwrap();
    for entry in SolveOptions::entries() {
        let of_key =
            keys.split_once(&format!("\n    {}\n", entry.key)).unwrap_or_else(|| panic!("{} is not in {keys}", entry.key)).1;
        let described =
            of_key.lines().take_while(|line| line.starts_with("          ")).map(str::trim).collect::<Vec<_>>().join(" ");
        let default = entry.value(&SolveOptions::default()).map_or(String::new(), |value| format!("[default: {value}]"));
        assert!(described.starts_with(entry.help) && described.ends_with(&default), "{}: {described}", entry.key);
        assert!(described.contains(&format!("[{}]", entry.range())), "{}: {described}", entry.key);
    }
    assert!(flags.contains("[a number above 0 and below 1] [default: 0.02]"), "{flags}");
}

#[test]
fn the_order_of_settings_does_not_matter() {
    let place = Place::new();
    let text = |arguments: &str| {
        let ran = place.run(&format!("solve room.obj --error 0.3 --points P.csv --values - {arguments}"));
        assert!(ran.code == 0 || ran.code == 4, "{arguments}: {}", ran.stderr);
        ran.stdout
    };
    let view = text("--set importance=view --set strategy=error-driven");
    assert!(view.starts_with("x,y,z,"), "{view}");
    assert_eq!(text("--set strategy=error-driven --set importance=view"), view);
    assert_eq!(text("--strategy error-driven --set importance=view"), view);
    assert_eq!(text("--set strategy=error-driven --importance view"), view);

    // The camera of the picture is that of the view, however the view is asked for.
    let elsewhere = text("--strategy error-driven --importance view --camera eye=1,1,1");
    assert!(elsewhere != view, "the camera matters");
    assert_eq!(text("--camera eye=1,1,1 --set importance=view --set strategy=error-driven"), elsewhere);

    // Of two values for a key the last one counts.
    let last = |arguments: &str| {
        let report = place.run(&format!("solve room.obj --error 0.3 {arguments} --report -")).succeeded().stdout.clone();
        serde_json::from_str::<serde_json::Value>(&report).unwrap()["options"]["seed"].clone()
    };
    assert_eq!(last("--set seed=1 --set seed=2"), 2);
    assert_eq!(last("--set threads=1000 --seed 1"), 1);
}

#[test]
fn wrong_usage_ends_with_2_and_says_what_is_wrong() {
    let place = Place::new();
    for (arguments, words) in [
        ("", &["Usage"][..]),
        ("fly room.obj", &["unrecognized subcommand 'fly'"]),
        ("solve", &["<SCENE>"]),
        ("solve room.obj --shadows", &["--shadows"]),
        ("solve room.obj --error 0", &["error is 0", "above 0 and below 1"]),
        ("solve room.obj --error 1.5", &["error is 1.5"]),
        ("solve room.obj --error NaN", &["error is NaN"]),
        ("solve room.obj --error much", &["error is much", "above 0 and below 1"]),
        ("solve room.obj --strategy best", &["strategy is best", "hanrahan91"]),
        ("solve room.obj --backend gpu", &["unknown backend 'gpu'", "brute-force"]),
        ("solve room.obj --sides back", &["sides is 'back'", "front or both"]),
        ("solve room.obj --strategy bottom-up98 --set bottom_samples=9", &["bottom_samples is 9", "1 to 8"]),
        ("solve room.obj --bounds guaranteed --strategy lazy94", &["bounds is guaranteed", "estimate for the strategies of 1994"]),
        ("solve room.obj --importance view", &["importance is view", "unless strategy is error-driven"]),
        ("solve room.obj --strategy error-driven --importance everything", &["importance is everything", "material NAME"]),
        ("solve room.obj --image w.exr --quantity width", &["width", "--bounds guaranteed"]),
        ("solve room.obj --bounds tight", &["bounds is tight"]),
        ("solve room.obj --set gather=links", &["unknown option 'gather'", "solver"]),
        ("solve room.obj --set solver=hemisphere", &["solver is hemisphere", "auto, links or cells"]),
        ("solve room.obj --set positions=255", &["positions is 255", "from 256 to 16777216"]),
        ("solve room.obj --set strategy=lazy94 --bounds guaranteed", &["bounds is guaranteed"]),
        ("solve room.obj --time 0", &["time is '0'", "seconds"]),
        ("solve room.obj --time -1", &["-1"]),
        ("solve room.obj --memory inf", &["memory is 'inf'"]),
        ("solve room.obj --set error", &["--set error", "key=value"]),
        ("solve room.obj --set colour=red", &["unknown option 'colour'"]),
        ("solve room.obj --set threads=many", &["threads is 'many'"]),
        ("solve room.obj --bounds guaranteed --image w.png --image w.exr --quantity width", &["width is for .exr alone"]),
        ("solve room.obj --progress loud", &["loud"]),
        ("solve room.obj --points P.csv", &["--values"]),
        ("solve room.obj --values V.csv", &["--points"]),
        ("solve room.obj --image room.jpg", &["room.jpg: unknown extension", ".exr or .png"]),
        ("solve room.obj --image room", &["unknown extension"]),
        ("solve room.obj --size 100x100", &["need --image"]),
        ("solve room.obj --image a.png --size 100", &["size is '100'", "960x720"]),
        ("solve room.obj --image a.png --size 0x5", &["0x5"]),
        ("solve room.obj --image a.png --size 65536x65536", &["65536x65536"]),
        ("solve room.obj --image a.png --camera eye=1,2", &["'eye=1,2' needs three numbers"]),
        ("solve room.obj --image a.png --camera fov=200", &["fov is 200"]),
        ("solve room.obj --image a.png --camera zoom=2", &["'zoom=2' is no key of a camera"]),
        ("solve room.obj --image a.png --exposure bright", &["exposure is 'bright'"]),
        ("solve room.obj --image a.exr --exposure 2", &["--exposure is for .png"]),
        ("solve room.obj --image a.png --quantity radiosity", &["--quantity is for .exr"]),
        ("solve room.obj --image a.exr --quantity light", &["quantity is 'light'", "radiance, radiosity"]),
        ("render room.solution", &["--output"]),
        ("render room.solution -o a.gif", &["a.gif: unknown extension"]),
        ("export room.solution -o a.obj", &["a.obj: unknown extension", ".ply or .glb or .vtp"]),
        ("export room.solution -o a.glb --quadratic", &["--quadratic is for .ply"]),
        ("info room.obj --sides none", &["sides is 'none'"]),
    ] {
        place.run(arguments).failed(2, words);
    }
    place
        .run_with(&["solve", "room.obj", "--image", "a.png", "--camera", "eye=1,1,1 target=1,1,1"], "")
        .failed(2, &["eye and target are the same point"]);
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}

#[test]
fn a_flag_and_a_setting_for_the_same_key_contradict_each_other() {
    let place = Place::new();
    for (arguments, words) in [
        ("--set error=0.1 --error 0.2", "--set error=0.1 and --error both say what error is: leave one of them out"),
        ("--set threads=1 --threads 2", "--set threads=1 and --threads"),
        ("--set lit_mesh=false --lit-mesh", "--set lit_mesh=false and --lit-mesh"),
        ("--set max_links=1 --max-links 2", "--set max_links=1 and --max-links"),
    ] {
        place.run(&format!("solve room.obj {arguments}")).failed(2, &[words]);
    }
}

#[test]
fn missing_and_broken_inputs_end_with_3_and_are_named() {
    let place = Place::new();
    place.run("solve missing.obj").failed(3, &["missing.obj"]);
    place.run("info missing.obj").failed(3, &["missing.obj"]);
    place.run("render missing.solution -o a.png").failed(3, &["missing.solution"]);
    place.run("export missing.solution -o a.ply").failed(3, &["missing.solution"]);
    place.run("render room.obj -o a.png").failed(3, &["room.obj: this is no solution", "patchlight solve -o"]);
    place.run("sample room.solution missing.csv").failed(3, &["missing.csv"]);
    fs::write(place.path("broken.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n").unwrap();
    place.run("solve broken.obj").failed(3, &["broken.obj:3"]);
    fs::write(place.path("empty.obj"), "# nothing\n").unwrap();
    place.run("solve empty.obj").failed(3, &["empty.obj"]);
    fs::write(place.path("cut.glb"), b"glTF\x02\0\0\0\x40\0\0\0").unwrap();
    place.run("solve cut.glb").failed(3, &["cut.glb: the file is cut off: it should have 64 bytes and has 12"]);
    assert_eq!(place.new_files(), ["broken.obj", "cut.glb", "empty.obj"]);
}

#[test]
fn damaged_solutions_are_found_out_by_every_command() {
    let place = Place::new();
    let mut bytes = fs::read(place.path("room.solution")).unwrap();
    fs::write(place.path("short.solution"), &bytes[..bytes.len() / 2]).unwrap();
    bytes[100] ^= 4;
    fs::write(place.path("flipped.solution"), &bytes).unwrap();
    for (name, words) in [("short.solution", "the file is cut off"), ("flipped.solution", "the file is damaged")] {
        for arguments in [
            format!("sample {name} P.csv"),
            format!("render {name} -o a.png"),
            format!("export {name} -o a.ply"),
            format!("info {name}"),
        ] {
            place.run(&arguments).failed(3, &[name, words, "solve the scene again"]);
        }
    }
    assert_eq!(place.new_files(), ["flipped.solution", "short.solution"]);
}

#[test]
fn bad_points_are_found_before_the_solve_and_name_their_line() {
    let place = Place::new();
    for (name, text, words) in [
        ("header.csv", "1,2,3,0,0,1\n", "header.csv:1: the header is"),
        ("nan.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,nan,0,0,0,1\n", "nan.csv:3: y is 'nan'"),
        ("columns.csv", "x,y,z,nx,ny,nz\n0,0,0\n", "columns.csv:2: 3 fields"),
        ("normal.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,0.5\n", "normal.csv:2: the normal"),
        ("nothing.csv", "", "nothing.csv: the file is empty"),
    ] {
        fs::write(place.path(name), text).unwrap();
        place.run(&format!("sample room.solution {name} -o V.csv")).failed(3, &[words]);
        place.run(&format!("solve room.obj --points {name} --values V.csv")).failed(3, &[words]);
    }
    assert!(!place.path("V.csv").exists());
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_the_work() {
    let place = Place::new();
    fs::create_dir(place.path("folder.png")).unwrap();
    for arguments in [
        "solve room.obj -o nowhere/room.solution",
        "solve room.obj --report nowhere/r.json",
        "solve room.obj --image nowhere/a.png",
        "solve room.obj --mesh nowhere/a.ply",
        "solve room.obj --points P.csv --values nowhere/V.csv",
        "sample room.solution P.csv -o nowhere/V.csv",
        "render room.solution -o nowhere/a.exr",
        "export room.solution -o nowhere/a.ply",
    ] {
        place.run(arguments).failed(2, &["cannot write nowhere/"]);
    }
    place.run("render room.solution -o folder.png").failed(2, &["folder.png: it is a directory"]);
    // Before the work: also before the input is read.
    place.run("solve missing.obj -o nowhere/room.solution").failed(2, &["cannot write"]);
}

#[test]
fn a_file_is_not_read_and_written_or_written_twice() {
    let place = Place::new();
    place.run("solve room.obj -o room.obj").failed(2, &["room.obj is read by this command"]);
    place.run("sample room.solution P.csv -o P.csv").failed(2, &["P.csv is read by this command"]);
    place.run("solve room.obj -o a --report a").failed(2, &["two outputs cannot both be a"]);
    place.run("solve room.obj --points P.csv --values - --report -").failed(2, &["two outputs cannot both go to stdout"]);
    assert_eq!(place.read("room.obj"), ROOM);
    assert!(place.new_files().is_empty());
}
