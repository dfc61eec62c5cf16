//! Shadows of lights that are no surfaces, on the lit mesh: exact on both sides of their borders.
#![allow(clippy::print_stderr, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use patchlight::discontinuities::{Degree, Discontinuities, of_lights};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Light, LightShape, PointLight, Scene, Spot, Sun, SurfaceId, SurfacePoint};
use rooms::{Room, solved};
use triangles::Random;

/// The ground is the first surface.
const GROUND: SurfaceId = SurfaceId(0);

/// The corners of the plate, at height 1.
const PLATE: [[f64; 2]; 4] = [[-0.3, -0.6], [0.7, -0.6], [0.7, 0.4], [-0.3, 0.4]];

const LAMP: DVec3 = DVec3::new(0.1, 0.2, 3.0);

/// Grey ground of 6 x 6 m around the origin, and a black square of 1 m over it.
fn scene(lights: Vec<LightShape>) -> Scene {
    let mut room = Room::default();
    let (grey, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[0.0]));
    room.quad([-3.0, -3.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], grey);
    room.sheet(&PLATE.map(|[x, y]| [x, y, 1.0]), black);
    let light = |(number, shape)| Light { name: format!("light {number}"), strength: vec![10.0], shape };
    room.scene().with_lights(lights.into_iter().enumerate().map(light).collect()).unwrap()
}

fn lamp() -> LightShape {
    LightShape::Point(PointLight::uniform(LAMP.to_array()))
}

fn sun(diameter: f64) -> LightShape {
    LightShape::Sun(Sun::new([0.6, 0.0, 0.8], diameter).unwrap())
}

/// The corners of the plate's shadow from a point, or from afar.
fn shadow_of_lamp() -> [DVec2; 4] {
    PLATE.map(|[x, y]| LAMP.truncate() + (DVec2::new(x, y) - LAMP.truncate()) * 1.5)
}

fn shadow_of_sun() -> [DVec2; 4] {
    PLATE.map(|[x, y]| DVec2::new(x - 0.75, y))
}

fn from_lamp(at: DVec2) -> f64 {
    0.5 * 10.0 * LAMP.z / (LAMP - at.extend(0.0)).length().powi(3)
}

/// What a mesh for this error has at places of the ground.
fn values(evaluator: &Evaluator, error: f64, places: &[DVec2]) -> Vec<f64> {
    let mesh = evaluator.lit_mesh(error, &Silent).unwrap();
    assert!(mesh.claimed <= error, "{} claimed", mesh.claimed);
    let on_ground = |at: &DVec2| SurfacePoint { position: at.extend(0.0).to_array(), normal: [0.0, 0.0, 1.0] };
    let points: Vec<SurfacePoint> = places.iter().map(on_ground).collect();
    evaluator.values_of_mesh(&mesh, &points).into_iter().map(f64::from).collect()
}

/// Places along the sides of a square, so far inside of it and outside.
fn beside(square: [DVec2; 4], by: f64) -> Vec<[DVec2; 2]> {
    let of_side = |side: usize| {
        let (from, to) = (square[side], square[(side + 1) % 4]);
        let inward = (to - from).normalize().perp();
        (1..100).map(move |k| from.lerp(to, f64::from(k) / 100.0)).map(move |at| [at + by * inward, at - by * inward])
    };
    (0..4).flat_map(of_side).collect()
}

/// The mesh is dark inside of a shadow, and as bright as it is outside, a thousandth of the distance of what casts it beside its border.
fn check_step(light: LightShape, square: [DVec2; 4], exact: impl Fn(DVec2) -> f64) {
    let (evaluator, _) = solved(scene(vec![light]), 0.02, 0);
    let places = beside(square, 1e-3);
    let found = values(&evaluator, 0.01, places.as_flattened());
    let mut most = 0.0_f64;
    for ([_, outside], value) in places.iter().zip(found.chunks(2)) {
        assert_eq!(value[0], 0.0, "inside of {outside}");
        let off = (value[1] / exact(*outside) - 1.0).abs();
        assert!(off < 0.01, "{outside}: {} for {}", value[1], exact(*outside));
        most = most.max(off);
    }
    eprintln!("{most:.5} off at most");
}

#[test]
fn the_shadow_under_a_lamp_is_exact_on_both_sides() {
    check_step(lamp(), shadow_of_lamp(), from_lamp);
}

#[test]
fn the_shadow_of_parallel_light_is_exact_on_both_sides() {
    check_step(sun(0.0), shadow_of_sun(), |_| 0.5 * 10.0 * 0.8);
}

/// How far the penumbra of the sides along x reaches on either side: 1 m below them, where a plane through the side touches the sun.
fn half_penumbra(radius: f64) -> f64 {
    (radius.sin() / 0.8).asin().tan()
}

#[test]
fn the_penumbra_of_a_sun_lies_between_its_borders() {
    // Across the sides along x: the sun stands in the plane of the middle of the penumbra, so its borders are even.
    let radius = 0.02_f64;
    let (evaluator, _) = solved(scene(vec![sun(2.0 * radius)]), 0.02, 0);
    let middle = DVec2::new(-0.55, -0.6);
    // A plane along x that is turned by an angle from the one through the sun's middle is off that by 0.8 times its sine.
    let seen = |beside: f64| {
        let a = (0.8 * beside.atan().sin() / radius.sin()).clamp(-1.0, 1.0);
        1.0 - (a.acos() - a * (1.0 - a * a).sqrt()) / PI
    };
    let half = half_penumbra(radius);
    let offsets: Vec<f64> = (-40..=40).map(|k| f64::from(k) / 20.0 * half).collect();
    let places: Vec<DVec2> = offsets.iter().map(|&d| middle - DVec2::new(0.0, d)).collect();
    let found = values(&evaluator, 0.01, &places);
    let mut squares = 0.0;
    for (&d, value) in offsets.iter().zip(&found) {
        let off = value / (0.5 * 10.0 * 0.8) - seen(d);
        // An element across the penumbra follows its curve to some hundredths; beside it nothing is wrong.
        let allowed = if d.abs() < half { 0.08 } else { 0.005 };
        assert!(off.abs() < allowed, "{d}: {value}, {} seen", seen(d));
        squares += off * off;
    }
    let rms = (squares / offsets.len() as f64).sqrt();
    eprintln!("{rms:.4} off in the root mean square");
    assert!(rms < 0.01, "{rms}");
}

/// Whether segments of a degree lie along all of a way.
fn covers(found: &Discontinuities, degree: Degree, from: DVec2, to: DVec2) -> bool {
    (0..=20).all(|k| {
        let at = from.lerp(to, f64::from(k) / 20.0).extend(0.0);
        found.of(GROUND).iter().filter(|segment| segment.degree == degree).any(|segment| {
            let [a, b] = segment.ends().map(DVec3::from);
            let part = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            at.distance(a.lerp(b, part)) < 1e-6
        })
    })
}

#[test]
fn borders_are_found_where_they_are_and_no_others() {
    for (light, square) in [(lamp(), shadow_of_lamp()), (sun(0.0), shadow_of_sun())] {
        let found = of_lights(&scene(vec![light]), 0.01);
        assert_eq!(found.of(GROUND).len(), 4);
        for side in 0..4 {
            assert!(covers(&found, Degree::D0, square[side], square[(side + 1) % 4]), "{:?}", found.of(GROUND));
        }
        let counters = found.counters();
        assert_eq!((counters.d0, counters.d1, counters.d2, counters.unfollowed_edges), (4, 0, 0, 0));
        assert!(found.of(GROUND).iter().all(|segment| segment.source.is_none() && segment.change.is_finite()));
    }
}

#[test]
fn a_disc_has_two_borders_at_each_side_and_one_where_it_is_next_to_a_point() {
    let radius = 0.02_f64;
    let found = of_lights(&scene(vec![sun(2.0 * radius)]), 0.01);
    assert_eq!(found.counters().d0 + found.counters().d2, 0);
    assert_eq!(found.of(GROUND).len(), 8);
    let half = half_penumbra(radius);
    let [a, b, ..] = shadow_of_sun();
    for beside in [-half, half] {
        let by = DVec2::new(0.0, beside);
        assert!(covers(&found, Degree::D1, a.lerp(b, 0.1) + by, a.lerp(b, 0.9) + by), "{:?}", found.of(GROUND));
    }
    let [_, b, c, _] = shadow_of_sun();
    let elevation = 0.8_f64.asin();
    for angle in [elevation - radius, elevation + radius] {
        let by = DVec2::new(0.75 - 1.0 / angle.tan(), 0.0);
        assert!(covers(&found, Degree::D1, b.lerp(c, 0.1) + by, b.lerp(c, 0.9) + by), "{:?}", found.of(GROUND));
    }

    // So narrow that a step is off by less than is tolerated.
    let narrow = of_lights(&scene(vec![sun(2e-9)]), 0.01);
    assert_eq!((narrow.counters().d0, narrow.counters().d1), (4, 0));
}

#[test]
fn what_brings_little_has_no_borders_and_that_is_counted() {
    let brings = 10.0 * 0.8;
    let found = of_lights(&scene(vec![sun(0.0)]), brings * 1.3);
    assert_eq!((found.counters().segments(), found.counters().weak_edges, found.counters().wedges), (0, 8, 0));
    // The lamp brings more to edges near it than to what lies below.
    let of_lamp = |tolerance: f64| *of_lights(&scene(vec![lamp()]), tolerance).counters();
    assert_eq!((of_lamp(0.5).segments(), of_lamp(0.5).left_out), (4, 0));
    let some = of_lamp(2.0);
    assert!(some.left_out > 0 && some.segments() + some.left_out == 4, "{some:?}");
    assert_eq!((of_lamp(3.0).weak_edges, of_lamp(3.0).wedges), (8, 0));
}

#[test]
fn a_lamp_that_touches_a_ceiling_is_not_hidden_by_it() {
    let mut room = Room::default();
    let (grey, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[0.0]));
    room.quad([-3.0, -3.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], grey);
    room.sheet(&PLATE.map(|[x, y]| [x, y, 1.0]), black);
    room.sheet(&[[-1.0, -1.0, 3.0], [1.0, -1.0, 3.0], [1.0, 1.0, 3.0], [-1.0, 1.0, 3.0]], black);
    let lamp = Light { name: "lamp".to_owned(), strength: vec![10.0], shape: lamp() };
    let found = of_lights(&room.scene().with_lights(vec![lamp]).unwrap(), 0.01);
    let square = shadow_of_lamp();
    assert!((0..4).all(|side| covers(&found, Degree::D0, square[side], square[(side + 1) % 4])));
}

#[test]
fn what_crosses_is_followed_by_elements_all_the_same() {
    // Two shadows that lie over each other in part.
    let (evaluator, _) = solved(scene(vec![lamp(), sun(0.0)]), 0.02, 0);
    let (of_lamp, of_sun) = (shadow_of_lamp(), shadow_of_sun());
    let is_in = |square: [DVec2; 4], at: DVec2| at.cmpgt(square[0]).all() && at.cmplt(square[2]).all();
    let near = |square: [DVec2; 4], at: DVec2| square.iter().any(|corner| (*corner - at).abs().min_element() < 2e-3);
    let mut places = beside(of_lamp, 1e-3);
    places.extend(beside(of_sun, 1e-3));
    let places: Vec<DVec2> = places.into_flattened();
    let found = values(&evaluator, 0.01, &places);
    for (&at, value) in places.iter().zip(found) {
        let exact = if is_in(of_lamp, at) { 0.0 } else { from_lamp(at) } + if is_in(of_sun, at) { 0.0 } else { 4.0 };
        let is_beside_both = near(of_lamp, at) && near(of_sun, at);
        assert!(is_beside_both || (value - exact).abs() <= 0.01 * exact, "{at}: {value} for {exact}");
    }
}

#[test]
fn a_jump_that_no_element_follows_is_not_overshot() {
    // The cone of a spot ends sharply, and its border is curved. Beside it there is a tenth of its light.
    let spot = Spot::new([0.0, 0.0, -1.0], 0.3, 0.3).unwrap();
    let spot = LightShape::Point(PointLight::new([0.0, 0.0, 3.0], patchlight::scene::Distribution::Spot(spot)));
    let even = LightShape::Sun(Sun::new([0.0, 0.0, 1.0], 0.0).unwrap());
    let mut room = Room::default();
    let grey = room.material(&[0.5], &[0.0]);
    room.quad([-3.0, -3.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], grey);
    let light = |strength: f64, shape| Light { name: format!("{strength}"), strength: vec![strength], shape };
    let scene = room.scene().with_lights(vec![light(9.0, spot), light(0.1, even)]).unwrap();
    let (evaluator, _) = solved(scene, 0.02, 0);
    let mut random = Random(5);
    let places: Vec<DVec2> =
        (0..20_000).map(|_| DVec2::from_angle(2.0 * PI * random.unit()) * (0.92 + random.between(-0.3, 0.3))).collect();
    let found = values(&evaluator, 0.1, &places);
    let [least, most] = [0.05, 0.05 + 0.5];
    for (at, value) in places.iter().zip(found) {
        assert!((least * 0.999..=most * 1.001).contains(&value), "{at}: {value}");
    }
}

#[test]
fn any_number_of_threads_makes_the_same_mesh() {
    let made = |threads: usize| {
        let (evaluator, _) = solved(scene(vec![lamp(), sun(0.01)]), 0.05, threads);
        let mesh = evaluator.lit_mesh(0.02, &Silent).unwrap();
        postcard::to_stdvec(&mesh).unwrap()
    };
    let one = made(1);
    assert!([2, 3].into_iter().all(|threads| made(threads) == one));
}
