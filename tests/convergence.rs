//! Solutions that are known: how fast elements and points approach them.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use fixtures::{solution_cases, solution_value, value};
use patchlight::scene::Scene;
use patchlight::scene::SurfacePoint;
use patchlight::solve::{LinkOptions, Norm, Solution, SolveOptions, Strategy, UniformOptions};
use rooms::{Room, icosphere, points_of, solve, straight, values, with_point_rays};
use triangles::Random;
use two_squares::TwoSquares;

/// Elements of side `h`, exact form factors, values as the links give them.
fn uniform(h: f64) -> SolveOptions {
    SolveOptions {
        strategy: Strategy::Uniform,
        error: 0.5,
        uniform: UniformOptions { element_area: Some(h * h) },
        links: LinkOptions { form_factor_accuracy: 0.0, leaf_rays: Some(0), sweep_tolerance: 1e-12, ..LinkOptions::default() },
        ..SolveOptions::default()
    }
}

fn case_name(blocker: bool) -> &'static str {
    if blocker { "two_squares_h1_blocker_rho0" } else { "two_squares_h1" }
}

/// The probes of the cases, `B1(x, y)` or `B2(x, y)`: square (0 or 1), place, value.
fn probes(blocker: bool) -> Vec<(usize, [f64; 2], f64)> {
    let cases = solution_cases();
    let of_point = cases.iter().filter(|case| case["name"] == case_name(blocker)).filter_map(|case| {
        let quantity = case["quantity"].as_str().unwrap();
        let (square, place) = quantity.strip_suffix(')')?.split_once('(')?;
        let (x, y) = place.split_once(", ")?;
        Some((usize::from(square == "B2"), [x.parse().unwrap(), y.parse().unwrap()], value(case)))
    });
    let probes: Vec<_> = of_point.collect();
    assert_eq!(probes.len(), 10);
    probes
}

fn place(square: usize, [x, y]: [f64; 2]) -> SurfacePoint {
    SurfacePoint { position: [x, y, square as f64], normal: [0.0, 0.0, 1.0 - 2.0 * square as f64] }
}

#[test]
fn the_independent_solution_has_the_reference_values() {
    for blocker in [false, true] {
        let exact = TwoSquares::new(blocker);
        // The reference values have 10 digits with the blocker and 12 without.
        let tolerance = if blocker { 2e-10 } else { 2e-11 };
        for (square, x, expected) in probes(blocker) {
            assert!((exact.at(square, x) - expected).abs() < tolerance, "{blocker} {square} {x:?}: {}", exact.at(square, x));
        }
        for square in 0..2 {
            let expected = solution_value(case_name(blocker), ["mean B1", "mean B2"][square]);
            assert!((exact.mean(square) - expected).abs() < tolerance);
        }
    }
}

/// What the leaves of the two squares get wrong, relative to the mean of what the upper square reflects: the root mean square of
/// the constant elements over both squares, the largest difference of an element's value from the exact mean over it, and the largest
/// from the exact value at a corner of it.
fn element_errors(solution: &Solution, exact: &TwoSquares) -> [f64; 3] {
    // Two Gauss points each way are as good as exact for the mean over an element, and good enough for the mean square.
    let gauss = [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()];
    let (mut sum, mut area, mut largest, mut largest_at_corner) = (0.0, 0.0, 0.0f64, 0.0f64);
    solution.for_each_leaf(|vertices, surface, radiosity| {
        if surface > 1 {
            return;
        }
        for corner in vertices {
            let truth = exact.at(surface as usize, [corner[0], corner[1]]);
            largest_at_corner = largest_at_corner.max((f64::from(radiosity[0]) - truth).abs());
        }
        let (a, c) = (vertices[0], vertices[2]);
        let mut mean = 0.0;
        for (s, t) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let x = [a[0] + gauss[s] * (c[0] - a[0]), a[1] + gauss[t] * (c[1] - a[1])];
            let truth = exact.at(surface as usize, x);
            mean += 0.25 * truth;
            sum += ((c[0] - a[0]) * (c[1] - a[1])).abs() * 0.25 * (f64::from(radiosity[0]) - truth).powi(2);
        }
        area += ((c[0] - a[0]) * (c[1] - a[1])).abs();
        largest = largest.max((f64::from(radiosity[0]) - mean).abs());
    });
    // All of both squares, but for rounding.
    assert!((area - 2.0).abs() < 1e-9);
    let scale = exact.mean(1);
    [(sum / area).sqrt() / scale, largest / scale, largest_at_corner / scale]
}

/// The slope of the least-squares line through `(ln h, ln error)`.
fn order(errors: &[(f64, f64)]) -> f64 {
    let points: Vec<(f64, f64)> = errors.iter().map(|(h, error)| (h.ln(), error.ln())).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}

#[test]
fn elements_converge_with_their_size() {
    for blocker in [false, true] {
        let exact = TwoSquares::new(blocker);
        let mut errors: [Vec<(f64, f64)>; 3] = Default::default();
        for h in [0.5, 0.25, 0.125, 0.0625] {
            // Enough rays that their noise stays below the size of the elements.
            let rays = if blocker { 256 } else { 1 };
            let mut options = uniform(h);
            options.links.rays_per_link = rays;
            options.links.rays_per_light_link = rays;
            let (evaluator, _) = solve(rooms::two_squares(blocker), &options);
            let [rms, sup, at_corner] = element_errors(evaluator.solution(), &exact);
            println!("blocker {blocker}, h {h}: rms {rms:.5}, largest of a mean {sup:.5}, at a corner {at_corner:.5}");
            errors.iter_mut().zip([rms, sup, at_corner]).for_each(|(errors, error)| errors.push((h, error)));
        }

        // At h = 1/2 the values of an element are as far apart as those of the square: its corner tells nothing about the order yet.
        let [mean_square, largest, at_corner] = &errors;
        let orders = [order(mean_square), order(largest), order(&at_corner[1..])];
        println!("blocker {blocker}: orders {orders:.3?}");
        // Constant elements are of first order, which the coarsest have not quite reached.
        assert!(orders.iter().all(|&order| order >= 0.9), "{orders:?} {errors:?}");
    }
}

#[test]
fn values_at_points_of_two_squares() {
    // With the blocker rays leave noise: spread evenly, less than the 0.5 / sqrt(2^17) = 1.4e-3 of independent ones. Without it what is
    // left is how B varies over elements.
    for (blocker, rays, tolerance) in [(false, 1024, 1e-4), (true, 1 << 17, 1e-3)] {
        let mut options = SolveOptions { point_rays: Some(64), ..uniform(0.125) };
        options.links.rays_per_link = 64;
        options.links.rays_per_light_link = 64;
        let (evaluator, _) = solve(rooms::two_squares(blocker), &options);
        let probes = probes(blocker);
        let points: Vec<SurfacePoint> = probes.iter().map(|(square, x, _)| place(*square, *x)).collect();
        for (value, (square, x, expected)) in values(&with_point_rays(&evaluator, rays), &points).into_iter().zip(&probes) {
            let mean = solution_value(case_name(blocker), ["mean B1", "mean B2"][*square]);
            let error = (value - expected).abs() / mean;
            println!(
                "blocker {blocker}, square {square} at {x:?}: {value:.7}, exact {expected:.7}, off by {error:.1e} of the mean"
            );
            assert!(error <= tolerance, "blocker {blocker}, square {square} at {x:?}: {value} instead of {expected}");
        }
    }
}

/// The cube of the case `cube6`: floor, ceiling, x0, x1, y0, y1, with one material each.
fn cube_of(reflectances: [f64; 6]) -> Scene {
    let mut room = Room::default();
    // Faces of a cuboid come as floor, ceiling, x0, x1, y0, y1.
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |room, face| {
        room.material(&[reflectances[face]], &[if face == 0 { 1.0 } else { 0.0 }])
    });
    room.scene()
}

#[test]
fn six_patches_solve_their_exact_system() {
    let scene = cube_of([0.2, 0.8, 0.5, 0.5, 0.3, 0.7]);
    let (evaluator, report) = solve(scene, &uniform(1.0));
    assert_eq!(report.counts.elements, 6);
    let solution = evaluator.solution();
    for (face, name) in [(0, "floor"), (1, "ceiling"), (2, "x0"), (3, "x1"), (5, "y1")] {
        let expected = solution_value(&format!("cube6_B_{name}"), &format!("patch-constant B_{name}"));
        let node = solution.hierarchy().node_of(patchlight::scene::SurfaceId(face));
        let found = solution.radiosity().of(node)[0];
        // Exact form factors are good to 1e-10.
        assert!((found / expected - 1.0).abs() < 1e-10, "{name}: {found} instead of {expected}");
    }
}

#[test]
fn two_patches_solve_their_exact_system() {
    let expected = solution_value("two_squares_patch_constant_B1", "patch-constant B1");
    let (evaluator, _) = solve(rooms::two_squares(false), &uniform(1.0));
    let solution = evaluator.solution();
    let found = solution.radiosity().of(solution.hierarchy().node_of(patchlight::scene::SurfaceId(0)))[0];
    // Exact form factors are good to 1e-10.
    assert!((found / expected - 1.0).abs() < 1e-10, "{found} instead of {expected}");
}

/// The points of the case of the cube whose floor emits: name, place, normal.
const CUBE_POINTS: [(&str, [f64; 3], [f64; 3]); 9] = [
    ("B_floor(.5,.5)", [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]),
    ("B_floor(.1,.5)", [0.1, 0.5, 0.0], [0.0, 0.0, 1.0]),
    ("B_floor(.1,.1)", [0.1, 0.1, 0.0], [0.0, 0.0, 1.0]),
    ("B_ceiling(.5,.5)", [0.5, 0.5, 1.0], [0.0, 0.0, -1.0]),
    ("B_ceiling(.1,.1)", [0.1, 0.1, 1.0], [0.0, 0.0, -1.0]),
    ("B_wall(mid,.5)", [0.0, 0.5, 0.5], [1.0, 0.0, 0.0]),
    ("B_wall(mid,z=.1)", [0.0, 0.5, 0.1], [1.0, 0.0, 0.0]),
    ("B_wall(mid,z=.9)", [0.0, 0.5, 0.9], [1.0, 0.0, 0.0]),
    ("B_wall(.1 along,z=.1)", [0.0, 0.1, 0.1], [1.0, 0.0, 0.0]),
];

#[test]
fn values_at_points_of_a_cube_whose_floor_emits() {
    let case = "unit_cube_floor_emits_rho0.5";
    let points: Vec<SurfacePoint> =
        CUBE_POINTS.iter().map(|(_, position, normal)| SurfacePoint { position: *position, normal: *normal }).collect();
    let mut errors = Vec::new();
    for h in [0.5, 0.25, 0.125] {
        // Radiosity varies over elements: rays find how it does, and few would leave noise.
        let (evaluator, _) = solve(cube_of([0.5; 6]), &SolveOptions { point_rays: Some(1 << 13), ..uniform(h) });
        let values = values(&evaluator, &points);
        let mut largest = 0.0f64;
        for (value, (quantity, ..)) in values.iter().zip(&CUBE_POINTS) {
            let expected = solution_value(case, quantity);
            println!("h {h}: {quantity} is {value:.6}, exact {expected}, off by {:+.1e}", value - expected);
            largest = largest.max((value - expected).abs());
        }
        for (face, quantity) in [(0, "mean floor"), (1, "mean ceiling"), (2, "mean wall")] {
            let solution = evaluator.solution();
            let mean = solution.radiosity().of(solution.hierarchy().node_of(patchlight::scene::SurfaceId(face)))[0];
            println!("h {h}: {quantity} is {mean:.6}, exact {}", solution_value(case, quantity));
        }
        errors.push((h, largest));
    }
    println!("{errors:?}, order {:.2}", order(&errors));
    // First order at least; at 1/8 the noise of the rays and the digits of the reference are well below 1e-3.
    assert!(order(&errors) >= 0.9, "{errors:?}");
    assert!(errors[2].1 <= 1e-3, "{errors:?}");
}

/// Similar polyhedra about one centre, the inner convex and seen from outside: as for spheres, `F_12 = 1` and `F_21 = A_1 / A_2`, which is
/// the square of the ratio of sizes. B differs a little between faces, so the closed form holds for spheres only up to the second order of that
/// difference.
#[test]
fn concentric_spheres() {
    let mut room = Room::default();
    let (inner, outer) = (room.material(&[0.5], &[1.0]), room.material(&[0.7], &[0.0]));
    for triangle in icosphere(0.5, 1) {
        room.face(&triangle, inner);
    }
    for [a, b, c] in icosphere(1.0, 1) {
        room.face(&[a, c, b], outer);
    }
    let scene = room.scene();
    assert_eq!(scene.surfaces().len(), 160);
    let mut options = uniform(1.0);
    options.links.rays_per_light_link = 64;
    options.links.rays_per_link = 64;
    let (evaluator, _) = solve(scene, &options);

    let (mut sum, mut area, mut low, mut high) = ([0.0; 2], [0.0; 2], [f64::INFINITY; 2], [0.0f64; 2]);
    let solution = evaluator.solution();
    for node in solution.hierarchy().ids().filter(|&node| solution.hierarchy().is_leaf(node)) {
        let sphere = usize::from(solution.hierarchy().surface_of(node).unwrap().0 >= 80);
        let b = solution.radiosity().of(node)[0];
        sum[sphere] += solution.hierarchy().area(node) * b;
        area[sphere] += solution.hierarchy().area(node);
        (low[sphere], high[sphere]) = (low[sphere].min(b), high[sphere].max(b));
    }
    for (sphere, name) in ["inner", "outer"].into_iter().enumerate() {
        let expected = solution_value(&format!("concentric_spheres_B_{name}"), &format!("B_{name}"));
        let mean = sum[sphere] / area[sphere];
        println!("{name}: mean {mean:.6}, from {:.5} to {:.5}, exact {expected:.6}", low[sphere], high[sphere]);
        // B differs by up to 0.5% between faces, and 64 rays a link leave noise.
        assert!((mean / expected - 1.0).abs() < 1e-3, "{name}: {mean} instead of {expected}");
    }
}

/// What a default run claims by energy covers the truth at points of both squares, near shadows' edges too. Nor does it take many rays to know
/// that: looks aim at the lower square. Rays over the hemisphere alone, of which few meet it, take 8 million on average at 1%.
#[test]
fn default_runs_reach_what_was_asked() {
    let seeds = 4;
    let mut rays = 0;
    for (blocker, requested, seed) in
        [(false, 0.02, 0), (true, 0.02, 0), (false, 0.01, 0)].into_iter().chain((0..seeds).map(|seed| (true, 0.01, seed)))
    {
        let exact = TwoSquares::new(blocker);
        let scene = rooms::two_squares(blocker);
        let options = SolveOptions { error: requested, norm: Norm::Energy, seed, ..SolveOptions::default() };
        let (evaluator, report) = solve(scene.clone(), &options);
        let points: Vec<_> = points_of(&scene, 2000, &mut Random(3)).into_iter().filter(|(_, surface)| *surface < 2).collect();
        let places: Vec<_> = points.iter().map(|(point, _)| *point).collect();
        let values = values(&evaluator, &places);
        let square_error = |(value, (point, surface)): (&f64, &(SurfacePoint, usize))| {
            (value - exact.at(*surface, [point.position[0], point.position[1]])).powi(2)
        };
        let mean_sq = values.iter().zip(&points).map(square_error).sum::<f64>() / points.len() as f64;
        let error = (2.0 * mean_sq / exact.reflected_norm_sq()).sqrt();
        println!(
            "blocker {blocker}, requested {requested}: error {error:.5}, claimed {:.5}, {} rays, {:?}",
            report.error.estimate, report.counts.rays, report.time_s
        );
        assert!(report.converged && error <= report.error.estimate, "blocker {blocker}: {error}, {report:?}");
        rays += if blocker && requested == 0.01 { report.counts.rays } else { 0 };
    }
    assert!(rays <= seeds * 6_000_000, "{rays} rays");
}
