//! From a scene to a solution.

use std::path::PathBuf;

use patchlight::output::{Provenance, RunReport, SceneReport, read_solution, write_report};
use patchlight::pipeline::{Evaluator, solve_on};
use patchlight::progress::Observer;
use patchlight::solve::{SolveOptions, SolveReport, StoppedBy};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{Failure, warn_of_limit};
use crate::lit::{Known, Lit, Report};
use crate::options::Settings;
use crate::scene::Scene;
use crate::solution::Solution;
use crate::watch::{Listener, watched};
use crate::workers::workers;

/// Solves a scene.
///
/// scene: a `Scene`, the path of an .obj file, or a mesh as `Scene.from_mesh` takes it.
/// error: what is asked for, relative to the reflected light, 0 to 1; 0.02 if left out.
/// threads: int, for threads of its own; None for those that all solves share, one for each core. Changes no answer.
/// progress: True for a bar, or a function of stage (str) and fraction (float from 0 to 1, or None where it is not known), called on this
///     thread up to 20 times a second. Returns it True, the solve ends, and what there is is returned; what it raises ends the solve and
///     is raised.
/// memory: GB that it may take; or a function of the bytes (int) that it would take, called on this thread before it takes more. Returns it
///     True, they are refused: the solve ends as with that limit. What it raises is raised. It must not use Patchlight itself: the solve waits.
/// options: time in seconds, backend, and all that `patchlight.options()` lists, by name.
///
/// Other Python threads go on meanwhile. Ctrl-C ends it within half a second with KeyboardInterrupt. A solve that a limit ends returns a
/// solution as well, and warns with `LimitWarning`; `converged` and `stopped_by` tell.
#[pyfunction]
#[pyo3(signature = (scene, error=None, *, threads=None, progress=None, **options))]
pub fn solve(
    scene: &Bound<'_, PyAny>,
    error: Option<f64>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Solution> {
    let py = scene.py();
    let settings = Settings::new(error, options)?;
    let listener = Listener::new(progress)?.asking(settings.memory);
    let scene = Scene::of(scene)?;
    let scene = scene.get();
    let workers = workers(threads)?;

    let (pool, copy) = (workers.clone(), scene.scene.clone());
    let work = |observer: &dyn Observer| solve_on(pool, copy, &settings.solve, &settings.run, observer);
    let (evaluator, report) = watched(py, &listener, work)?.map_err(Failure::from)?;
    if let Some(limit) = limit(&report) {
        warn_of_limit(py, &limit)?;
    }
    let json = json(scene, &settings.solve, &report, workers.count());
    Ok(Solution::of(Lit::new(evaluator, Known::Solved(Box::new(Report { json, solve: report })))))
}

/// Reads a solution that this version of Patchlight stored. Nothing in the file is trusted before it is checked.
///
/// path: the file. threads: as in `solve`. backend: who answers visibility, see `patchlight.options()`.
#[pyfunction]
#[pyo3(signature = (path, *, threads=None, backend=None))]
pub fn load(py: Python<'_>, path: PathBuf, threads: Option<usize>, backend: Option<&str>) -> PyResult<Solution> {
    let backend = backend.unwrap_or_default();
    let backend = if backend.is_empty() { Ok(Default::default()) } else { backend.parse() };
    let backend = backend.map_err(|error| Failure::option(format_args!("{error}")))?;
    let workers = workers(threads)?;
    let evaluator = py.detach(|| -> Result<Evaluator, Failure> {
        let solution = workers.install(|| read_solution(&path))?;
        Ok(Evaluator::new_on(workers, solution, backend)?)
    })?;
    Ok(Solution::of(Lit::new(evaluator, Known::Nothing)))
}

/// What is warned of, if the error that was asked for is not reached and nobody wanted that.
fn limit(report: &SolveReport) -> Option<String> {
    let what = match report.stopped_by {
        StoppedBy::Error | StoppedBy::Cancelled => return None,
        StoppedBy::Exhausted if report.converged => return None,
        StoppedBy::MaxLinks => "the limit on links ended the solve",
        StoppedBy::Time => "the time limit ended the solve",
        StoppedBy::Memory => "the memory budget, or who was asked for more, ended the solve",
        StoppedBy::Exhausted => "nothing more can be gained",
    };
    Some(format!("{what}: an error of {} is claimed, {} was asked for", report.claimed(), report.error.requested))
}

/// The report as the program writes it; what only a program knows is missing.
fn json(scene: &Scene, options: &SolveOptions, report: &SolveReport, threads: usize) -> String {
    let provenance = Provenance::new(options);
    let of_scene = SceneReport::of(&scene.scene, scene.file.clone());
    let mut run = RunReport::of_solve(provenance.software(), of_scene, options, report);
    run.threads = threads;
    run.warnings.clone_from(&scene.warnings);
    run.warned_faces.clone_from(&scene.warned_faces);
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = write_report(&mut text, &run);
    String::from_utf8_lossy(&text).into_owned()
}
