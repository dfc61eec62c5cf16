//! `patchlight solve`: read, solve, write what is asked for, tell how it went.

use std::time::Instant;

use patchlight::bounds::{BoundsReport, Certainty};
use patchlight::output::{CpuReport, Points, Provenance, Quantity, RunReport, SceneReport, write_report};
use patchlight::picture::Image;
use patchlight::pipeline::{self, Evaluator, Workers};
use patchlight::scene::import::read_scene;
use patchlight::scene::{FileUv, Scene};
use patchlight::solve::{ErrorReport, LitMeshReport, Norm, RunOptions, SolveOptions, SolveReport, StoppedBy};
use patchlight::values::{Values, ValuesError};

use super::exit::{Exit, Failure};
use super::files::Outputs;
use super::light_groups::tell_groups;
use super::pictures::Limits;
use super::progress::{Voice, Watcher};
use super::request::{PictureRequest, SolveRequest};
use super::stderr::say;
use super::{files, interrupt, pictures, process, results};

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
    let workers = Workers::new(request.run.threads)?;
    let (scene, warnings, _) = workers.install(|| read(&request, &request.outputs))?;
    let request = request.or_leave_a_page()?;
    let scene_report = SceneReport::of(&scene, request.scene.clone());
    let load_s = start.elapsed().as_secs_f64();
    interrupt::listen(interrupt::OF_RUN);

    // The solve. What an interrupt or a limit leaves is a solution as well, and is written.
    let cpu_before = process::cpu_seconds();
    let run = within_limits(&request, points.as_ref(), load_s, scene.channels());
    let (evaluator, report) = pipeline::solve_on(workers, scene, &options, &run, &Watcher::new(voice))?;
    let cpu_solved = process::cpu_seconds();
    let provenance = Provenance::new(&options);
    let mut run_report = RunReport::of_solve(provenance.software(), scene_report, &options, &report);
    tell_key_figures(voice, &run_report, &report);

    // What is asked for.
    let mut ending = Ending::new(Exit::of_solve(report.stopped_by, report.converged));
    let sampling = Instant::now();
    // Whoever interrupts a solve does not wait for a good picture.
    let time_s = if report.stopped_by == StoppedBy::Cancelled { Some(0.0) } else { request.run.time_s };
    let limits = Limits::of(RunOptions { time_s, ..run }, start);
    let written = write_results(&request, &evaluator, points.as_ref(), (&provenance, &limits), &mut ending);
    run_report.error.points = written.and_then(|values| values.error);
    let sample_s = sampling.elapsed().as_secs_f64() - ending.output_s;

    // The report, last: it tells about all of the above.
    let cpu_now = process::cpu_seconds();
    let between = |from: Option<f64>, to: Option<f64>| Some(to? - from?);
    run_report.threads = if request.run.threads > 0 { request.run.threads } else { available_threads() };
    run_report.warnings = warnings;
    run_report.time_s.load = load_s;
    run_report.time_s.sample = sample_s;
    run_report.time_s.output = ending.output_s;
    run_report.time_s.total = start.elapsed().as_secs_f64();
    run_report.cpu_s = CpuReport { total: cpu_now, solve: between(cpu_before, cpu_solved), sample: between(cpu_solved, cpu_now) };
    run_report.memory.peak_resident_bytes = process::peak_resident_bytes();
    tell_time(voice, &run_report);
    if let Some(sink) = &request.report {
        ending.note(sink.write(|mut writer| write_report(&mut writer, &run_report)));
    }
    if let Some(page) = &request.html {
        let name = request.scene.file_name().unwrap_or_default().to_string_lossy();
        ending.note(results::write_page_to(page, &evaluator, (&name, Some(&run_report)), voice));
    }
    // The program ends: the system takes all memory back at once, where freeing a large scene piece by piece takes a while.
    std::mem::forget(evaluator);
    ending.finish()
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
    let workers = Workers::new(request.run.threads)?;
    let (scene, _, uv) = workers.install(|| read(request, outputs))?;
    let (plan, demand) = plan(&scene, &uv)?;
    let values = request.options.expected_values.or(Some(demand.values));
    let options = SolveOptions { expected_values: values, ..request.options.clone() };
    let scene_report = SceneReport::of(&scene, request.scene.clone());
    let load_s = start.elapsed().as_secs_f64();
    interrupt::listen(interrupt::OF_RUN);
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

/// Reads the scene, with coordinates that its file has for lightmaps, and warns of what was repaired.
fn read(request: &SolveRequest, outputs: &Outputs) -> Result<(Scene, Vec<String>, FileUv), Failure> {
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
    Ok((scene, warnings, imported.uv))
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

fn available_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// What matters most, on a few lines.
fn tell_key_figures(voice: Voice, run: &RunReport, report: &SolveReport) {
    let scene = &run.scene;
    let channels = if scene.channels == 1 { "1 channel".to_owned() } else { format!("{} channels", scene.channels) };
    voice.figure("scene", format_args!("{}: {} surfaces, {channels}", scene.file.display(), scene.surfaces));
    voice.figure("backend", format_args!("{}", report.backend));
    let counts = &report.counts;
    voice.figure("solution", format_args!("{} elements, {} links, {} rays", counts.elements, counts.links, counts.rays));
    let error = &report.error;
    let claim = claim_in_words(error, run.options.norm);
    if run.options.lit_mesh {
        voice.figure("error", format_args!("{claim}, of values at points"));
        voice.figure("mesh", format_args!("{}", mesh_in_words(report)));
    } else {
        let reached = if report.converged { "reached" } else { "not reached" };
        let asked = 100.0 * run.options.error;
        voice.figure("error", format_args!("{claim}; {asked:.2}% asked for: {reached} (stopped by {})", stopped_by_name(report)));
    }
    if let Some(groups) = &report.light_groups {
        tell_groups(voice, groups);
    }
    if let Some(transport) = &report.transport {
        let (terms, mb) = (transport.terms, transport.bytes as f64 * 1e-6);
        voice.figure("transport", format_args!("{terms} terms of paths over {} cells, {mb:.1} MB", transport.cells));
    } else if run.options.keep_transport {
        voice.warn(format_args!("what paths bring is not kept: a limit ended the solve before"));
    }
    if let Some(links) = &report.link_error {
        let part = 100.0 * links.estimated_error / links.reflected;
        voice.figure(
            "links",
            format_args!("leave {part:.2}% of what elements reflect open, weighted by importance: an estimated error"),
        );
    }
    if let Some(bounds) = &report.bounds {
        voice.figure("bounds", format_args!("{}", bounds_in_words(bounds)));
    }
}

/// How good the lit mesh is, or why there is none.
fn mesh_in_words(report: &SolveReport) -> String {
    let Some(mesh) = &report.lit_mesh else {
        return format!("not made: the solve was stopped by {}", stopped_by_name(report));
    };
    let LitMeshReport { elements, nodes, off_values, whole, .. } = mesh;
    let off = 100.0 * off_values.estimate;
    let claim = if whole.estimate.is_finite() {
        let reached = if report.converged { "reached" } else { "not reached" };
        let (claimed, asked) = (100.0 * whole.estimate, 100.0 * report.error.requested);
        format!("{claimed:.2}% claimed of both together; {asked:.2}% asked for: {reached} (stopped by {})", stopped_by_name(report))
    } else {
        "nothing can be said about both together".to_owned()
    };
    format!("{elements} elements, {nodes} nodes, claimed to be {off:.2}% off the values; {claim}")
}

/// What bounds prove. It is a mean over the area, of elements: single points have bounds of their own, which may be wider or narrower.
fn bounds_in_words(bounds: &BoundsReport) -> String {
    let apart = if bounds.relative_error <= 1.0 {
        format!("{:.2}% of the reflected light apart in the mean over the area", 100.0 * bounds.relative_error)
    } else {
        "have not closed in: farther apart, in the mean over the area, than what is certainly reflected".to_owned()
    };
    let in_doubt = bounds.conditions.iter().filter(|condition| condition.could_matter);
    let reasons: Vec<String> = in_doubt.map(|condition| condition.kind.to_string()).collect();
    match (bounds.certainty, bounds.conditions.len()) {
        (Certainty::Estimate, _) if reasons.is_empty() => format!("{apart}: an estimate"),
        (Certainty::Estimate, _) => {
            format!("{apart}: an estimate, because of {}; the report says where", reasons.join(" and "))
        }
        (Certainty::Guaranteed, 1) => format!("{apart}: proved, on a condition that the report lists"),
        (Certainty::Guaranteed, count) => format!("{apart}: proved, on {count} conditions that the report lists"),
    }
}

/// Where light was found on less than this part of the area, the claim says so.
const WORTH_TELLING: f64 = 0.99;

/// The claim, or that there is none: nothing was estimated, or nothing can be.
pub fn claim_in_words(error: &ErrorReport, norm: Norm) -> String {
    if !error.estimate.is_finite() {
        let why = if norm == Norm::Local && error.lit > 0.0 {
            let claimed = error.where_found.map(|found| found.estimate).filter(|claimed| claimed.is_finite());
            let there = claimed.map_or_else(String::new, |claimed| format!(", where {:.2}% is claimed", 100.0 * claimed));
            let lit = 100.0 * error.lit;
            format!("light comes to much of the area by paths too rare to tell how much; it was found on {lit:.0}%{there}")
        } else {
            "too little was done to estimate it".to_owned()
        };
        return format!("nothing can be said about it in the {norm} norm: {why}");
    }
    let (percent, confidence) = (100.0 * error.estimate, 100.0 * error.confidence);
    let where_lit = if norm == Norm::Local && error.lit < WORTH_TELLING {
        format!(", on the {:.0}% of the area where light was found", 100.0 * error.lit)
    } else {
        String::new()
    };
    format!("{percent:.2}% claimed in the {norm} norm with {confidence:.0}% confidence{where_lit}")
}

/// The name that the report uses.
pub fn stopped_by_name(report: &SolveReport) -> String {
    serde_json::to_value(report.stopped_by).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
}

fn tell_time(voice: Voice, run: &RunReport) {
    let time = &run.time_s;
    let cpu = run.cpu_s.total.map_or(String::new(), |seconds| format!(", {seconds:.2} CPU-s"));
    voice.figure(
        "time",
        format_args!(
            "{:.2} s{cpu}: load {:.2}, solve {:.2}, sample {:.2}, output {:.2}",
            time.total,
            time.load,
            time.total - time.load - time.sample - time.output,
            time.sample,
            time.output
        ),
    );
}

/// How the run ends: one failure does not keep the other results from being written.
pub struct Ending {
    exit: Exit,
    failures: Vec<Failure>,
    /// Seconds that writing took.
    output_s: f64,
}

impl Ending {
    /// Nothing has failed yet.
    pub fn new(exit: Exit) -> Self {
        Self { exit, failures: Vec::new(), output_s: 0.0 }
    }

    fn note(&mut self, result: Result<(), Failure>) {
        self.failures.extend(result.err());
    }

    /// Does some writing, and counts its time.
    pub fn write(&mut self, work: impl FnOnce() -> Result<(), Failure>) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_known_is_not_claimed() {
        let known = ErrorReport { estimate: 0.0123, confidence: 0.98, ..ErrorReport::default() };
        assert_eq!(claim_in_words(&known, Norm::Energy), "1.23% claimed in the energy norm with 98% confidence");
        let half = claim_in_words(&ErrorReport { lit: 0.5, ..known }, Norm::Local);
        assert_eq!(half, "1.23% claimed in the local norm with 98% confidence, on the 50% of the area where light was found");
        for estimate in [f64::INFINITY, f64::NAN] {
            let unknown = claim_in_words(&ErrorReport { estimate, ..known }, Norm::Local);
            assert!(unknown.starts_with("nothing can be said about it in the local norm"), "{unknown}");
        }
    }
}
