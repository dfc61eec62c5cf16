//! Does visibility lose inside a solve? What a solve asks is recorded and asked again, and the rates are printed side by side.
//!
//! `cargo bench --bench visibility_in_solve`. Scenes are the Cornell box, the furnished room and the full office of scenes/, and
//! what else the environment variable `VISIBILITY_BENCH_SCENES` names, OBJ files separated by colons. Everything runs on one
//! thread. For segments and for first hits, in millions a second:
//! - `solve`: their number by the time that the solve itself spent on them, among all else that it does;
//! - `calls`: the same calls made again, one after the other, with nothing between;
//! - `batches`: the same questions in the same order, in batches of 1024: what the backend can do;
//! - `drawn`: segments of the same scene, drawn as the benchmark `visibility` does, 16 between two random triangles that face each
//!   other, in batches of 1024; as first hits, rays along these segments.
//!
//! Solves and repetitions alternate, and medians are printed, because machines are not quiet. Before anything is timed, the
//! batches must give the answers of the calls.
#![allow(clippy::print_stdout, reason = "it prints its table")]

#[path = "support/facing.rs"]
mod facing;
#[path = "support/recorder.rs"]
mod recorder;
#[path = "../tests/support/triangles.rs"]
mod triangles;

use std::{
    env,
    hint::black_box,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::Instant,
};

use facing::facing_segments;
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, SolveReport};
use patchlight::visibility::{Backend, OccluderMesh, Ray, Segment, Visibility, build};
use recorder::{Call, Record, Recorder};

/// Questions in a batch.
const BATCH: usize = 1024;
/// Questions that are kept, about.
const KEPT: u64 = 1 << 20;
/// Segments that are drawn, and how many of them between two triangles.
const DRAWN: usize = 1 << 17;
const GROUP: usize = 16;
/// Solves and repetitions.
const ROUNDS: usize = 5;

/// Millions a second.
#[derive(Clone, Copy)]
struct Rates {
    solve: f64,
    calls: f64,
    batches: f64,
    drawn: f64,
}

/// All questions of one kind, and how many there are in each call.
struct Questions<Q> {
    all: Vec<Q>,
    calls: Vec<usize>,
}

impl<Q> Questions<Q> {
    fn of(calls: Vec<Vec<Q>>) -> Self {
        Self { calls: calls.iter().map(Vec::len).collect(), all: calls.into_iter().flatten().collect() }
    }

    /// Asks them call by call.
    fn by_calls<A>(&self, mut answers: &mut [A], ask: impl Fn(&[Q], &mut [A])) {
        let mut questions = &self.all[..];
        for &call in &self.calls {
            let (now, later) = questions.split_at(call);
            let (answers_now, answers_later) = std::mem::take(&mut answers).split_at_mut(call);
            ask(now, answers_now);
            (questions, answers) = (later, answers_later);
        }
    }

    /// Asks them in batches.
    fn by_batches<A>(&self, answers: &mut [A], ask: impl Fn(&[Q], &mut [A])) {
        self.all.chunks(BATCH).zip(answers.chunks_mut(BATCH)).for_each(|(questions, answers)| ask(questions, answers));
    }

    /// The rates of calls and batches; panics if their answers differ.
    fn rates<A: Clone + PartialEq>(&self, none: &A, ask: impl Fn(&[Q], &mut [A])) -> (f64, f64) {
        let (mut by_calls, mut by_batches) = (vec![none.clone(); self.all.len()], vec![none.clone(); self.all.len()]);
        let calls = seconds(|| self.by_calls(black_box(&mut by_calls), &ask));
        let batches = seconds(|| self.by_batches(black_box(&mut by_batches), &ask));
        assert!(by_calls == by_batches, "the answers depend on the batches");
        (1e-6 * self.all.len() as f64 / calls, 1e-6 * self.all.len() as f64 / batches)
    }
}

/// The rate at which drawn questions are answered.
fn drawn_rate<Q, A: Clone>(drawn: &[Q], none: &A, ask: impl Fn(&[Q], &mut [A])) -> f64 {
    let mut answers = vec![none.clone(); drawn.len()];
    let batches =
        || drawn.chunks(BATCH).zip(black_box(&mut answers).chunks_mut(BATCH)).for_each(|(now, answers)| ask(now, answers));
    1e-6 * drawn.len() as f64 / seconds(batches)
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Solves on one thread with a backend that is made for it.
fn solve(scene: &Scene, options: &SolveOptions, backend: &dyn Fn() -> Box<dyn Visibility>) -> SolveReport {
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    pipeline::solve_asking(backend(), scene.clone(), options, &run, &Silent).expect("options that are legal").1
}

/// What a solve asks; of long ones every so many calls.
fn record(
    scene: &Scene,
    options: &SolveOptions,
    backend: &dyn Fn() -> Box<dyn Visibility>,
    every: usize,
) -> (Questions<Segment>, Questions<Ray>) {
    let record = Arc::new(Mutex::new(Record::default()));
    solve(scene, options, &|| Box::new(Recorder { backend: backend(), every, record: Arc::clone(&record) }));
    let (mut occluded, mut first_hits) = (Vec::new(), Vec::new());
    for call in std::mem::take(&mut record.lock().expect("recorded without a panic").calls) {
        match call {
            Call::Occluded(segments) => occluded.push(segments),
            Call::FirstHits(rays) => first_hits.push(rays),
        }
    }
    (Questions::of(occluded), Questions::of(first_hits))
}

/// Segments as the benchmark of the backends draws them, and rays along these.
fn draw(scene: &Scene, mesh: &OccluderMesh) -> (Vec<Segment>, Vec<Ray>) {
    let has_two_sides = |triangle: usize| scene.surfaces()[mesh.surfaces[triangle] as usize].twin().is_some();
    let segments = facing_segments(mesh, DRAWN, GROUP, has_two_sides);
    let along = |segment: &Segment| {
        let direction = triangles::unit(triangles::sub(segment.to, segment.from));
        Ray { origin: segment.from, direction, origin_plane: segment.from_plane }
    };
    let rays = segments.iter().map(along).collect();
    (segments, rays)
}

fn measure(name: &str, scene: &Scene, error: f64) {
    let mesh = OccluderMesh::of_scene(scene);
    let backend = || build(Backend::Auto, &mesh).expect("a backend");
    let options = SolveOptions { error, ..SolveOptions::default() };
    let counts = solve(scene, &options, &backend).counts;
    let every = counts.rays.div_ceil(KEPT).max(1) as usize;
    let (segments, rays) = record(scene, &options, &backend, every);
    let (drawn_segments, drawn_rays) = draw(scene, &mesh);

    // Measure, round after round.
    let asked = backend();
    let mut rounds: Vec<[Rates; 2]> = Vec::new();
    for _ in 0..ROUNDS {
        let SolveReport { counts, time_s, .. } = solve(scene, &options, &backend);
        let (calls, batches) = segments.rates(&false, |segments, occluded| asked.occluded(segments, occluded));
        let rate = |count: u64, seconds: f64| 1e-6 * count as f64 / seconds;
        let solve = rate(counts.rays - counts.first_hit_rays, time_s.visibility - time_s.first_hits);
        let drawn = drawn_rate(&drawn_segments, &false, |segments, occluded| asked.occluded(segments, occluded));
        let of_segments = Rates { solve, calls, batches, drawn };
        let (calls, batches) = rays.rates(&None, |rays, hits| asked.first_hits(rays, hits));
        let drawn = drawn_rate(&drawn_rays, &None, |rays, hits| asked.first_hits(rays, hits));
        let of_first_hits = Rates { solve: rate(counts.first_hit_rays, time_s.first_hits), calls, batches, drawn };
        rounds.push([of_segments, of_first_hits]);
    }

    // Tell.
    let numbers = [counts.rays - counts.first_hit_rays, counts.first_hit_rays];
    let sizes = [segments.all.len() / segments.calls.len().max(1), rays.all.len() / rays.calls.len().max(1)];
    for (kind, what) in ["segments", "first hits"].into_iter().enumerate() {
        let of_kind: Vec<Rates> = rounds.iter().map(|round| round[kind]).collect();
        println!(
            "{name:>11} {error:>5} {what:<10} {:>9} a solve, {:>4} a call | {}",
            numbers[kind],
            sizes[kind],
            medians(&of_kind)
        );
    }
}

/// Medians over the rounds, in words.
fn medians(rounds: &[Rates]) -> String {
    let of = |rate: &dyn Fn(&Rates) -> f64| median(rounds.iter().map(rate).collect());
    format!(
        "solve {:>5.2}  calls {:>5.2}  batches {:>5.2}  drawn {:>5.2} | solve / batches {:.2}  / drawn {:.2}",
        of(&|r| r.solve),
        of(&|r| r.calls),
        of(&|r| r.batches),
        of(&|r| r.drawn),
        of(&|r| r.solve / r.batches),
        of(&|r| r.solve / r.drawn)
    )
}

fn main() {
    let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let runs = [("cornell.obj", 0.05), ("cornell.obj", 0.02), ("cornell.obj", 0.01), ("room.obj", 0.05), ("full_office.obj", 0.05)];
    let mut runs: Vec<(PathBuf, f64)> = runs.into_iter().map(|(file, error)| (ours.join(file), error)).collect();
    runs.extend(env::var_os("VISIBILITY_BENCH_SCENES").iter().flat_map(env::split_paths).map(|file| (file, 0.05)));
    for (file, error) in runs {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let scene = read_scene(&file, &ImportOptions::default()).expect("a scene that can be read").scene;
        measure(&name, &scene, error);
    }
}
