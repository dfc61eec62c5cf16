//! Elements along discontinuities (Lischinski 1994, section 4.2): they cover their surfaces, no contact runs through one, and their light converges where
//! that of regular elements does not.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;
#[path = "support/two_squares.rs"]
mod two_squares;

use std::path::Path;

use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::discontinuities::{Degree, of_emitters};
use patchlight::geometry::Polygon;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{LinkOptions, Solution, SolveOptions, Solver, Strategy, Subdivision, UniformOptions};
use patchlight::visibility::{Backend, OccluderMesh, build};
use rooms::{crowded, solve};
use triangles::{Random, add, cross, dot, sub, times, unit};
use two_squares::TwoSquares;

const FLOOR: SurfaceId = SurfaceId(0);

fn pyramid() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/pyramid.obj");
    read_scene(&file, &ImportOptions::default()).unwrap().scene
}

/// Elements of at most this area, as links make them.
fn uniform(subdivision: Subdivision, element_area: f64, rays: u32) -> SolveOptions {
    SolveOptions {
        strategy: Strategy::Uniform,
        error: 0.5,
        point_rays: Some(1),
        uniform: UniformOptions { element_area: Some(element_area) },
        links: LinkOptions {
            leaf_rays: Some(0),
            rays_per_light_link: rays,
            rays_per_link: rays,
            form_factor_accuracy: 0.0,
            sweep_tolerance: 1e-9,
            subdivision,
            discontinuity_tolerance: Some(0.0),
            ..LinkOptions::default()
        },
        ..SolveOptions::default()
    }
}

/// The leaves of a surface, and the radiosity of each in its first channel.
fn leaves(solution: &Solution, of: SurfaceId) -> Vec<(Polygon, f64)> {
    let mut leaves = Vec::new();
    solution.for_each_leaf(|corners, surface, radiosity| {
        if SurfaceId(surface) == of {
            leaves.push((Polygon::new(corners).expect("elements are convex"), f64::from(radiosity[0])));
        }
    });
    leaves
}

/// How deep a point of the plane of a polygon lies in it, in metres.
fn depth(polygon: &Polygon, point: [f64; 3]) -> f64 {
    let corners: Vec<[f64; 3]> = polygon.vertices().collect();
    let from_side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        dot(unit(cross(polygon.normal(), sub(b, a))), sub(point, a))
    };
    (0..corners.len()).map(from_side).fold(f64::INFINITY, f64::min)
}

fn leaf_at(leaves: &[(Polygon, f64)], point: [f64; 3]) -> &(Polygon, f64) {
    leaves.iter().max_by(|a, b| depth(&a.0, point).total_cmp(&depth(&b.0, point))).unwrap()
}

/// Whatever decides what is split: the leaves of each surface are convex and add up to it, and none lies over another.
#[test]
fn elements_cover_every_surface_once() {
    for (name, scene, tolerance) in [("pyramid", pyramid(), 0.05), ("crowded", crowded(4, 5), 1.0)] {
        for strategy in [Strategy::Default, Strategy::Hanrahan91, Strategy::Uniform, Strategy::ErrorDriven, Strategy::Lazy94] {
            let mut options = uniform(Subdivision::Discontinuities, 0.2, 4);
            (options.strategy, options.solver) = (strategy, Solver::Links);
            (options.links.tolerance, options.links.min_element) = (Some(tolerance), 1e-3);
            let (evaluator, _) = solve(scene.clone(), &options);
            let solution = evaluator.solution();
            assert_eq!(solution.validate(), Ok(()), "{name}, {strategy}");
            let stored: Solution = postcard::from_bytes(&postcard::to_stdvec(solution).unwrap()).unwrap();
            assert!(stored == *solution, "{name}, {strategy}: what is stored is all");
            let mut random = Random(3);
            let mut elements = 0;
            for (index, surface) in scene.surfaces().iter().enumerate() {
                let leaves = leaves(solution, SurfaceId(index as u32));
                elements += leaves.len();
                let area: f64 = leaves.iter().map(|(leaf, _)| leaf.area()).sum();
                assert!((area / surface.polygon.area() - 1.0).abs() < 1e-9, "{name}, {strategy}, surface {index}: {area}");
                let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
                for _ in 0..20 {
                    let weights: Vec<f64> = corners.iter().map(|_| random.unit()).collect();
                    let sum: f64 = weights.iter().sum();
                    let point = corners.iter().zip(&weights).fold([0.0; 3], |point, (&c, w)| add(point, times(c, w / sum)));
                    let within = |least: f64| leaves.iter().filter(|(leaf, _)| depth(leaf, point) >= least).count();
                    assert!(within(-1e-9) >= 1 && within(1e-9) <= 1, "{name}, {strategy}, surface {index}: {point:?}");
                }
            }
            println!("{name}, {strategy}: {elements} elements");
            assert!(elements > scene.surfaces().len());
        }
    }
}

/// Once elements are small, no contact runs through the inside of one: the lines come first. Through regular elements many do.
#[test]
fn no_contact_runs_through_an_element() {
    let scene = pyramid();
    let found = of_emitters(&scene, 0.0);
    let contacts: Vec<[[f64; 3]; 2]> =
        found.of(FLOOR).iter().filter(|segment| segment.degree == Degree::D0).map(|segment| segment.ends()).collect();
    assert_eq!(contacts.len(), 4);
    let crossed = |subdivision| {
        let (evaluator, _) = solve(scene.clone(), &uniform(subdivision, 16.0 / 32.0, 4));
        let leaves = leaves(evaluator.solution(), FLOOR);
        let along = |[a, b]: [[f64; 3]; 2]| (1..100).map(move |k| add(a, times(sub(b, a), f64::from(k) / 100.0)));
        let points = contacts.iter().flat_map(|&contact| along(contact));
        points.filter(|&point| leaves.iter().any(|(leaf, _)| depth(leaf, point) > 1e-4)).count()
    };
    let (driven, regular) = (crossed(Subdivision::Discontinuities), crossed(Subdivision::Regular));
    println!("{driven} points of contacts lie inside of elements along discontinuities, {regular} inside of regular ones");
    assert!(driven == 0 && regular > 300);
}

/// Figure 4.5 in small: with regular elements some place stays off by most of the light, since an element that the pyramid covers in part is one
/// constant. Along discontinuities the largest error falls, and the root mean square is at most half as large, and falls faster.
#[test]
fn the_largest_error_falls_along_discontinuities_alone() {
    let scene = pyramid();
    let side = 60;
    let place = |k: usize| -2.0 + 4.0 * (k as f64 + 0.5) / side as f64;
    let points: Vec<(SurfaceId, [f64; 3])> = (0..side * side).map(|k| (FLOOR, [place(k % side), 0.0, place(k / side)])).collect();
    let visibility = build(Backend::Auto, &OccluderMesh::of_scene(&scene)).unwrap();
    let exact = direct_irradiance(&scene, &*visibility, &points, DirectEffort { rays: 1, method: Method::Exact }, 0);
    let exact: Vec<f64> = exact.irradiance.iter().step_by(scene.channels()).map(|h| 0.5 * h).collect();
    let brightest = exact.iter().copied().fold(0.0, f64::max);
    let errors = |subdivision, element_area: f64| {
        let (evaluator, _) = solve(scene.clone(), &uniform(subdivision, element_area, 64));
        let leaves = leaves(evaluator.solution(), FLOOR);
        let off = points.iter().zip(&exact).map(|((_, point), b)| (leaf_at(&leaves, *point).1 - b).abs() / brightest);
        let (sum, largest) = off.fold((0.0, 0.0), |(sum, largest), off| (sum + off * off, f64::max(largest, off)));
        let rms = f64::sqrt(sum / points.len() as f64);
        println!("{subdivision}: {} elements, RMS {rms:.4}, largest {largest:.3}", leaves.len());
        (leaves.len(), rms, largest)
    };
    let [coarse, fine] = [64.0, 1024.0].map(|count| errors(Subdivision::Regular, 16.0 / count));
    assert_eq!((coarse.0, fine.0), (64, 1024));
    assert!(coarse.2 > 0.75 && fine.2 > 0.75, "{coarse:?} {fine:?}");

    // No more elements than the regular ones.
    let [driven_coarse, driven] = [40.0, 600.0].map(|count| errors(Subdivision::Discontinuities, 16.0 / count));
    assert!(driven_coarse.0 <= 64 && driven.0 <= 1024, "{driven_coarse:?} {driven:?}");
    assert!(driven.2 < 0.7 * driven_coarse.2 && driven.2 < 0.35, "{driven_coarse:?} {driven:?}");
    assert!(driven_coarse.1 < 0.5 * coarse.1 && driven.1 < 0.5 * fine.1);
    assert!(driven.1 / driven_coarse.1 < fine.1 / coarse.1);
}

/// Two squares with a blocker between, whose solution is known: constant elements are of first order along discontinuities, too.
#[test]
fn elements_converge_to_the_exact_solution() {
    let exact = TwoSquares::new(true);
    let scene = rooms::two_squares(true);
    let mut random = Random(11);
    let points: Vec<(usize, [f64; 2])> = (0..600).map(|k| (k % 2, [random.unit(), random.unit()])).collect();
    let truth: Vec<f64> = points.iter().map(|&(square, x)| exact.at(square, x)).collect();
    let mut errors = Vec::new();
    for h in [0.5, 0.25, 0.125_f64] {
        let (evaluator, _) = solve(scene.clone(), &uniform(Subdivision::Discontinuities, h * h, 256));
        let squares = [0, 1].map(|square| leaves(evaluator.solution(), SurfaceId(square)));
        let off = points.iter().zip(&truth).map(|(&(square, [x, y]), b)| {
            let (_, radiosity) = leaf_at(&squares[square], [x, y, square as f64]);
            (radiosity - b).powi(2)
        });
        let rms = (off.sum::<f64>() / points.len() as f64).sqrt() / exact.mean(1);
        let elements = squares[0].len() + squares[1].len();
        println!("h {h}: {elements} elements, RMS {rms:.5}");
        errors.push((elements as f64, rms));
    }
    let order = -2.0 * (errors[2].1 / errors[0].1).ln() / (errors[2].0 / errors[0].0).ln();
    println!("order {order:.2}");
    assert!(order >= 0.9, "{errors:?}");
}
