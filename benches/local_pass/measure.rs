//! Global solutions, the methods on each, and how far off they are.

use std::path::Path;

use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{LinkOptions, RunOptions, SolveOptions, SolveReport, Solver};
use patchlight::values::ShadingMethod;

use super::cpu::cpu_seconds;
use super::points::{LeftOut, spread};

/// Points at which radiosities are compared.
const POINTS: usize = 4000;

/// Tolerances of refinement from coarse to fine, each this part of the one before: seven, as in the thesis.
const FIRST_TOLERANCE: f64 = 0.4;
const NEXT_TOLERANCE: f64 = 0.4;
const RUNGS: i32 = 7;

/// A ladder ends with the first rung of so many links.
const MOST_LINKS: u64 = 400_000;

/// What the reference is asked for, over links and over cells.
const REFERENCE_ERROR: f64 = 0.004;
const CHECK_ERROR: f64 = 0.01;

/// Rays of our own method.
const RAYS: [u32; 3] = [16, 64, 256];

/// A way to find the radiosity at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    Method(ShadingMethod),
    Own(u32),
}

impl Way {
    pub fn all() -> impl Iterator<Item = Self> {
        let methods =
            [ShadingMethod::Leaf, ShadingMethod::FormFactors, ShadingMethod::Visibility, ShadingMethod::EmitterVisibility];
        methods.into_iter().map(Self::Method).chain(RAYS.into_iter().map(Self::Own))
    }

    pub fn name(self) -> String {
        match self {
            Self::Method(ShadingMethod::Leaf) => "A".to_owned(),
            Self::Method(ShadingMethod::FormFactors) => "B".to_owned(),
            Self::Method(ShadingMethod::Visibility) => "C".to_owned(),
            Self::Method(ShadingMethod::EmitterVisibility) => "D".to_owned(),
            Self::Own(rays) => format!("own, {rays} rays"),
        }
    }
}

/// Errors as parts of the reflected light: of the mean, of the root mean square, and the largest of the mean.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    pub l1: f64,
    pub rms: f64,
    pub largest: f64,
}

/// A way on a solution.
pub struct Row {
    pub way: Way,
    pub errors: Errors,
    /// Of one point, in millionths of a CPU second.
    pub micros: f64,
}

/// A global solution.
pub struct Rung {
    pub tolerance: f64,
    pub report: SolveReport,
    pub leaves: usize,
    pub cpu_s: f64,
    pub rows: Vec<Row>,
}

/// Solutions of a scene.
pub struct Ladder {
    pub name: &'static str,
    pub surfaces: usize,
    /// What references over links and over cells differ by.
    pub reference: Errors,
    pub rungs: Vec<Rung>,
}

pub fn read(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
    read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene
}

pub fn measure(name: &'static str) -> Ladder {
    let scene = read(name);
    let wanted = |material: &patchlight::scene::Material| !material.emits();
    let points: Vec<SurfacePoint> =
        spread(&scene, wanted, LeftOut::AllBacks, POINTS, 94).into_iter().map(|(_, point)| point).collect();
    let reference = |solver, error| {
        let options = SolveOptions { solver, error, ..SolveOptions::default() };
        values(&solve(&scene, &options).0, &points)
    };
    let (exact, over_cells) = (reference(Solver::Links, REFERENCE_ERROR), reference(Solver::Cells, CHECK_ERROR));

    let mut rungs: Vec<Rung> = Vec::new();
    for step in 0..RUNGS {
        let tolerance = FIRST_TOLERANCE * NEXT_TOLERANCE.powi(step);
        let rung = rung(&scene, tolerance, &points, &exact);
        let is_last = rung.report.counts.links > MOST_LINKS;
        rungs.push(rung);
        if is_last {
            break;
        }
    }
    Ladder { name, surfaces: scene.surfaces().len(), reference: errors(&over_cells, &exact), rungs }
}

/// Radiosities of elements by links alone; values with so many rays.
fn options(tolerance: f64, rays: u32) -> SolveOptions {
    let links = LinkOptions { tolerance: Some(tolerance), leaf_rays: Some(0), ..LinkOptions::default() };
    SolveOptions { solver: Solver::Links, error: 0.9, point_rays: Some(rays), links, ..SolveOptions::default() }
}

fn solve(scene: &Scene, options: &SolveOptions) -> (Evaluator, SolveReport) {
    pipeline::solve(scene.clone(), options, &RunOptions::default(), &Silent).expect("options that are legal")
}

fn values(evaluator: &Evaluator, points: &[SurfacePoint]) -> Vec<f32> {
    evaluator.values_at(points, &Silent).expect("nobody cancels").radiosity
}

fn rung(scene: &Scene, tolerance: f64, points: &[SurfacePoint], exact: &[f32]) -> Rung {
    let start = cpu_seconds();
    let (evaluator, report) = solve(scene, &options(tolerance, 1));
    let cpu_s = cpu_seconds() - start;
    let row = |way: Way| {
        // The same links, with other rays to a point.
        let own = match way {
            Way::Own(rays) => Some(solve(scene, &options(tolerance, rays)).0),
            Way::Method(_) => None,
        };
        let take = |points: &[SurfacePoint]| match (way, &own) {
            (Way::Method(method), _) => evaluator.shade(points, method),
            (Way::Own(_), Some(own)) => values(own, points),
            (Way::Own(_), None) => Vec::new(),
        };

        // What is made once is no part of the cost of a point.
        let start = cpu_seconds();
        take(&points[..1]);
        let once = cpu_seconds() - start;
        let start = cpu_seconds();
        let found = take(points);
        let micros = 1e6 * (cpu_seconds() - start - once).max(0.0) / points.len() as f64;
        Row { way, errors: errors(&found, exact), micros }
    };
    let rows = Way::all().map(row).collect();
    let hierarchy = evaluator.solution().hierarchy();
    let leaves = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).count();
    Rung { tolerance, report, leaves, cpu_s, rows }
}

fn errors(found: &[f32], exact: &[f32]) -> Errors {
    let pairs = || found.iter().zip(exact).map(|(&a, &b)| (f64::from(a) - f64::from(b), f64::from(b)));
    let (mut off, mut off_sq, mut most, mut sum, mut sum_sq) = (0.0, 0.0, 0.0_f64, 0.0, 0.0);
    for (error, value) in pairs() {
        off += error.abs();
        off_sq += error * error;
        most = most.max(error.abs());
        sum += value;
        sum_sq += value * value;
    }
    Errors { l1: off / sum, rms: (off_sq / sum_sq).sqrt(), largest: most * exact.len() as f64 / sum }
}
