//! How far pictures are off, pixel by pixel, and what they take: meshes of the view and values gathered for the picture, beside a path tracer that
//! shares nothing with either.
//!
//! `cargo bench --bench pictures` prints tables as Markdown, in some minutes; `-- SCENE...` are other files, `--errors 0.05,0.02` what is asked for,
//! `--seeds 3` how many seeds, `--pixels 3000` how many pixels are judged, `--size 960x720` of how many, `--gather` gathers as well, `--keep FOLDER`
//! keeps the pixels of the path tracer there for the next time.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
#[path = "../support/path_tracer.rs"]
mod path_tracer;
mod reference;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::{Path, PathBuf};

use patchlight::picture::Image;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};

use cpu::cpu_seconds;
use reference::Reference;

/// What is asked for on the command line.
struct Request {
    scenes: Vec<PathBuf>,
    errors: Vec<f64>,
    seeds: u64,
    pixels: usize,
    size: [u32; 2],
    gather: bool,
    keep: Option<PathBuf>,
}

impl Request {
    fn read() -> Self {
        let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
        let (scenes, errors) = (Vec::new(), vec![0.05, 0.02]);
        let mut all = Self { scenes, errors, seeds: 1, pixels: 2000, size: [960, 720], gather: false, keep: None };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().expect("a flag has a value");
            match argument.as_str() {
                "--errors" => all.errors = value().split(',').map(|error| error.parse().expect("an error")).collect(),
                "--seeds" => all.seeds = value().parse().expect("a number of seeds"),
                "--pixels" => all.pixels = value().parse().expect("a number of pixels"),
                "--size" => {
                    let sides: Vec<u32> = value().split('x').map(|side| side.parse().expect("a size")).collect();
                    all.size = [sides[0], sides[1]];
                }
                "--keep" => all.keep = Some(PathBuf::from(value())),
                "--gather" => all.gather = true,
                scene => all.scenes.push(PathBuf::from(scene)),
            }
        }
        if all.scenes.is_empty() {
            let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
            all.scenes = ["cornell", "room", "full_office"].map(|name| scenes.join(name).with_extension("obj")).into();
        }
        all
    }
}

fn main() {
    let request = Request::read();
    for path in &request.scenes {
        let read = || read_scene(path, &ImportOptions::default()).expect("a scene").scene;
        let scene = read();
        let reference = reference(&request, path, &scene);
        println!("\n{}, {} x {}, {} pixels:\n", path.display(), request.size[0], request.size[1], reference.pixels());
        println!(
            "| asked | seed | solve, CPU-s | claimed of values | picture, CPU-s | elements | claimed of it | off where nothing emits, local | by energy | off everywhere, local | by energy |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|");
        for &error in &request.errors {
            for seed in 0..request.seeds {
                let options = SolveOptions { error, seed, ..SolveOptions::default() };
                let begun = cpu_seconds();
                let (evaluator, report) = pipeline::solve(read(), &options, &RunOptions::default(), &Silent).expect("it solves");
                let solved = cpu_seconds() - begun;
                let first = format!("| {:.1}% | {seed} | {solved:.2} | {:.2}%", 100.0 * error, 100.0 * report.error.estimate);
                let begun = cpu_seconds();
                let (image, told) = of_view(&evaluator, error, request.size);
                row(&first, (cpu_seconds() - begun, &told), &reference, &image);
                if request.gather {
                    let begun = cpu_seconds();
                    let image = gathered(&evaluator, request.size);
                    row(&first, (cpu_seconds() - begun, "gathered | "), &reference, &image);
                }
            }
        }
    }
}

/// The pixels as they were kept, or traced anew.
fn reference(request: &Request, scene_file: &Path, scene: &Scene) -> Reference {
    let ([width, height], count) = (request.size, request.pixels);
    let name = format!("{}_{width}x{height}_{count}.txt", scene_file.file_stem().unwrap_or_default().display());
    let file = request.keep.as_ref().map(|folder| folder.join(name));
    let kept = file.as_ref().and_then(|file| std::fs::read_to_string(file).ok());
    if let Some(text) = kept {
        return Reference::read(&text);
    }
    let reference = Reference::trace(scene, request.size, count);
    if let Some(file) = file {
        std::fs::write(file, reference.written()).expect("the folder can be written");
    }
    reference
}

/// A picture of the mesh of the view, and what is told of that.
fn of_view(evaluator: &Evaluator, error: f64, [width, height]: [u32; 2]) -> (Image, String) {
    let camera = evaluator.default_camera(width, height);
    let mesh = evaluator.view_mesh(&camera, error, &Silent).expect("a camera").expect("not cancelled");
    let image = evaluator.render_mesh(&mesh, &camera, &Silent).expect("a camera").expect("not cancelled");
    (image, format!("{} | {:.2}%", mesh.elements(), 100.0 * mesh.claimed))
}

fn gathered(evaluator: &Evaluator, [width, height]: [u32; 2]) -> Image {
    let camera = evaluator.default_camera(width, height);
    evaluator.render(&camera, &Silent).expect("a camera").expect("not cancelled")
}

fn row(first: &str, (seconds, told): (f64, &str), reference: &Reference, image: &Image) {
    let errors = reference.errors_of(image).map(|[error, doubt]| format!("{:.2}% +- {:.2}", 100.0 * error, 100.0 * doubt));
    println!("{first} | {seconds:.2} | {told} | {} |", errors.join(" | "));
}
