//! Lazy linking and link reduction on five rooms: the tables and figures of Holzschuch, Sillion, Drettakis 1994 for this implementation,
//! beside the paper's.
//!
//! `cargo bench --bench lazy_linking` prints them as Markdown; `-- --plots docs` also draws figures 2, 5, 6, 7 into docs/, and names of rooms leave out the
//! others. All strategies share form factors, visibility and 16 rays a link, on one thread; what differs is which links are made. The
//! parameters below are the same for all rooms.
#![allow(missing_docs, reason = "a program")]
#![allow(clippy::print_stdout, reason = "a program that prints tables")]

mod measure;
mod paper;
mod plot;
#[path = "../../tests/support/rooms.rs"]
mod rooms;
mod tables;
#[path = "../../tests/support/triangles.rs"]
mod triangles;

use std::path::{Path, PathBuf};

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{SolveOptions, Strategy};

use measure::{Run, difference, element_values, point_values, run, run_default};
use paper::{PaperRoom, ROOMS};
use triangles::Random;

/// eps_refine in units of the mean reflected radiosity that a room may be expected to have.
const REFINE_TOLERANCE: f64 = 0.02;
/// MinArea in m^2: the number of the paper's figure 1.
const MIN_AREA: f64 = 0.001;
/// eps_reduce, which the paper does not tell.
const REDUCE_TOLERANCE: f64 = 0.5;
/// The smallest form factor that link culling leaves.
const CULL_FORM_FACTOR: f64 = 1e-3;

/// Points at which elements are compared; at the first of them values are, too.
const POINTS: usize = 4000;
const VALUE_POINTS: usize = 500;

/// All that is measured of a room.
pub struct Measured {
    pub room: &'static PaperRoom,
    pub original: Run,
    pub culling: Run,
    pub lazy: Run,
    pub reduced: Run,
    /// Of the elements of lazy linking, and of lazy linking with reduction, from those of the original.
    pub lazy_difference: f64,
    pub reduced_difference: f64,
    /// The same of link culling.
    pub culling_difference: f64,
    /// Of the values at points, in the same order.
    pub value_differences: [f64; 3],
    pub default: Option<Comparison>,
}

/// The default strategy beside the original.
pub struct Comparison {
    pub cpu_s: f64,
    pub claimed: f64,
    pub rays: u64,
    pub links: u64,
    /// Errors against a finer solution of the default strategy: its claim is the last number.
    pub error: f64,
    pub original_error: f64,
    pub reduced_error: f64,
    pub reference_claim: f64,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut names, mut plots, mut with_default) = (Vec::new(), None, true);
    let mut settings = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--plots" => plots = arguments.next().map(PathBuf::from),
            "--without-default" => with_default = false,
            "--set" => settings.extend(arguments.next()),
            _ => names.push(argument),
        }
    }
    let is_chosen = |room: &&PaperRoom| names.is_empty() || names.iter().any(|name| name == room.file);
    let measured: Vec<Measured> = ROOMS.iter().filter(is_chosen).map(|room| measure(room, with_default, &settings)).collect();
    tables::print(&measured);
    if let Some(folder) = plots {
        plot::draw(&measured, &folder).expect("the folder can be written");
    }
}

fn measure(room: &'static PaperRoom, with_default: bool, settings: &[String]) -> Measured {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{}.obj", room.file));
    let scene = read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene;
    assert_eq!(scene.surfaces().len(), room.polygons, "the paper's number of polygons");
    let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    let mut options = SolveOptions {
        tolerance: Some(REFINE_TOLERANCE),
        min_element: MIN_AREA / area,
        reduce_tolerance: REDUCE_TOLERANCE,
        cull_form_factor: CULL_FORM_FACTOR,
        ..SolveOptions::default()
    };
    for setting in settings {
        let (key, value) = setting.split_once('=').expect("--set key=value");
        options.set(key, value).expect("an option of the solver");
    }
    let of = |strategy: Strategy| run(&scene, &SolveOptions { strategy, ..options.clone() });
    let (original, culling) = (of(Strategy::Original94), of(Strategy::Culling94));
    let (lazy, reduced) = (of(Strategy::Lazy94), of(Strategy::Lazy94Reduction));

    let points = rooms::points_of(&scene, POINTS, &mut Random(94));
    let values = |run: &Run| element_values(run.evaluator.solution(), &points);
    let from_original = |run: &Run| difference(&scene, &points, &values(run), &values(&original));
    let (lazy_difference, reduced_difference) = (from_original(&lazy), from_original(&reduced));
    let culling_difference = from_original(&culling);
    let places = &points[..VALUE_POINTS];
    let original_values = point_values(&original.evaluator, places);
    let value_differences =
        [&lazy, &reduced, &culling].map(|run| difference(&scene, places, &point_values(&run.evaluator, places), &original_values));
    let default = with_default.then(|| compare(&scene, &points, &original, &reduced));
    Measured {
        room,
        original,
        culling,
        lazy,
        reduced,
        lazy_difference,
        reduced_difference,
        culling_difference,
        value_differences,
        default,
    }
}

/// Solves with the default strategy, and measures errors against a finer solution.
fn compare(scene: &Scene, points: &[(patchlight::reconstruct::SurfacePoint, usize)], original: &Run, reduced: &Run) -> Comparison {
    let (reference, fine, _) = run_default(scene, 0.02, 60.0);
    let (default, report, cpu_s) = run_default(scene, 0.05, 60.0);
    let points = &points[..VALUE_POINTS];
    let truth = point_values(&reference, points);
    let error = |values: &[f64]| difference(scene, points, values, &truth);
    Comparison {
        cpu_s,
        claimed: report.error.estimate,
        rays: report.counts.rays,
        links: report.counts.links,
        error: error(&point_values(&default, points)),
        original_error: error(&element_values(original.evaluator.solution(), points)),
        reduced_error: error(&element_values(reduced.evaluator.solution(), points)),
        reference_claim: fine.error.estimate,
    }
}
