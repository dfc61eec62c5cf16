//! Runs a strategy on a room, with CPU time by iteration, and compares solutions at points.

use std::sync::Mutex;

use patchlight::hierarchy::NodeId;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::{Observer, Progress, Silent, Stage};
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{IterationReport, RunOptions, Solution, SolveOptions, SolveReport, Strategy};

use super::cpu::cpu_seconds;
use super::rooms;
use super::triangles::Random;

/// A run with what it took.
pub struct Run {
    pub evaluator: Evaluator,
    pub report: SolveReport,
    /// CPU seconds up to the end of each iteration.
    pub cpu_s: Vec<f64>,
}

/// What a run was like by iteration, without its solution.
pub struct Course {
    pub bounces: Vec<IterationReport>,
    pub cpu_s: Vec<f64>,
}

impl From<Run> for Course {
    fn from(run: Run) -> Self {
        Self { bounces: run.report.bounces, cpu_s: run.cpu_s }
    }
}

/// Notes the CPU time when iterations start, and when the last has ended.
struct Stopwatch(Mutex<Vec<f64>>);

impl Observer for Stopwatch {
    fn progress(&self, progress: &Progress) {
        let Ok(mut starts) = self.0.lock() else { return };
        let is_next = match progress.stage {
            Stage::Refine => progress.round as usize == starts.len() + 1,
            Stage::Error => true,
            _ => false,
        };
        if is_next {
            starts.push(cpu_seconds());
        }
    }
}

/// Points at which elements are compared; at the first of them values are, too.
const POINTS: usize = 4000;
const VALUE_POINTS: usize = 500;

/// Where solutions of a scene are compared, uniform by area.
pub struct Points(Vec<(SurfacePoint, usize)>);

impl Points {
    pub fn of(scene: &Scene) -> Self {
        Self(rooms::points_of(scene, POINTS, &mut Random(94)))
    }

    fn for_values(&self) -> &[(SurfacePoint, usize)] {
        &self.0[..VALUE_POINTS]
    }

    /// The values that a user gets, at some of the points.
    pub fn values(&self, run: &Run) -> Vec<f64> {
        self.values_of(&run.evaluator)
    }

    pub fn values_of(&self, evaluator: &Evaluator) -> Vec<f64> {
        point_values(evaluator, self.for_values())
    }

    /// The radiosities of the elements that all points lie on.
    pub fn elements(&self, run: &Run) -> Vec<f64> {
        element_values(run.evaluator.solution(), &self.0)
    }

    /// `||a - b|| / ||b - E||` of [`Points::values`], channels pooled.
    pub fn difference_of_values(&self, scene: &Scene, a: &[f64], b: &[f64]) -> f64 {
        difference(scene, self.for_values(), a, b)
    }

    /// The same of [`Points::elements`]; of the first of them, where `b` has no more.
    pub fn difference_of_elements(&self, scene: &Scene, a: &[f64], b: &[f64]) -> f64 {
        difference(scene, &self.0, a, b)
    }
}

/// Rays to a point at which values are compared: so many that their noise is well below a percent.
const POINT_RAYS: u32 = 2048;

/// Solves on one thread.
pub fn run(scene: &Scene, options: &SolveOptions) -> Run {
    let stopwatch = Stopwatch(Mutex::new(Vec::new()));
    let options = SolveOptions { error: 0.9, point_rays: Some(POINT_RAYS), ..options.clone() };
    let (evaluator, report) = pipeline::solve(scene.clone(), &options, &one_thread(), &stopwatch).expect("options that are legal");
    evaluator.solution().validate().expect("a solution that is well formed");
    let starts = stopwatch.0.into_inner().expect("nothing panics");
    let count = report.bounces.len();
    assert_eq!(count, options.holzschuch94.iterations as usize, "a limit has ended the run");
    let cpu_s = starts[1..=count].iter().map(|end| end - starts[0]).collect();
    Run { evaluator, report, cpu_s }
}

pub fn one_thread() -> RunOptions {
    RunOptions { threads: 1, ..RunOptions::default() }
}

/// Solves with the default strategy to `error`; CPU seconds of the solve beside.
pub fn run_default(scene: &Scene, error: f64, time_s: f64) -> (Evaluator, SolveReport, f64) {
    let options = SolveOptions { error, strategy: Strategy::Default, ..SolveOptions::default() };
    let start = cpu_seconds();
    let run = RunOptions { time_s: Some(time_s), ..one_thread() };
    let (evaluator, report) = pipeline::solve(scene.clone(), &options, &run, &Silent).expect("options that are legal");
    (evaluator, report, cpu_seconds() - start)
}

/// The radiosities of the elements that `points` lie on, channels in a row.
fn element_values(solution: &Solution, points: &[(SurfacePoint, usize)]) -> Vec<f64> {
    points
        .iter()
        .flat_map(|(point, surface)| solution.radiosity().of(leaf_at(solution, *surface, point.position)))
        .copied()
        .collect()
}

/// The values at points that a user gets.
fn point_values(evaluator: &Evaluator, points: &[(SurfacePoint, usize)]) -> Vec<f64> {
    let places: Vec<SurfacePoint> = points.iter().map(|(point, _)| *point).collect();
    let values = evaluator.values_at(&places, &Silent).expect("nobody cancels");
    assert_eq!(values.missed, 0, "points that lie on no surface");
    values.radiosity.into_iter().map(f64::from).collect()
}

/// `||a - b|| / ||b - E||` over points that are uniform by area, channels pooled.
fn difference(scene: &Scene, points: &[(SurfacePoint, usize)], a: &[f64], b: &[f64]) -> f64 {
    let exitance = points.iter().flat_map(|(_, surface)| &scene.material_of(SurfaceId(*surface as u32)).exitance);
    let (mut error, mut reflected) = (0.0, 0.0);
    for ((a, b), exitance) in a.iter().zip(b).zip(exitance) {
        error += (a - b) * (a - b);
        reflected += (b - exitance) * (b - exitance);
    }
    (error / reflected).sqrt()
}

fn leaf_at(solution: &Solution, surface: usize, point: [f64; 3]) -> NodeId {
    let hierarchy = solution.hierarchy();
    let normal = solution.scene().surfaces()[surface].polygon.normal();
    let mut node = hierarchy.node_of(SurfaceId(surface as u32));
    while !hierarchy.is_leaf(node) {
        let inner = |child: &NodeId| inner_distance(&hierarchy.polygon(*child), normal, point);
        node = hierarchy.children(node).max_by(|a, b| inner(a).total_cmp(&inner(b))).expect("inner nodes have children");
    }
    node
}

/// Distance from the nearest edge, positive inside.
fn inner_distance(corners: &[[f64; 3]], normal: [f64; 3], point: [f64; 3]) -> f64 {
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let inward = cross(normal, sub(b, a));
        dot(inward, sub(point, a)) / dot(inward, inward).sqrt()
    };
    (0..corners.len()).map(edge).fold(f64::INFINITY, f64::min)
}
