//! Standard errors of values: over many points and seeds, values lie within one and within two of them as often as normal errors would.

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use patchlight::picture::Camera;
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{SolveOptions, Solver};
use patchlight::values::Values;
use rooms::{crowded, points_of, read, solve, two_squares};
use triangles::Random;

/// Points of all polygons of four corners that reflect, in proportion to their areas.
fn points(scene: &Scene, count: usize) -> Vec<SurfacePoint> {
    let mut random = Random(5);
    let reflects = |material: u32| scene.materials()[material as usize].reflectance.iter().any(|&rho| rho > 0.0);
    let surfaces: Vec<_> = scene.surfaces().iter().filter(|surface| reflects(surface.material)).collect();
    let total: f64 = surfaces.iter().map(|surface| surface.polygon.area()).sum();
    let mut below = 0.0;
    let mut points = Vec::new();
    for surface in surfaces {
        below += surface.polygon.area() / total;
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        while (points.len() as f64) < below * count as f64 {
            let (u, v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
            let along = |k: usize| corners[0][k] + u * (corners[1][k] - corners[0][k]) + v * (corners[3][k] - corners[0][k]);
            points.push(SurfacePoint { position: std::array::from_fn(along), normal: surface.polygon.normal() });
        }
    }
    points
}

fn solved(scene: Scene, solver: Solver, error: f64, seed: u64) -> Evaluator {
    solve(scene, &SolveOptions { error, solver, seed, ..SolveOptions::default() }).0
}

fn values(evaluator: &Evaluator, points: &[SurfacePoint]) -> Values {
    evaluator.values_at(points, &Silent).unwrap()
}

/// How many errors of values are within one and within 1.96 standard errors, and how many there are.
#[derive(Default)]
struct Within {
    within: [f64; 2],
    count: f64,
}

impl Within {
    fn add(&mut self, found: &Values, truth: &Values) {
        for index in 0..found.radiosity.len() {
            let off = f64::from((found.radiosity[index] - truth.radiosity[index]).abs());
            let bar = f64::from(found.standard_error[index]).hypot(f64::from(truth.standard_error[index]));
            assert!(bar.is_finite(), "{bar} at {index}");
            // Points under boxes are dark.
            if bar > 0.0 {
                self.count += 1.0;
                let is_within = [1.0, 1.96].map(|bars| f64::from(u8::from(off <= bars * bar)));
                self.within = std::array::from_fn(|which| self.within[which] + is_within[which]);
            } else {
                assert!(off < 1e-6, "{off} at {index}");
            }
        }
    }

    fn parts(&self) -> [f64; 2] {
        self.within.map(|within| within / self.count)
    }
}

/// The parts of all errors that are within one and within 1.96 standard errors: 68 and 95% where errors are normal and known. They have
/// tails, and their deviation is known to a fifth at a single point, so a little less often within two.
#[test]
fn errors_lie_within_their_bars_as_often_as_these_say() {
    for (solver, boxes) in [(Solver::Links, 3), (Solver::Cells, 3), (Solver::Cells, 30)] {
        let scene = || crowded(boxes, 4);
        let points = points(&scene(), 400);
        let truth = values(&solved(scene(), Solver::Cells, 0.005, 99), &points);
        let mut within = Within::default();
        for seed in 0..6 {
            within.add(&values(&solved(scene(), solver, 0.04, seed), &points), &truth);
        }
        let [one, two] = within.parts();
        assert!((0.6..0.8).contains(&one), "{solver:?}, {boxes} boxes: {one} within one");
        assert!((0.9..0.99).contains(&two), "{solver:?}, {boxes} boxes: {two} within two");
    }
}

/// The same of a lit mesh. Its bars are root mean squares over elements, so in those with an edge of light most points are within.
#[test]
fn errors_of_a_lit_mesh_lie_within_the_bars_of_its_elements() {
    for boxes in [3, 30] {
        let scene = || crowded(boxes, 4);
        let points = points(&scene(), 400);
        let truth = values(&solved(scene(), Solver::Cells, 0.005, 99), &points);
        let (mut within, mut told) = (Within::default(), Vec::new());
        for seed in 0..4 {
            let options = SolveOptions { error: 0.05, lit_mesh: true, seed, ..SolveOptions::default() };
            let (evaluator, report) = solve(scene(), &options);
            let found = evaluator.mesh_values_at(&points).unwrap();
            within.add(&found, &truth);
            told.push([found.error.unwrap().local, report.lit_mesh.unwrap().whole.measured]);
            let parts = evaluator.mesh().unwrap().parts(evaluator.solution().scene());
            assert!(parts.flat_map(|part| part.standard_errors).all(|error| error.is_finite() && error >= 0.0));
        }
        let [one, two] = within.parts();
        assert!((0.6..0.85).contains(&one), "{boxes} boxes: {one} within one");
        assert!((0.88..0.99).contains(&two), "{boxes} boxes: {two} within two");
        // Over these points they come to what is told of the whole, whose points are others.
        assert!(told.iter().all(|[bars, whole]| (0.5..2.0).contains(&(bars / whole))), "{told:?}");
    }
}

#[test]
fn what_is_exact_has_no_error_to_speak_of() {
    let evaluator = solved(two_squares(false), Solver::Links, 0.01, 0);
    let above = |x: f64| SurfacePoint { position: [x, 0.4, 1.0], normal: [0.0, 0.0, -1.0] };
    let found = values(&evaluator, &[above(0.1), above(0.5)]);
    let part = |index: usize| found.standard_error[index] / found.radiosity[index];
    assert!(part(0) < 0.01 && part(1) < 0.01, "{found:?}");
    let error = found.error.unwrap();
    assert!(error.energy < 0.01 && error.local < 0.01, "{error:?}");
}

#[test]
fn pictures_have_bars_as_values_do() {
    let evaluator = solved(crowded(3, 4), Solver::Cells, 0.1, 0);
    let camera = Camera { width: 16, height: 12, ..evaluator.default_camera(16, 12) };
    let image = evaluator.render(&camera, &Silent).unwrap().unwrap();
    let errors = image.standard_error.as_ref().unwrap();
    assert_eq!(errors.len(), image.radiance.len());
    let parts: Vec<f32> = errors.iter().zip(&image.radiance).filter(|(_, l)| **l > 0.0).map(|(error, l)| error / l).collect();
    let mean = parts.iter().sum::<f32>() / parts.len() as f32;
    // Asked for 10% with all rays; pictures take fewer.
    assert!((0.01..0.3).contains(&mean), "{mean}");
}

/// Whoever interrupts a solve is not kept waiting: values take the fewest rays there are, their standard errors say so, and time enough gives the planned ones.
#[test]
fn hurried_values_are_coarser_and_own_it() {
    for (name, solver) in [("room.obj", Solver::Links), ("full_office.obj", Solver::Cells)] {
        let scene = read(name);
        let points: Vec<SurfacePoint> = points_of(&scene, 1000, &mut Random(3)).into_iter().map(|(point, _)| point).collect();
        let evaluator = solved(scene, solver, 0.05, 0);
        let planned = evaluator.values_at(&points, &Silent).unwrap();
        assert_eq!(evaluator.hurried_values_at(&points, 1e9, &Silent).unwrap().0, planned);

        let (hurried, _) = evaluator.hurried_values_at(&points, 0.0, &Silent).unwrap();
        let size = |numbers: &mut dyn Iterator<Item = f32>| numbers.map(|x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        let off = size(&mut hurried.radiosity.iter().zip(&planned.radiosity).map(|(a, b)| a - b));
        let [own, of_planned] = [&hurried, &planned].map(|values| size(&mut values.standard_error.iter().copied()));
        let is_owned = own > 1.2 * of_planned && (0.5..1.5).contains(&(off / own));
        assert!(is_owned, "{name}: off by {off} with standard errors of {own}, planned {of_planned}");
    }
}
