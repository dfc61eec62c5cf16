//! Every visibility backend of this build is fed the same cases, beside answers that are known and beside the f64 reference.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print what they measure, and what they skip")]

mod agreement;
#[path = "../support/triangles.rs"]
mod triangles;

use patchlight::visibility::{Backend, Hit, NO_PLANE, OccluderMesh, Ray, Segment, Visibility, VisibilityError, build};
use triangles::{push_quad, push_triangle, segment};

/// All backends over one mesh; the reference is the first.
struct Runner(Vec<(Backend, Box<dyn Visibility>)>);

impl Runner {
    fn over(mesh: &OccluderMesh) -> Self {
        let named = Backend::ALL.into_iter().filter(|&backend| backend != Backend::Auto && backend.is_built());
        let mut backends: Vec<_> = named
            .map(|backend| (backend, build(backend, mesh).unwrap_or_else(|error| panic!("{}: {error}", backend.name()))))
            .collect();
        backends.sort_by_key(|(backend, _)| *backend != Backend::BruteForce);
        Self(backends)
    }

    /// All backends must answer `expected`, in both directions.
    fn expect_occluded(&self, expected: bool, segment: Segment) {
        let back = Segment { from: segment.to, to: segment.from, from_plane: segment.to_plane, to_plane: segment.from_plane };
        for (backend, visibility) in &self.0 {
            let mut occluded = [!expected; 2];
            visibility.occluded(&[segment, back], &mut occluded);
            assert_eq!(occluded, [expected; 2], "{} on {segment:?} and back", backend.name());
        }
    }

    /// All backends must answer this surface and this distance: to a relative 1e-9, as it is that of the triangle's plane in f64.
    fn expect_hit(&self, expected: Option<(u32, f64)>, ray: Ray) {
        for (backend, visibility) in &self.0 {
            let mut hits = [Some(Hit { surface: 12345, distance: -1.0 })];
            visibility.first_hits(&[ray], &mut hits);
            let name = backend.name();
            match (expected, hits[0]) {
                (None, None) => {}
                (Some((surface, distance)), Some(hit)) => {
                    assert_eq!(hit.surface, surface, "{name} on {ray:?}: {hit:?}");
                    assert!((hit.distance / distance - 1.0).abs() < 1e-9, "{name} on {ray:?}: {hit:?} instead of {distance}");
                }
                (expected, hit) => panic!("{name} on {ray:?}: {hit:?} instead of {expected:?}"),
            }
        }
    }

    fn occluded(&self, which: usize, segments: &[Segment]) -> Vec<bool> {
        let mut occluded = vec![false; segments.len()];
        self.0[which].1.occluded(segments, &mut occluded);
        occluded
    }

    /// Prints how many answers differ from the reference, and demands that it is at most the given part of each backend's
    /// answers.
    fn compare(&self, what: &str, segments: &[Segment], at_most: f64) {
        let reference = self.occluded(0, segments);
        let blocked = reference.iter().filter(|&&occluded| occluded).count();
        for which in 1..self.0.len() {
            let answers = self.occluded(which, segments);
            let wrong = answers.iter().zip(&reference).filter(|(answer, reference)| answer != reference).count();
            let name = self.0[which].0.name();
            println!("{what}: {name} differs on {wrong} of {} segments, {blocked} of them occluded", segments.len());
            assert!(wrong as f64 <= at_most * segments.len() as f64, "{what}: {name} differs on {wrong} of {}", segments.len());
        }
    }
}

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray { origin, direction, origin_plane: NO_PLANE }
}

/// A wall in the plane x = 0 over [-1, 1]^2 with a hole over [-0.25, 0.25]^2: four surfaces of plane 7.
fn wall_with_a_hole() -> OccluderMesh {
    let mut mesh = OccluderMesh::default();
    let mut piece = |low: [f64; 2], high: [f64; 2], surface: u32| {
        let (u, v) = ([0.0, high[0] - low[0], 0.0], [0.0, 0.0, high[1] - low[1]]);
        push_quad(&mut mesh, [0.0, low[0], low[1]], u, v, surface, 7);
    };
    piece([-1.0, -1.0], [1.0, -0.25], 0);
    piece([-1.0, 0.25], [1.0, 1.0], 1);
    piece([-1.0, -0.25], [-0.25, 0.25], 2);
    piece([0.25, -0.25], [1.0, 0.25], 3);
    mesh
}

/// On Debian 12, where Embree 3 is part of the documented set-up, and on a Debian 13 that has Embree 4.
#[test]
fn debian_answers_by_its_embree() {
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let debian = |version: &str| {
        let has = |line: String| release.lines().any(|found| found.replace('"', "") == line);
        has("ID=debian".to_owned()) && has(format!("VERSION_ID={version}"))
    };
    let expected = if debian("12") {
        "embree 3."
    } else if debian("13") && std::path::Path::new("/usr/include/embree4/rtcore.h").exists() {
        "embree 4."
    } else {
        eprintln!("skipped: this is neither Debian 12 nor a Debian 13 with libembree-dev");
        return;
    };
    if !cfg!(feature = "embree") {
        eprintln!("skipped: built without the feature embree");
        return;
    }
    let auto = build(Backend::Auto, &wall_with_a_hole()).unwrap();
    assert!(auto.description().starts_with(expected), "answered by {}, not by {expected}x", auto.description());
}

#[test]
fn backends_say_who_they_are() {
    for (backend, visibility) in Runner::over(&wall_with_a_hole()).0 {
        println!("{}: {}", backend.name(), visibility.description());
        let word = backend.name().split('-').next().unwrap();
        assert!(visibility.description().starts_with(word), "{} calls itself {}", backend.name(), visibility.description());
    }
}

#[test]
fn wall_blocks_and_hole_does_not() {
    let runner = Runner::over(&wall_with_a_hole());
    for i in -12..=12 {
        for k in -12..=12 {
            // Never on an edge, nor on the diagonal of a quad.
            let (y, z) = (f64::from(i) * 0.1 + 0.003, f64::from(k) * 0.1 + 0.0017);
            let in_wall = y.abs() < 1.0 && z.abs() < 1.0 && !(y.abs() < 0.25 && z.abs() < 0.25);
            runner.expect_occluded(in_wall, segment([-1.0, y, z], [1.0, y, z]));
            // Slanted, through the same point.
            runner.expect_occluded(in_wall, segment([-0.5, y + 1.0, z - 2.0], [0.5, y - 1.0, z + 2.0]));
            // On one side only.
            runner.expect_occluded(false, segment([0.001, y, z], [1.0, y, z]));
            runner.expect_occluded(false, segment([-1.0, y, z], [-0.001, y, z]));
        }
    }
}

#[test]
fn ends_that_touch_are_not_blocked() {
    let runner = Runner::over(&wall_with_a_hole());
    for (y, z) in [(0.5, 0.5), (0.5, 0.0), (-0.9, 0.3)] {
        // From steep to grazing.
        for slope in [0.0, 1.0, 1e3, 1e6] {
            let far = [1.0, y + slope, z];
            runner.expect_occluded(false, segment([0.0, y, z], far));
            // Behind the wall by a part of its size that f32 resolves: blocked.
            if slope < 1e3 {
                runner.expect_occluded(true, segment([-1e-6, y, z], far));
            }
        }
    }
}

#[test]
fn segments_in_and_along_the_plane_are_free() {
    let runner = Runner::over(&wall_with_a_hole());
    runner.expect_occluded(false, segment([0.0, -2.0, 0.6], [0.0, 2.0, 0.6]));
    runner.expect_occluded(false, segment([0.0, 0.3, 0.6], [0.0, 0.9, -0.6]));
    runner.expect_occluded(false, segment([1e-6, -2.0, 0.6], [1e-6, 2.0, 0.6]));
}

#[test]
fn planes_of_the_ends_are_ignored() {
    let mut mesh = wall_with_a_hole();
    push_quad(&mut mesh, [0.5, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], 4, 8);
    let runner = Runner::over(&mesh);
    let (from, to) = ([-1.0, 0.5, 0.5], [1.0, 0.6, 0.6]);
    let ask = |from_plane, to_plane| Segment { from, to, from_plane, to_plane };
    runner.expect_occluded(true, ask(NO_PLANE, NO_PLANE));
    runner.expect_occluded(true, ask(7, NO_PLANE));
    runner.expect_occluded(true, ask(NO_PLANE, 8));
    runner.expect_occluded(true, ask(7, 7));
    runner.expect_occluded(false, ask(7, 8));
    runner.expect_hit(Some((4, 1.5)), Ray { origin: from, direction: [1.0, 0.0, 0.0], origin_plane: 7 });
}

#[test]
fn close_gaps_are_seen() {
    // A plate over a floor, by a part of the size that f32 resolves well.
    for height in [1e-2, 1e-4, 1e-5, 2e-6] {
        let mut mesh = OccluderMesh::default();
        push_quad(&mut mesh, [-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], 0, 0);
        push_quad(&mut mesh, [-0.5, -0.5, height], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1, 1);
        let runner = Runner::over(&mesh);
        let ask = |x: f64, to: [f64; 3]| Segment { from: [x, 0.1, 0.0], to, from_plane: 0, to_plane: NO_PLANE };
        runner.expect_occluded(true, ask(0.2, [0.3, 0.2, 1.0]));
        runner.expect_occluded(false, ask(0.7, [0.8, 0.2, 1.0]));
        runner.expect_hit(Some((1, height)), Ray { origin: [0.2, 0.1, 0.0], direction: [0.0, 0.0, 1.0], origin_plane: 0 });
    }
}

#[test]
fn first_hits_tell_surface_and_distance() {
    let mut mesh = wall_with_a_hole();
    push_quad(&mut mesh, [2.0, -4.0, -4.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0], 9, 8);
    let runner = Runner::over(&mesh);
    // Through the wall or the hole, with directions of any length, from near, from inside, from far away, and from behind.
    runner.expect_hit(Some((1, 3.0)), ray([-3.0, 0.1, 0.5], [1.0, 0.0, 0.0]));
    runner.expect_hit(Some((1, 3e150)), ray([-3.0, 0.1, 0.5], [1e-150, 0.0, 0.0]));
    runner.expect_hit(Some((9, 5e-150)), ray([-3.0, 0.1, 0.05], [1e150, 0.0, 0.0]));
    runner.expect_hit(Some((0, 0.25)), ray([0.5, 0.1, -0.5], [-2.0, 0.0, 0.0]));
    runner.expect_hit(Some((9, 0.75)), ray([0.5, 0.1, -0.5], [2.0, 0.1, 0.1]));
    runner.expect_hit(Some((9, 3e4)), ray([30002.0, 0.3, -0.7], [-1.0, 0.0, 0.0]));
    runner.expect_hit(Some((9, 2e6)), ray([2_000_002.0, 0.3, -0.7], [-1.0, 0.0, 0.0]));
    runner.expect_hit(None, ray([30002.0, 0.3, -0.7], [1.0, 0.0, 0.0]));
    runner.expect_hit(None, ray([30002.0, 0.3, -0.7], [0.0, 1.0, 0.0]));
    runner.expect_hit(None, ray([-3.0, 5.0, 0.5], [1.0, 0.0, 0.0]));
    // A ray that starts on a surface does not hit it.
    runner.expect_hit(Some((9, 2.0)), ray([0.0, 0.5, 0.5], [1.0, 0.0, 0.0]));
    runner.expect_hit(None, ray([0.0, 0.5, 0.5], [-1.0, 0.0, 0.0]));
}

#[test]
fn what_is_not_finite_is_answered_before_the_backend() {
    let runner = Runner::over(&wall_with_a_hole());
    let good = segment([1.0, 0.5, 0.5], [2.0, 0.5, 0.5]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        for axis in 0..3 {
            let mut broken = good;
            broken.from[axis] = bad;
            if bad.is_finite() {
                // So long that its way overflows.
                broken.to[axis] = -bad;
            }
            runner.expect_occluded(true, broken);

            let mut broken = ray([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
            if !bad.is_finite() {
                broken.origin[axis] = bad;
                runner.expect_hit(None, broken);
                let mut broken = ray([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
                broken.direction[axis] = bad;
                runner.expect_hit(None, broken);
            }
        }
    }
    runner.expect_occluded(true, segment([1.0, 0.5, 0.5], [1.0, 0.5, 0.5]));
    runner.expect_hit(None, ray([-1.0, 0.5, 0.5], [0.0, -0.0, 0.0]));

    // Good ones in bad company keep their answers.
    let bad = segment([f64::NAN; 3], [0.0; 3]);
    let segments: Vec<Segment> = (0..1000).map(|k| if k % 3 == 1 { bad } else { good }).collect();
    for which in 0..runner.0.len() {
        let expected: Vec<bool> = (0..1000).map(|k| k % 3 == 1).collect();
        assert_eq!(runner.occluded(which, &segments), expected, "{}", runner.0[which].0.name());
    }
}

#[test]
fn empty_mesh_hides_nothing() {
    let lonely = OccluderMesh { vertices: vec![[1.0, 2.0, 3.0]], ..OccluderMesh::default() };
    for mesh in [OccluderMesh::default(), lonely] {
        let runner = Runner::over(&mesh);
        runner.expect_occluded(false, segment([0.0; 3], [1.0, 2.0, 3.0]));
        runner.expect_occluded(false, segment([-1e9; 3], [1e9, 2.0, 3.0]));
        runner.expect_occluded(true, segment([0.0, f64::NAN, 0.0], [1.0, 2.0, 3.0]));
        runner.expect_occluded(true, segment([1.0; 3], [1.0; 3]));
        runner.expect_hit(None, ray([0.0; 3], [1.0, 2.0, 3.0]));
    }
}

#[test]
fn inconsistent_meshes_are_refused() {
    let good = wall_with_a_hole();
    let mut cases = vec![good.clone(); 6];
    cases[0].vertices[3][1] = f64::NAN;
    cases[1].vertices[3][1] = f64::INFINITY;
    cases[2].triangles[5][2] = good.vertices.len() as u32;
    cases[3].planes.pop();
    cases[4].surfaces.push(3);
    cases[5].planes[2] = NO_PLANE;
    for mesh in cases {
        for backend in Backend::ALL.into_iter().filter(|backend| backend.is_built()) {
            assert!(matches!(build(backend, &mesh), Err(VisibilityError::BadMesh(_))), "{}", backend.name());
        }
    }
}

#[test]
fn one_triangle() {
    let mut mesh = OccluderMesh::default();
    push_triangle(&mut mesh, [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    let runner = Runner::over(&mesh);
    runner.expect_occluded(true, segment([0.2, 0.2, 0.0], [0.2, 0.2, 2.0]));
    runner.expect_occluded(false, segment([0.6, 0.6, 0.0], [0.6, 0.6, 2.0]));
    runner.expect_occluded(false, segment([0.2, 0.2, 1.5], [0.2, 0.2, 2.0]));
    runner.expect_hit(Some((0, 1.0)), ray([0.2, 0.2, 0.0], [0.0, 0.0, 1.0]));
    runner.expect_hit(Some((0, 1.0)), ray([0.2, 0.2, 2.0], [0.0, 0.0, -1.0]));
}

#[test]
fn degenerate_triangles_hide_nothing() {
    let mut mesh = OccluderMesh::default();
    push_triangle(&mut mesh, [[0.0, 0.0, 0.0]; 3]);
    push_triangle(&mut mesh, [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    push_triangle(&mut mesh, [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let runner = Runner::over(&mesh);
    for x in [-0.5, 0.0, 0.3] {
        runner.expect_occluded(false, segment([x, -1.0, -1.0], [x, 1.0, 1.0]));
        runner.expect_hit(None, ray([x, -1.0, -1.0], [0.0, 1.0, 1.0]));
    }
}

#[test]
fn duplicates_hide_like_one() {
    let mut mesh = OccluderMesh::default();
    for _ in 0..100 {
        push_triangle(&mut mesh, [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    }
    mesh.surfaces.fill(3);
    let runner = Runner::over(&mesh);
    runner.expect_occluded(true, segment([0.2, 0.2, 0.0], [0.2, 0.2, 2.0]));
    runner.expect_occluded(false, segment([0.6, 0.6, 0.0], [0.6, 0.6, 2.0]));
    runner.expect_hit(Some((3, 2.0)), ray([0.2, 0.2, 0.0], [0.0, 0.0, 0.5]));
}
