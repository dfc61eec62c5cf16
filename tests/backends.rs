//! Every visibility backend of this build is fed the same cases, beside answers that are known and beside the f64 reference.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print what they measure, and what they skip")]

#[path = "support/triangles.rs"]
mod triangles;

use patchlight::visibility::{Backend, Hit, NO_PLANE, OccluderMesh, Ray, Segment, Visibility, VisibilityError, build};
use triangles::{Random, add, placed, point_on, push_box, push_quad, push_sphere, push_triangle, segment, soup, sub, times};

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

    /// All backends must answer this surface and this distance to a relative 1e-9.
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

/// Half of the segments lie in the cube of half side 1, the rest reach out of it, some very far.
fn random_segments(random: &mut Random, count: usize, planes: usize) -> Vec<Segment> {
    (0..count)
        .map(|k| {
            let far = [1.0, 1.0, 3.0, 100.0][k % 4];
            let plane = |random: &mut Random| if random.below(4) == 0 { random.below(planes) as u32 } else { NO_PLANE };
            Segment { from: random.point(far), to: random.point(1.0), from_plane: plane(random), to_plane: plane(random) }
        })
        .collect()
}

#[test]
fn random_soups_agree_with_the_reference() {
    for (triangles, size, segments, at_most) in [(10, 1.0, 100_000, 3e-5), (1000, 0.15, 20_000, 1e-4), (20_000, 0.04, 2_000, 1e-3)]
    {
        let mut random = Random(triangles as u64);
        let mesh = soup(&mut random, triangles, size);
        let segments = random_segments(&mut random, segments, triangles);
        Runner::over(&mesh).compare(&format!("soup of {triangles}"), &segments, at_most);
    }
}

#[test]
fn slivers_agree_with_the_reference() {
    for width in [1e-2, 1e-4, 1e-5] {
        let mut random = Random(5);
        let mut mesh = OccluderMesh::default();
        for _ in 0..300 {
            let (corner, long) = (random.point(1.0), random.point(1.0));
            push_triangle(&mut mesh, [corner, add(corner, long), add(corner, random.point(width))]);
        }
        // Aimed into the slivers, where the answer hangs on their width.
        let segments: Vec<Segment> = (0..20_000)
            .map(|_| {
                let k = random.below(300);
                let (middle, half) = (point_on(&mesh, k, &mut random), random.direction());
                segment(add(middle, half), sub(middle, half))
            })
            .collect();
        // The parts of a sliver that f32 does not resolve: some 1e-7 of its width.
        Runner::over(&mesh).compare(&format!("slivers {width:e} wide"), &segments, 1e-6 / width + 1e-4);
    }
}

#[test]
fn scale_and_place_do_not_matter() {
    let mut random = Random(11);
    let mesh = soup(&mut random, 500, 0.3);
    let segments = random_segments(&mut random, 5_000, 500);
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for sizes in [0.0, 1.0, 1e3, 1e6] {
            let offset = times([1.0, -1.0, 0.7], sizes * scale);
            let place = |point: [f64; 3]| add(times(point, scale), offset);
            let segments: Vec<Segment> = segments.iter().map(|s| Segment { from: place(s.from), to: place(s.to), ..*s }).collect();
            Runner::over(&placed(&mesh, scale, offset)).compare(
                &format!("scale {scale:e}, offset {sizes:e} sizes"),
                &segments,
                4e-4,
            );
        }
    }
}

/// How many of `count` segments between points on the inside of a closed convex mesh each backend calls occluded. Every eighth
/// end is a vertex or lies on an edge.
fn false_occlusions(mesh: &OccluderMesh, count: usize, what: &str) {
    let mut random = Random(3);
    let end = |random: &mut Random| {
        let k = random.below(mesh.triangles.len());
        let [a, b, _] = mesh.triangles[k].map(|vertex| mesh.vertices[vertex as usize]);
        let along = random.unit();
        let point = match random.below(16) {
            0 => a,
            1 => std::array::from_fn(|axis| a[axis] + along * (b[axis] - a[axis])),
            _ => point_on(mesh, k, random),
        };
        (point, mesh.planes[k])
    };
    let segments: Vec<Segment> = (0..count)
        .map(|_| {
            let ((from, from_plane), (to, to_plane)) = (end(&mut random), end(&mut random));
            Segment { from, to, from_plane, to_plane }
        })
        .filter(|segment| segment.from != segment.to)
        .collect();
    let runner = Runner::over(mesh);
    for which in 0..runner.0.len() {
        let (backend, _) = &runner.0[which];
        if *backend == Backend::BruteForce && mesh.triangles.len() > 1000 {
            continue;
        }
        let wrong = runner.occluded(which, &segments).into_iter().filter(|&occluded| occluded).count();
        println!("{what}: {} calls {wrong} of {} segments occluded", backend.name(), segments.len());
        assert_eq!(wrong, 0, "{what}: {}", backend.name());
    }
}

#[test]
fn closed_spheres_and_boxes_do_not_hide_their_inside() {
    for scale in [1e-6, 1.0, 1e6] {
        for offset in [0.0, 1e3, 1e6] {
            let centre = [offset * scale, -0.3 * offset * scale, 0.9 * offset * scale];
            let mut sphere = OccluderMesh::default();
            push_sphere(&mut sphere, centre, scale, 40);
            false_occlusions(&sphere, 100_000, &format!("sphere of scale {scale:e} at {offset:e} sizes"));
            let mut room = OccluderMesh::default();
            push_box(&mut room, centre, add(centre, [4.0 * scale, 3.0 * scale, 2.5 * scale]), 0);
            false_occlusions(&room, 100_000, &format!("box of scale {scale:e} at {offset:e} sizes"));
        }
    }
}

#[test]
fn shared_edges_leak_rarely() {
    // From near the centre of a sphere outwards, exactly at points of its edges and at its vertices.
    for (offset, rings) in [(0.0, 12), (1e6, 12)] {
        let mut sphere = OccluderMesh::default();
        let centre = [offset, 0.3 * offset, -0.7 * offset];
        push_sphere(&mut sphere, centre, 1.0, rings);
        let mut random = Random(17);
        let segments: Vec<Segment> = (0..65_536)
            .map(|k| {
                let [a, b, _] = sphere.triangles[random.below(sphere.triangles.len())].map(|v| sphere.vertices[v as usize]);
                let along = if k % 8 == 0 { 0.0 } else { random.unit() };
                let aim: [f64; 3] = std::array::from_fn(|axis| a[axis] + along * (b[axis] - a[axis]));
                let from = add(centre, random.point(0.5));
                segment(from, add(from, times(sub(aim, from), 3.0)))
            })
            .collect();
        let runner = Runner::over(&sphere);
        for which in 0..runner.0.len() {
            let name = runner.0[which].0.name();
            let leaks = runner.occluded(which, &segments).into_iter().filter(|&occluded| !occluded).count();
            println!("offset {offset:e}: {name} lets {leaks} of {} rays through edges", segments.len());
            assert!(leaks <= 20, "{name}: {leaks}");
        }
    }
}

#[test]
fn first_hits_agree_with_the_reference() {
    let mut random = Random(23);
    let mesh = soup(&mut random, 1000, 0.15);
    let rays: Vec<Ray> = (0..20_000)
        .map(|k| {
            let origin = random.point([1.0, 1.0, 3.0, 100.0][k % 4]);
            let origin_plane = if k % 5 == 0 { random.below(1000) as u32 } else { NO_PLANE };
            Ray { origin, direction: sub(random.point(1.0), origin), origin_plane }
        })
        .collect();
    let runner = Runner::over(&mesh);
    let ask = |which: usize| {
        let mut hits = vec![None; rays.len()];
        runner.0[which].1.first_hits(&rays, &mut hits);
        hits
    };
    let reference = ask(0);
    for which in 1..runner.0.len() {
        let (mut different, mut farthest) = (0, 0.0_f64);
        for (hit, reference) in ask(which).iter().zip(&reference) {
            match (hit, reference) {
                (Some(hit), Some(reference)) if hit.surface == reference.surface => {
                    farthest = farthest.max((hit.distance / reference.distance - 1.0).abs());
                }
                (None, None) => {}
                _ => different += 1,
            }
        }
        let name = runner.0[which].0.name();
        println!("{name}: {different} of {} first hits differ, distances by {farthest:.1e}", rays.len());
        assert!(different <= 6, "{name}: {different} first hits differ");
        assert!(farthest < 1e-9, "{name}: distances differ by {farthest}");
    }
}

#[test]
fn threads_and_company_do_not_change_answers() {
    // Segments at edges, and half of them with an end as near to a triangle as f32 can tell, where an answer hangs on the last
    // bit.
    for rings in [12, 120] {
        let mut mesh = OccluderMesh::default();
        push_sphere(&mut mesh, [0.0; 3], 1.0, rings);
        let mut random = Random(29);
        let segments: Vec<Segment> = (0..20_000)
            .map(|k| {
                let [a, b, _] = mesh.triangles[random.below(mesh.triangles.len())].map(|v| mesh.vertices[v as usize]);
                let along = random.unit();
                let aim: [f64; 3] = std::array::from_fn(|axis| a[axis] + along * (b[axis] - a[axis]));
                let from = random.point(2.0);
                let beyond = if k % 2 == 0 { 1.5 } else { 1.0 + random.between(-2e-7, 2e-7) };
                segment(from, add(from, times(sub(aim, from), beyond)))
            })
            .collect();
        let runner = Runner::over(&mesh);
        for (backend, visibility) in &runner.0 {
            if *backend == Backend::BruteForce && rings > 20 {
                continue;
            }
            let mut together = vec![false; segments.len()];
            visibility.occluded(&segments, &mut together);

            // One by one, and in pieces on many threads, in another order.
            let mut alone = vec![false; segments.len()];
            for (segment, occluded) in segments.iter().zip(&mut alone) {
                visibility.occluded(std::slice::from_ref(segment), std::slice::from_mut(occluded));
            }
            assert_eq!(alone, together, "{}", backend.name());
            std::thread::scope(|scope| {
                for thread in 0..8 {
                    let (segments, together) = (&segments, &together);
                    scope.spawn(move || {
                        let stride = 2 * thread + 1;
                        let order: Vec<usize> = (0..segments.len()).map(|k| (k * stride + thread) % segments.len()).collect();
                        let shuffled: Vec<Segment> = order.iter().map(|&k| segments[k]).collect();
                        let mut occluded = vec![false; shuffled.len()];
                        for (segments, occluded) in shuffled.chunks(37).zip(occluded.chunks_mut(37)) {
                            visibility.occluded(segments, occluded);
                        }
                        for (&k, occluded) in order.iter().zip(occluded) {
                            assert_eq!(occluded, together[k], "{} on segment {k}", backend.name());
                        }
                    });
                }
            });
        }
    }
}
