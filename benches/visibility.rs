//! How many segments a second does each backend answer, on one thread and on two, and how long does it take to build?
//!
//! `cargo bench --bench visibility` measures scenes of 1.6k and 200k triangles; with `VISIBILITY_BENCH_LARGE=1` also one of 2M. A
//! scene is a room with tessellated spheres. Segments run between triangles that face each other: `grouped`, 16 between two
//! random triangles, as hierarchical radiosity asks them, or `random`, each between two triangles of its own. Throughput is in
//! segments. `camera` are first hits of the rays through pixels, asked as any rays are, and as coherent ones.
//!
//! Before anything is timed, all backends must agree on the segments, and on the small scene with the f64 reference.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

#[path = "support/facing.rs"]
mod facing;
#[path = "../tests/support/triangles.rs"]
mod triangles;

use std::{env, hint::black_box, time::Duration};

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use facing::facing_segments;
use patchlight::visibility::{Backend, NO_PLANE, OccluderMesh, Ray, Segment, Visibility, build};
use rayon::{ThreadPool, ThreadPoolBuilder, prelude::*};
use triangles::{Random, push_box, push_sphere};

/// Segments per scene and kind.
const SEGMENTS: usize = 1 << 15;
/// Segments between two patches.
const GROUP: usize = 16;
/// Segments that a thread takes at once.
const CHUNK: usize = 1024;
/// Segments near edges on which f32 backends may differ.
const DISAGREEMENT: f64 = 1e-3;

fn scene(spheres: usize, rings: u32) -> OccluderMesh {
    let mut random = Random(1);
    let mut mesh = OccluderMesh::default();
    push_box(&mut mesh, [-5.0, -4.0, -1.5], [5.0, 4.0, 1.5], 0);
    // The six walls keep the numbers 0 to 5, spheres count on from the triangles: no number is used twice.
    for _ in 0..spheres {
        let centre = [random.between(-4.5, 4.5), random.between(-3.5, 3.5), random.between(-1.1, 1.1)];
        push_sphere(&mut mesh, centre, 0.35, rings);
    }
    mesh
}

fn ask(pool: &ThreadPool, visibility: &dyn Visibility, segments: &[Segment], occluded: &mut [bool]) {
    if pool.current_num_threads() == 1 {
        for (segments, occluded) in segments.chunks(CHUNK).zip(occluded.chunks_mut(CHUNK)) {
            visibility.occluded(segments, occluded);
        }
    } else {
        pool.install(|| {
            segments
                .par_chunks(CHUNK)
                .zip(occluded.par_chunks_mut(CHUNK))
                .for_each(|(segments, occluded)| visibility.occluded(segments, occluded));
        });
    }
}

fn differences(a: &[bool], b: &[bool]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

fn short<'a>(criterion: &'a mut Criterion, name: String) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group
}

fn visibility(criterion: &mut Criterion) {
    let mut scenes = vec![("1.6k", scene(7, 8)), ("200k", scene(28, 43))];
    if env::var_os("VISIBILITY_BENCH_LARGE").is_some() {
        scenes.push(("2M", scene(28, 134)));
    }
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool"));
    let backends: Vec<Backend> = Backend::ALL
        .into_iter()
        .filter(|&backend| backend.is_built() && !matches!(backend, Backend::Auto | Backend::BruteForce))
        .collect();

    for (size, mesh) in &scenes {
        let built: Vec<Box<dyn Visibility>> = backends.iter().map(|&backend| build(backend, mesh).expect("a backend")).collect();

        for (kind, count) in [("grouped", GROUP), ("random", 1)] {
            // The walls are seen from both sides; the spheres from outside.
            let segments = facing_segments(mesh, SEGMENTS, count, |triangle| triangle < 12);
            let mut occluded = vec![false; segments.len()];
            let mut reference = vec![false; segments.len()];

            // All must agree with the first, and the first with brute force.
            built[0].occluded(&segments, &mut reference);
            for (backend, visibility) in backends.iter().zip(&built) {
                visibility.occluded(&segments, &mut occluded);
                let different = differences(&occluded, &reference);
                assert!(different as f64 <= DISAGREEMENT * segments.len() as f64, "{backend:?} differs on {different}");
            }
            if *size == "1.6k" {
                let brute = build(Backend::BruteForce, mesh).expect("brute force");
                brute.occluded(&segments[..4096], &mut occluded[..4096]);
                let different = differences(&occluded[..4096], &reference[..4096]);
                assert!(different <= 4, "{} differs from brute force on {different}", built[0].description());
            }

            for pool in &pools {
                let threads = pool.current_num_threads();
                let mut group = short(criterion, format!("visibility/{size}/{kind}/{threads}"));
                group.throughput(Throughput::Elements(segments.len() as u64));
                for (backend, visibility) in backends.iter().zip(&built) {
                    group.bench_function(backend.name(), |bencher| {
                        bencher.iter(|| ask(pool, &**visibility, black_box(&segments), &mut occluded));
                    });
                }
                group.finish();
            }
        }

        cameras(criterion, &format!("visibility/{size}/camera"), &backends, &built);
        drop(built);
        let mut group = short(criterion, format!("visibility/{size}/build"));
        group.throughput(Throughput::Elements(mesh.triangles.len() as u64));
        for &backend in &backends {
            group.bench_function(backend.name(), |bencher| bencher.iter(|| build(backend, black_box(mesh)).expect("a backend")));
        }
        group.finish();
    }
}

/// First hits of rays from the middle, through pixels as those of a picture 960 pixels wide, on one thread.
fn cameras(criterion: &mut Criterion, name: &str, backends: &[Backend], built: &[Box<dyn Visibility>]) {
    let through = |pixel: usize| {
        let [x, y] = [pixel % 960, pixel / 960].map(|at| at as f64 / 480.0 - 1.0);
        Ray { origin: [0.0; 3], direction: [1.0, x, y], origin_plane: NO_PLANE }
    };
    let rays: Vec<Ray> = (0..64 * 960).map(through).collect();
    let mut hits = vec![None; rays.len()];
    let mut group = short(criterion, name.to_owned());
    group.throughput(Throughput::Elements(rays.len() as u64));
    for (backend, visibility) in backends.iter().zip(built) {
        group.bench_function(format!("{}/any", backend.name()), |bencher| {
            bencher.iter(|| visibility.first_hits(black_box(&rays), &mut hits));
        });
        group.bench_function(format!("{}/coherent", backend.name()), |bencher| {
            bencher.iter(|| visibility.coherent_first_hits(black_box(&rays), &mut hits));
        });
    }
    group.finish();
}

criterion_group!(benches, visibility);
criterion_main!(benches);
