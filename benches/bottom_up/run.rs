//! Runs a strategy, with the CPU time of its refinement.

use std::path::Path;
use std::sync::Mutex;

use patchlight::hierarchy::NodeId;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::{Observer, Progress, Stage};
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{ChangShih98Options, LinkOptions, RunOptions, Solution, SolveOptions, SolveReport, Strategy};

use super::cpu::cpu_seconds;

/// A run with what it took.
pub struct Run {
    pub evaluator: Evaluator,
    pub report: SolveReport,
    /// CPU seconds of subdividing and linking.
    pub refine_cpu_s: f64,
}

impl Run {
    pub fn solution(&self) -> &Solution {
        self.evaluator.solution()
    }

    /// Links that serve both directions, as the paper counts them.
    pub fn links(&self) -> usize {
        self.solution().links().len() / 2
    }
}

/// A scene of the repository.
pub fn scene(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
    read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene
}

/// Solves on one thread.
pub fn run(scene: &Scene, strategy: Strategy, form_factor_tolerance: f64, samples: u32, seed: u64) -> Run {
    let options = SolveOptions {
        strategy,
        seed,
        error: 0.9,
        point_rays: Some(1),
        chang_shih98: ChangShih98Options { form_factor_tolerance, bottom_samples: samples, ..ChangShih98Options::default() },
        links: LinkOptions { sweep_tolerance: 1e-9, ..LinkOptions::default() },
        ..SolveOptions::default()
    };
    let stopwatch = Stopwatch::default();
    let one_thread = RunOptions { threads: 1, ..RunOptions::default() };
    let (evaluator, report) = pipeline::solve(scene.clone(), &options, &one_thread, &stopwatch).expect("options that are legal");
    let [start, end] = stopwatch.0.into_inner().expect("nothing panics").map(|time| time.expect("both stages were passed"));
    assert!(evaluator.solution().links().dormant().is_empty(), "a limit has ended the run");
    Run { evaluator, report, refine_cpu_s: end - start }
}

/// Of every node the smallest elements below it, by their numbers in the list of these.
pub fn elements_below(solution: &Solution) -> (Vec<NodeId>, Vec<Vec<u32>>) {
    let hierarchy = solution.hierarchy();
    let elements: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
    let mut below = vec![Vec::new(); hierarchy.len()];
    for (number, &element) in elements.iter().enumerate() {
        std::iter::successors(Some(element), |&node| hierarchy.parent(node))
            .for_each(|node| below[node.index()].push(number as u32));
    }
    (elements, below)
}

/// Notes the CPU time when refinement starts, and when it has ended.
#[derive(Default)]
struct Stopwatch(Mutex<[Option<f64>; 2]>);

impl Observer for Stopwatch {
    fn progress(&self, progress: &Progress) {
        let place = match progress.stage {
            Stage::Refine => 0,
            Stage::Gather => 1,
            _ => return,
        };
        if let Ok(mut times) = self.0.lock() {
            times[place].get_or_insert_with(cpu_seconds);
        }
    }
}
