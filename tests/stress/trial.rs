//! One run of a scene, and everything that must hold of it whatever the scene.

use std::io::Cursor;
use std::path::Path;

use patchlight::output::{Provenance, read_solution_from, write_ply, write_solution};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Norm, RunOptions, SolveOptions, SolveReport, Solver};
use patchlight::visibility::Backend;

use crate::hard_scenes::HardScene;
use crate::rooms::points_of;
use crate::triangles::Random;

/// How a scene is run.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub backend: Backend,
    pub solver: Solver,
    pub seed: u64,
}

/// A claim beside the truth.
pub struct Claim {
    /// What was run, for messages.
    pub run: String,
    pub error: f64,
    pub claimed: f64,
}

impl Claim {
    pub fn holds(&self) -> bool {
        self.error <= self.claimed
    }
}

/// Where all but a thousandth is reflected no number of links is enough, and a run must end well without.
const MOST_LINKS: u64 = 30_000;

/// Points at which the error of a run is taken.
const POINTS: usize = 1000;

/// Runs a scene: panics where any output is not finite or negative, or does not fit the others; gives the claim if the truth is known.
pub fn run(hard: &HardScene, way: Way, requested: f64) -> Option<Claim> {
    let run = format!("{}, {}, {:?}, seed {}", hard.name, way.backend.name(), way.solver, way.seed);
    let options = SolveOptions {
        error: requested,
        norm: Norm::Energy,
        solver: way.solver,
        seed: way.seed,
        max_links: Some(MOST_LINKS),
        ..SolveOptions::default()
    };
    let run_options = RunOptions { backend: way.backend, ..RunOptions::default() };
    let (evaluator, report) = pipeline::solve(hard.scene.clone(), &options, &run_options, &Silent).unwrap();
    check_solution(&run, &evaluator);
    check_report(&run, &report, requested);
    check_picture(&run, &evaluator);

    // Values at points, and how far they are from the truth in the norm of the claim.
    let points = points_of(&hard.scene, POINTS, &mut Random(17));
    let places: Vec<SurfacePoint> = points.iter().map(|(point, _)| *point).collect();
    let values = evaluator.values_at(&places, &Silent).unwrap();
    assert_eq!(values.missed, 0, "{run}: points that lie on no surface");
    assert!(values.radiosity.iter().all(|value| value.is_finite() && *value >= 0.0), "{run}: a value is negative or not finite");
    let truth = hard.truth.as_ref()?;
    let (mut error_sq, mut norm_sq) = (0.0, 0.0);
    for (value, (point, surface)) in values.radiosity.iter().zip(&points) {
        let expected = truth(point, *surface);
        error_sq += (f64::from(*value) - expected).powi(2);
        norm_sq += (expected - exitance(&hard.scene, *surface)).powi(2);
    }
    let error = if error_sq == 0.0 { 0.0 } else { (error_sq / norm_sq).sqrt() };
    let claim = Claim { run, error, claimed: report.error.estimate };
    println!(
        "{}: error {error:.5}, claimed {:.5}, measured {:.5}, {:?}, {} links",
        claim.run, claim.claimed, report.error.measured, report.stopped_by, report.counts.links
    );
    Some(claim)
}

fn exitance(scene: &Scene, surface: usize) -> f64 {
    scene.material_of(SurfaceId(surface as u32)).exitance[0]
}

/// The solution is well formed, its leaves are finite, and it comes back from a file as it was.
fn check_solution(run: &str, evaluator: &Evaluator) {
    let solution = evaluator.solution();
    solution.validate().unwrap_or_else(|fault| panic!("{run}: {fault}"));
    solution.for_each_leaf(|_, _, radiosity| {
        assert!(radiosity.iter().all(|b| b.is_finite() && *b >= 0.0), "{run}: a leaf has {radiosity:?}");
    });
    assert!(solution.links().iter().all(|(_, link)| link.occluded_form_factor().is_finite()), "{run}: a link is no number");

    let provenance = Provenance::new(solution.options());
    let mut file = Cursor::new(Vec::new());
    write_solution(&mut file, solution, &provenance).unwrap();
    file.set_position(0);
    let stored = read_solution_from(file, Path::new("in memory")).unwrap_or_else(|error| panic!("{run}: {error}"));
    assert!(stored == *solution, "{run}: the stored solution is another one");
    write_ply(&mut Vec::new(), solution, &provenance).unwrap();
}

/// No figure of the report is negative or not a number; the claim is kept where the run says that it converged.
fn check_report(run: &str, report: &SolveReport, requested: f64) {
    let (error, energy) = (&report.error, &report.energy);
    assert!(error.estimate >= 0.0 && error.measured >= 0.0, "{run}: {error:?}");
    assert!(!report.converged || error.estimate <= requested, "{run}: {error:?}");
    assert!(energy.emitted.is_finite() && energy.emitted >= 0.0, "{run}: {energy:?}");
    assert!(energy.absorbed.is_finite() && energy.absorbed >= 0.0, "{run}: {energy:?}");
    assert!(energy.escaped.is_finite() && energy.residual.is_finite(), "{run}: {energy:?}");
}

/// A small picture, from where the scene is seen best.
fn check_picture(run: &str, evaluator: &Evaluator) {
    let camera = evaluator.default_camera(12, 9);
    let image = evaluator.render(&camera, &Silent).unwrap_or_else(|error| panic!("{run}: {error}")).unwrap();
    assert!(image.radiance.iter().all(|l| l.is_finite() && *l >= 0.0), "{run}: a pixel is negative or not finite");
}
