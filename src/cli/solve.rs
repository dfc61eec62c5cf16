//! `patchlight solve`: read, solve, write what is asked for, tell how it went.

use std::time::Instant;

use patchlight::output::{CpuReport, Points, Provenance, Quantity, RunReport, SceneReport, write_report};
use patchlight::picture::Image;
use patchlight::pipeline::{self, Evaluator};
use patchlight::scene::import::read_scene;
use patchlight::scene::{FileUv, Scene};
use patchlight::solve::{RunOptions, SolveOptions, StoppedBy};
use patchlight::values::{Values, ValuesError};

use super::exit::{Exit, Failure};
use super::files::Outputs;
use super::key_figures::{tell_key_figures, tell_time};
use super::page_extras::FoundExtras;
use super::pictures::Limits;
use super::progress::{Voice, Watcher};
use super::report::write_page_to;
use super::request::{PictureRequest, SolveRequest};
use super::stderr::say;
use super::{files, interrupt, pictures, process, ranks, results};

/// Warnings that are printed one by one; `patchlight info` prints all.
const PRINTED_WARNINGS: usize = 20;

/// Solves, and writes what is asked for.
pub fn solve(request: SolveRequest) -> Result<Exit, Failure> {
    let start = Instant::now();
    let voice = request.voice;

    // Everything that is read, before the long work. An interrupt ends it at once.
    let points = request.points.as_ref().map(|(path, _)| files::read_points(path)).transpose()?;
    let expected_values = request.options.expected_values.or(points.as_ref().map(|points| points.len() as u64));
    let options = SolveOptions { expected_values, ..request.options.clone() };
    let workers = ranks::workers(request.run.threads)?;
    let (scene, warnings, _) = workers.install(|| read(&request, &request.outputs))?;
    let request = request.or_leave_a_page()?;
    let scene_report = SceneReport::of(&scene, request.scene.clone());
    let load_s = start.elapsed().as_secs_f64();
    interrupt::listen_alone(interrupt::OF_RUN);

    // The solve. What an interrupt or a limit leaves is a solution as well, and is written.
    let cpu_before = cpu_seconds_of_all();
    let run = within_limits(&request, points.as_ref(), load_s, scene.channels());
    let (mut evaluator, report) = pipeline::solve_on(workers, scene, &options, &run, &Watcher::new(voice))?;
    let cpu_solved = cpu_seconds_of_all();
    let provenance = Provenance::new(&options);
    let mut run_report = RunReport::of_solve(provenance.software(), scene_report, &options, &report);
    tell_key_figures(voice, &run_report, &report);

    // What is asked for.
    let mut ending = Ending { writes: ranks::is_first(), ..Ending::new(Exit::of_solve(report.stopped_by, report.converged)) };
    let sampling = Instant::now();
    // Whoever interrupts a solve does not wait for a good picture.
    let time_s = if report.stopped_by == StoppedBy::Cancelled { Some(0.0) } else { request.run.time_s };
    let limits = Limits::of(RunOptions { time_s, ..run }, start);
    let written = write_results(&request, &evaluator, points.as_ref(), (&provenance, &limits), &mut ending);
    run_report.error.points = written.and_then(|values| values.error);
    let (extras, cut_short) = request.extras.find(&evaluator, voice)?;
    ending.limit(cut_short);
    let sample_s = sampling.elapsed().as_secs_f64() - ending.output_s;

    // The report, last: it tells about all of the above. The first process makes it.
    let cpu_now = cpu_seconds_of_all();
    evaluator.leave_team();
    if !ranks::is_first() {
        std::mem::forget(evaluator);
        return ending.finish();
    }
    let between = |from: Option<f64>, to: Option<f64>| Some(to? - from?);
    run_report.threads = if request.run.threads > 0 { request.run.threads } else { available_threads() };
    (run_report.processes, run_report.given_bytes) = (ranks::size(), ranks::given_bytes());
    (run_report.warnings, run_report.warned_faces) = (warnings.texts, warnings.faces);
    run_report.time_s.load = load_s;
    run_report.time_s.sample = sample_s;
    run_report.time_s.output = ending.output_s;
    run_report.time_s.total = start.elapsed().as_secs_f64();
    run_report.cpu_s = CpuReport { total: cpu_now, solve: between(cpu_before, cpu_solved), sample: between(cpu_solved, cpu_now) };
    run_report.memory.peak_resident_bytes = process::peak_resident_bytes();
    tell_time(voice, &run_report);
    write_reports(&request, (&evaluator, &extras), (&run_report, &provenance), &mut ending);
    // The program ends: the system takes all memory back at once, where freeing a large scene piece by piece takes a while.
    std::mem::forget(evaluator);
    ending.finish()
}

/// Writes what tells about the run: report, plots and page.
fn write_reports(
    request: &SolveRequest,
    (evaluator, extras): (&Evaluator, &FoundExtras),
    (report, provenance): (&RunReport, &Provenance),
    ending: &mut Ending,
) {
    let voice = request.voice;
    if let Some(sink) = &request.report {
        ending.note(sink.write(|mut writer| write_report(&mut writer, report)));
    }
    if let Some(plots) = &request.plots {
        ending.note(plots.write(report, provenance, voice));
    }
    if let Some(page) = &request.html {
        let name = request.scene.file_name().unwrap_or_default().to_string_lossy();
        ending.note(write_page_to(page, (evaluator, &name), (Some(report), extras), voice));
    }
}

/// What is made of a scene right after it is solved takes so much.
pub struct Demand {
    /// Values.
    pub values: u64,
    /// Bytes, beside what the solve takes.
    pub bytes: u64,
    /// The part of the time that is left to it, at least.
    pub time: f64,
}

/// Solves a scene for something that is made of it right after: `plan` says of the scene what that is, and what it takes. `outputs` are all
/// that is written.
pub fn light<T>(
    request: &SolveRequest,
    outputs: &Outputs,
    plan: impl FnOnce(&Scene, &FileUv) -> Result<(T, Demand), Failure>,
) -> Result<(Evaluator, Exit, T), Failure> {
    let start = Instant::now();
    let workers = ranks::workers(request.run.threads)?;
    let (scene, _, uv) = workers.install(|| read(request, outputs))?;
    let (plan, demand) = plan(&scene, &uv)?;
    let values = request.options.expected_values.or(Some(demand.values));
    let options = SolveOptions { expected_values: values, ..request.options.clone() };
    let scene_report = SceneReport::of(&scene, request.scene.clone());
    let load_s = start.elapsed().as_secs_f64();
    interrupt::listen_alone(interrupt::OF_RUN);
    let run = within_limits(request, None, load_s, scene.channels());
    let run = RunOptions {
        time_s: run.time_s.map(|seconds| (1.0 - demand.time) * seconds),
        memory_bytes: run.memory_bytes.map(|bytes| bytes.saturating_sub(demand.bytes)),
        ..run
    };
    let (evaluator, report) = pipeline::solve_on(workers, scene, &options, &run, &Watcher::new(request.voice))?;
    let run_report = RunReport::of_solve(Provenance::new(&options).software(), scene_report, &options, &report);
    tell_key_figures(request.voice, &run_report, &report);
    Ok((evaluator, Exit::of_solve(report.stopped_by, report.converged), plan))
}

/// A picture for which more than the solution is to be found has this part of the time.
const PART_OF_PICTURE: f64 = 0.5;

/// How the solve runs: reading took some of the time, points and a picture take some, and some of the memory.
pub fn within_limits(request: &SolveRequest, points: Option<&Points>, load_s: f64, channels: usize) -> RunOptions {
    // Results are written from what the solution holds, one after the other: the largest counts.
    let values = points.map_or(0, |points| Values::bytes_of(points.len(), channels));
    let pictures = request.picture.as_ref().map_or(0, |picture| Image::bytes_of(picture.size.into(), channels));
    let of_results = points.map_or(0, Points::memory_bytes) + values.max(pictures);
    let takes_time = |picture: &PictureRequest| picture.quantity != Quantity::Width && !request.options.lit_mesh;
    let part = if request.picture.as_ref().is_some_and(takes_time) { 1.0 - PART_OF_PICTURE } else { 1.0 };
    RunOptions {
        time_s: request.run.time_s.map(|seconds| part * (seconds - load_s).max(0.0)),
        values_in_time: points.map_or(0, |points| points.len() as u64),
        memory_bytes: request.run.memory_bytes.map(|bytes| bytes.saturating_sub(of_results)),
        ..request.run.clone()
    }
}

/// What was repaired or is suspicious, and the faces that this is about, from 1.
struct Warnings {
    texts: Vec<String>,
    faces: Vec<Option<u32>>,
}

/// Reads the scene, with coordinates that its file has for lightmaps, and warns of what was repaired.
fn read(request: &SolveRequest, outputs: &Outputs) -> Result<(Scene, Warnings, FileUv), Failure> {
    let imported = read_scene(&request.scene, &request.import).map_err(Failure::bad_input)?;
    outputs.check_unread(&imported.libraries)?;
    let warnings = imported.diagnostics.warnings();
    warnings.iter().take(PRINTED_WARNINGS).for_each(|warning| request.voice.warn(format_args!("{warning}")));
    if warnings.len() > PRINTED_WARNINGS {
        let more = warnings.len() - PRINTED_WARNINGS;
        request.voice.warn(format_args!("{more} more; 'patchlight info {}' prints all", request.scene.display()));
    }
    let scene = match &request.light_groups {
        Some(grouping) => grouping.apply_to(&imported.scene)?,
        None => imported.scene,
    };
    request.extras.check(&scene)?;
    Ok((scene, Warnings { texts: warnings, faces: imported.diagnostics.warned_faces() }, imported.uv))
}

/// What is known of values that were written.
#[derive(Clone, Copy)]
pub struct WrittenValues {
    /// How wrong they are.
    pub error: Option<ValuesError>,
    /// How many points lie on no surface.
    pub missed: usize,
}

/// Writes what is asked for, but for the report, and gives what is known of the values at points. The solution first: everything else can be
/// made from it again.
pub fn write_results(
    request: &SolveRequest,
    evaluator: &Evaluator,
    points: Option<&Points>,
    (provenance, limits): (&Provenance, &Limits),
    ending: &mut Ending,
) -> Option<WrittenValues> {
    let (voice, mut written) = (request.voice, None);
    if let Some(destination) = &request.solution {
        ending.write(|| results::write_solution_to(destination, evaluator, voice));
    }
    if let (Some((_, sink)), Some(points)) = (&request.points, points) {
        match results::values_at(evaluator, points, voice) {
            Some(values) => {
                written = Some(WrittenValues { error: values.0.error, missed: values.0.missed });
                ending.write(|| results::write_values_to(sink, points, &values, voice));
            }
            None => ending.cancel(voice, &sink.name()),
        }
    }
    match (&request.mesh, evaluator.mesh()) {
        (Some(destination), Some(mesh)) => ending.write(|| results::write_mesh_to(destination, evaluator, mesh, voice)),
        (Some((destination, _)), None) => {
            voice.warn(format_args!("{} is not written: there is no mesh", destination.path().display()))
        }
        (None, _) => {}
    }
    if let Some(picture) = &request.picture {
        match pictures::take_picture(evaluator, picture, limits, voice) {
            Ok(Some(image)) => {
                ending.write(|| pictures::write_picture(&image, picture, provenance, voice));
                ending.limit(image.limit);
            }
            Ok(None) => ending.cancel(voice, "the picture"),
            Err(failure) => ending.note(Err(failure)),
        }
    }
    written
}

/// CPU seconds of all processes so far, where the system tells.
fn cpu_seconds_of_all() -> Option<f64> {
    process::cpu_seconds().map(ranks::sum)
}

fn available_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// How the run ends: one failure does not keep the other results from being written.
pub struct Ending {
    exit: Exit,
    failures: Vec<Failure>,
    /// Whether this process writes: of several that work together the first one does.
    writes: bool,
    /// Seconds that writing took.
    output_s: f64,
}

impl Ending {
    /// Nothing has failed yet.
    pub fn new(exit: Exit) -> Self {
        Self { exit, failures: Vec::new(), writes: true, output_s: 0.0 }
    }

    fn note(&mut self, result: Result<(), Failure>) {
        self.failures.extend(result.err());
    }

    /// Does some writing, and counts its time.
    pub fn write(&mut self, work: impl FnOnce() -> Result<(), Failure>) {
        if !self.writes {
            return;
        }
        let start = Instant::now();
        self.note(work());
        self.output_s += start.elapsed().as_secs_f64();
    }

    /// An interrupt keeps something from being written.
    pub fn cancel(&mut self, voice: Voice, left_out: &str) {
        voice.warn(format_args!("{left_out} is not written: interrupted"));
        self.exit = Exit::Cancelled;
    }

    /// A limit ended something before it was as good as asked for.
    pub fn limit(&mut self, exit: Option<Exit>) {
        if let (Exit::Done, Some(exit)) = (self.exit, exit) {
            self.exit = exit;
        }
    }

    /// The exit code, or the last failure; others are told of.
    pub fn finish(mut self) -> Result<Exit, Failure> {
        let last = self.failures.pop();
        self.failures.iter().for_each(|failure| say(format_args!("error: {}", failure.message)));
        last.map_or(Ok(self.exit), Err)
    }
}
