//! Light that comes from no surface: against exact values, and against path tracing.
#![allow(clippy::print_stderr, reason = "a test tells what it measured")]

#[path = "support/claims.rs"]
mod claims;
#[path = "../benches/support/path_tracer.rs"]
mod path_tracer;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::f64::consts::PI;

use glam::DVec3;
use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::picture::Camera;
use patchlight::pipeline::{self, Evaluator, PipelineError};
use patchlight::progress::Silent;
use patchlight::scene::{
    EmitterName, Light, LightGroupError, LightGrouping, LightShape, LightWeight, PointLight, Scene, SceneError, Sky, Sun,
    SurfaceId, SurfacePoint,
};
use patchlight::solve::{Bounds, Norm, RunOptions, SolveOptions, Solver, Strategy};
use patchlight::visibility::{Backend, OccluderMesh, build};
use path_tracer::PathTracer;
use rooms::{Room, cube, points_of, solve, straight, values};
use triangles::Random;

fn light(name: &str, strength: &[f64], shape: LightShape) -> Light {
    Light { name: name.to_owned(), strength: strength.to_vec(), shape }
}

fn point(position: [f64; 3]) -> LightShape {
    LightShape::Point(PointLight::uniform(position))
}

fn sun(towards: [f64; 3], diameter: f64) -> LightShape {
    LightShape::Sun(Sun::new(towards, diameter).unwrap())
}

fn sky() -> LightShape {
    LightShape::Sky(Sky::uniform([0.0, 0.0, 1.0]).unwrap())
}

/// Ground of 4 x 4 m around the origin, and a black plate of 2 x 2 m, 1 m above it, whose middle is above `x`, `y`.
fn under_a_plate(x: f64, y: f64, lights: Vec<Light>) -> Scene {
    let mut room = Room::default();
    let (grey, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[0.0]));
    room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], grey);
    let plate = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[u, v]| [x + u, y + v, 1.0]);
    room.sheet(&plate, black);
    room.scene().with_lights(lights).unwrap()
}

fn options(solver: Solver, error: f64) -> SolveOptions {
    SolveOptions { solver, error, ..SolveOptions::default() }
}

fn on_ground(at: &[[f64; 2]]) -> Vec<SurfacePoint> {
    at.iter().map(|&[x, y]| SurfacePoint { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0] }).collect()
}

const WAYS: [Solver; 2] = [Solver::Links, Solver::Cells];

const STRATEGIES: [Strategy; 11] = [
    Strategy::Default,
    Strategy::Uniform,
    Strategy::Hanrahan91,
    Strategy::Original94,
    Strategy::Culling94,
    Strategy::Lazy94,
    Strategy::Lazy94Reduction,
    Strategy::ErrorDriven,
    Strategy::TopDown98,
    Strategy::BottomUp98,
    Strategy::Multiresolution96,
];

#[test]
fn points_and_suns_light_the_ground_exactly() {
    let at = [[-1.5, -1.5], [0.3, -0.2], [-0.4, 1.1], [1.9, 0.1]];
    for way in WAYS {
        let lights = vec![light("lamp", &[3.0], point([-1.0, 0.5, 0.75])), light("sun", &[2.0], sun([0.6, 0.0, 0.8], 0.0))];
        let (evaluator, report) = solve(under_a_plate(1.0, 1.0, lights), &options(way, 0.05));
        for (found, [x, y]) in values(&evaluator, &on_ground(&at)).iter().zip(at) {
            let to = DVec3::new(-1.0 - x, 0.5 - y, 0.75);
            let from_lamp = 3.0 * 0.75 / to.length().powi(3);
            // The plate's shadow lies three quarters of a metre beside it.
            let is_shaded = (-0.75..1.25).contains(&x) && (0.0..2.0).contains(&y);
            let expected = 0.5 * (from_lamp + if is_shaded { 0.0 } else { 2.0 * 0.8 });
            assert!((found - expected).abs() < 1e-6 * expected, "{way:?} {x} {y}: {found} for {expected}");
        }
        assert!(report.converged, "{report:?}");
    }
}

#[test]
fn the_penumbra_of_a_sun_is_the_part_of_its_disc_that_is_seen() {
    // An edge 1 m above: at a distance d from below it, a part of the disc of radius sin r is beyond.
    let radius = 0.1_f64;
    let lights = vec![light("sun", &[1.0], sun([0.0, 0.0, 1.0], 2.0 * radius))];
    let offsets = [-0.5, -0.07, -0.03, 0.0, 0.05, 0.08, 0.5];
    for way in WAYS {
        let (evaluator, _) = solve(under_a_plate(1.0, 0.0, lights.clone()), &options(way, 0.01));
        let at: Vec<[f64; 2]> = offsets.iter().map(|&d| [d, 0.0]).collect();
        let found = evaluator.values_at(&on_ground(&at), &Silent).unwrap();
        for (number, &d) in offsets.iter().enumerate() {
            // The edge is seen at the angle whose tangent is d; the plate covers what lies beyond it.
            let a = (-d.atan().sin() / radius.sin()).clamp(-1.0, 1.0);
            let seen = 1.0 - (a.acos() - a * (1.0 - a * a).sqrt()) / PI;
            let (value, expected) = (f64::from(found.radiosity[number]), 0.5 * seen);
            let se = f64::from(found.standard_error[number]);
            assert!((value - expected).abs() < 4.0 * se + 0.02 * 0.5, "{way:?} {d}: {value} +- {se} for {expected}");
        }
    }
}

/// From a square of side 2 to one of side 4 around the point 1 m below its middle, by 100,000 directions: to half a hundredth.
fn form_factor_to_ground() -> f64 {
    let mut random = Random(9);
    let count = 100_000;
    let mut arrives = || {
        let [x, y] = [(); 2].map(|()| random.between(-1.0, 1.0));
        let (s, turn) = (random.unit(), 2.0 * PI * random.unit());
        let run = (s / (1.0 - s)).sqrt();
        (x + run * turn.cos()).abs() < 2.0 && (y + run * turn.sin()).abs() < 2.0
    };
    f64::from((0..count).map(|_| u32::from(arrives())).sum::<u32>()) / f64::from(count)
}

#[test]
fn a_plate_takes_its_form_factor_of_the_sky_away() {
    let lights = || vec![light("sky", &[1.0], sky())];
    // Under the middle of a square of side 2 at height 1 (Howell C-12: four times the corner of one metre square).
    let covered = 4.0 * 0.5 / PI * (2.0 / 2f64.sqrt() * (1.0 / 2f64.sqrt()).atan());
    let seen_by_plate = form_factor_to_ground();
    for way in WAYS {
        let (evaluator, report) = solve(under_a_plate(0.0, 0.0, lights()), &options(way, 0.01));
        let values = evaluator.values_at(&on_ground(&[[0.0, 0.0]]), &Silent).unwrap();
        let (found, se) = (f64::from(values.radiosity[0]), f64::from(values.standard_error[0]));
        let expected = 0.5 * (1.0 - covered);
        assert!((found - expected).abs() < 4.0 * se + 0.01 * expected, "{way:?}: {found} +- {se} for {expected}");
        // The plate has all of the sky on its top, none below; it takes from the ground what it sees of that.
        let energy = report.energy;
        let on_ground = 16.0 - 4.0 * seen_by_plate;
        assert!((energy.of_lights / (4.0 + on_ground) - 1.0).abs() < 0.05, "{way:?}: {energy:?}");
        // Half of what arrives on the ground is reflected, and counts as escaped: what is black is not linked.
        let absorbed = 4.0 + 0.5 * (energy.of_lights - 4.0);
        assert!((energy.absorbed / absorbed - 1.0).abs() < 1e-9, "{way:?}: {absorbed} {energy:?}");
        assert!((energy.escaped - 0.5 * (energy.of_lights - 4.0)).abs() < 1e-9, "{way:?}: {energy:?}");
    }
}

/// Pictures show where shadows of lights end: of a point 1.5 m above a plate of 2 m, 5/3 m to each side on the ground 1 m below.
#[test]
fn curves_show_where_shadows_of_lights_end() {
    let scene = under_a_plate(0.0, 0.0, vec![light("lamp", &[5.0], point([0.0, 0.0, 2.5]))]);
    let (evaluator, _) = solve(scene, &options(Solver::Cells, 0.1));
    // From under the plate, 2 m to each side.
    let field_of_view_degrees = 2.0 * 2.0_f64.atan2(0.9).to_degrees();
    let [eye, up] = [[0.0, 0.0, 0.9], [0.0, 1.0, 0.0]];
    let camera = Camera { eye, target: [0.0; 3], up, field_of_view_degrees, width: 200, height: 200 };
    let marks = evaluator.mark_curves(1e-3, &camera, &Silent).unwrap().unwrap();
    let pixels: Vec<usize> = marks.pixels().map(|(pixel, _)| pixel).collect();
    let from_middle = |pixel: usize| [pixel % 200, pixel / 200].map(|at| (at as f64 - 99.5).abs() * 0.02);
    let is_on_border = |&pixel: &usize| {
        let [x, y] = from_middle(pixel);
        (x.max(y) - 5.0 / 3.0).abs() < 0.04
    };
    // Four sides of 167 pixels.
    assert!(pixels.iter().all(is_on_border) && (640..1400).contains(&pixels.len()), "{pixels:?}");
}

/// A lamp in a closed box: what it sends is absorbed, whatever reflects it in between.
#[test]
fn a_closed_room_absorbs_what_a_point_light_sends() {
    let scene = cube(&[0.8], &[0.0]).with_lights(vec![light("lamp", &[5.0], point([0.4, 0.3, 0.6]))]).unwrap();
    for way in WAYS {
        let (evaluator, report) = solve(scene.clone(), &options(way, 0.01));
        let sent = 4.0 * PI * 5.0;
        assert!((report.energy.of_lights / sent - 1.0).abs() < 0.05, "{way:?}: {:?}", report.energy);
        let places = points_of(&scene, 4000, &mut Random(5));
        let points: Vec<SurfacePoint> = places.iter().map(|(point, _)| *point).collect();
        let mean: f64 = values(&evaluator, &points).iter().sum::<f64>() / points.len() as f64;
        // B = 0.8 H over 6 m^2, of which a fifth is absorbed. 4000 random points know the mean of what varies by half to a hundredth.
        let expected = sent / 6.0 * 0.8 / 0.2;
        assert!((mean / expected - 1.0).abs() < 0.03 + report.error.estimate, "{way:?}: {mean} for {expected}");
    }
}

/// A room with a window, a table and a lamp, under a sun and a sky.
fn sunlit_room() -> Scene {
    let mut room = Room::default();
    let [wall, floor, wood] = [[0.7, 0.7, 0.65], [0.4, 0.3, 0.2], [0.5, 0.4, 0.25]].map(|rho| room.material(&rho, &[0.0; 3]));
    room.quad([0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], floor);
    room.quad([0.0, 0.0, 2.5], [0.0, 3.0, 0.0], [4.0, 0.0, 0.0], wall);
    room.quad([0.0; 3], [0.0, 3.0, 0.0], [0.0, 0.0, 2.5], wall);
    room.quad([0.0, 3.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 2.5], wall);
    room.quad([0.0; 3], [0.0, 0.0, 2.5], [4.0, 0.0, 0.0], wall);
    // The wall with the window, from 1 to 2 m.
    room.quad([4.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 3.0, 0.0], wall);
    room.quad([4.0, 0.0, 2.0], [0.0, 0.0, 0.5], [0.0, 3.0, 0.0], wall);
    room.quad([4.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.8, 0.0], wall);
    room.quad([4.0, 2.2, 1.0], [0.0, 0.0, 1.0], [0.0, 0.8, 0.0], wall);
    room.cuboid([1.5, 1.0, 0.6], straight(1.2, 0.8, 0.1), false, |_, _| wood);
    let lights = vec![
        light("lamp", &[2.0, 1.8, 1.4], point([1.0, 2.0, 2.2])),
        light("sun", &[100.0, 90.0, 80.0], sun([1.0, 0.3, 0.8], 0.03)),
        light("sky", &[20.0, 25.0, 40.0], sky()),
    ];
    room.scene().with_lights(lights).unwrap()
}

/// The claim holds against path tracing, over links and over cells.
#[test]
fn a_room_under_sun_and_sky_is_as_wrong_as_it_claims_at_most() {
    let scene = sunlit_room();
    let places = points_of(&scene, 400, &mut Random(11));
    let tracer = PathTracer::new(&scene, None, Backend::Auto);
    let truth: Vec<[f64; 3]> = places
        .iter()
        .map(|(point, surface)| tracer.batch(SurfaceId(*surface as u32), point.position, 1 << 12, 3).radiosity)
        .collect();
    let points: Vec<SurfacePoint> = places.iter().map(|(point, _)| *point).collect();
    let light_sq: f64 = truth.iter().flatten().map(|b| b * b).sum();
    let mut failed = 0;
    let errors = [0.2, 0.1, 0.05];
    for way in WAYS {
        for error in errors {
            let options = SolveOptions { norm: Norm::Energy, ..options(way, error) };
            let (evaluator, report) = solve(scene.clone(), &options);
            let found = values(&evaluator, &points);
            let off_sq: f64 = found.iter().zip(truth.iter().flatten()).map(|(found, truth)| (found - truth).powi(2)).sum();
            let (off, claimed) = ((off_sq / light_sq).sqrt(), report.error.estimate);
            eprintln!("{way:?} {error}: off {off:.4}, claimed {claimed:.4}, {:?}", report.stopped_by);
            // The reference is off as well: 4096 paths, by about a hundredth.
            failed += usize::from(off > claimed.hypot(0.015));
            assert!(report.converged, "{report:?}");
        }
    }
    assert!(failed <= claims::most_failures(WAYS.len() * errors.len()), "{failed} claims fail");
}

/// A sensor sees what a surface would, and a point light outside of a convex room does not shine through its walls.
#[test]
fn walls_of_a_convex_room_keep_light_out() {
    let lights = vec![
        light("lamp", &[5.0], point([0.5, 0.5, 2.0])),
        light("sun", &[5.0], sun([0.1, 0.2, 1.0], 0.01)),
        light("sky", &[1.0], sky()),
    ];
    let scene = cube(&[0.8], &[0.0]).with_lights(lights).unwrap();
    for way in WAYS {
        let (evaluator, report) = solve(scene.clone(), &options(way, 0.05));
        let points: Vec<SurfacePoint> = points_of(&scene, 100, &mut Random(5)).iter().map(|(point, _)| *point).collect();
        assert!(values(&evaluator, &points).iter().all(|&b| b == 0.0), "{way:?}");
        assert_eq!((report.energy.of_lights, report.error.estimate), (0.0, 0.0));
        let sensors = [0.5, 1.5].map(|z| SurfacePoint { position: [0.5, 0.5, z], normal: [0.0, 0.0, 1.0] });
        let [inside, above] = evaluator.irradiances_at(&sensors, &Silent).irradiance[..] else { panic!("two sensors") };
        assert_eq!(inside, 0.0);
        // 5 / 0.25 from the lamp, the sun by its cosine, and the whole sky.
        let expected = 20.0 + 5.0 / (1.0 + 0.05_f64).sqrt() + 1.0;
        assert!((f64::from(above) / expected - 1.0).abs() < 0.01, "{way:?}: {above} for {expected}");
    }
}

/// The light of a group alone is what its light alone brings; other weights are sums, in values, fluxes and a stored solution.
#[test]
fn lights_make_light_groups() {
    let all = sunlit_room();
    let groups = LightGrouping::Named(vec![
        ("day".to_owned(), vec!["light sun".parse().unwrap(), "light sky".parse().unwrap()]),
        ("night".to_owned(), vec![EmitterName::Light("lamp".to_owned())]),
    ]);
    let weight = |group: &str, weight: f64| LightWeight { group: group.to_owned(), by_band: vec![weight] };
    let points: Vec<SurfacePoint> = points_of(&all, 200, &mut Random(31)).iter().map(|(point, _)| *point).collect();
    let rms = |values: &[f64]| (values.iter().map(|b| b * b).sum::<f64>() / values.len() as f64).sqrt();
    let power = |evaluator: &Evaluator| evaluator.solution().fluxes().iter().map(|flux| flux.incident[1]).sum::<f64>();
    for way in WAYS {
        let options = SolveOptions { norm: Norm::Energy, ..options(way, 0.05) };
        let (evaluator, report) = solve(all.with_light_groups(&groups).unwrap(), &options);
        let (plain, plain_report) = solve(all.clone(), &options);
        assert_eq!(values(&evaluator, &points), values(&plain, &points), "{way:?}: groups change nothing of the sum");
        assert_eq!(report.error.estimate, plain_report.error.estimate);

        let mut powers = Vec::new();
        for (group, other, names) in [("day", "night", &["sun", "sky"][..]), ("night", "day", &["lamp"])] {
            let relit = evaluator.solution().relit(&[weight(other, 0.0)]).unwrap();
            relit.validate().unwrap();
            let claimed = relit.light_groups_report().unwrap().error.estimate;
            let relit = Evaluator::new(relit, &RunOptions::default()).unwrap();
            let lights: Vec<Light> = all.lights().iter().filter(|light| names.contains(&&*light.name)).cloned().collect();
            let (alone, alone_report) = solve(all.clone().with_lights(lights).unwrap(), &options);
            let (found, expected) = (values(&relit, &points), values(&alone, &points));
            let off: Vec<f64> = found.iter().zip(&expected).map(|(found, expected)| found - expected).collect();
            let (off, allowed) = (rms(&off) / rms(&expected), claimed.hypot(alone_report.error.estimate));
            eprintln!("{way:?} {group}: off {off:.4}, claimed {claimed:.4} and {:.4}", alone_report.error.estimate);
            assert!(off <= allowed, "{way:?} {group}: {off} for {allowed}");
            powers.push(power(&relit));
        }
        // What arrives by all is the sum of what arrives by each.
        let (sum, all) = (powers.iter().sum::<f64>(), power(&evaluator));
        assert!((sum / all - 1.0).abs() < 1e-6, "{way:?}: {powers:?} for {all}");
    }
    let unnamed = LightGrouping::Named(vec![("day".to_owned(), vec!["light sun".parse().unwrap(), "light sky".parse().unwrap()])]);
    assert!(matches!(all.with_light_groups(&unnamed), Err(LightGroupError::Light { name, .. }) if name == "lamp"));
}

/// Of fifty lights, more than there are rays, some of which suns with discs: draws are right on average, and know their scatter.
#[test]
fn lights_that_are_drawn_bring_what_all_bring() {
    let mut random = Random(17);
    let mut lights = Vec::new();
    for number in 0..50 {
        let at = [random.between(-3.0, 3.0), random.between(-3.0, 3.0), random.between(0.3, 3.0)];
        let shape = if number % 5 == 0 { sun(at, 0.02) } else { point(at) };
        lights.push(light(&format!("{number}"), &[random.between(0.1, 2.0)], shape));
    }
    let scene = under_a_plate(0.2, -0.1, lights);
    let visibility = build(Backend::Auto, &OccluderMesh::of_scene(&scene)).unwrap();
    let points = vec![(SurfaceId(0), [0.4, 0.3, 0.0]); 4000];
    let many = direct_irradiance(&scene, &*visibility, &points[..1], DirectEffort { rays: 20_000, method: Method::Rays }, 5);
    for rays in [1, 2, 7, 16, 49, 64] {
        let effort = DirectEffort { rays, method: Method::Rays };
        let found: Vec<[f64; 2]> = (0..4000)
            .map(|seed| {
                let found = direct_irradiance(&scene, &*visibility, &points[..1], effort, seed);
                [found.irradiance[0], found.variance[0]]
            })
            .collect();
        let count = found.len() as f64;
        let mean = found.iter().map(|[h, _]| h).sum::<f64>() / count;
        let variance = found.iter().map(|[h, _]| (h - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let told = found.iter().map(|[_, variance]| variance).sum::<f64>() / count;
        let se = (variance / count).sqrt() + 1e-3 * mean;
        assert!((mean - many.irradiance[0]).abs() < 4.0 * se, "{rays} rays: {mean} +- {se} for {}", many.irradiance[0]);
        // A single ray tells nothing of its variance; the discs' points are spread evenly, so that they scatter less than they tell.
        assert!(rays == 1 || (told > 0.8 * variance && told < 3.0 * variance + 1e-9), "{rays} rays: {told} for {variance}");
    }
}

/// The dimmest and the brightest lamps, and one that all but touches the ground.
#[test]
fn lamps_out_of_range_are_refused_and_near_ones_stay_finite() {
    for strength in [1e-40, 1e21, -1.0, f64::NAN, f64::INFINITY] {
        let lamp = light("lamp", &[strength], point([0.0, 0.0, 1.0]));
        let wrong = under_a_plate(0.0, 0.0, Vec::new()).with_lights(vec![lamp]);
        assert!(matches!(wrong, Err(SceneError::BadLight { .. })), "{strength}");
    }
    for way in WAYS {
        for (strength, height) in [(1e-30, 0.5), (1e20, 1e-12), (1e20, 0.5)] {
            // The solution is checked where it is solved.
            let (_, report) =
                solve(under_a_plate(0.0, 0.0, vec![light("lamp", &[strength], point([-1.5, 0.0, height]))]), &options(way, 0.1));
            assert!(report.error.estimate.is_finite(), "{way:?} {strength} {height}: {report:?}");
        }
    }
}

#[test]
fn bounds_refuse_lights_and_strategies_know_them() {
    let scene = under_a_plate(0.0, 0.0, vec![light("lamp", &[3.0], point([-1.9, 0.0, 0.5]))]);
    let bounded = SolveOptions { bounds: Bounds::Guaranteed, ..options(Solver::Auto, 0.05) };
    let refused = pipeline::solve(scene.clone(), &bounded, &RunOptions::default(), &Silent);
    assert!(matches!(refused, Err(PipelineError::Lights)));
    for strategy in STRATEGIES {
        let options = SolveOptions { strategy, ..options(Solver::Auto, 0.1) };
        let (evaluator, _) = solve(scene.clone(), &options);
        let expected = 0.5 * 3.0 * 0.5 / DVec3::new(-1.9, 0.0, 0.5).length().powi(3);
        let found = values(&evaluator, &on_ground(&[[0.0, 0.0]]))[0];
        assert!((found - expected).abs() < 1e-6 * expected, "{strategy:?}: {found} for {expected}");

        // In a closed room of 6 m^2 that absorbs a fifth of what arrives; the paper's strategies bounce light a fixed number of times.
        let lamp = light("lamp", &[5.0], point([0.4, 0.3, 0.6]));
        let (_, report) = solve(cube(&[0.8], &[0.0]).with_lights(vec![lamp]).unwrap(), &options);
        let (sent, expected) = (report.energy.sent, 4.0 * PI * 5.0 * 0.8 / 0.2);
        eprintln!("{strategy:?}: {sent:.1} W sent of {expected:.1}");
        assert!(sent > 0.6 * expected && sent < 1.1 * expected, "{strategy:?}: {sent} for {expected}");
    }
}
