//! What a solve costs in counts that no machine changes: rays, links, elements, sweeps. A change that makes solves dearer, or cheaper, is seen here.
//!
//! The counts are kept in `tests/counters.json`. Where one of them moves by more than the leeway the test prints all that moved and
//! fails; if that is what the change is meant to do, `make counters` writes the file anew, and the difference belongs to the review.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{Holzschuch94Options, LinkOptions, RunOptions, SolveOptions, Solver, Strategy};
use patchlight::visibility::{Backend, Hit, OccluderMesh, Ray, Segment, Visibility, build};
use triangles::Random;

/// Counts by name, of one run.
type Counters = BTreeMap<String, u64>;

/// Rays in f32 may differ in their last bit from processor to processor, and with them what is refined; beyond this part a change is
/// meant, or a defect.
const LEEWAY: f64 = 0.03;

/// Small counts may differ by this.
const SLACK: u64 = 2;

/// Points at which values are taken.
const POINTS: usize = 300;

fn file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/counters.json")
}

/// A backend that counts what it is asked.
struct Counting {
    backend: Box<dyn Visibility>,
    segments: Arc<AtomicU64>,
    first_hits: Arc<AtomicU64>,
}

impl Visibility for Counting {
    fn description(&self) -> String {
        self.backend.description()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        self.segments.fetch_add(segments.len() as u64, Ordering::Relaxed);
        self.backend.occluded(segments, occluded);
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.first_hits.fetch_add(rays.len() as u64, Ordering::Relaxed);
        self.backend.first_hits(rays, hits);
    }
}

/// The runs that are watched: a few bright sources, many dim ones, both ways of gathering, clusters, a strategy of the papers.
fn runs() -> Vec<(&'static str, &'static str, SolveOptions)> {
    let error = |error| SolveOptions { error, ..SolveOptions::default() };
    vec![
        ("cornell to 5%", "cornell", error(0.05)),
        ("cornell to 2%", "cornell", error(0.02)),
        ("cornell to 5%, over cells", "cornell", SolveOptions { solver: Solver::Cells, ..error(0.05) }),
        ("full office to 10%", "full_office", error(0.1)),
        ("room to 10%", "room", error(0.1)),
        ("room to 20%, over links", "room", SolveOptions { solver: Solver::Links, ..error(0.2) }),
        (
            "full office, lazily with reduction",
            "full_office",
            SolveOptions {
                strategy: Strategy::Lazy94Reduction,
                links: LinkOptions {
                    tolerance: Some(2.0),
                    rays_per_link: 16,
                    rays_per_light_link: 16,
                    leaf_rays: Some(0),
                    ..LinkOptions::default()
                },
                holzschuch94: Holzschuch94Options { iterations: 4, ..Holzschuch94Options::default() },
                ..error(0.5)
            },
        ),
    ]
}

fn scene(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.obj"));
    read_scene(&file, &ImportOptions::default()).unwrap().scene
}

fn count(scene: Scene, options: &SolveOptions) -> Counters {
    let mesh = OccluderMesh::of_scene(&scene);
    let (segments, first_hits) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
    // The pure-Rust backend is the same in every build.
    let backend = build(Backend::Obvhs, &mesh).unwrap();
    let counting = Counting { backend, segments: segments.clone(), first_hits: first_hits.clone() };
    let points: Vec<SurfacePoint> = rooms::points_of(&scene, POINTS, &mut Random(1)).into_iter().map(|(point, _)| point).collect();
    let (evaluator, report) = pipeline::solve_asking(Box::new(counting), scene, options, &RunOptions::default(), &Silent).unwrap();
    let asked = || [&segments, &first_hits].map(|count| count.load(Ordering::Relaxed));
    let of_solve = asked();
    rooms::values(&evaluator, &points);
    let of_all = asked();

    let counts = report.counts;
    let counters = [
        ("clusters", counts.clusters),
        ("elements", counts.elements),
        ("links", counts.links),
        ("dormant pairs", counts.dormant),
        ("iterations", counts.iterations),
        ("rounds", counts.rounds),
        ("segments of the solve", of_solve[0]),
        ("first hits of the solve", of_solve[1]),
        ("segments of values", of_all[0] - of_solve[0]),
        ("first hits of values", of_all[1] - of_solve[1]),
        ("bytes of the solution", report.memory_bytes),
    ];
    counters.into_iter().map(|(name, count)| (name.to_owned(), count)).collect()
}

fn is_within_leeway(found: u64, kept: u64) -> bool {
    found.abs_diff(kept) <= SLACK.max((LEEWAY * kept as f64) as u64)
}

#[test]
fn solves_cost_what_they_did() {
    let found: BTreeMap<String, Counters> =
        runs().into_iter().map(|(name, file, options)| (name.to_owned(), count(scene(file), &options))).collect();
    if std::env::var_os("PATCHLIGHT_WRITE_COUNTERS").is_some() {
        std::fs::write(file(), serde_json::to_string_pretty(&found).unwrap() + "\n").unwrap();
        return;
    }

    let kept: BTreeMap<String, Counters> = serde_json::from_str(&std::fs::read_to_string(file()).unwrap()).unwrap();
    assert!(found.keys().eq(kept.keys()), "other runs than those in counters.json; make counters writes it");
    let mut moved = Vec::new();
    for (run, counters) in &found {
        assert!(counters.keys().eq(kept[run].keys()), "{run}: other counts than those in counters.json; make counters writes it");
        for (name, &now) in counters {
            let before = kept[run][name];
            if !is_within_leeway(now, before) {
                let percent = 100.0 * (now as f64 / before as f64 - 1.0);
                moved.push(format!("{run}: {name} {before} -> {now} ({percent:+.1}%)"));
            }
        }
    }
    moved.iter().for_each(|line| println!("{line}"));
    assert!(moved.is_empty(), "counts moved; if they are meant to, run `make counters` and commit the file:\n{}", moved.join("\n"));
}

#[test]
fn what_moves_beyond_the_leeway_is_told() {
    assert!(is_within_leeway(1029, 1000) && is_within_leeway(3, 1) && is_within_leeway(0, 0));
    assert!(!is_within_leeway(1031, 1000) && !is_within_leeway(969, 1000) && !is_within_leeway(4, 1));
}
