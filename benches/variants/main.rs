//! Many variants of one scene over its stored transport, beside solves from scratch: CPU time, and whether claims hold.
//!
//! `cargo bench --bench variants` prints a table as Markdown, in some minutes. The furnished room: powers of its four lights between 0 and twice as much,
//! reflectances of five materials anywhere between 0.1 and 0.85 in each channel, and one of two curtains. `-- --variants 1000` is how many,
//! `--asked 0.05` the error asked for, `--stored 0.0125` for what the stored transport is solved, `--checked 12` how many of the variants are held against
//! a path tracer, at `--points 2000` points with twice `--paths 2048` paths, and `--scratch 12` how many of them are solved from scratch. What is
//! claimed worse than was asked for is solved from scratch as well, and counted.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

#[path = "../support/cpu.rs"]
mod cpu;
#[path = "../support/path_tracer.rs"]
mod path_tracer;
#[path = "../support/points.rs"]
mod points;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::Path;

use patchlight::pipeline::{self, Evaluator, Workers, with_materials_on};
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Material, Scene, SurfaceId, SurfacePoint};
use patchlight::solve::{RunOptions, Solution, SolveOptions, SolveReport};
use patchlight::visibility::Backend;

use cpu::cpu_seconds;
use path_tracer::PathTracer;
use points::{LeftOut, spread};
use triangles::Random;

/// Materials whose reflectance changes.
const PAINTED: [&str; 5] = ["wall", "ceiling", "floor", "sofa", "rug"];

/// The other curtain.
const DARK_CURTAIN: [f64; 3] = [0.12, 0.16, 0.3];

/// What is asked for on the command line.
struct Request {
    variants: usize,
    asked: f64,
    stored: Vec<f64>,
    checked: usize,
    scratch: usize,
    points: usize,
    paths: u32,
}

impl Request {
    fn read() -> Self {
        let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
        let stored = vec![0.0125];
        let mut all = Self { variants: 1000, asked: 0.05, stored, checked: 12, scratch: 12, points: 2000, paths: 2048 };
        while let Some(argument) = arguments.next() {
            let value = arguments.next().expect("a flag has a value");
            let number = || value.parse().expect("a number");
            match argument.as_str() {
                "--variants" => all.variants = number(),
                "--asked" => all.asked = value.parse().expect("an error"),
                "--stored" => all.stored = value.split(',').map(|error| error.parse().expect("an error")).collect(),
                "--checked" => all.checked = number(),
                "--scratch" => all.scratch = number(),
                "--points" => all.points = number(),
                "--paths" => all.paths = value.parse().expect("a number"),
                _ => panic!("there is no flag {argument}"),
            }
        }
        all
    }
}

fn main() {
    let request = &Request::read();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room.obj");
    let scene = read_scene(&file, &ImportOptions::default()).expect("a scene").scene;
    let variants: Vec<Vec<Material>> = (0..request.variants).map(|number| variant(&scene, number as u64)).collect();

    // From scratch.
    let scratch = SolveOptions { error: request.asked, ..SolveOptions::default() };
    let (mut of_scratch, mut offs) = (0.0, Vec::new());
    for (materials, number) in variants.iter().zip(0..).take(request.scratch) {
        let before = cpu_seconds();
        let (evaluator, report) = solved(scene.with_materials(materials.clone()).expect("materials"), &scratch);
        of_scratch += (cpu_seconds() - before) / request.scratch as f64;
        offs.push([off(request, number, evaluator.solution().clone()), report.error.estimate]);
    }
    println!(
        "From scratch to {}%: {of_scratch:.3} CPU-s each, mean of {}; {}.\n",
        100.0 * request.asked,
        request.scratch,
        in_words(&mut offs)
    );

    println!(
        "| stored for | solve and keep, CPU-s | MB | variant, CPU-ms | claimed, median | within {}% | all {} with those from scratch, CPU-s | \
         all from scratch | times less | checked |",
        100.0 * request.asked,
        request.variants
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for &error in &request.stored {
        row(request, &scene, &variants, (error, of_scratch));
    }
}

/// Solves all variants over the transport of a solve to `error`, and prints a row.
fn row(request: &Request, scene: &Scene, variants: &[Vec<Material>], (error, of_scratch): (f64, f64)) {
    let before = cpu_seconds();
    let (evaluator, report) = solved(scene.clone(), &SolveOptions { error, keep_transport: true, ..SolveOptions::default() });
    let of_stored = cpu_seconds() - before;
    let transport = report.transport.expect("it is kept");

    // All of them; those to be checked are kept.
    let workers = Workers::new(1).expect("a thread");
    let (mut claims, mut kept) = (Vec::new(), Vec::new());
    let before = cpu_seconds();
    for materials in variants {
        let found = with_materials_on(&workers, evaluator.solution(), materials.clone(), &Silent);
        let found = found.expect("materials").expect("not cancelled");
        claims.push(found.1.estimate);
        if kept.len() < request.checked {
            kept.push(found);
        }
    }
    let of_variants = cpu_seconds() - before;

    // What is asked for and not reached is solved from scratch.
    let missed: Vec<&Vec<Material>> =
        variants.iter().zip(&claims).filter(|(_, claim)| **claim > request.asked).map(|(of, _)| of).collect();
    let all = of_stored + of_variants + missed.len() as f64 * of_scratch;
    let from_scratch = variants.len() as f64 * of_scratch;

    // How far values are off.
    let mut offs: Vec<[f64; 2]> =
        kept.into_iter().zip(0..).map(|((solution, error), number)| [off(request, number, solution), error.estimate]).collect();
    claims.sort_by(f64::total_cmp);
    println!(
        "| {}% | {of_stored:.2} | {:.1} | {:.2} | {:.2}% | {} of {} | {all:.1} | {from_scratch:.1} | {:.1} | {} |",
        100.0 * error,
        transport.bytes as f64 * 1e-6,
        1e3 * of_variants / variants.len() as f64,
        100.0 * claims[claims.len() / 2],
        variants.len() - missed.len(),
        variants.len(),
        from_scratch / all,
        in_words(&mut offs),
    );
}

/// What was found of values that are so far off, and claim so much.
fn in_words(offs: &mut [[f64; 2]]) -> String {
    let worse = offs.iter().filter(|[off, claim]| off > claim).count();
    let mut middle = |which: usize| {
        offs.sort_by(|a, b| a[which].total_cmp(&b[which]));
        100.0 * offs.get(offs.len() / 2).map_or(f64::NAN, |of| of[which])
    };
    let (off, claim) = (middle(0), middle(1));
    format!("{} checked: off {off:.2}%, claimed {claim:.2}% (medians), {worse} off more than claimed", offs.len())
}

fn solved(scene: Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    pipeline::solve(scene, options, &RunOptions { threads: 1, ..RunOptions::default() }, &Silent).expect("a solution")
}

/// The materials of a variant.
fn variant(scene: &Scene, number: u64) -> Vec<Material> {
    let mut random = Random(1 + number);
    let mut materials = scene.materials().to_vec();
    for material in &mut materials {
        let factor = random.between(0.0, 2.0);
        material.exitance.iter_mut().for_each(|e| *e *= factor);
        if PAINTED.contains(&material.name.as_str()) {
            material.reflectance.iter_mut().for_each(|rho| *rho = random.between(0.1, 0.85));
        }
        if material.name == "curtain" && random.unit() < 0.5 {
            material.reflectance = DARK_CURTAIN.to_vec();
        }
    }
    materials
}

/// How far values are off in the local norm, by two independent estimates of the truth, whose noise leaves no bias. What that is relative to is told by
/// the values: by the truths, whose noise it would share, it would be too much where these are dim by chance. Points and paths are others for each variant.
fn off(request: &Request, number: u64, solution: Solution) -> f64 {
    let scene = solution.scene().clone();
    let reflects = |material: &Material| material.reflectance.iter().any(|&rho| rho > 0.0);
    let places = spread(&scene, reflects, LeftOut::AllBacks, request.points, 5 + number);
    let points: Vec<SurfacePoint> = places.iter().map(|(_, point)| *point).collect();
    let evaluator = Evaluator::new(solution, &RunOptions::default()).expect("a backend");
    let values = evaluator.values_at(&points, &Silent).expect("not cancelled").radiosity;

    let tracer = PathTracer::new(&scene, None, Backend::default());
    let mut squares = Vec::new();
    for ((surface, point), value) in places.iter().zip(values.chunks(3)) {
        let exitance = &scene.material_of(SurfaceId(surface.0)).exitance;
        let truths = [2 * number, 2 * number + 1].map(|seed| tracer.batch(*surface, point.position, request.paths, seed).radiosity);
        let (mut light_sq, mut product) = (0.0, 0.0);
        for channel in 0..3 {
            let [first, second] = truths.map(|truth| truth[channel]);
            let value = f64::from(value[channel]);
            light_sq += (value - exitance[channel]).powi(2);
            product += (value - first) * (value - second);
        }
        squares.push([light_sq, product]);
    }
    let mut lit: Vec<f64> = squares.iter().map(|[light_sq, _]| *light_sq).filter(|light_sq| *light_sq > 0.0).collect();
    lit.sort_by(f64::total_cmp);
    let typical = lit[lit.len() / 2];
    let sum: f64 = squares.iter().map(|[light_sq, product]| product / light_sq.max(typical)).sum();
    (sum / lit.len() as f64).max(0.0).sqrt()
}
