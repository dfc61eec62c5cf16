//! One job, from its scene to its results.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use patchlight::output::{Points, Provenance};
use patchlight::pipeline::{self, Evaluator, Workers};
use patchlight::progress::Observer;
use patchlight::solve::{RunOptions, SolveOptions};

use super::super::changes::changed;
use super::super::exit::{Exit, Failure};
use super::super::files;
use super::super::key_figures::stopped_by_name;
use super::super::pictures::Limits;
use super::super::progress::{Voice, Watcher};
use super::super::solve::{Ending, within_limits, write_results};
use super::identity::{self, Inputs};
use super::journal::{Figures, Record};
use super::shared_transport::Shared;
use super::stock::{Stock, Stocked};
use super::tasks::Task;

/// A job with all that it reads.
pub struct Ready<'a> {
    task: &'a Task,
    scene: Arc<Stocked>,
    points: Option<Points>,
    options: SolveOptions,
    identity: String,
}

impl<'a> Ready<'a> {
    /// Reads what the job reads, on these threads.
    pub fn new(task: &'a Task, stock: &Stock, workers: &Workers) -> Result<Self, Failure> {
        let (job, request) = (&task.job, &task.request);
        let scene = stock.scene(task.scene, workers)?;
        request.outputs.check_unread(&scene.libraries)?;
        let points = request.points.as_ref().map(|(path, _)| files::read_points(path)).transpose()?;
        let digest_of = |path: &Path| {
            identity::digest_of_file(path).map_err(|error| Failure::bad_input(format_args!("{}: {error}", path.display())))
        };
        let points_digest = request.points.as_ref().map(|(path, _)| digest_of(path)).transpose()?;
        let expected_values = request.options.expected_values.or(points.as_ref().map(|points| points.len() as u64));
        let options = SolveOptions { expected_values, ..request.options.clone() };
        let inputs = Inputs { scene: &scene.digest, points: points_digest.as_deref() };
        let identity = identity::identity(job, request, &options, &inputs);
        Ok(Self { task, scene, points, options, identity })
    }

    /// Whether `known` is what it would come to: the same identity, and files that are as they were written.
    pub fn is_done(&self, known: &Record, results: &Path) -> bool {
        let is_whole =
            |path: &str, digest: &String| identity::digest_of_file(&results.join(path)).is_ok_and(|found| found == *digest);
        let outputs = &self.task.job.outputs;
        known.identity.as_ref() == Some(&self.identity)
            && outputs.len() == known.files.len()
            && outputs.iter().all(|output| known.files.get(&output.text).is_some_and(|digest| is_whole(&output.text, digest)))
    }

    /// Solves it and writes its results; `None` if interrupted.
    pub fn work(&self, workers: &Workers, results: &Path) -> Result<Option<Record>, Failure> {
        let Self { task: Task { job, request, .. }, options, .. } = self;
        let start = Instant::now();

        let Some(Found { evaluator, exit, figures }) = self.solve(workers)? else { return Ok(None) };

        // What is asked for.
        let mut ending = Ending::new(exit);
        let run = within_limits(request, self.points.as_ref(), 0.0, evaluator.solution().scene().channels());
        let limits = Limits::of(RunOptions { time_s: request.run.time_s, ..run }, start);
        let provenance = Provenance::new(options);
        let values = write_results(request, &evaluator, self.points.as_ref(), (&provenance, &limits), &mut ending);
        let exit = ending.finish()?;
        if exit == Exit::Cancelled {
            return Ok(None);
        }
        let mut files = BTreeMap::new();
        for output in &job.outputs {
            let path = results.join(&output.text);
            let digest = identity::digest_of_file(&path);
            files
                .insert(output.text.clone(), digest.map_err(|error| Failure::failed(format_args!("{}: {error}", path.display())))?);
        }
        let points_missed = values.map_or(String::new(), |values| values.missed.to_string());
        let figures = Figures { points_missed, ..figures };
        let (name, identity) = (job.name.clone(), Some(self.identity.clone()));
        Ok(Some(Record { name, identity, exit: exit as u8, figures, files, ..Record::default() }))
    }

    /// Solves it, over stored transport where that is shared and does; `None` if interrupted.
    fn solve(&self, workers: &Workers) -> Result<Option<Found>, Failure> {
        let Self { task: Task { job, request, .. }, options, .. } = self;
        let scene = changed(&self.scene.scene, &job.changes)?;
        let (run, watcher) = (within_limits(request, self.points.as_ref(), 0.0, scene.channels()), Watcher::new(Voice::Job));
        // All jobs of this scene share its geometry.
        let visibility = || Ok::<_, Failure>(Box::new(self.scene.visibility(request.run.backend)?));
        let solve = |scene| -> Result<_, Failure> {
            Ok(pipeline::solve_asking_on(workers.clone(), visibility()?, scene, options, &run, &watcher)?)
        };

        if self.task.shares_transport() {
            let of_file = || Ok(solve(self.scene.scene.clone())?.0);
            match self.scene.transports.with_materials(&scene, (options, &request.run), workers, of_file)? {
                Shared::Good(solution, error) => {
                    let evaluator = Evaluator::asking_on(workers.clone(), visibility()?, *solution);
                    let figures = figures_of(options, "transport".to_owned(), [error.estimate, error.confidence]);
                    return Ok(Some(Found { evaluator, exit: Exit::Done, figures }));
                }
                Shared::Cancelled => return Ok(None),
                Shared::FromScratch if watcher.cancelled() => return Ok(None),
                Shared::FromScratch => {}
            }
        }

        let (evaluator, report) = solve(scene)?;
        let exit = Exit::of_solve(report.stopped_by, report.converged);
        let figures = figures_of(options, stopped_by_name(&report), [report.claimed(), report.error.confidence]);
        Ok(Some(Found { evaluator, exit, figures }).filter(|found| found.exit != Exit::Cancelled))
    }
}

/// What was solved.
struct Found {
    evaluator: Evaluator,
    exit: Exit,
    figures: Figures,
}

/// What the solve tells about itself that is the same in every run: why it ended, what is claimed, and with which confidence.
fn figures_of(options: &SolveOptions, stopped_by: String, [claimed, confidence]: [f64; 2]) -> Figures {
    let known = |number: f64| if number.is_finite() { number.to_string() } else { String::new() };
    Figures {
        stopped_by,
        norm: options.norm.to_string(),
        requested: known(options.error),
        claimed: known(claimed),
        confidence: known(confidence),
        ..Figures::default()
    }
}
